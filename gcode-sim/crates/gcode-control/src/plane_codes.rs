//! G68.2 and G68.4: a tilted plane. G53.1: the rotary axes point the tool along its Z.
use super::functions::ExecResult;
use super::kinematics::{Alignment, Vector, choosing_axis, pointing_positions};
use super::plan::BlockPlan;
use super::plane::{Plane, PlaneEntry, Tilt};
use super::planner::Planner;
use super::state::State;
use std::cmp::Ordering;

use gcode_lang::alarm::{Alarm, LocatedAlarm};
use gcode_lang::control::Kinematics;
use gcode_lang::motion::{AxisIndex, EventKind, Position};
use gcode_lang::program::modes::Rotation;

impl State {
    /// Returns X, Y and Z with the alignment of part and tool that G53.1 has set.
    #[inline]
    pub(super) fn alignment(&self) -> Option<([AxisIndex; 3], &Alignment)> {
        let tilt = self.transform.tilt.as_ref()?;
        tilt.alignment.as_ref().map(|alignment| (tilt.axes, alignment))
    }

    /// Turns the tool length back along the head's position 0, where no plane holds the tool.
    pub(super) fn end_alignment(&mut self) {
        if let Some(tilt) = &mut self.transform.tilt
            && let Some(alignment) = tilt.alignment.take()
        {
            let axes = tilt.axes;
            let length = axes.map(|axis| self.length_offset[axis]);
            for (axis, value) in axes.into_iter().zip(alignment.tool.transposed().apply(length)) {
                self.length_offset[axis] = (value * 1e9).round() / 1e9;
            }
        }
    }
}

