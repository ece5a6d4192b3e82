//! Settings, parameters and offset tables of a control.
use std::collections::BTreeMap;

use super::functions::integer;
use super::state::State;
use gcode_lang::alarm::Alarm;
use gcode_lang::control::{OffsetMemory, ParameterError, ParameterId, Settings};
use gcode_lang::motion::{AxisIndex, Position};
use gcode_lang::program::Words;
use gcode_lang::program::modes::WorkSystem;

/// Number of fixture offsets of G54.2.
pub(super) const FIXTURES: usize = 8;

/// Number of setting errors of G54.4.
pub(super) const SETTING_ERRORS: usize = 7;

/// Settings, parameters and offset tables. They change between blocks only, by G10 and by system variables.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct ControlData {
    pub(super) settings: Settings,
    /// Parameters that the program has written.
    pub(super) parameters: BTreeMap<ParameterId, f64>,
    pub(super) offsets: Offsets,
    /// Axes of the work offsets that G10 or a variable has set.
    pub(super) set_offsets: SystemAxes,
}

/// Axes of work coordinate systems, as bits by [`system_index`].
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct SystemAxes(BTreeMap<usize, u8>);

impl SystemAxes {
    /// Returns the axes of a system, as bits.
    pub(super) fn axes(&self, system: usize) -> u8 {
        self.0.get(&system).copied().unwrap_or_default()
    }

    pub(super) fn add(&mut self, system: usize, axes: u8) {
        *self.0.entry(system).or_default() |= axes;
    }

    pub(super) fn remove(&mut self, system: usize, axes: u8) {
        self.0.entry(system).and_modify(|all| *all &= !axes);
    }
}

/// Offset tables; lengths in mm, multiples of the increment.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Offsets {
    /// Work offsets by [`system_index`].
    pub(super) work: Vec<Position>,
    /// Tool offset memory C by [`Register`]; row 0 is no offset.
    pub(super) tools: [Vec<f64>; 4],
    /// Fixture offsets of G54.2, where something states them.
    pub(super) fixtures: [Option<Position>; FIXTURES],
    /// Shifts X Y Z and rotations about X Y Z of G54.4, where something states them.
    pub(super) setting_errors: [Option<[f64; 6]>; SETTING_ERRORS],
}

/// Table of tool offset memory C: H or D, geometry or wear.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Register {
    HGeometry,
    HWear,
    DGeometry,
    DWear,
}

impl Register {
    /// Returns the table that G10 L1 or L10 to L13 sets.
    pub(super) fn of_data_input(l: u32) -> Self {
        match l {
            10 => Self::HGeometry,
            12 => Self::DGeometry,
            13 => Self::DWear,
            _ => Self::HWear,
        }
    }
}

/// Number of the systems that every control has: the external offset and G54 to G59.
pub(super) const STANDARD_SYSTEMS: usize = 7;

/// Returns the index of a work coordinate system: 1 to 6 for G54 to G59, 7 and up for G54.1 P1…; 0 is the external
/// offset.
#[inline]
pub(super) fn system_index(work: WorkSystem) -> usize {
    match work {
        WorkSystem::Standard(number) => usize::from(number),
        WorkSystem::Additional(number) => STANDARD_SYSTEMS - 1 + usize::from(number),
    }
}

impl Offsets {
    /// Returns a tool offset; an alarm for a number that the table lacks.
    pub(super) fn tool(&self, register: Register, number: u32) -> Result<f64, Alarm> {
        let unknown = || Alarm::OffsetNumber { number: i64::from(number) };
        self.tools[register as usize].get(number as usize).copied().ok_or_else(unknown)
    }

    /// Returns the tool length, geometry and wear, of an H number.
    pub(super) fn length(&self, h: u32) -> Result<f64, Alarm> {
        Ok(self.tool(Register::HGeometry, h)? + self.tool(Register::HWear, h)?)
    }
}

impl ControlData {
    pub(super) fn new(settings: Settings) -> Self {
        let offsets = Offsets {
            work: vec![Position::default(); STANDARD_SYSTEMS + settings.work_systems],
            tools: std::array::from_fn(|_| vec![0.0; settings.tool_offsets + 1]),
            fixtures: [None; FIXTURES],
            setting_errors: [None; SETTING_ERRORS],
        };
        Self { settings, parameters: BTreeMap::new(), offsets, set_offsets: SystemAxes::default() }
    }

    pub(super) fn set_work_offset(&mut self, system: usize, axis: AxisIndex, value: f64) {
        self.offsets.work[system][axis] = value;
        self.set_offsets.add(system, 1 << axis);
    }

    /// Returns the zero of the active work coordinate system in machine coordinates.
    pub(super) fn zero(&self, state: &State, axis: AxisIndex) -> f64 {
        let Offsets { work, .. } = &self.offsets;
        let system = system_index(state.modal.work);
        work[0][axis] + work[system][axis] + state.g52_shift[axis] + state.g92_shift[axis]
    }

