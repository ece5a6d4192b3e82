//! Programmed, work and machine coordinates, and the stored stroke check.
use super::data::{ControlData, Register};
use super::kinematics::{remove_noise, scaled, sum};
use super::state::{EndBeforeTransform, State};
use gcode_lang::alarm::Alarm;
use gcode_lang::control::{Increment, StrokeLimits};
use gcode_lang::motion::{AxisIndex, EventKind, MAX_AXES, PlanarArc, Position};
use gcode_lang::program::modes::{Length, Unit};
use gcode_lang::units::{Deg, round, round_scaled};

impl ControlData {
    /// Returns the zero of the active work coordinate system of every axis, see [`ControlData::zero`].
    pub(super) fn zeros(&self, state: &State) -> Position {
        Position(std::array::from_fn(|axis| self.zero(state, axis)))
    }

    /// Returns a programmed end point in machine coordinates, tool length included.
    pub(super) fn to_machine(&self, state: &State, point: &Position) -> Position {
        self.work_to_machine(state, &self.to_work(state, point))
    }

    /// Returns a programmed point that is no end point in machine coordinates, as [`ControlData::to_machine`] without
    /// rounding.
    pub(super) fn to_machine_unrounded(&self, state: &State, point: &Position) -> Position {
        self.work_to_machine(state, &state.transform.work_position(*point))
    }

    /// Returns a programmed end point in work coordinates; those that rotation or scaling computes are rounded to the least
    /// input increment, except in a plane that G53.1 has aligned.
    pub(super) fn to_work(&self, state: &State, point: &Position) -> Position {
        let mut work = state.transform.work_position(*point);
        let computed = state.transform.computed_axes();
        if state.is_turned() {
            return work;
        }
        for axis in (0..MAX_AXES).filter(|axis| computed >> axis & 1 == 1) {
            work[axis] = self.round_to_increment(state, axis, work[axis]);
        }
        work
    }

    /// Returns a computed coordinate as a multiple of the least input increment, halves away from zero.
    pub(super) fn round_to_increment(&self, state: &State, axis: AxisIndex, value: f64) -> f64 {
        self.to_stored(state, Some(axis), self.to_program_unit(state, Some(axis), value))
    }

    fn work_to_machine(&self, state: &State, work: &Position) -> Position {
        let zero = self.zeros(state);
        let to_machine = |axis| match state.is_turned() {
            true => remove_noise(work[axis] + zero[axis] + state.length_offset[axis]),
            false => self.on_machine(work[axis], zero[axis], state.length_offset[axis]),
        };
        let mut machine = Position(std::array::from_fn(to_machine));
        for axis in self.settings.rollover_axes().filter(|axis| !state.is_virtual(*axis)) {
            // The shorter rotation from the current position; full rotations stay.
            let from = state.machine_position[axis] - self.zero(state, axis) - state.length_offset[axis];
            machine[axis] = self
                .without_residue(state, state.machine_position[axis] + shortest_rotation(from, work[axis]));
        }
        match self.aligned(state, &machine) {
            Some(aligned) => self.with_tip_at(state, &aligned, work, &machine),
            None => machine,
        }
    }

    /// Returns a point of a canned cycle in machine coordinates; `start` is the state at the start of its block. An axis that
    /// rolls over counts on from there without a wrap.
    pub(super) fn cycle_point(&self, start: &State, point: &Position) -> Position {
        let mut machine = self.to_machine(start, point);
        for axis in self.settings.rollover_axes() {
            let travel = point[axis] - start.programmed_position[axis];
            machine[axis] = self.remove_residue(start.machine_position[axis] + travel);
        }
        machine
    }

    /// Returns a work coordinate in machine coordinates; every caller adds in this order, so that all get the same bits.
    #[inline(always)]
    pub(super) fn on_machine(&self, work: f64, zero: f64, length: f64) -> f64 {
        self.remove_residue(work + zero + length)
    }

