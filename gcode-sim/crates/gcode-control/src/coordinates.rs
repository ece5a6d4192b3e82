//! Programmed, work and machine coordinates.
use super::data::ControlData;
use super::linear_motion::shortest_rotation;
use super::offsets::Register;
use super::state::{EndPoint, State};
use gcode_lang::alarm::Alarm;
use gcode_lang::motion::{AxisIndex, MAX_AXES, Position};
use gcode_lang::program::modes::{Length, Unit};
use gcode_lang::units::{round, round_scaled};

impl ControlData {
    /// The zero of the active work coordinate system in machine coordinates.
    pub(super) fn zero(&self, state: &State, axis: AxisIndex) -> f64 {
        self.offsets.zero(self.offsets.work_system(state.modal.work), state, axis)
    }

    /// As [`ControlData::zero`], of all axes.
    pub(super) fn zeros(&self, state: &State) -> Position {
        let system = self.offsets.work_system(state.modal.work);
        let mut zeros = Position::default();
        for axis in 0..MAX_AXES {
            zeros[axis] = self.offsets.zero(system, state, axis);
        }
        zeros
    }

    /// A programmed point in machine coordinates, tool length included.
    pub(super) fn to_machine(&self, state: &State, point: &Position) -> Position {
        let work = state.transform.forward(*point);
        let zero = self.zeros(state);
        let mut machine = Position::default();
        for axis in 0..MAX_AXES {
            machine[axis] = self.on_machine(work[axis], zero[axis], state.length_offset[axis]);
        }
        for axis in self.settings.rollover_axes() {
            // From where the axis stands, the shorter way: turns already made stay made.
            let from = state.machine[axis] - self.zero(state, axis) - state.length_offset[axis];
            machine[axis] = self.remove_residue(state.machine[axis] + shortest_rotation(from, work[axis]));
        }
        machine
    }

    /// A work coordinate in machine coordinates. Which of them is computed may depend on the block, the result must not.
    #[inline(always)]
    pub(super) fn on_machine(&self, work: f64, zero: f64, length: f64) -> f64 {
        self.remove_residue(work + zero + length)
    }

    /// The tool in the work coordinate system, without the length offset.
    fn work_point(&self, state: &State) -> Position {
        let mut work = Position::default();
        for axis in 0..self.settings.axes.len() {
            let at = state.machine[axis] - self.zero(state, axis) - state.length_offset[axis];
            work[axis] = self.wrap_angle(axis, self.remove_residue(at));
        }
        work
    }

    /// Mirror, scaling or rotation were switched: the program stands elsewhere in its coordinates, and #5001… go on
    /// showing where its last move was programmed to end.
    pub(super) fn apply_transform_change(&self, state: &mut State) {
        let (programmed, work) = (self.move_end(state), self.work_point(state));
        self.recompute_position(state);
        state.last_end_point = (state.programmed != programmed).then_some(EndPoint { programmed, work });
    }

    /// The end of the last move as it was programmed.
    pub(super) fn move_end(&self, state: &State) -> Position {
        let Some(EndPoint { mut programmed, work }) = state.last_end_point else { return state.programmed };
        let now = self.work_point(state);
        for axis in 0..self.settings.axes.len() {
            programmed[axis] = self.remove_residue(programmed[axis] + now[axis] - work[axis]);
        }
        programmed
    }

    /// Where the program stands after something other than a move changed its coordinates.
    pub(super) fn recompute_position(&self, state: &mut State) {
        let work = self.work_point(state);
        state.programmed = state.transform.backward(work);
        if !state.transform.is_none() {
            for axis in 0..MAX_AXES {
                state.programmed[axis] = self.remove_residue(state.programmed[axis]);
            }
        }
    }

    /// A coordinate without the residues of adding: a hundredth of the increment carries both mm and inches exactly.
    #[inline]
    pub(super) fn remove_residue(&self, value: f64) -> f64 {
        let grid = self.settings.increment.per_unit() * 100.0;
        round(value * grid) / grid
    }