    /// Returns the table that a variable addresses: series 15 offsets swap geometry and wear.
    pub(super) fn register(&self, register: Register) -> Register {
        self.table(match (self.settings.series_15_offsets, register) {
            (false, same) => same,
            (true, Register::HGeometry) => Register::HWear,
            (true, Register::HWear) => Register::HGeometry,
            (true, Register::DGeometry) => Register::DWear,
            (true, Register::DWear) => Register::DGeometry,
        })
    }

    /// Returns the table of a register in the memory: A and B have one for H and D, A none for wear.
    pub(super) fn table(&self, register: Register) -> Register {
        match (self.settings.offset_memory, register) {
            (OffsetMemory::C, same) => same,
            (OffsetMemory::B, Register::HWear | Register::DWear) => Register::HWear,
            (OffsetMemory::A | OffsetMemory::B, _) => Register::HGeometry,
        }
    }

    /// Returns the radius of a D number, geometry and wear, half of it with ODI; `None` if the table lacks the number.
    pub(super) fn offset_radius(&self, d: u32) -> Option<f64> {
        let geometry = self.offsets.tool(self.table(Register::DGeometry), d).ok()?;
        let wear = self.offsets.tool(self.table(Register::DWear), d).ok()?;
        let sum = if self.settings.offset_memory == OffsetMemory::A { geometry } else { geometry + wear };
        Some(if self.settings.has_diameter_offsets() { sum / 2.0 } else { sum })
    }

    /// Returns the axis with a letter; PS0009 if the control lacks it.
    pub(super) fn axis_with_letter(&self, letter: u8) -> Result<AxisIndex, Alarm> {
        let missing = Alarm::ImproperAddress { letter: char::from(letter) };
        self.settings.axes.find(letter).ok_or(missing)
    }

    pub(super) fn axis_letter(&self, axis: AxisIndex) -> u8 {
        self.settings.axes.letter(axis) as u8
    }

    pub(super) fn is_skip_on(&self, switch: u8) -> bool {
        self.settings.skip_switches.get(usize::from(switch.max(1)) - 1).copied().unwrap_or(false)
    }

    /// Returns the words of a block without those that a block skip inside it excludes, and the switch of that block skip if it
    /// is off.
    pub(super) fn words_not_skipped<'a>(&self, words: &'a Words) -> (&'a Words, Option<u8>) {
        match words.form_if_skipped() {
            Some((switch, short)) if self.is_skip_on(*switch) => (short, None),
            Some((switch, _)) => (words, Some(*switch)),
            None => (words, None),
        }
    }

    /// Returns the value of `PRM[n]`, `PRM[n,bit]`, `PRM[n]/[axis]` or `PRM[n,bit]/[axis]`; the number of the parameter if
    /// nothing states it.
    pub(super) fn read_parameter(
        &self,
        number: f64,
        bit: Option<f64>,
        axis: Option<f64>,
    ) -> Result<Result<f64, u16>, Alarm> {
        let format = || Alarm::ArgumentFormat { function: "PRM".into() };
        let known = integer(number)?;
        let unknown = || Alarm::NotSimulated { what: format!("PRM[{known}]") };
        let id = ParameterId {
            number: u16::try_from(known).map_err(|_| unknown())?,
            bit: bit.map(|bit| parameter_bit(bit).ok_or_else(format)).transpose()?,
            axis: axis.map(|axis| self.axis_of(axis).map_err(|_| format())).transpose()?,
        };
        if let Some(written) = self.parameters.get(&id) {
            return Ok(Ok(*written));
        }
        match self.settings.parameter(id) {
            Ok(value) => Ok(Ok(value)),
            Err(
                ParameterError::MissingAxis | ParameterError::UnexpectedAxis | ParameterError::UnexpectedBit,
            ) => Err(format()),
            Err(ParameterError::Unknown) if id.number != 0 => Ok(Err(id.number)),
            Err(_) => Err(unknown()),
        }
    }

    /// Returns an axis by its number, counted from 1.
    pub(super) fn axis_of(&self, number: f64) -> Result<AxisIndex, Alarm> {
        let number = integer(number)?;
        let axis = usize::try_from(number - 1).ok().filter(|axis| *axis < self.settings.axes.len());
        axis.ok_or(Alarm::AxisNumber { number })
    }

    /// Writes a parameter that planning has checked on a copy of the settings.
    pub(super) fn set_parameter(&mut self, id: ParameterId, value: f64, has_no_effect: bool) {
        self.parameters.insert(id, value);
        if !has_no_effect {
            let set = self.settings.set_parameter(id, value);
            debug_assert_eq!(set, Ok(()));
        }
    }
}

pub(super) fn parameter_bit(bit: f64) -> Option<u8> {
    (0.0..=7.0).contains(&bit.round()).then_some(bit.round() as u8)
}
