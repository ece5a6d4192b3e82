//! Everything that a program can read: variables, modes, positions, tables, signals and clocks.
use std::cell::Cell;
use std::collections::BTreeMap;

use super::data::ControlData;
use super::functions::integer;
use super::linear_motion::CoordinateBasis;
use super::lookahead::Lookahead;
use super::outcome::BlockEffects;
use super::state::State;
use super::variables::{OperandStack, Vars};
use gcode_lang::alarm::Alarm;
use gcode_lang::control::Settings;
use gcode_lang::motion::UnknownAxes;
use gcode_lang::program::modes::Unit;

/// Values from which expressions, words and system variables are evaluated, and which blocks change.
#[derive(Clone, Debug)]
pub(super) struct Registers {
    pub(super) data: ControlData,
    pub(super) variables: Vars,
    /// Modes and positions, which a block of words replaces as a whole.
    pub(super) state: Box<State>,
    /// Blocks that are read and wait for the next move.
    pub(super) lookahead: Lookahead,
    pub(super) panel: Panel,
    pub(super) clock: Clock,
    pub(super) operand_stack: OperandStack,
    pub(super) block_effects: BlockEffects,
    /// Origin and units of axis words while a block can be a plain move.
    pub(super) plain_basis: Option<CoordinateBasis>,
}

impl Registers {
    pub(super) fn new(settings: Settings) -> Self {
        let variables = Vars::new(&settings.extra_commons, settings.aliases_commons);
        let uncommanded = (0..settings.axes.len()).fold(0, |axes, axis| axes | 1 << axis);
        let mut state =
            State { unknown: UnknownAxes { uncommanded, ..UnknownAxes::default() }, ..State::default() };
        if settings.is_inch_at_power_on == Some(true) {
            state.modal.unit = Unit::Inch;
        }
        Self {
            data: ControlData::new(settings),
            variables,
            state: Box::new(state),
            lookahead: Lookahead::default(),
            panel: Panel::default(),
            clock: Clock::default(),
            operand_stack: OperandStack::default(),
            block_effects: BlockEffects::default(),
            plain_basis: None,
        }
    }

    /// Returns true if a program that continues from here can't distinguish the two, except by a clock that it reads.
    pub(super) fn continues_like(&self, other: &Self) -> bool {
        self.continues_like_but_for_variables(other) && self.variables.has_same_values(&other.variables)
    }

    /// Returns true if a program can't distinguish the two but by its variables and a clock.
    pub(super) fn continues_like_but_for_variables(&self, other: &Self) -> bool {
        let Self {
            data,
            variables: _,
            state,
            lookahead,
            panel,
            clock,
            // Empty between two blocks.
            operand_stack: _,
            block_effects: _,
            // Derived from the rest.
            plain_basis: _,
        } = self;
        **state == *other.state
            && *lookahead == other.lookahead
            && *panel == other.panel
            && clock.continues_like(&other.clock)
            && *data == other.data
    }
}

/// Signals, switches and counters that a program sets.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Panel {
    /// Output signals, #1100 the lowest bit.
    pub(super) outputs: u32,
    /// #3003 and #3004.
    pub(super) control_switches: [f64; 2],
    /// #3901 and #3902: parts made, parts required.
    pub(super) part_counters: [f64; 2],
    /// Outputs and tables of a Haas that the program has written, by their variables.
    stored_values: BTreeMap<u32, f64>,
    /// Output device open: between POPEN and PCLOS.
    pub(super) is_output_open: bool,
}

/// Refuses signals beyond the first 32; a control may have up to 128 each way.
pub(super) fn check_signal_word(word: u32) -> Result<(), Alarm> {
    if word > 0 {
        return Err(Alarm::NotSimulated { what: "more than 32 interface signals".into() });
    }
    Ok(())
}

impl Panel {
    /// Returns an output or an entry of a table that the program has written.
    pub(super) fn stored(&self, number: u32) -> Option<f64> {
        self.stored_values.get(&number).copied()
    }

    /// Writes an output or an entry of a table.
    pub(super) fn store(&mut self, number: u32, value: f64) {
        self.stored_values.insert(number, value);
    }

    pub(super) fn set_output(&mut self, bit: u32, on: bool) {
        self.outputs = if on { self.outputs | 1 << bit } else { self.outputs & !(1 << bit) };
    }

    /// Sets a word of 32 output signals.
    pub(super) fn set_outputs(&mut self, word: u32, value: f64) -> Result<(), Alarm> {
        let bits = integer(value)?;
        check_signal_word(word)?;
        // 32 bits, signed or not.
        if !(i64::from(i32::MIN)..=i64::from(u32::MAX)).contains(&bits) {
            return Err(Alarm::OutOfRange { function: "#1132".into(), value });
        }
        self.outputs = bits as u32;
        Ok(())
    }

    /// Sets #3003, which has two bits, or #3004, which has three.
    pub(super) fn set_switch(&mut self, switch: u32, value: f64) -> Result<(), Alarm> {
        let max = if switch == 0 { 3.0 } else { 7.0 };
        if !(0.0..=max).contains(&value.round()) {
            return Err(Alarm::OutOfRange { function: format!("#{}", 3003 + switch), value });
        }
        self.control_switches[switch as usize] = value.round();
        Ok(())
    }

