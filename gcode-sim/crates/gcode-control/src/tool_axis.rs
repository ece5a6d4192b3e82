//! G53.1, and G53.6 about the tip: the rotary axes point the tool along Z of the tilted plane.
use super::functions::ExecResult;
use super::kinematics::{Alignment, Vector, choosing_axis, pointing_positions, sum};
use super::linear_motion::Endpoint;
use super::notes::Note;
use super::plan::BlockPlan;
use super::plane::Tilt;
use super::planner::Planner;
use super::state::State;
use super::transform::Transform;
use std::cmp::Ordering;

use gcode_lang::alarm::Alarm;
use gcode_lang::control::{Kinematics, RotaryAxis};
use gcode_lang::motion::{AxisIndex, Position, UnknownAxes};
use gcode_lang::program::g_codes::{Effect, OneShot};
use gcode_lang::program::modes::{Length, Motion};

/// G53.1 where nothing has set a plane.
pub(super) const NO_PLANE: &str = "G53.1, G53.6 or G253 without a tilted plane";

impl Planner<'_> {
    /// Makes X, Y and Z unknown on the part, until a code ends the mode and an absolute word commands them, and the rotary axes
    /// if they turn: nothing states the kinematics of the machine.
    pub(super) fn lose_position(&self, plan: &mut BlockPlan, code: u32, turns: bool) {
        plan.notes.push(Note::NoKinematics(code));
        let axes = &self.data.settings.axes;
        let slides = self.data.linear_axes().unwrap_or_default().into_iter();
        let slides = slides.fold(0, |bits, axis| bits | 1 << axis);
        let rotary = (0..axes.len()).filter(|axis| turns && axes.is_rotary(*axis));
        let lost = rotary.fold(slides, |bits, axis| bits | 1 << axis);
        plan.state.transform.unknown_centre |= slides;
        let unknown = UnknownAxes { shifted: lost, ..UnknownAxes::default() };
        plan.state.unknown = plan.state.unknown.with_axes_of(lost, unknown);
        self.push_unknown_axes(plan);
    }

    /// Returns the first code × 10 of the block with this effect; 0 without one.
    pub(super) fn code_of(&self, is_meant: impl Fn(Effect) -> bool) -> u32 {
        self.words.g_codes().find(|row| is_meant(row.effect)).map_or(0, |row| row.code)
    }

    /// G53.1: rotary axes turn by rapid so that the tool points along Z of the plane, which stays on the part. X, Y and Z
    /// don't move. G53.6: they move so that the tip stays on the part.
    pub(super) fn plan_tool_axis(&self, keeps_tip: bool, plan: &mut BlockPlan) -> ExecResult<()> {
        let tool_axis = Effect::OneShot(OneShot::ToolAxis { keeps_tip });
        let illegal = |what| Alarm::ToolAxisCode(what).located_at(self.block);
        if self.names_axis() {
            return Err(illegal("G53.1, G53.6 or G253 with an axis"));
        }
        let state = &mut plan.state;
        let Some(mut tilt) = state.transform.tilt.filter(|_| state.transform.plane_entry.is_none()) else {
            return Err(illegal(NO_PLANE));
        };
        let side = match self.words.count(b'P')?.unwrap_or(0) {
            0 => 0.0,
            1 => 1.0,
            2 => -1.0,
            _ => return Err(illegal("P of G53.1 is 0 to 2")),
        };
        let before = state.length_offset;
        state.end_alignment();
        tilt.alignment = None;
        state.transform.tilt = Some(tilt);
        let Some(kinematics) = &self.data.settings.kinematics else {
            let alignment = self.level_alignment(state, &tilt);
            self.align(plan, tilt, alignment, before);
            self.lose_position(plan, self.code_of(|effect| effect == tool_axis), true);
            return Ok(());
        };
        let zero = self.data.zeros(state);
        let normal = state.transform.direction_in_plane(&tilt, tilt.axes[2]);
        let target = self.tool_axis_target(state, kinematics, normal, &zero, side)?;
        for axis in kinematics.axes() {
            state.unknown = state.apply_absolute(axis.axis, state.unknown);
        }
        self.push_unknown_axes(plan);
        match keeps_tip {
            true => self.push_turn_about_tip(plan, &target)?,
            false => self.push_rapid(plan, &target),
        }
        self.align(plan, tilt, Alignment::new(kinematics, &target, &zero), before);
        Ok(())
    }

    /// Returns the alignment of a plane on a machine that nothing describes.
    pub(super) fn level_alignment(&self, state: &State, tilt: &Tilt) -> Alignment {
        let zero = self.data.zeros(state);
        Alignment::level(&tilt.plane.matrix, sum(tilt.plane.origin, tilt.axes.map(|axis| zero[axis])))
    }

    /// Sets the alignment of part and tool in a plane, and turns the tool length with it; `before` is the length offset at the
    /// start of the block.
    pub(super) fn align(&self, plan: &mut BlockPlan, tilt: Tilt, alignment: Alignment, before: Position) {
        let state = &mut plan.state;
        let length = alignment.tool.apply(tilt.axes.map(|axis| state.length_offset[axis]));
        for (axis, value) in tilt.axes.into_iter().zip(length) {
            state.length_offset[axis] = value;
        }
        state.transform.tilt = Some(Tilt { alignment: Some(alignment), ..tilt });
        self.push_turned_length(plan, before);
        self.data.apply_transform_change(&mut plan.state);
    }

    /// Emits the rapid of the rotary axes to `target` in which the tip stays where it is on the part.
    fn push_turn_about_tip(&self, plan: &mut BlockPlan, target: &Position) -> ExecResult<()> {
        let (modal, transform) = (plan.state.modal, plan.state.transform);
        plan.state.modal.length = Length::TipByAngles;
        plan.state.modal.motion = Motion::Rapid;
        plan.state.transform = Transform::default();
        self.data.recompute_position(&mut plan.state);
        let mut endpoint = Endpoint {
            programmed: plan.state.programmed_position,
            machine: *target,
            unknown: plan.state.unknown,
        };
        for axis in (0..self.data.settings.axes.len()).filter(|axis| self.data.settings.axes.is_rotary(*axis))
        {
            endpoint.programmed[axis] = target[axis] - self.data.zero(&plan.state, axis);
        }
        if let Some(aligned) = self.data.part_aligned(&plan.state, target) {
            endpoint.machine = self.data.with_tip_at(&plan.state, &aligned, &endpoint.programmed, target);
        }
        let moved = self.push_tip_path(plan, &endpoint, None);
        (plan.state.modal, plan.state.transform) = (modal, transform);
        moved
    }

    /// Returns the position with the rotary axes where the tool points along `normal`, a direction on the machine with the
    /// table at its work zeros. A positive `side` takes the solution with the plus sign of the choosing axis, a negative one the
    /// other; 0 the one with the shortest way of the first axis, then of the second, then the one whose first axis is nearest to
    /// 0, then the second, then the plus sign of the first. The table's axes come first where the head has one too
    /// (operator's manual of the 16i, tool axis direction control).
    pub(super) fn tool_axis_target(
        &self,
        state: &State,
        kinematics: &Kinematics,
        normal: Vector,
        zero: &Position,
        side: f64,
    ) -> ExecResult<Position> {
        let from = &state.machine_position;
        let on_table = Alignment::new(kinematics, &Position::default(), zero).frame.rotation.apply(normal);
        let Some(found) = pointing_positions(kinematics, on_table, from) else {
            return Err(self.not_simulated("G53.1 on a machine with more than two rotary axes"));
        };
        let choosing = choosing_axis(kinematics, self.data.settings.tool_axis_choice);
        let is_on_side = |at: &Position| {
            let angle = choosing.map_or(0.0, |axis| at[axis] - 360.0 * (at[axis] / 360.0).round());
            // A half turn has both signs.
            angle * side >= 0.0 || angle.abs() > 180.0 - 1e-6
        };
        let reachable = found.into_iter().filter(is_on_side).filter_map(|mut at| {
            for axis in kinematics.axes() {
                let sign = if choosing == Some(axis.axis) { side } else { 0.0 };
                at[axis.axis] = self.nearest_turn(axis.axis, at[axis.axis], from[axis.axis], sign)?;
            }
            Some(at)
        });
        let is_mixed = !kinematics.head.is_empty() && !kinematics.table.is_empty();
        let (first, second) = if is_mixed {
            (&kinematics.table, &kinematics.head)
        } else {
            (&kinematics.head, &kinematics.table)
        };
        let axes: Vec<AxisIndex> = first.iter().chain(second).map(|axis: &RotaryAxis| axis.axis).collect();
        let order = |a: &Position, b: &Position| {
            let way = |axis: &AxisIndex| ((a[*axis] - from[*axis]).abs(), (b[*axis] - from[*axis]).abs());
            let from_zero = |angle: f64| (angle - 360.0 * (angle / 360.0).round()).abs();
            let size = |axis: &AxisIndex| (from_zero(a[*axis]), from_zero(b[*axis]));
            let mut keys = axes.iter().map(way).chain(axes.iter().map(size));
            let differing = keys.find(|(a, b)| (a - b).abs() > 1e-6);
            let (a, b) = differing.or(axes.first().map(|axis| (-a[*axis], -b[*axis]))).unwrap_or_default();
            a.total_cmp(&b)
        };
        let nearest = reachable.min_by(order);
        nearest.ok_or_else(|| Alarm::ToolAxisUnreachable.located_at(self.block))
    }

    /// Returns the angle plus full turns that is nearest to the current position within the stroke limits. Of two half turns it
    /// is the one nearer to 0, then that of the sign, the plus side if `sign` is 0.
    fn nearest_turn(&self, axis: AxisIndex, angle: f64, from: f64, sign: f64) -> Option<f64> {
        let turns = ((from - angle) / 360.0).round();
        let limits = self.data.settings.stroke_limits.filter(|_| !self.data.settings.rolls_over[axis]);
        let is_allowed = |at: &f64| {
            limits.is_none_or(|limits| {
                limits.max[axis].is_none_or(|max| *at <= max) && limits.min[axis].is_none_or(|min| min <= *at)
            })
        };
        let mut candidates = [turns, turns - 1.0, turns + 1.0].map(|turns| angle + 360.0 * turns);
        let preferred = if sign < 0.0 { -1.0 } else { 1.0 };
        let order = |at: f64| (((at - from).abs() * 1e6).round(), (at.abs() * 1e6).round(), -preferred * at);
        candidates.sort_by(|a, b| order(*a).partial_cmp(&order(*b)).unwrap_or(Ordering::Equal));
        candidates.into_iter().find(is_allowed)
    }
}
