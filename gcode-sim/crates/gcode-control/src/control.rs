//! A control with programs in its memory: its run, block by block, and what can be seen of it.
use std::collections::BTreeMap;
use std::sync::Arc;
use std::sync::atomic::Ordering;

use super::executor::Executor;
use super::functions::ExecResult;
use super::lookahead::Lookahead;
use super::loop_detection::LoopDetector;
use super::notes::Note;
use super::outcome::{AlarmStop, Limits, OperatorStop, Outcome, Progress, RunEnd, UnsetWorkOffset};
use super::plan::BlockPlan;
use super::state::State;
use super::variables::{Value, Vars};
use super::words::BlockWords;
use gcode_lang::alarm::Alarm;
use gcode_lang::control::Settings;
use gcode_lang::motion::{AxisIndex, Backtrace, EventSink, Position};
use gcode_lang::program::modes::{ModalGroup, Unit, WorkSystem};
use gcode_lang::program::{Library, Memory, Slot};
use gcode_lang::source::Span;
use gcode_lang::units::Seconds;

/// Control with programs in its memory.
#[derive(Debug)]
pub struct Control {
    pub(super) memory: Memory,
    pub(super) executor: Executor,
    pub(super) plan: BlockPlan,
    pub(super) block_words: BlockWords,
    pub(super) loop_detector: LoopDetector,
    outcome: Option<Outcome>,
    progress: Option<Arc<Progress>>,
}

/// Observer of a control between its blocks.
pub trait Observer {
    /// Returns false if the calls have no effect; consecutive statements are then executed without them.
    fn is_active(&self) -> bool {
        true
    }

    /// Called before a block; [`Control::next_block`] lowers it and changes nothing else.
    fn before_block(&mut self, control: &mut Control);

    /// Called after the block, or after the alarm that has stopped it.
    fn after_block(&mut self, control: &Control);
}

/// No observer.
impl Observer for () {
    fn is_active(&self) -> bool {
        false
    }

    fn before_block(&mut self, _: &mut Control) {}

    fn after_block(&mut self, _: &Control) {}
}

impl<O: Observer> Observer for &mut O {
    fn is_active(&self) -> bool {
        (**self).is_active()
    }

    fn before_block(&mut self, control: &mut Control) {
        (**self).before_block(control);
    }

    fn after_block(&mut self, control: &Control) {
        (**self).after_block(control);
    }
}

/// Optional observer.
impl<O: Observer> Observer for Option<O> {
    fn is_active(&self) -> bool {
        self.as_ref().is_some_and(O::is_active)
    }

    fn before_block(&mut self, control: &mut Control) {
        self.iter_mut().for_each(|observer| observer.before_block(control));
    }

    fn after_block(&mut self, control: &Control) {
        self.iter_mut().for_each(|observer| observer.after_block(control));
    }
}

/// A run ends after this number of moves, or [`MOVES_PER_BLOCK`] times its limit of blocks: a cycle with K or small pecks
/// is one block, and a loop with it must end too.
const MIN_MOVE_LIMIT: u64 = 1_000_000;

const MOVES_PER_BLOCK: u64 = 20;

/// Number of blocks between updates of [`Progress`].
const PROGRESS_INTERVAL: u64 = 4096;

/// Returns the number of moves beyond which a run ends.
pub(super) fn max_moves(limits: Limits) -> u64 {
    limits.blocks.saturating_mul(MOVES_PER_BLOCK).max(MIN_MOVE_LIMIT)
}

impl Control {
    /// Returns a control after power-on that will run the first program of `memory`.
    pub fn new(memory: Memory, settings: Settings) -> Self {
        let mut control = Self {
            memory,
            executor: Executor::new(settings),
            plan: BlockPlan::default(),
            block_words: BlockWords::default(),
            loop_detector: LoopDetector::default(),
            outcome: None,
            progress: None,
        };
        let main = control.memory.main();
        if let Some(program) = control.memory.programs().get(main.0 as usize) {
            control.executor.flow.frame.program = main;
            control.executor.registers.state.modal_words.o = program.number_or_zero();
            control.executor.flow.block = program.span;
        }
        control
    }

