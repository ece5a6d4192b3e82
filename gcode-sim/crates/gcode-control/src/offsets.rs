//! The offset tables: work coordinate systems and tool offsets, held in increments as a control holds them.
use super::state::State;
use gcode_lang::alarm::Alarm;
use gcode_lang::motion::{AxisIndex, Position};
use gcode_lang::program::modes::WorkSystem;

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
    pub(super) fn zero(&self, system: &Position, state: &State, axis: AxisIndex) -> f64 {
        self.external[axis] + system[axis] + state.local_offset[axis] + state.coordinate_shift[axis]
    }

    pub(super) fn work_system(&self, work: WorkSystem) -> &Position {
        match work {
            WorkSystem::Standard(number) => &self.standard[usize::from(number) - 1],
            WorkSystem::Additional(number) => &self.additional[usize::from(number) - 1],
        }
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