    /// A work coordinate from 0 to 360 on an axis that rolls over.
    pub(super) fn wrap_angle(&self, axis: AxisIndex, value: f64) -> f64 {
        if self.settings.rolls_over[axis] { self.remove_residue(value.rem_euclid(360.0)) } else { value }
    }

    /// Where an axis ends that is sent to machine coordinates: one that rolls over goes there by the shorter way and
    /// unwinds no turns.
    pub(super) fn rollover_target(&self, axis: AxisIndex, from: f64, to: f64) -> f64 {
        if self.settings.rolls_over[axis] {
            self.remove_residue(from + shortest_rotation(from, to))
        } else {
            to
        }
    }

    /// What is stored of an offset that is written in the unit in force: mm, a multiple of the increment.
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

    /// An offset has as many digits as a position.
    pub(super) fn check_offset_range(&self, value: f64) -> Result<f64, Alarm> {
        let is_in_range = value.abs() * self.settings.increment.per_unit() <= 999_999_999.0;
        if is_in_range { Ok(value) } else { Err(Alarm::OffsetValue { value }) }
    }

    /// A length in mm as a program reads it: in the unit in force.
    pub(super) fn to_program_unit(&self, state: &State, axis: Option<AxisIndex>, value: f64) -> f64 {
        let is_rotary = axis.is_some_and(|axis| self.settings.axes.is_rotary(axis));
        if state.modal.unit == Unit::Inch && !is_rotary { value / 25.4 } else { value }
    }

    /// The length offset that the modal state asks for on its axis, Z.
    pub(super) fn length_offset(&self, state: &State) -> Result<Position, Alarm> {
        let mut offset = Position::default();
        let sign = match state.modal.length {
            Length::Plus => 1.0,
            Length::Minus => -1.0,
            Length::Off => return Ok(offset),
        };
        let axis = self.settings.axes.find(b'Z').ok_or(Alarm::ImproperAddress { letter: 'Z' })?;
        offset[axis] = sign * self.offsets.length(state.codes.h)?;
        Ok(offset)
    }

    /// An axis of the control by its number from 0 on.
    pub(super) fn check_axis(&self, axis: u32) -> Result<AxisIndex, Alarm> {
        let known = Some(axis as usize).filter(|axis| *axis < self.settings.axes.len());
        known.ok_or(Alarm::AxisNumber { number: i64::from(axis) + 1 })
    }

    /// The control has so many work coordinate systems; 6 are G54 to G59.
    pub(super) fn check_system(&self, system: usize) -> Result<(), Alarm> {
        if system > 6 + self.offsets.additional.len() {
            return Err(Alarm::OffsetNumber { number: system as i64 - 6 });
        }
        Ok(())
    }

    pub(super) fn register(&self, register: Register) -> Register {
        match (self.settings.series_15_offsets, register) {
            (false, same) => same,
            (true, Register::HGeometry) => Register::HWear,
            (true, Register::HWear) => Register::HGeometry,
            (true, Register::DGeometry) => Register::DWear,
            (true, Register::DWear) => Register::DGeometry,
        }
    }

    /// Geometry and wear of a D number, or half of them with ODI; `None` where it isn't in the table.
    pub(super) fn offset_radius(&self, d: u32) -> Option<f64> {
        let geometry = self.offsets.tool(Register::DGeometry, d).ok()?;
        let sum = geometry + self.offsets.tool(Register::DWear, d).ok()?;
        Some(if self.settings.offsets_are_diameters { sum / 2.0 } else { sum })
    }
}

#[cfg(test)]
mod tests {
    use gcode_lang::control::Settings;

    use super::*;

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
        assert!(data.set_systems.contains(&1), "G54 is known to be set");
    }

    #[test]
    fn where_the_program_stands_follows_the_offset() {
        let mut data = ControlData::new(Settings::default());
        let mut state = State { machine: at(30.0, 0.0), ..State::default() };
        data.set_work_offset(1, 0, 10.0);
        data.recompute_position(&mut state);
        assert_eq!(state.programmed, at(20.0, 0.0));
        assert_eq!(data.to_machine(&state, &state.programmed), state.machine);
    }
}