    /// Returns the tool position in the work coordinate system, without the length offset.
    fn work_point(&self, state: &State) -> Position {
        let mut work = Position::default();
        for axis in 0..self.settings.axes.len() {
            let at = state.machine_position[axis] - self.zero(state, axis) - state.length_offset[axis];
            let at = self.without_residue(state, at);
            work[axis] = if state.is_virtual(axis) { at } else { self.wrap_angle(axis, at) };
        }
        if let Some(aligned) = self.aligned(state, &state.machine_position) {
            let position = aligned.axes.map(|axis| state.machine_position[axis]);
            let turned = sum(position, scaled(aligned.length, -1.0));
            for (axis, value) in aligned.axes.into_iter().zip(aligned.frame.revert(turned)) {
                work[axis] = remove_noise(value - self.zero(state, axis));
            }
        }
        work
    }

    /// Recomputes the programmed position after a change of mirror, scaling or rotation; #5001… keep showing the programmed
    /// end of the last move.
    pub(super) fn apply_transform_change(&self, state: &mut State) {
        let (programmed, work) = (self.move_end(state), self.work_point(state));
        self.recompute_position(state);
        state.unknown = state.transform.spread(state.stated_unknown);
        state.end_before_transform =
            (state.programmed_position != programmed).then_some(EndBeforeTransform { programmed, work });
    }

    /// Returns the end of the last move as programmed.
    pub(super) fn move_end(&self, state: &State) -> Position {
        if let Some(plane) = &state.virtual_plane {
            let mut end = state.programmed_position;
            end[plane.rotary] = remove_noise(end[plane.rotary] / plane.scale());
            return end;
        }
        let Some(EndBeforeTransform { mut programmed, work }) = state.end_before_transform else {
            return state.programmed_position;
        };
        let now = self.work_point(state);
        for axis in 0..self.settings.axes.len() {
            programmed[axis] = self.remove_residue(programmed[axis] + now[axis] - work[axis]);
        }
        programmed
    }

    /// Recomputes the programmed position after something other than a move has changed its coordinates.
    pub(super) fn recompute_position(&self, state: &mut State) {
        let work = self.work_point(state);
        state.programmed_position = state.transform.programmed_position(work);
        if !state.transform.is_identity() {
            for axis in 0..MAX_AXES {
                state.programmed_position[axis] =
                    self.without_residue(state, state.programmed_position[axis]);
            }
        }
    }

    /// Returns a coordinate without the rounding errors of sums: a hundredth of the increment carries mm and inches exactly.
    #[inline]
    pub(super) fn remove_residue(&self, value: f64) -> f64 {
        let grid = residue_grid(self.settings.increment);
        round(value * grid) / grid
    }

    /// Returns a coordinate without rounding errors, to 1e-9 where kinematics computes it.
    pub(super) fn without_residue(&self, state: &State, value: f64) -> f64 {
        if state.is_turned() { remove_noise(value) } else { self.remove_residue(value) }
    }

    /// Returns a work coordinate, from 0 to 360 on an axis that rolls over.
    pub(super) fn wrap_angle(&self, axis: AxisIndex, value: f64) -> f64 {
        if self.settings.rolls_over[axis] { remove_noise(value.rem_euclid(360.0)) } else { value }
    }

    /// Returns the end of an axis that goes to a machine coordinate: an axis that rolls over takes the shorter rotation.
    pub(super) fn rollover_target(&self, axis: AxisIndex, from: f64, to: f64) -> f64 {
        if self.settings.rolls_over[axis] {
            self.remove_residue(from + shortest_rotation(from, to))
        } else {
            to
        }
    }

    /// Converts a length from the active unit to mm, a multiple of the increment, as offsets are stored.
    pub(super) fn to_stored(&self, state: &State, axis: Option<AxisIndex>, value: f64) -> f64 {
        let is_rotary = axis.is_some_and(|axis| self.settings.axes.is_rotary(axis));
        let increment = self.settings.increment;
        match state.modal.unit {
            Unit::Inch if !is_rotary => {
                let tenths = increment.per_unit() * 10.0;
                self.remove_residue(round_scaled(value, tenths) / tenths * 25.4)
            }
            Unit::Inch | Unit::Metric => increment.round(value),
        }
    }

