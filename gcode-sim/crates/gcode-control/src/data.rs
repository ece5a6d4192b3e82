//! What the control's screens of settings, parameters and offsets hold, and what follows from these alone: quantities,
//! coordinates, times and limits.
use std::collections::{BTreeMap, BTreeSet};

use super::checked::integer;
use super::offsets::Offsets;
use gcode_lang::alarm::Alarm;
use gcode_lang::control::{ParameterError, ParameterId, Settings};
use gcode_lang::motion::AxisIndex;

/// Settings, parameters and offset tables. They change between blocks only, by G10 and by system variables.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct ControlData {
    pub(super) settings: Settings,
    /// Parameters that the program has written.
    pub(super) parameters: BTreeMap<ParameterId, f64>,
    pub(super) offsets: Offsets,
    /// The work coordinate systems that G10 or a variable has set, counted as in [`Offsets::work`].
    pub(super) set_systems: BTreeSet<usize>,
}

impl ControlData {
    pub(super) fn new(settings: Settings) -> Self {
        let offsets = Offsets::new(settings.tool_offsets, settings.work_systems);
        Self { settings, parameters: BTreeMap::new(), offsets, set_systems: BTreeSet::new() }
    }

    /// Writes a work offset of one axis; system 0 is the external one, 1 to 6 are G54 to G59, 7 and up G54.1 P1….
    pub(super) fn set_work_offset(&mut self, system: usize, axis: AxisIndex, value: f64) {
        self.offsets.work_mut(system)[axis] = value;
        self.set_systems.insert(system);
    }
}

impl ControlData {
    /// Block skip: whether the switch is on.
    pub(super) fn is_skip_on(&self, switch: u8) -> bool {
        self.settings.skip_switches.get(usize::from(switch.max(1)) - 1).copied().unwrap_or(false)
    }

    /// `PRM[n]`, `PRM[n,bit]`, `PRM[n]/[axis]`, `PRM[n,bit]/[axis]`.
    pub(super) fn read_parameter(
        &self,
        number: f64,
        bit: Option<f64>,
        axis: Option<f64>,
    ) -> Result<f64, Alarm> {
        let format = || Alarm::ArgumentFormat { function: "PRM".into() };
        let known = integer(number)?;
        let unknown = || Alarm::NotSimulated { what: format!("PRM[{known}]") };
        let id = ParameterId {
            number: u16::try_from(known).map_err(|_| unknown())?,
            bit: bit.map(|bit| self.parameter_bit(bit).ok_or_else(format)).transpose()?,
            axis: axis.map(|axis| self.axis_of(axis).map_err(|_| format())).transpose()?,
        };
        if let Some(written) = self.parameters.get(&id) {
            return Ok(*written);
        }
        self.settings.parameter(id).map_err(|error| match error {
            ParameterError::MissingAxis | ParameterError::UnexpectedAxis | ParameterError::UnexpectedBit => {
                format()
            }
            _ => unknown(),
        })
    }

    pub(super) fn parameter_bit(&self, bit: f64) -> Option<u8> {
        (0.0..=7.0).contains(&bit.round()).then_some(bit.round() as u8)
    }

    /// An axis by its number from 1 on.
    pub(super) fn axis_of(&self, number: f64) -> Result<AxisIndex, Alarm> {
        let number = integer(number)?;
        let axis = usize::try_from(number - 1).ok().filter(|axis| *axis < self.settings.axes.len());
        axis.ok_or(Alarm::AxisNumber { number })
    }

    /// Carries out what [`Planner::plan_parameter`] has checked.
    pub(super) fn set_parameter(&mut self, id: ParameterId, value: f64, has_no_effect: bool) {
        self.parameters.insert(id, value);
        if has_no_effect {
            return;
        }
        // It was tried on a copy when the block was checked.
        let set = self.settings.set_parameter(id, value);
        debug_assert_eq!(set, Ok(()));
    }
}