    /// Shares the progress of the run, and lets its holder cancel it.
    pub fn set_progress(&mut self, progress: Arc<Progress>) {
        self.progress = Some(progress);
    }

    /// Sets a variable before the run, as on the control's screen.
    pub fn set_variable(&mut self, number: u32, value: f64) -> Result<(), Alarm> {
        let (slot, value) = (Slot::of(number), Value::Number(value));
        self.executor.write(slot, value, None, Span::default(), &mut ()).map_err(|alarm| alarm.node)
    }

    /// Sets a variable whose value is in mm, whatever the unit at power-on.
    pub fn set_metric_variable(&mut self, number: u32, value: f64) -> Result<(), Alarm> {
        let unit = std::mem::replace(&mut self.executor.registers.state.modal.unit, Unit::Metric);
        let result = self.set_variable(number, value);
        self.executor.registers.state.modal.unit = unit;
        result
    }

    /// Runs to the end, to an alarm, or to a limit.
    pub fn run<S: EventSink>(&mut self, limits: Limits, library: &mut impl Library, sink: &mut S) -> Outcome {
        self.run_observed(limits, library, sink, &mut ())
    }

    /// Runs as [`Control::run`] and calls an observer before and after every block.
    pub fn run_observed<S: EventSink>(
        &mut self,
        limits: Limits,
        library: &mut impl Library,
        sink: &mut S,
        observer: &mut impl Observer,
    ) -> Outcome {
        if let Some(outcome) = self.final_outcome() {
            return outcome;
        }
        self.loop_detector.endless_loop = None;
        self.executor.log.max_moves = max_moves(limits);
        if self.executor.log.blocks == 0 {
            self.executor.state_start(sink);
        }
        while self.executor.log.blocks < limits.blocks
            && self.executor.log.moves <= self.executor.log.max_moves
        {
            if self.executor.log.blocks.is_multiple_of(PROGRESS_INTERVAL) && self.is_cancelled() {
                break;
            }
            let until =
                limits.blocks.min((self.executor.log.blocks / PROGRESS_INTERVAL + 1) * PROGRESS_INTERVAL);
            self.executor.registers.block_effects.set_pause(until);
            while self.executor.log.blocks < until {
                observer.before_block(self);
                if observer.is_active() {
                    self.executor.registers.block_effects.set_pause(self.executor.log.blocks + 1);
                }
                let result = self.execute_block(library, sink);
                if !self.is_uneventful(&result) {
                    if let Some(outcome) = self.conclude(result, sink) {
                        observer.after_block(self);
                        return *outcome;
                    }
                    self.executor.registers.block_effects.set_pause(until);
                }
                observer.after_block(self);
            }
        }
        self.outcome = Some(Outcome::Limit);
        Outcome::Limit
    }

    /// Updates the [`Progress`] and returns true if its holder has cancelled the run.
    pub fn is_cancelled(&self) -> bool {
        self.progress.as_ref().is_some_and(|progress| {
            progress.blocks.store(self.executor.log.blocks, Ordering::Relaxed);
            progress.cancel.load(Ordering::Relaxed)
        })
    }

    /// Executes one block; returns the outcome when the run ends. A block that raises an alarm has changed nothing, except
    /// a G31 that the setting `SKIP-ALARM` stops after its move.
    pub fn step<S: EventSink>(&mut self, library: &mut impl Library, sink: &mut S) -> Option<Outcome> {
        if let Some(outcome) = self.final_outcome() {
            return Some(outcome);
        }
        self.executor.log.max_moves = u64::MAX;
        if self.executor.log.blocks == 0 {
            self.executor.state_start(sink);
        }
        self.executor.registers.block_effects.set_pause(self.executor.log.blocks + 1);
        let result = self.execute_block(library, sink);
        self.conclude(result, sink).map(|outcome| *outcome)
    }