impl Planner<'_> {
    /// G68.2, and G68.4 within the plane that is active: the forms P0 to P4.
    pub(super) fn plan_tilt(&self, plan: &mut BlockPlan) -> ExecResult<()> {
        if plan.state.controls_tip() {
            return Err(self.not_simulated("G68.2 in tool centre point control (command G49 before it)"));
        }
        let state = &mut plan.state;
        let (mut axes, mut origin, mut angles) = ([0; 3], [0.0; 3], [0.0; 3]);
        for (index, letter) in [b'X', b'Y', b'Z'].into_iter().enumerate() {
            let missing = Alarm::ImproperAddress { letter: char::from(letter) };
            axes[index] = self.locate(self.data.settings.axes.find(letter).ok_or(missing))?;
            origin[index] = self.dimension(letter, state)?.unwrap_or(0.0);
        }
        let form = self.words.count(b'P')?.unwrap_or(0);
        if form != 3 {
            for (index, letter) in [b'I', b'J', b'K'].into_iter().enumerate() {
                angles[index] = self.angle(letter)?.unwrap_or(0.0);
            }
        }
        let is_within = state.modal.rotation == Rotation::TiltedFurther;
        let base = match state.transform.tilt {
            Some(tilt) if is_within => Some(tilt.plane),
            None if is_within => return Err(self.plane_format("G68.4 without G68.2")),
            _ => None,
        };
        let plane = match form {
            0 if !self.words.has_any(b"QR") => Some(Plane::by_euler_angles(origin, angles)),
            1 if !self.words.has(b'R') => {
                let order = self.words.count(b'Q')?.unwrap_or(123);
                let plane = Plane::by_roll_pitch_yaw(origin, angles, order);
                Some(plane.ok_or_else(|| self.plane_format("Q of P1 is an order of 1, 2 and 3"))?)
            }
            2 | 3 => self.add_plane_block(state, form, origin)?,
            4 if !self.words.has_any(b"QR") => {
                let plane = Plane::by_projection(origin, angles);
                Some(plane.ok_or_else(|| self.plane_format("both directions of P4 are parallel"))?)
            }
            _ => return Err(self.plane_format("P is 0 to 4; Q belongs to P1, P2 and P3, R to P2")),
        };
        let Some(plane) = plane else { return Ok(()) };
        let plane = base.map_or(plane, |base| plane.within(&base));
        let before = state.length_offset;
        state.end_alignment();
        state.transform.plane_entry = None;
        state.transform.tilt = Some(Tilt { axes, plane, alignment: None });
        self.push_turned_length(plan, before);
        self.data.apply_transform_change(&mut plan.state);
        Ok(())
    }

    /// Adds a block of P2 or P3; returns the plane with the last one.
    fn add_plane_block(&self, state: &mut State, form: u32, point: Vector) -> ExecResult<Option<Plane>> {
        let mut vector = [0.0; 3];
        if form == 3 {
            for (index, letter) in [b'I', b'J', b'K'].into_iter().enumerate() {
                vector[index] = self.dimension(letter, state)?.unwrap_or(0.0);
            }
        }
        let angle = self.angle(b'R')?.unwrap_or(0.0);
        let q = self.words.count(b'Q')?.unwrap_or(0);
        let mut entry = state.transform.plane_entry.unwrap_or(PlaneEntry { form, ..PlaneEntry::default() });
        let is_same_form = entry.form == form && (form == 2 || !self.words.has(b'R'));
        let added = entry.add(q, point, vector, angle).filter(|_| is_same_form);
        let plane = added.ok_or_else(|| {
            self.plane_format(match form {
                2 => "P2 takes Q1, Q2 and Q3 in this order, points that are not on one line, and Q0 before them",
                _ => "P3 takes Q1 with the vector of X and Q2 with that of Z, at right angles within 5 degrees",
            })
        })?;
        state.transform.plane_entry = Some(entry);
        Ok(plane)
    }

    fn plane_format(&self, what: &'static str) -> LocatedAlarm {
        Alarm::PlaneFormat(what).located_at(self.block)
    }

    /// Emits the tool length if it has turned with the tool.
    pub(super) fn push_turned_length(&self, plan: &mut BlockPlan, before: Position) {
        if plan.state.length_offset != before {
            let (offset, compensation) = (plan.state.length_offset, plan.state.length_compensation());
            plan.push_event(EventKind::ToolLength { offset, compensation });
        }
    }

    /// Returns the kinematics of the machine file; an alarm names what the file lacks.
    pub(super) fn kinematics(&self, code: &str) -> ExecResult<&Kinematics> {
        self.data.settings.kinematics.as_ref().ok_or_else(|| {
            self.not_simulated(format!(
                "{code} without a machine file that describes the rotary axes, [[table]] or [[head.axis]], and the tool, [head],"
            ))
        })
    }

    /// G53.1: rotary axes turn by rapid so that the tool points along Z of the plane, which stays on the part. X, Y and Z
    /// don't move.
    pub(super) fn plan_tool_axis(&self, plan: &mut BlockPlan) -> ExecResult<()> {
        let illegal = |what| Alarm::ToolAxisCode(what).located_at(self.block);
        if self.names_axis() {
            return Err(illegal("G53.1 with an axis"));
        }
        let state = &mut plan.state;
        let Some(mut tilt) = state.transform.tilt.filter(|_| state.transform.plane_entry.is_none()) else {
            return Err(illegal("G53.1 without a plane of G68.2"));
        };
        let kinematics = self.kinematics("G53.1")?;
        let before = state.length_offset;
        state.end_alignment();
        tilt.alignment = None;
        state.transform.tilt = Some(tilt);
        let zero = self.data.zeros(state);
        let normal = state.transform.direction_in_plane(&tilt, tilt.axes[2]);
        let side = match self.words.count(b'P')?.unwrap_or(0) {
            0 => 0.0,
            1 => 1.0,
            2 => -1.0,
            _ => return Err(illegal("P of G53.1 is 0 to 2")),
        };
        let target = self.tool_axis_target(state, kinematics, normal, &zero, side)?;
        for axis in kinematics.axes() {
            state.unknown = state.apply_absolute(axis.axis, state.unknown);
        }
        self.push_unknown_axes(plan);
        self.push_rapid(plan, &target);
        let state = &mut plan.state;
        let alignment = Alignment::new(kinematics, &target, &zero);
        let length = alignment.tool.apply(tilt.axes.map(|axis| state.length_offset[axis]));
        for (axis, value) in tilt.axes.into_iter().zip(length) {
            state.length_offset[axis] = value;
        }
        state.transform.tilt = Some(Tilt { alignment: Some(alignment), ..tilt });
        self.push_turned_length(plan, before);
        self.data.apply_transform_change(&mut plan.state);
        Ok(())
    }

    /// Returns the position with the rotary axes where the tool points along `normal`, a direction on the machine with the
    /// table at its work zeros. A positive `side` takes the solution with the plus sign of the choosing axis, a negative one the
    /// other; 0 the one with the shortest way of the first axis, then of the second, then the plus sign of the first.
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
            angle * side >= 0.0
        };
        let reachable = found.into_iter().filter(is_on_side).filter_map(|mut at| {
            for axis in kinematics.axes() {
                at[axis.axis] = self.nearest_turn(axis.axis, at[axis.axis], from[axis.axis])?;
            }
            Some(at)
        });
        let order = |a: &Position, b: &Position| {
            let way = |axis: AxisIndex| ((a[axis] - from[axis]).abs(), (b[axis] - from[axis]).abs());
            let differing = kinematics.axes().map(|axis| way(axis.axis)).find(|(a, b)| (a - b).abs() > 1e-6);
            let first = kinematics.axes().next().map(|axis| (-a[axis.axis], -b[axis.axis]));
            let (a, b) = differing.or(first).unwrap_or_default();
            a.total_cmp(&b)
        };
        let nearest = reachable.min_by(order);
        nearest.ok_or_else(|| Alarm::ToolAxisUnreachable.located_at(self.block))
    }

    /// Returns the angle plus full turns that is nearest to the current position within the stroke limits.
    fn nearest_turn(&self, axis: AxisIndex, angle: f64, from: f64) -> Option<f64> {
        let turns = ((from - angle) / 360.0).round();
        let limits = self.data.settings.stroke_limits.filter(|_| !self.data.settings.rolls_over[axis]);
        let is_allowed = |at: &f64| {
            limits.is_none_or(|limits| {
                limits.max[axis].is_none_or(|max| *at <= max) && limits.min[axis].is_none_or(|min| min <= *at)
            })
        };
        let mut candidates = [turns, turns - 1.0, turns + 1.0].map(|turns| angle + 360.0 * turns);
        // Of two half turns the one nearer to 0, then the plus side.
        let order = |at: f64| (((at - from).abs() * 1e6).round(), (at.abs() * 1e6).round(), -at);
        candidates.sort_by(|a, b| order(*a).partial_cmp(&order(*b)).unwrap_or(Ordering::Equal));
        candidates.into_iter().find(is_allowed)
    }
}
