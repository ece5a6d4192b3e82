//! Where holes enter the part: below what the program has removed before their first pass.
use nalgebra::{Point3, Vector3};

use super::axis_box::directions_across;
use super::metal::{KnownMetal, is_rounding};
use super::removed_metal::Covers;
use super::strip::{Line, Strip};
use super::{DrilledHole, HoleExtractor};
use crate::machine::TOUCH_DEPTH;

/// Distance inside the wall of a hole at which the metal round an empty axis is looked for, mm.
const INSIDE_WALL: f64 = 0.05;

impl HoleExtractor<'_> {
    /// Finds where each hole enters the part: a body that is known, without what its feeds have removed before.
    pub(super) fn find_surfaces(&self, holes: &mut [DrilledHole]) {
        for hole in holes {
            hole.surface = self.surface_of(hole);
        }
    }

    fn surface_of(&self, hole: &DrilledHole) -> Option<Point3<f64>> {
        let body = self.surface?;
        let sweeps = hole.passes().map(|pass| pass.cut.sweeps_before).min()?;
        let (bottom, out) = (hole.bottom(), hole.axis.into_inner());
        let top = body.exit(&bottom, &hole.axis).filter(|top| 0.0 < (top - bottom).dot(&out))?;
        let first_on =
            |offset: Vector3<f64>| self.metal.first_metal(&[top + offset, bottom + offset], sweeps);
        let depth = first_on(Vector3::zeros()).or_else(|| {
            // A hole that is cast or sawn out has metal at its wall alone.
            let radius = hole.diameter? / 2.0 - INSIDE_WALL;
            let [u, v] = directions_across(&hole.axis);
            [u, v, -u, -v].into_iter().filter_map(|spoke| first_on(spoke * radius)).reduce(f64::min)
        })?;
        Some(top - out * depth)
    }
}

impl KnownMetal {
    /// Returns how far along a line its first metal lies that the first sweeps have left, mm; `None` without any.
    fn first_metal(&self, [from, to]: &Line, sweeps: u32) -> Option<f64> {
        let length = (to - from).norm();
        let strip = Strip::line([*from, *to]);
        let mut shares = self.solid(&strip, TOUCH_DEPTH, |_| true);
        self.removed.first(sweeps).uncover(&strip, Covers::All, &mut shares);
        shares.sort();
        let first = shares.pieces().iter().find(|piece| !is_rounding(length, **piece))?;
        let depth = first[0] * length;
        // A body begins at its face, and what is left of it where a feed has cut: both searches spare a thickness.
        Some(if depth <= 2.0 * TOUCH_DEPTH { 0.0 } else { depth - TOUCH_DEPTH })
    }
}