    /// Raises the alarm of an offset with more digits than a position.
    pub(super) fn check_offset_range(&self, value: f64) -> Result<f64, Alarm> {
        let is_in_range = value.abs() * self.settings.increment.per_unit() <= 999_999_999.0;
        if is_in_range { Ok(value) } else { Err(Alarm::OffsetValue { value }) }
    }

    /// Converts a length in mm to the active unit, as a program reads it.
    pub(super) fn to_program_unit(&self, state: &State, axis: Option<AxisIndex>, value: f64) -> f64 {
        let is_rotary = axis.is_some_and(|axis| self.settings.axes.is_rotary(axis));
        if state.modal.unit == Unit::Inch && !is_rotary { value / 25.4 } else { value }
    }

    /// Returns the length offset of the modal state, on Z, or along the tool that G53.1 has turned; and its wear.
    pub(super) fn length_offset(&self, state: &State) -> Result<(Position, f64), Alarm> {
        let sign = match state.modal.length {
            Length::Plus | Length::TipByAngles | Length::TipByVector | Length::TipOfHaas => 1.0,
            Length::Minus => -1.0,
            Length::Off => return Ok((Position::default(), 0.0)),
        };
        self.axis_with_letter(b'Z')?;
        let h = state.modal_words.h;
        let wear = sign * self.offsets.tool(Register::HWear, h)?;
        Ok((self.along_tool(state, sign * self.offsets.length(h)?), wear))
    }

    /// Returns a length on Z, or along the tool that G53.1 has turned.
    pub(super) fn along_tool(&self, state: &State, length: f64) -> Position {
        let mut offset = Position::default();
        let Some(axis) = self.settings.axes.find(b'Z') else { return offset };
        offset[axis] = length;
        if let Some((axes, alignment)) = state.alignment() {
            let length = alignment.tool.apply(axes.map(|axis| offset[axis]));
            for (axis, value) in axes.into_iter().zip(length) {
                offset[axis] = value;
            }
        }
        offset
    }

    /// Returns the event of the active length offset.
    pub(super) fn length_event(&self, state: &State) -> EventKind {
        EventKind::ToolLength {
            offset: state.length_offset,
            wear: self.along_tool(state, state.length_wear),
            compensation: state.length_compensation(),
        }
    }

    /// Returns an axis of the control by its number, counted from 0.
    pub(super) fn check_axis(&self, axis: u32) -> Result<AxisIndex, Alarm> {
        let known = Some(axis as usize).filter(|axis| *axis < self.settings.axes.len());
        known.ok_or(Alarm::AxisNumber { number: i64::from(axis) + 1 })
    }

    /// Raises the alarm of a work coordinate system that the control lacks.
    pub(super) fn check_system(&self, system: usize) -> Result<(), Alarm> {
        if system >= self.offsets.work.len() {
            return Err(Alarm::OffsetNumber { number: system as i64 - 6 });
        }
        Ok(())
    }

    /// Checks the stroke of events in a virtual plane, as the machine executes them.
    pub(super) fn check_moves_of<'e>(
        &self,
        state: &State,
        mut events: impl Iterator<Item = &'e EventKind>,
    ) -> Result<(), Alarm> {
        let Some(mut plane) = state.virtual_plane else {
            return events.try_for_each(|kind| self.check_move(kind));
        };
        let mut result = Ok(());
        for kind in events {
            plane.emit(kind, 0.0, self.settings.chord_tolerance, &mut |kind, _| {
                if result.is_ok() {
                    result = self.check_move(&kind);
                }
            });
        }
        result
    }

    /// Stored stroke check 1 (parameters 1320 and 1321): raises the alarm of a move beyond the limits, if there are any.
    pub(super) fn check_move(&self, kind: &EventKind) -> Result<(), Alarm> {
        let (Some(stroke), Some(to)) = (&self.settings.stroke_limits, kind.end()) else { return Ok(()) };
        self.check_point(stroke, to)?;
        if let EventKind::Arc { arc, .. } = kind {
            extremes(arc, to).iter().flatten().try_for_each(|point| self.check_point(stroke, point))?;
        }
        Ok(())
    }

    fn check_point(&self, stroke: &StrokeLimits, point: &Position) -> Result<(), Alarm> {
        for (axis, letter) in self.settings.axes.iter() {
            // An axis that rolls over has no end.
            if self.settings.rolls_over[axis] {
                continue;
            }
            let value = point[axis];
            if let Some(limit) = stroke.max[axis].filter(|limit| value > *limit) {
                return Err(Alarm::Overtravel { letter, is_plus: true, value, limit });
            }
            if let Some(limit) = stroke.min[axis].filter(|limit| value < *limit) {
                return Err(Alarm::Overtravel { letter, is_plus: false, value, limit });
            }
        }
        Ok(())
    }
}

