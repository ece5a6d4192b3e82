//! Walls of nominal holes that a path cuts beside the circle or the stroke that makes the hole.
use nalgebra::{Point3, Unit, Vector3};

use super::HoleExtractor;
use super::hole_circles::PathExcess;
use super::metal::KnownMetal;
use super::rapids::format_point;
use crate::findings::FEED_BESIDE_HOLE;
use crate::machine::TOUCH_DEPTH;
use gcode_lang::diag::Diagnostic;
use gcode_lang::motion::Backtrace;
use gcode_part::{Collar, exceeds};

/// Largest depth of a cut in the wall of a hole, mm: the tolerance of its diameter.
const MAX_WALL_CUT: f64 = 0.05;

impl KnownMetal {
    /// Returns the index of the nominal hole that a tool at a tip is in, and how far the tool reaches beyond its wall.
    fn wall_excess(&self, tip: &Point3<f64>, axis: &Unit<Vector3<f64>>, radius: f64) -> Option<(usize, f64)> {
        let holes = self.holes.as_ref()?;
        let mut nearest: Option<(usize, f64)> = None;
        holes.around(tip, tip, &mut |hole| {
            let collar = holes.collar(hole);
            let aside = collar.from_axis(tip);
            let is_in = collar.is_parallel(axis) && collar.has_diameter && TOUCH_DEPTH < collar.depth(tip);
            if is_in && nearest.is_none_or(|(_, least)| aside < least) {
                nearest = Some((hole, aside));
            }
        });
        let (hole, aside) = nearest?;
        let wall = wall_radius(holes.collar(hole), tip)?;
        Some((hole, aside + radius - wall))
    }
}

/// Returns the radius of a nominal hole at the depth of a point.
fn wall_radius(collar: &Collar, p: &Point3<f64>) -> Option<f64> {
    let depth = collar.depth(p);
    let steps = collar.steps.iter().filter(|step| depth <= step.max_depth + TOUCH_DEPTH);
    steps.map(|step| step.radius(depth)).reduce(f64::max)
}

impl HoleExtractor<'_> {
    /// Reports where a path cuts the wall of a nominal hole deeper than its diameter allows. Deeper cuts of a known diameter
    /// are what no feed may remove: these are reported already.
    pub(super) fn report_wall_cut(
        &mut self,
        excess: &PathExcess,
        out: &Unit<Vector3<f64>>,
        backtrace: &Backtrace,
    ) {
        let PathExcess { centre, tip, outwards, depth } = *excess;
        if !exceeds(depth, MAX_WALL_CUT) || self.engagement.is_spoilt(self.gouge_count) {
            return;
        }
        let radius = self.machine.diameter_of(self.setup.tool).map(|diameter| diameter / 2.0);
        let wall = radius.map(|radius| self.metal.wall_excess(&tip, out, radius));
        let hole_at = |tip: &Point3<f64>| self.metal.wall_excess(tip, out, 0.0).map(|(hole, _)| hole);
        let (hole, depth) = match wall {
            Some(Some((hole, beyond))) => (hole, depth.min(beyond)),
            // Below the hole, or beside it.
            Some(None) => return,
            // A path that goes on to another hole shows nothing of the wall of this one.
            None => match hole_at(&tip).filter(|hole| hole_at(&centre) == Some(*hole)) {
                Some(hole) => (hole, depth),
                None => return,
            },
        };
        let at = tip + outwards * radius.unwrap_or(0.0);
        let edge = [at, at - out.into_inner() * TOUCH_DEPTH];
        if !exceeds(depth, MAX_WALL_CUT) || self.metal.is_in_pocket(&edge) {
            return;
        }
        let id = self.metal.holes.as_ref().map_or("", |holes| holes.id(hole)).to_owned();
        self.findings.add(&FEED_BESIDE_HOLE, backtrace, 1, |kind| {
            let place = format_point(&at);
            let message =
                format!("the wall of hole {id} is cut {depth:.3} mm deep at {place}: limit {MAX_WALL_CUT}");
            Diagnostic::new(kind, message)
                .help("keep the path inside the circle that makes the hole, the ways to it and from it too")
        });
    }
}
