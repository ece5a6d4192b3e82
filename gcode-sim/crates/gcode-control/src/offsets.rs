//! The offset tables: work coordinate systems and tool offsets, held in increments as a control holds them.
use super::Executor;
use super::linear_motion::shortest_rotation;
use super::state::{EndPoint, State};
use gcode_lang::alarm::Alarm;
use gcode_lang::motion::{AxisIndex, MAX_AXES, Position};
use gcode_lang::program::modes::{Length, Unit, WorkSystem};
use gcode_lang::units::round;
use gcode_lang::units::round_scaled;

/// Tool offset memory C: H and D, geometry and wear.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Register {
    HGeometry,
    HWear,
    DGeometry,
    DWear,
}

/// All offsets; lengths in mm.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Offsets {
    external: Position,
    /// G54 to G59.
    standard: [Position; 6],
    pub(super) additional: Vec<Position>,
    h_geometry: Vec<f64>,
    h_wear: Vec<f64>,
    d_geometry: Vec<f64>,
    d_wear: Vec<f64>,
}

impl Offsets {
    pub(super) fn new(tools: usize, systems: usize) -> Self {
        let empty = vec![0.0; tools + 1];
        Self {
            external: Position::default(),
            standard: [Position::default(); 6],
            additional: vec![Position::default(); systems],
            h_geometry: empty.clone(),
            h_wear: empty.clone(),
            d_geometry: empty.clone(),
            d_wear: empty,
        }
    }

    pub(super) fn register(&mut self, register: Register) -> &mut Vec<f64> {
        match register {
            Register::HGeometry => &mut self.h_geometry,
            Register::HWear => &mut self.h_wear,
            Register::DGeometry => &mut self.d_geometry,
            Register::DWear => &mut self.d_wear,
        }
    }

    /// The rows of a table; row 0 is no offset.
    pub(super) fn table(&self, register: Register) -> &[f64] {
        match register {
            Register::HGeometry => &self.h_geometry,
            Register::HWear => &self.h_wear,
            Register::DGeometry => &self.d_geometry,
            Register::DWear => &self.d_wear,
        }
    }

    pub(super) fn tool(&self, register: Register, number: u32) -> Result<f64, Alarm> {
        let unknown = || Alarm::OffsetNumber { number: i64::from(number) };
        self.table(register).get(number as usize).copied().ok_or_else(unknown)
    }

    pub(super) fn external(&self) -> &Position {
        &self.external
    }

    /// G54 to G59.
    pub(super) fn standard(&self) -> &[Position; 6] {
        &self.standard
    }

    /// Geometry and wear of an H number; H0 is no offset.
    pub(super) fn length(&self, h: u32) -> Result<f64, Alarm> {
        Ok(self.tool(Register::HGeometry, h)? + self.tool(Register::HWear, h)?)
    }

    /// The zero of a work coordinate system in machine coordinates.
    fn zero(&self, system: &Position, state: &State, axis: AxisIndex) -> f64 {
        self.external[axis] + system[axis] + state.local_offset[axis] + state.coordinate_shift[axis]
    }

    fn work_system(&self, work: WorkSystem) -> &Position {
        match work {
            WorkSystem::Standard(number) => &self.standard[usize::from(number) - 1],
            WorkSystem::Additional(number) => &self.additional[usize::from(number) - 1],
        }
    }
}

impl Executor {
    /// The zero of the active work coordinate system in machine coordinates.
    pub(super) fn zero(&self, state: &State, axis: AxisIndex) -> f64 {
        self.offsets.zero(self.offsets.work_system(state.modal.work), state, axis)
    }

    /// As [`Executor::zero`], of all axes.
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

    /// Whether every axis stands where the programmed point is on the machine, so that one which isn't named stays there.
    pub(super) fn is_at_programmed_point(&self) -> bool {
        self.state.transform.is_none()
            && self.settings.rollover_axes().next().is_none()
            && self.to_machine(&self.state, &self.state.programmed).0.map(f64::to_bits)
                == self.state.machine.0.map(f64::to_bits)
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
}

impl Offsets {
    /// System 0 is the external one, 1 to 6 are G54 to G59, 7 and up G54.1 P1….
    pub(super) fn work(&self, system: usize) -> &Position {
        match system {
            0 => &self.external,
            1..=6 => &self.standard[system - 1],
            _ => &self.additional[system - 7],
        }
    }

    pub(super) fn work_mut(&mut self, system: usize) -> &mut Position {
        match system {
            0 => &mut self.external,
            1..=6 => &mut self.standard[system - 1],
            _ => &mut self.additional[system - 7],
        }
    }
}