/// Returns the points with the largest and smallest coordinates of a circle that an arc passes, the other axes at its end.
fn extremes(arc: &PlanarArc, to: &Position) -> [Option<Position>; 4] {
    let (x, y) = (to[arc.plane.0] - arc.centre.0, to[arc.plane.1] - arc.centre.1);
    let radius = libm::hypot(x, y);
    let end = Deg::atan2(y, x).0;
    [(0.0, (1.0, 0.0)), (90.0, (0.0, 1.0)), (180.0, (-1.0, 0.0)), (270.0, (0.0, -1.0))].map(
        |(angle, (cosine, sine))| {
            // Angle from the point to the end, in the direction of the sweep.
            let back = (end - angle).rem_euclid(360.0);
            let passed = if arc.sweep.0 > 0.0 { back } else { (360.0 - back).rem_euclid(360.0) };
            (passed < arc.sweep.0.abs()).then(|| {
                let mut point = *to;
                point[arc.plane.0] = arc.centre.0 + radius * cosine;
                point[arc.plane.1] = arc.centre.1 + radius * sine;
                point
            })
        },
    )
}

/// Returns the number of steps in a unit to which sums of coordinates are rounded.
#[inline]
pub(super) fn residue_grid(increment: Increment) -> f64 {
    increment.per_unit() * 100.0
}

/// Returns the rotation of an axis that rolls over: the shorter one, 180° in the plus direction.
pub(super) fn shortest_rotation(from: f64, to: f64) -> f64 {
    let rotation = (to - from).rem_euclid(360.0);
    if rotation > 180.0 { rotation - 360.0 } else { rotation }
}

#[cfg(test)]
mod tests {
    use super::*;
    use gcode_lang::control::Settings;

    fn at(x: f64, z: f64) -> Position {
        let mut position = Position::default();
        (position[0], position[2]) = (x, z);
        position
    }

    #[test]
    fn a_programmed_point_is_moved_by_work_offset_and_tool_length() {
        let mut data = ControlData::new(Settings::default());
        data.set_work_offset(1, 0, 100.0);
        data.set_work_offset(0, 0, 0.5);
        let state = State { length_offset: at(0.0, 50.0), ..State::default() };
        assert_eq!(data.to_machine(&state, &at(10.0, 1.0)), at(110.5, 51.0));
        assert_eq!(data.set_offsets.axes(1), 1, "X of G54 is known to be set");
    }

    #[test]
    fn the_programmed_position_follows_the_offset() {
        let mut data = ControlData::new(Settings::default());
        let mut state = State { machine_position: at(30.0, 0.0), ..State::default() };
        data.set_work_offset(1, 0, 10.0);
        data.recompute_position(&mut state);
        assert_eq!(state.programmed_position, at(20.0, 0.0));
        assert_eq!(data.to_machine(&state, &state.programmed_position), state.machine_position);
    }

    #[test]
    fn a_rotary_axis_takes_the_shorter_rotation() {
        assert_eq!(shortest_rotation(0.0, -150.0), -150.0);
        assert_eq!(shortest_rotation(210.0, 540.0), -30.0);
        assert_eq!(shortest_rotation(0.0, 180.0), 180.0);
    }
}
