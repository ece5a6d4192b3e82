//! Rapids behind a tool change: most machines retract the tool for it, and the program doesn't say so.
use nalgebra::Point3;

use super::HoleExtractor;
use super::rapid_paths::UnsearchedMotions;
use crate::findings::RAPID_INTO_PART;
use crate::machine::TOUCH_DEPTH;
use gcode_lang::diag::{Diagnostic, FindingKind};
use gcode_lang::motion::{Event, Position};

/// Rapids that are free only if the tool change has retracted the tool.
#[derive(Debug, Default)]
pub(super) struct ChangeRetract {
    /// No rapid has moved the tool along its axis since the last tool change.
    is_open: bool,
    /// The rapid that is checked leads from the place of a tool change.
    is_checked: bool,
    pub rapids: UnsearchedMotions,
}

impl ChangeRetract {
    /// Applies a tool change at a known position.
    pub(super) fn begin(&mut self, is_known: bool) {
        self.is_open = is_known;
    }

    /// Applies a feed, which cuts where the program has left the tool, or a motion from or to an unknown position.
    pub(super) fn end(&mut self) {
        self.is_open = false;
    }

    /// Returns true while a rapid from the place of a tool change is checked.
    pub(super) fn is_checked(&self) -> bool {
        self.is_checked
    }
}

impl HoleExtractor<'_> {
    /// Checks a rapid on all its paths. Behind a tool change it is free if the change retracts the tool and the rapid ends
    /// outside the metal.
    pub(super) fn check_rapid_motion(
        &mut self,
        event: &Event<'_>,
        travel: (&Position, &Position),
        start: Option<Point3<f64>>,
        before: &Point3<f64>,
    ) {
        let counted = self.change_retract.rapids.number();
        let way = self.pose.tip - before;
        let along = self.tool_direction().map_or(0.0, |axis| way.dot(&axis));
        // Down along the tool it is part of the way from any retract.
        let is_down = way.norm() <= -along + TOUCH_DEPTH;
        self.change_retract.is_checked = self.change_retract.is_open && !is_down;
        self.check_rapid_paths(event, travel, start);
        self.change_retract.is_checked = false;
        if !self.change_retract.is_open || along.abs() <= TOUCH_DEPTH {
            return;
        }
        self.change_retract.is_open = false;
        if counted < self.change_retract.rapids.number() {
            self.check_known_end(event, &self.pose.tip.clone());
        }
    }

    /// Adds the finding on a rapid that cuts; behind a tool change the rapid is counted.
    pub(super) fn add_rapid_into_part(
        &mut self,
        event: &Event<'_>,
        make: impl FnOnce(&'static FindingKind) -> Diagnostic,
    ) {
        if self.change_retract.is_checked {
            self.change_retract.rapids.count(|| event.backtrace());
        } else {
            self.findings.add(&RAPID_INTO_PART, &event.backtrace(), 0, make);
        }
    }
}
