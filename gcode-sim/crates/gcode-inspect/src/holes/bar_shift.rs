//! Boring bars that are shifted off the wall of their hole with the spindle stopped.
use nalgebra::{Point3, Unit, Vector3};

use super::line::MAX_BAR_SHIFT;
use super::near_metal::{Contact, Judged};
use super::rapid_paths::{OnPath, Search};
use super::rapids::format_point;
use super::swept_tool::{TipPaths, contact};
use super::{HoleExtractor, MotionKind};
use crate::findings::RAPID_INTO_PART;
use crate::machine::{TOUCH_DEPTH, ToolKind};
use gcode_lang::diag::{Diagnostic, Severity};
use gcode_lang::motion::{Event, SpindleDirection};
use gcode_lang::source::Span;

/// Shift of a boring bar. A shift before the bar goes down a hole counts if a cycle makes both, or if the machine file says that the
/// tool is a boring bar.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct BarShift {
    /// The bar has cut backwards and is shifted by the current motion.
    pub is_back_bored: bool,
    /// The spindle has stopped at a known angle, by M19 or a cycle: the shift takes the edge off the wall.
    pub is_oriented: bool,
    /// The tool has been fed into the solid metal of a known stock, as no bar is.
    pub has_drilled: bool,
    /// Tip before the shift, while the bar is shifted.
    home: Option<Point3<f64>>,
    /// The same after the current motion, if that begins or ends a shift, and its block.
    next: Option<(Option<Point3<f64>>, Span)>,
}

impl HoleExtractor<'_> {
    /// Returns the radius of the tool; `None` if it is unknown, and while it is a boring bar that is shifted off the wall.
    pub(super) fn tool_radius(&self) -> Option<f64> {
        if self.bar_shift.home.is_some() {
            return None;
        }
        self.machine.diameter_of(self.setup.tool).map(|diameter| diameter / 2.0)
    }

    /// Returns true if the spindle is stopped and the tool may be a boring bar: one of unknown kind that has turned may be, unless it
    /// has drilled.
    pub(super) fn may_be_shifted(&self) -> bool {
        let kind = self.machine.kind_of(self.setup.tool);
        let may_be_bar = kind
            .map_or(self.has_tool_turned && !self.bar_shift.has_drilled, |kind| kind == ToolKind::BoringBar);
        may_be_bar && self.cutting_state.spindle_direction == SpindleDirection::Off
    }

    /// Follows a motion that begins or ends a shift, on the line that the bar has cut or before it goes down a hole.
    pub(super) fn follow_bar_shift(&mut self, event: &Event<'_>, kind: MotionKind, from: &Point3<f64>) {
        let is_shifted = self.current_line.as_ref().is_some_and(|line| line.is_bar_shifted());
        let is_on_line = std::mem::take(&mut self.bar_shift.is_back_bored) || is_shifted;
        if let Some((next, block)) = self.bar_shift.next.take() {
            let is_meant = self.machine.kind_of(self.setup.tool).is_some() || event.block == block;
            self.bar_shift.home = next.filter(|_| is_meant);
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
            self.check_shift_in_hole(event, from, &axis);
            self.check_shifted_body(event, from, &axis);
            return;
        }
        match self.bar_shift.home {
            Some(home) if split(&home).1 <= TOUCH_DEPTH => self.bar_shift.next = Some((None, event.block)),
            Some(_) => self.bar_shift.home = None,
            None if is_on_line => {
                self.bar_shift.home = Some(*from);
                self.check_shifted_body(event, from, &axis);
            }
            None if along <= TOUCH_DEPTH
                && across <= MAX_BAR_SHIFT
                && self.tool_radius().is_none_or(|radius| across < radius) =>
            {
                self.bar_shift.next = Some((Some(*from), event.block));
            }
            None => {}
        }
    }

    /// Reports the shank or the holder of a shifted bar in metal: the shift takes its edge off one wall, and them towards the other.
    fn check_shifted_body(&mut self, event: &Event<'_>, from: &Point3<f64>, axis: &Unit<Vector3<f64>>) {
        if self.bar_shift.home.is_none() || !self.metal.is_known() {
            return;
        }
        let path = TipPaths::line(&[*from, self.pose.tip]);
        let behind = self.tool_body.iter().filter(|part| !part.is_cutter);
        let found = behind.map(|part| contact(part, axis, &path, &self.metal, Judged::Uncut(None)));
        let Some(found) = found.filter(|found| !matches!(found, Contact::Clear)).last() else { return };
        if let Some(cut) = self.in_rapid(event, found, Search::Rapid(OnPath::Straight)) {
            self.report_side(event, cut, Severity::Error, (" while the bar is shifted", ""));
        }
    }

    /// Reports the edge of a shifted bar that goes through metal in rapid: it is nearer to the axis of the hole by the shift.
    fn check_shift_in_hole(&mut self, event: &Event<'_>, from: &Point3<f64>, axis: &Unit<Vector3<f64>>) {
        let Some(home) = self.bar_shift.home.filter(|_| self.surface.is_some()) else { return };
        let Some(diameter) = self.machine.diameter_of(self.setup.tool) else { return };
        let by = from - home;
        let shift = by - axis.into_inner() * by.dot(axis);
        let (length, radius) = (shift.norm(), diameter / 2.0);
        let Some(direction) = Unit::try_new(shift, TOUCH_DEPTH).filter(|_| length < radius) else { return };
        let edge = direction.into_inner() * (TOUCH_DEPTH - radius);
        let Some(found) = self.metal.uncut(&[from + edge, self.pose.tip + edge]) else { return };
        self.findings.add(&RAPID_INTO_PART, &event.backtrace(), 0, |kind| {
            let (reach, point) = (radius - length, format_point(&found.point));
            let message = format!(
                "the edge of the boring bar, shifted by {length:.3} mm, is {reach:.3} mm from the axis of its hole and \
                 meets metal in rapid at {point}"
            );
            Diagnostic::new(kind, message).help(
                "shift the bar by more than half its diameter less the radius of the hole: Q of the cycle",
            )
        });
    }
}
