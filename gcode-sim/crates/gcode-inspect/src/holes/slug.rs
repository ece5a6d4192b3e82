//! Slug of a through hole: metal that comes loose inside a circle while the mill still goes round it.
use nalgebra::{Point3, Unit, Vector3};

use super::HoleExtractor;
use super::metal::MAX_OFFSET;
use crate::machine::TOUCH_DEPTH;

/// Least diameter and height of a slug, mm; a thinner one breaks up.
const MIN_SLUG: f64 = 1.0;

/// Length below a circle along which metal would hold its slug, mm.
const MAX_FLOOR: f64 = 1000.0;

/// Full turn of a mill, at the height of its highest point.
#[derive(Clone, Copy, Debug)]
pub(super) struct Turn {
    pub centre: Point3<f64>,
    pub out: Unit<Vector3<f64>>,
    pub radius: f64,
}

impl HoleExtractor<'_> {
    /// Records the slug that the current run of arcs has cut loose: later feeds remove no metal that holds no longer.
    pub(super) fn note_slug(&mut self) {
        let Some(turn) = self.engagement.next_turn() else { return };
        if let Some(slug) = self.slug(&turn) {
            self.engagement.set_slug(slug);
        }
    }

    /// Returns the diameter of the metal inside a turn through the far side of a nominal hole.
    fn slug(&self, turn: &Turn) -> Option<f64> {
        let Turn { centre, out, radius } = *turn;
        let cutter = self.machine.diameter_of(self.setup.tool)?;
        let inner = radius - cutter / 2.0;
        let is_pointed = self.machine.tool_end(self.setup.tool).first().is_some_and(|full| 0.0 < full.from);
        if is_pointed || 2.0 * inner < MIN_SLUG || !self.is_through(&centre, &out) {
            return None;
        }
        let below = centre - out.into_inner() * TOUCH_DEPTH;
        if self.metal.is_solid(&[below, below - out.into_inner() * MAX_FLOOR]) {
            return None;
        }
        self.left_inside(&centre, &out, &[[0.0, inner]], MIN_SLUG).map(|_| 2.0 * inner)
    }

    /// Returns true if a point is on the axis of a nominal through hole, at its far side or below.
    fn is_through(&self, p: &Point3<f64>, out: &Unit<Vector3<f64>>) -> bool {
        let Some(holes) = self.metal.holes.as_ref() else { return false };
        let mut is_through = false;
        let up = p + out.into_inner() * self.metal.removed.height_of_metal(p, out).max(MAX_OFFSET);
        holes.around(&p.inf(&up), &p.sup(&up), &mut |hole| {
            let collar = holes.collar(hole);
            let is_below = collar.rod.length <= collar.depth(p) + TOUCH_DEPTH;
            is_through |=
                collar.is_through && collar.is_parallel(out) && is_below && collar.from_axis(p) <= MAX_OFFSET;
        });
        is_through
    }
}
