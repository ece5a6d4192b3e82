//! Boring bars that are shifted off the wall of their hole with the spindle stopped.
use nalgebra::Point3;

use super::line::MAX_BAR_SHIFT;
use super::{HoleExtractor, MotionKind};
use crate::machine::{TOUCH_DEPTH, ToolKind};
use gcode_lang::motion::{Event, SpindleDirection};
use gcode_lang::source::Span;

/// Shift of a boring bar.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct BarShift {
    /// Tip before the shift, while the bar is shifted.
    home: Option<Point3<f64>>,
    /// The same after the current motion, if that begins or ends a shift.
    next: Option<Option<Point3<f64>>>,
    /// Block of the last motion.
    last_block: Option<Span>,
}

impl HoleExtractor<'_> {
    /// Returns the radius of the tool; `None` if it is unknown, and while it is a boring bar that is shifted off the wall.
    pub(super) fn tool_radius(&self) -> Option<f64> {
        if self.bar_shift.home.is_some() {
            return None;
        }
        self.machine.diameter_of(self.setup.tool).map(|diameter| diameter / 2.0)
    }

    /// Returns true if the spindle is stopped and the tool may be a boring bar: one of unknown kind that has turned may be.
    pub(super) fn may_be_shifted(&self) -> bool {
        let kind = self.machine.kind_of(self.setup.tool);
        let may_be_bar = kind.map_or(self.has_tool_turned, |kind| kind == ToolKind::BoringBar);
        may_be_bar && self.cutting_state.spindle_direction == SpindleDirection::Off
    }

    /// Follows a motion that begins or ends a shift. A bar is shifted on the line that it has cut, or before it goes down a hole:
    /// by a cycle, or if the machine file says that it is one.
    pub(super) fn follow_bar_shift(&mut self, event: &Event<'_>, kind: MotionKind, from: &Point3<f64>, is_on_line: bool) {
        let is_same_block = self.bar_shift.last_block.replace(event.block) == Some(event.block);
        if let Some(next) = self.bar_shift.next.take() {
            self.bar_shift.home = next;
        }
        if !self.may_be_shifted() {
            self.bar_shift.home = None;
            return;
        }
        let to = self.pose.tip;
        let Some(axis) = self.axis_in_motion(from, &to).filter(|_| kind == MotionKind::Rapid) else { return };
        let split = |p: &Point3<f64>| {
            let (along, by) = ((to - p).dot(&axis), to - p);
            (along.abs(), (by - axis.into_inner() * along).norm())
        };
        let (along, across) = split(from);
        if across <= TOUCH_DEPTH {
            return;
        }
        match self.bar_shift.home {
            Some(home) if split(&home).1 <= TOUCH_DEPTH => self.bar_shift.next = Some(None),
            Some(_) => self.bar_shift.home = None,
            None if is_on_line => self.bar_shift.home = Some(*from),
            None => {
                let is_meant = is_same_block || self.machine.kind_of(self.setup.tool).is_some();
                if is_meant && along <= TOUCH_DEPTH && across <= MAX_BAR_SHIFT {
                    self.bar_shift.next = Some(Some(*from));
                }
            }
        }
    }
}
