//! Rapids behind a tool change: most machines retract the tool for it, and the program doesn't say so.
use nalgebra::{Point3, Unit, Vector3};

use super::HoleExtractor;
use super::metal::PointInMetal;
use super::rapid_paths::UnsearchedMotions;
use super::rapids::format_point;
use super::swept_tool::ring;
use super::unknown_axes::MAX_SINE;
use crate::findings::{RAPID_INTO_PART, TOOL_LEFT_IN_HOLE};
use crate::machine::{RapidPath, Setup, TOUCH_DEPTH};
use gcode_lang::diag::{Diagnostic, FindingKind};
use gcode_lang::motion::{AxisIndex, Event, Position, SpindleDirection};

/// Least radius at which metal round a tool is looked for, mm, and its distance from the tool.
const MIN_RADIUS: f64 = 0.5;
pub(super) const WALL_DISTANCE: f64 = 0.5;

/// Number of points round a tool.
pub(super) const RING_POINTS: u32 = 8;

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
    /// Applies a change of the tool, its offset or the head, which moves the tip.
    pub(super) fn update_setup(&mut self, change: impl FnOnce(&mut Setup)) {
        let before = self.setup;
        change(&mut self.setup);
        if self.setup == before {
            return;
        }
        let after = std::mem::replace(&mut self.setup, before);
        self.end_line(None);
        self.end_unsized_stroke();
        self.end_engagement();
        self.strokes.end_tool();
        self.setup = after;
        self.update_tool_body();
        self.pose = self.machine.tool_pose(&self.axis_position, &self.setup).relative_to(&self.frame);
    }

    /// Applies a tool change: in a hole, or between walls, the tool can't be changed.
    pub(super) fn begin_change(&mut self, event: &Event<'_>, number: u32) {
        let is_known = self.positions.is_known(self.machine);
        self.change_retract.is_open = is_known && self.has_left_start && !self.is_retracted_to_zero(number);
        let Some(axis) = self.tool_direction().filter(|_| is_known && self.metal.is_known()) else { return };
        let tip = self.pose.tip;
        let radius = self.body_radius().max(MIN_RADIUS) + WALL_DISTANCE;
        let up = axis.into_inner() * self.metal.removed.height_of_metal(&tip, &axis);
        let ring = ring(&axis, &Vector3::zeros(), radius, RING_POINTS).into_iter().map(|offset| tip + offset);
        let walls = ring.chain([tip]).filter_map(|p| self.metal.uncut(&[p, p + up]));
        let Some(wall) = walls.reduce(PointInMetal::deeper) else {
            return self.report_change_below_top(event, &axis);
        };
        let (depth, level) = (wall.depth, self.metal.level_at(&wall.point));
        self.findings.add(&TOOL_LEFT_IN_HOLE, &event.backtrace(), 1, |kind| {
            let point = format_point(&tip);
            let message = format!(
                "the tool is changed beside metal {depth:.3} mm below {level}, with its tip at {point}"
            );
            Diagnostic::new(kind, message).help("retract above the surface before the tool change")
        });
    }

    /// Returns true if the axes that draw the tool out of the part stand at machine zero: a tool change moves it no farther out. The
    /// work offsets show where that is, and the length of the next tool where its tip is.
    fn is_retracted_to_zero(&self, next: u32) -> bool {
        let is_stated = !self.machine.offsets.is_empty() && self.machine.has_tip(Some(next));
        let Some(out) = self.tool_direction().filter(|_| is_stated) else { return false };
        let mut axes = self.axes_along(&out).peekable();
        axes.peek().is_some() && axes.all(|axis| self.axis_position[axis] == 0.0)
    }

    /// Iterates over the linear axes by which the tool goes out along a direction.
    fn axes_along(&self, out: &Unit<Vector3<f64>>) -> impl Iterator<Item = AxisIndex> {
        let axes = (0..self.machine.axes.len()).filter(|axis| !self.machine.axes.is_rotary(*axis));
        axes.filter(|axis| {
            let by = self.displacement_by(*axis, &self.axis_position, &self.pose.tip);
            (by - out.into_inner()).norm() <= MAX_SINE
        })
    }

    /// Checks a rapid behind a tool change as if the axes along the tool arrive first: the tool then crosses at the level of its end,
    /// wherever the change has left it.
    fn check_crossing(&mut self, event: &Event<'_>, (from, to): (&Position, &Position)) {
        let Some(out) = self.tool_direction().filter(|_| matches!(self.rapid_path, RapidPath::Any)) else {
            return;
        };
        let mut level = *from;
        for axis in self.axes_along(&out) {
            level[axis] = to[axis];
        }
        let start = self.machine.forward(&level, &self.setup).tip;
        self.check_rapid_paths(event, (&level, to), Some(start));
    }

    /// Reports a tool change where the part has been, as in a pocket that is milled.
    fn report_change_below_top(&mut self, event: &Event<'_>, axis: &Unit<Vector3<f64>>) {
        let tip = self.pose.tip;
        let is_free = self.metal.is_in_open_void(&tip, axis);
        let Some(body) = self.surface.filter(|body| !is_free && body.is_deeper(&tip, TOUCH_DEPTH)) else {
            return;
        };
        let Some(top) = body.exit(&tip, axis) else { return };
        let depth = (top - tip).norm();
        self.findings.add(&TOOL_LEFT_IN_HOLE, &event.backtrace(), 1, |kind| {
            let point = format_point(&tip);
            let message = format!(
                "the tool is changed {depth:.3} mm below the top of the part, with its tip at {point}"
            );
            Diagnostic::new(kind, message).help("retract above the surface before the tool change")
        });
    }

    /// Checks a rapid on all its paths. Behind a tool change it is free if the change retracts the tool and the rapid ends
    /// outside the metal.
    pub(super) fn check_rapid_motion(
        &mut self,
        event: &Event<'_>,
        travel: (&Position, &Position),
        start: Option<Point3<f64>>,
        before: &Point3<f64>,
    ) {
        if !self.checks_rapids {
            return;
        }
        self.check_lost_offset(event);
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
            self.check_crossing(event, travel);
        }
    }

    /// Puts a tool into the spindle.
    pub(super) fn change_tool(&mut self, event: &Event<'_>, number: u32) {
        self.report_low_rapid();
        self.check_tool_known(event, number);
        self.begin_change(event, number);
        self.milled_blocks.end_tool();
        self.update_setup(|setup| setup.tool = Some(number));
        self.leave_offset();
        self.bar_shift.has_drilled = false;
        self.has_tool_turned = self.cutting_state.spindle_direction != SpindleDirection::Off;
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
            let note = "this block changes the tool length offset, and the tool moves by it: bring it home before G49";
            let is_by_length = self.length_change == Some(event.block);
            self.findings.add(&RAPID_INTO_PART, &event.backtrace(), 0, |kind| {
                let finding = make(kind);
                if is_by_length { finding.note(note) } else { finding }
            });
        }
    }
}
