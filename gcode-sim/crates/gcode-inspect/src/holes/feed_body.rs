//! Side of the tool in feeds: it must not cut a known body beside the nominal holes while the tip is in the air.
use nalgebra::{Point3, Unit, Vector3};

use super::HoleExtractor;
use super::line::CuttingLine;
use super::rapids::PLUNGE_COSINE;
use crate::findings::FEED_BESIDE_HOLE;
use crate::machine::{AxisMotion, TOUCH_DEPTH};
use gcode_lang::diag::Diagnostic;
use gcode_lang::motion::{Backtrace, Event};

impl HoleExtractor<'_> {
    /// Reports a feed across the tool through some points if the side or the end of the tool cuts the body beside the
    /// holes. A feed along the tool makes a hole; one with its tip in the metal is another check's.
    pub(super) fn check_body_in_feed(&mut self, backtrace: &Backtrace, path: &[Point3<f64>]) {
        let Some(axis) = self.pose.axis else { return };
        let is_along = |along: &Vector3<f64>| PLUNGE_COSINE * along.norm() <= along.dot(&axis).abs();
        let mut chords = path.windows(2).filter(|chord| !is_along(&(chord[1] - chord[0])));
        let is_cut = chords.any(|chord| self.body_cuts((&chord[0], &chord[1]), &axis));
        self.report_body_cut(backtrace, is_cut);
    }

    /// Checks a feed on an arc as one of chords.
    pub(super) fn check_body_on_arc(&mut self, event: &Event<'_>, travel: &AxisMotion<'_>) {
        if self.surface.is_none() || self.entries.is_none() {
            return;
        }
        let mut path = Vec::new();
        self.machine.for_each_pose(travel, &self.setup, TOUCH_DEPTH, |pose| path.push(pose.tip));
        self.check_body_in_feed(&event.backtrace(), &path);
    }

    /// Returns true if the body of the tool cuts the part in a feed inwards with its tip in the air.
    pub(super) fn cuts_in_plunge(&self, line: &CuttingLine) -> bool {
        let Some(axis) = line.tool_axis.filter(|axis| 0.0 < axis.dot(&line.out)) else { return false };
        line.cutting_state.tool == self.setup.tool
            && line.unknown_axes.is_none()
            && self.body_cuts((&line.start, &line.bottom()), &axis)
    }

    /// Reports a feed in which the body of the tool cuts the part.
    pub(super) fn report_body_cut(&mut self, backtrace: &Backtrace, is_cut: bool) {
        if !is_cut {
            return;
        }
        self.findings.add(&FEED_BESIDE_HOLE, backtrace, 0, |kind| {
            Diagnostic::new(kind, "the side of the tool cuts the part beside its holes in a feed").help(
                "keep the tool's radius away from the part, or state in [stock] the material that the program leaves",
            )
        });
    }

    /// Returns true if a part of the tool cuts the body between two tips in the air.
    fn body_cuts(&self, (from, to): (&Point3<f64>, &Point3<f64>), axis: &Unit<Vector3<f64>>) -> bool {
        let Some(surface) = self.surface.filter(|_| self.has_left_start && self.entries.is_some()) else {
            return false;
        };
        if TOUCH_DEPTH < surface.depth(&surface.deepest_between(from, to)) {
            return false;
        }
        let parts = self.machine.tool_body(&self.setup);
        parts.iter().any(|part| {
            !self.is_within_nominal_hole(&[*from, *to], axis, part.radius)
                && part.cuts(&surface, (from, axis), &(to - from))
        })
    }
}