    /// Returns the outcome if the run can't continue, as it can after a limit.
    fn final_outcome(&self) -> Option<Outcome> {
        self.outcome.clone().filter(|outcome| !matches!(outcome, Outcome::Limit))
    }

    /// Returns true if a block has neither an alarm nor another effect on the run, as most blocks.
    #[inline(always)]
    fn is_uneventful(&self, result: &ExecResult<()>) -> bool {
        result.is_ok() && self.executor.registers.block_effects.is_none()
    }

    /// Records the notes of a block; returns the outcome if the block has ended the run.
    #[inline(never)]
    fn conclude<S: EventSink>(&mut self, mut result: ExecResult<()>, sink: &mut S) -> Option<Box<Outcome>> {
        let (notes, run_end) = self.executor.registers.block_effects.take();
        if run_end == Some(RunEnd::ProgramEnd)
            && let Err(alarm) = self.executor.advance_lookahead(sink, Lookahead::finish)
        {
            result = Err(alarm);
        }
        for note in notes {
            self.executor.log.note(note, self.executor.flow.block);
        }
        let outcome = match result {
            Ok(()) => match run_end? {
                RunEnd::ProgramEnd => Outcome::End,
                RunEnd::EndlessLoop | RunEnd::MoveLimit => Outcome::Limit,
            },
            Err(alarm) => {
                self.executor.finish_before_alarm(&alarm, sink);
                let backtrace = self.executor.flow.backtrace();
                Outcome::Alarm(AlarmStop { alarm: alarm.node, span: alarm.span, backtrace })
            }
        };
        // The last events may have had effects too.
        self.executor.registers.block_effects.take();
        self.outcome = Some(outcome.clone());
        Some(Box::new(outcome))
    }

    /// Lets the run continue from a state before its end.
    pub(super) fn reopen(&mut self) {
        self.outcome = None;
    }

    /// Returns the memory.
    pub fn memory(&self) -> &Memory {
        &self.memory
    }

    /// Returns the settings, with the parameters that the program has written.
    pub fn settings(&self) -> &Settings {
        &self.executor.registers.data.settings
    }

    pub(super) fn set_outcome(&mut self, outcome: Option<Outcome>) {
        self.outcome = outcome;
    }

    /// Returns the end of the run; `None` while it continues.
    pub fn outcome(&self) -> Option<&Outcome> {
        self.outcome.as_ref()
    }

