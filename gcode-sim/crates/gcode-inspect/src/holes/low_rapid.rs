//! Rapids through a hole and far below the part: what is there, a table or a vise, is unknown.
use nalgebra::Point3;

use super::metal::PointInMetal;
use super::rapids::format_point;
use super::{HoleExtractor, MotionKind};
use crate::findings::RAPID_BEYOND_CUT;
use gcode_lang::diag::Diagnostic;
use gcode_lang::motion::{Backtrace, Event};

/// Rapid whose tip has come too far below the far side of a hole.
#[derive(Clone, Debug)]
pub(super) struct LowRapid {
    backtrace: Backtrace,
    /// Index of the nominal hole.
    hole: usize,
    at: PointInMetal,
}

impl HoleExtractor<'_> {
    /// Follows a motion at known positions: a rapid through a hole is reported once the tool comes up again, unless it has cut
    /// upwards, as a bar that bores from the back.
    pub(super) fn follow_low_rapid(&mut self, event: &Event<'_>, kind: MotionKind, before: &Point3<f64>) {
        let (tip, Some(axis)) = (self.pose.tip, self.pose.axis) else { return };
        let rise = (tip - before).dot(&axis);
        if kind == MotionKind::Feed && 0.0 < rise {
            self.low_rapid = None;
        }
        if kind != MotionKind::Rapid {
            return;
        }
        let beyond =
            if self.low_rapid.is_some() || rise < 0.0 { self.metal.beyond_hole(&tip, &axis) } else { None };
        match (&mut self.low_rapid, beyond) {
            (Some(_), None) => self.report_low_rapid(),
            (Some(low), Some((hole, at))) if low.at.depth < at.depth => {
                *low = LowRapid { backtrace: event.backtrace(), hole, at };
            }
            (None, Some((hole, at))) => {
                self.low_rapid = Some(LowRapid { backtrace: event.backtrace(), hole, at });
            }
            (_, _) => {}
        }
    }

    /// Reports the rapid that has led below the part.
    pub(super) fn report_low_rapid(&mut self) {
        let Some(LowRapid { backtrace, hole, at }) = self.low_rapid.take() else { return };
        let Some(holes) = self.metal.holes.as_ref() else { return };
        let (id, limit) = (holes.id(hole).to_owned(), holes.collar(hole).max_depth());
        self.findings.add(&RAPID_BEYOND_CUT, &backtrace, 2, |kind| {
            let message = format!(
                "the rapid leads through hole {id} and {:.3} mm below its entry, at {}: limit {limit:.3}",
                at.depth,
                format_point(&at.point)
            );
            Diagnostic::new(kind, message)
                .help("check the sign of Z and the length offset: what is below the part, a table or a vise, is unknown")
        });
    }
}
