//! What can be seen of a control: while it runs, and at its end.
use std::collections::BTreeMap;

use super::control::Control;
use super::notes::Note;
use super::outcome::{OperatorStop, Outcome};
use super::state::State;
use super::variables::{Value, Vars};
use gcode_lang::alarm::Alarm;
use gcode_lang::control::Settings;
use gcode_lang::motion::{AxisIndex, Backtrace, Position};
use gcode_lang::program::Memory;
use gcode_lang::source::Span;
use gcode_lang::units::Seconds;

impl Control {
    pub fn memory(&self) -> &Memory {
        &self.memory
    }

    pub fn settings(&self) -> &Settings {
        &self.executor.registers.data.settings
    }

    /// How the run ended, or `None` while it goes on.
    pub fn outcome(&self) -> Option<&Outcome> {
        self.outcome.as_ref()
    }

    /// What isn't vacant, by number: the main program's locals as they stood before M30's reset, and the commons.
    pub fn variables(&self) -> impl Iterator<Item = (u32, f64)> + '_ {
        self.executor.registers.variables.nonvacant()
    }

    /// A variable of any kind by its number, as a program would read it now.
    pub fn variable(&self, number: u32) -> Result<Value, Alarm> {
        self.executor.registers.without_side_effects(|registers| registers.read_variable(number))
    }

    /// Local and common variables as they stand.
    pub fn vars(&self) -> &Vars {
        &self.executor.registers.variables
    }

    /// The coordinate of an axis in the active work coordinate system, as #5001… show it.
    pub fn work_position(&self, axis: AxisIndex) -> f64 {
        let state = &self.executor.registers.state;
        self.executor.registers.data.to_program_unit(state, Some(axis), state.programmed[axis])
    }

    /// The tool's centre in machine coordinates, mm and degrees.
    pub fn machine_position(&self) -> Position {
        let mut centre = self.executor.registers.state.machine;
        for axis in 0..self.executor.registers.data.settings.axes.len() {
            centre[axis] = self.executor.registers.tool_centre(axis);
        }
        centre
    }

    pub fn state(&self) -> &State {
        &self.executor.registers.state
    }

    /// The block last begun, and the calls that led to it.
    pub fn backtrace(&self) -> Backtrace {
        self.executor.flow.backtrace()
    }

    /// Blocks executed so far.
    pub fn blocks(&self) -> u64 {
        self.executor.log.blocks
    }

    /// Moves so far.
    pub fn moves(&self) -> u64 {
        self.executor.log.moves
    }

    /// What the motion takes, without acceleration.
    pub fn seconds(&self) -> Seconds {
        Seconds(self.executor.registers.clock.motion_seconds)
    }

    /// M codes that the control has no use for: they went to the machine builder's logic, which isn't simulated. Each
    /// with the first block that has it.
    pub fn auxiliary_codes(&self) -> &BTreeMap<u32, Span> {
        &self.executor.log.auxiliary_codes
    }

    /// The lines of DPRNT and BPRNT, without their ends; BPRNT prints bytes that are no text.
    pub fn output(&self) -> &[Vec<u8>] {
        &self.executor.log.printed.lines
    }

    /// The first and the last block of the loop that was found never to end, where that ended the run.
    pub fn endless_loop(&self) -> Option<(Span, Span)> {
        let found = self.loop_detector.endless_loop()?;
        let first = self.memory.block_span(found.program, found.to)?;
        Some((first, found.from))
    }

    /// Operator stops in order; the first ten thousand.
    pub fn stops(&self) -> &[OperatorStop] {
        &self.executor.log.stops
    }
}

impl Control {
    /// Each note with the first block it is about.
    pub fn notes(&self) -> impl Iterator<Item = (Note, Span)> + '_ {
        self.executor.log.notes.iter().map(|(note, block)| (*note, *block))
    }
}