    /// Iterates over the variables that aren't vacant, by number: the main program's locals before the reset of M30, and
    /// the commons.
    pub fn variables(&self) -> impl Iterator<Item = (u32, f64)> + '_ {
        self.executor.registers.variables.nonvacant()
    }

    /// Returns a variable of any kind, as the program would read it now.
    pub fn variable(&self, number: u32) -> Result<Value, Alarm> {
        self.executor.registers.without_side_effects(|registers| registers.read_variable(number))
    }

    /// Returns the local and common variables.
    pub fn vars(&self) -> &Vars {
        &self.executor.registers.variables
    }

    /// Returns the coordinate of an axis in the active work coordinate system, as #5001….
    pub fn work_position(&self, axis: AxisIndex) -> f64 {
        let state = &self.executor.registers.state;
        let data = &self.executor.registers.data;
        let at = match state.virtual_plane {
            Some(_) => data.move_end(state)[axis],
            None => state.programmed_position[axis],
        };
        data.to_program_unit(state, Some(axis), at)
    }

    /// Returns true if G20 is in force: lengths are programmed in inches.
    pub fn is_inch(&self) -> bool {
        self.executor.registers.state.modal.unit == Unit::Inch
    }

    /// Returns the zero of the active work coordinate system in machine coordinates, mm and degrees.
    pub fn work_zeros(&self) -> Position {
        let registers = &self.executor.registers;
        registers.data.zeros(&registers.state)
    }

    /// Returns the tool centre in machine coordinates, mm and degrees.
    pub fn machine_position(&self) -> Position {
        let mut centre = self.executor.registers.state.machine_position;
        for axis in 0..self.settings().axes.len() {
            centre[axis] = self.executor.registers.tool_centre(axis);
        }
        centre
    }

    /// Returns modes and positions.
    pub fn state(&self) -> &State {
        &self.executor.registers.state
    }

    /// Returns the block that began last and the calls that led to it.
    pub fn backtrace(&self) -> Backtrace {
        self.executor.flow.backtrace()
    }

    /// Returns the number of blocks executed.
    pub fn blocks(&self) -> u64 {
        self.executor.log.blocks
    }

    /// Returns the number of moves.
    pub fn moves(&self) -> u64 {
        self.executor.log.moves
    }

    /// Returns the duration of the motion, without acceleration.
    pub fn seconds(&self) -> Seconds {
        Seconds(self.executor.registers.clock.motion_seconds)
    }

    /// Returns the M codes for the machine builder's logic, which isn't simulated, each with its first block.
    pub fn builder_m_codes(&self) -> &BTreeMap<u32, Span> {
        &self.executor.log.builder_m_codes
    }

    /// Returns the lines of DPRNT and BPRNT without their ends; see [`printable`](super::printable) for BPRNT.
    pub fn output(&self) -> &[Vec<u8>] {
        &self.executor.log.printed
    }

    /// Returns the first and the last block of the endless loop that has ended the run; `None` if there is none.
    pub fn endless_loop(&self) -> Option<(Span, Span)> {
        let found = self.loop_detector.endless_loop?;
        Some((self.memory.block_span(found.program, found.to)?, found.from))
    }

    /// Returns the operator stops in order, at most the first ten thousand.
    pub fn stops(&self) -> &[OperatorStop] {
        &self.executor.log.stops
    }

    /// Iterates over the notes, each with its first block.
    pub fn notes(&self) -> impl Iterator<Item = (Note, Span)> + '_ {
        self.executor.log.notes.iter().map(|(note, block)| (*note, *block))
    }

    /// Returns true if the text of the main program has ended the run, without M02, M30 or M99.
    pub fn lacks_end(&self) -> bool {
        self.executor.log.lacks_end
    }

    /// Returns the axes that blocks have placed in work coordinates, as bits.
    pub fn placed_axes(&self) -> u8 {
        let log = &self.executor.log;
        log.other_placed_axes.values().fold(log.first_placed_axes, |all, axes| all | axes)
    }

    /// Returns true if a block has placed an axis in this work coordinate system.
    pub fn uses_work_system(&self, system: WorkSystem) -> bool {
        let log = &self.executor.log;
        match system == WorkSystem::default() {
            true => log.first_placed_axes != 0,
            false => log.other_placed_axes.get(&system).is_some_and(|axes| *axes != 0),
        }
    }

    /// Returns true if a length offset counts behind G53 although a parameter may have cancelled it.
    pub fn assumes_restored_length(&self) -> bool {
        self.executor.log.restores_length
    }

    /// Returns the work offsets other than G54 that the run has used before anything set them.
    pub fn unset_work_offsets(&self) -> &[UnsetWorkOffset] {
        &self.executor.log.unset_systems
    }

    /// Returns true if a block has commanded this modal group, other than 01, before the first move of the run; G98 or G99
    /// before the first canned cycle, if there is one.
    pub fn is_commanded_before_use(&self, group: ModalGroup) -> bool {
        let log = &self.executor.log;
        let is_unused = group == ModalGroup::ReturnTo && !log.has_drilled;
        is_unused || log.commanded_groups.without(log.late_groups).contains(group)
    }
}