    /// Sets #3901 or #3902.
    pub(super) fn set_parts(&mut self, counter: u32, value: f64) -> Result<(), Alarm> {
        if value < 0.0 {
            return Err(Alarm::NegativeVariable { number: 3901 + counter });
        }
        self.part_counters[counter as usize] = value.round();
        Ok(())
    }
}

/// Clocks #3001, #3002 and #3012; they start with the run.
#[derive(Clone, Debug, Default)]
pub(super) struct Clock {
    /// Duration of the motion, seconds.
    pub(super) motion_seconds: f64,
    /// Seconds that have passed while the program only read a clock.
    pub(super) idle_seconds: f64,
    /// Offsets from setting #3001, milliseconds, and #3002, hours.
    pub(super) offsets: (f64, f64),
    /// The program has read a clock or a skip signal since the last jump back.
    pub(super) has_been_read: Cell<bool>,
}

impl Clock {
    /// Returns true if the clocks differ by the motion alone.
    pub(super) fn continues_like(&self, other: &Self) -> bool {
        let Self { motion_seconds: _, idle_seconds, offsets, has_been_read: _ } = self;
        (*idle_seconds, *offsets) == (other.idle_seconds, other.offsets)
    }

    /// Returns #3002, hours.
    pub(super) fn hours(&self) -> f64 {
        self.offsets.1 + self.seconds() / 3600.0
    }

    /// Sets #3001.
    pub(super) fn set_milliseconds(&mut self, value: f64) {
        self.offsets.0 = value - (self.motion_seconds + self.idle_seconds) * 1000.0;
    }

    /// Sets #3002.
    pub(super) fn set_hours(&mut self, value: f64) {
        self.offsets.1 = value - (self.motion_seconds + self.idle_seconds) / 3600.0;
    }

    /// Returns the seconds since the start, and records that a clock was read.
    pub(super) fn seconds(&self) -> f64 {
        self.has_been_read.set(true);
        self.motion_seconds + self.idle_seconds
    }

    /// Returns #3001, milliseconds; it wraps as on a control.
    pub(super) fn milliseconds(&self) -> f64 {
        (self.seconds() * 1000.0 + self.offsets.0 + 1e-6).trunc().rem_euclid(2_147_483_648.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::variables::Value;

    #[test]
    fn a_difference_that_a_program_can_read_makes_registers_differ() {
        let registers = Registers::new(Settings::default());
        let differs = |change: fn(&mut Registers)| {
            let mut other = registers.clone();
            change(&mut other);
            !registers.continues_like(&other)
        };
        assert!(!differs(|_| {}));
        assert!(differs(|r| r.variables.set(500, Value::Number(0.0))), "vacant is not 0");
        assert!(differs(|r| r.state.machine_position[1] = 0.001));
        assert!(differs(|r| r.panel.outputs = 1));
        assert!(differs(|r| r.data.settings.date += 1));
        assert!(differs(|r| r.data.set_work_offset(1, 0, 0.0)), "G54 has been set");
        assert!(differs(|r| r.clock.idle_seconds = 0.001));
        assert!(!differs(|r| r.clock.motion_seconds = 0.001), "motion alone decides nothing");
    }

    #[test]
    fn outputs_are_bits_of_one_word() {
        let mut panel = Panel::default();
        panel.set_output(3, true);
        panel.set_output(0, true);
        panel.set_output(3, false);
        assert_eq!(panel.outputs, 1);
        panel.set_outputs(0, -1.0).unwrap();
        assert_eq!(panel.outputs, u32::MAX, "32 bits with a sign");
        assert!(panel.set_outputs(0, 4_294_967_296.0).is_err());
        assert!(panel.set_outputs(1, 0.0).is_err(), "#1133 is not simulated");
        assert_eq!(panel.outputs, u32::MAX, "a refused value changes nothing");
    }

    #[test]
    fn switches_have_two_and_three_bits() {
        let mut panel = Panel::default();
        panel.set_switch(0, 3.0).unwrap();
        panel.set_switch(1, 7.0).unwrap();
        assert!(panel.set_switch(0, 4.0).is_err() && panel.set_switch(1, 8.0).is_err());
        assert_eq!(panel.control_switches, [3.0, 7.0]);
        assert!(panel.set_parts(0, -1.0).is_err());
    }

    #[test]
    fn a_clock_runs_with_the_motion_and_can_be_set() {
        let mut clock = Clock { motion_seconds: 1.5, ..Clock::default() };
        assert_eq!(clock.milliseconds(), 1500.0);
        assert!(clock.has_been_read.get());
        clock.set_milliseconds(100.0);
        clock.motion_seconds += 0.25;
        assert_eq!(clock.milliseconds(), 350.0);
        clock.set_hours(2.0);
        clock.motion_seconds += 1800.0;
        assert!((clock.hours() - 2.5).abs() < 1e-9);
    }

    #[test]
    fn clocks_that_differ_by_motion_alone_continue_alike() {
        let clock = Clock::default();
        assert!(clock.continues_like(&Clock { motion_seconds: 5.0, ..Clock::default() }));
        assert!(!clock.continues_like(&Clock { idle_seconds: 5.0, ..Clock::default() }));
        assert!(!clock.continues_like(&Clock { offsets: (0.0, 1.0), ..Clock::default() }));
    }
}
