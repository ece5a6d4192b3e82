//! A run: block by block to the end, to an alarm, or to a limit.
use std::sync::atomic::Ordering;

use super::evaluation::ExecResult;
use super::frames::FrameKind;
use super::notes::Note;
use super::plan::BlockFlow;
use super::{AlarmStop, Control, Executor, Limits, Observer, Outcome};
use gcode_lang::alarm::Alarm;
use gcode_lang::motion::{Backtrace, EventSink};
use gcode_lang::program::{DialectSyntax, GuardedOp, Library, Memory, OpBody, OpKind};
use gcode_lang::source::Span;

/// A run ends after so many moves, and so many for every block that it may execute: a cycle with K or with small
/// pecks is one block, and a loop round it must end as well.
const MIN_MOVE_LIMIT: u64 = 1_000_000;
const MOVES_PER_BLOCK: u64 = 20;
/// [`super::Progress`] is told after so many blocks.
const PROGRESS_INTERVAL: u64 = 4096;

/// How a block can end the run without an alarm.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum RunEnd {
    ProgramEnd,
    /// It is in a loop that never ends.
    EndlessLoop,
    /// It has made more moves than it may.
    MoveLimit,
}

impl Control {
    /// Runs to the end, to an alarm, or to a limit.
    pub fn run<S: EventSink>(&mut self, limits: Limits, library: &mut impl Library, sink: &mut S) -> Outcome {
        self.run_observed(limits, library, sink, &mut ())
    }

    /// As [`Control::run`], with somebody who looks on from block to block.
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
        self.loop_detector.reset();
        self.executor.max_moves = limits.blocks.saturating_mul(MOVES_PER_BLOCK).max(MIN_MOVE_LIMIT);
        while self.executor.blocks < limits.blocks && self.executor.moves <= self.executor.max_moves {
            if self.executor.blocks.is_multiple_of(PROGRESS_INTERVAL) && self.is_cancelled() {
                break;
            }
            let until = limits.blocks.min((self.executor.blocks / PROGRESS_INTERVAL + 1) * PROGRESS_INTERVAL);
            while self.executor.blocks < until {
                observer.before_block(self);
                let until = if observer.is_active() { self.executor.blocks + 1 } else { until };
                let result = self.execute_block(until, library, sink);
                if !self.is_uneventful(&result)
                    && let Some(outcome) = self.conclude(result, sink)
                {
                    observer.after_block(self);
                    return *outcome;
                }
                observer.after_block(self);
            }
        }
        self.outcome = Some(Outcome::Limit);
        Outcome::Limit
    }

    /// Tells who watches how far the run is; whether it should end.
    pub fn is_cancelled(&self) -> bool {
        self.progress.as_ref().is_some_and(|progress| {
            progress.blocks.store(self.executor.blocks, Ordering::Relaxed);
            progress.cancel.load(Ordering::Relaxed)
        })
    }

    /// Does one block; `Some` when the run is over. A block that alarms has changed nothing.
    pub fn step<S: EventSink>(&mut self, library: &mut impl Library, sink: &mut S) -> Option<Outcome> {
        if let Some(outcome) = self.final_outcome() {
            return Some(outcome);
        }
        self.executor.max_moves = u64::MAX;
        let result = self.execute_block(self.executor.blocks + 1, library, sink);
        self.conclude(result, sink).map(|outcome| *outcome)
    }

    /// How the run ended, if it can't go on; a limit is no end.
    fn final_outcome(&self) -> Option<Outcome> {
        self.outcome.clone().filter(|outcome| !matches!(outcome, Outcome::Limit))
    }

    /// Whether a block has ended nothing and has nothing to tell, as most.
    #[inline(always)]
    fn is_uneventful(&self, result: &ExecResult<()>) -> bool {
        result.is_ok() && self.executor.block_effects.is_none()
    }

    /// Takes note of what a block has to tell, and of the end of the run.
    #[inline(never)]
    fn conclude<S: EventSink>(&mut self, mut result: ExecResult<()>, sink: &mut S) -> Option<Box<Outcome>> {
        let (note, over) = self.executor.block_effects.take();
        if over == Some(RunEnd::ProgramEnd)
            && let Err(alarm) = self.executor.finish_lookahead(sink)
        {
            result = Err(alarm);
        }
        if let Some(note) = note {
            self.executor.notes.entry(note).or_insert(self.executor.block);
        }
        let outcome = match result {
            Ok(()) => match over? {
                RunEnd::ProgramEnd => Outcome::End,
                RunEnd::EndlessLoop | RunEnd::MoveLimit => Outcome::Limit,
            },
            Err(alarm) => {
                self.executor.finish_before_alarm(&alarm, sink);
                let calls = self.executor.frame.calls.clone();
                let place = Backtrace { block: self.executor.block, calls };
                Outcome::Alarm(AlarmStop { alarm: alarm.node, span: alarm.span, backtrace: place })
            }
        };
        // What was told at the end may have left something behind as well.
        self.executor.block_effects.take();
        self.outcome = Some(outcome.clone());
        Some(Box::new(outcome))
    }

    /// Reads the next block and does what it says. A statement never leads into another program: behind one the next block
    /// is done at once, as long as there are fewer than `until`.
    #[inline(always)]
    fn execute_block<S: EventSink>(
        &mut self,
        until: u64,
        library: &mut impl Library,
        sink: &mut S,
    ) -> ExecResult<()> {
        let Self { memory, executor: core, plan, block_words: given, loop_detector: watch, .. } = self;
        let Some(program) = memory.get_mut(core.frame.program) else { return core.end_of_program(memory) };
        let (program, op) = loop {
            let place = core.frame.next;
            let Some((program, op)) = program.lower_block(place) else { return core.end_of_program(memory) };
            core.block = op.span;
            core.blocks += 1;
            core.frame.next = place + 1;
            match op.body() {
                OpBody::Plain(OpKind::AssignFree(compute)) => core.assign(compute)?,
                OpBody::Plain(OpKind::Statement(statement)) => {
                    core.statement(program, statement, watch, sink)?;
                }
                _ => break (program, op),
            }
            if core.blocks >= until || !core.block_effects.is_none() {
                return Ok(());
            }
        };
        // In a long file most blocks are plain moves.
        if let OpBody::Plain(OpKind::Words(words)) = op.body()
            && core.plain_move(op, words, sink).is_some()
        {
            return Ok(());
        }
        let mut kind = match op.body() {
            OpBody::Plain(kind) => kind,
            OpBody::Guarded(asked) if core.check_guards(asked)? => return Ok(()),
            OpBody::Guarded(asked) => &asked.kind,
        };
        if let OpKind::If { condition, then } = kind
            && core.evaluate_condition(condition)?
        {
            kind = then;
        }
        match kind {
            OpKind::AssignFree(compute) => return core.assign_out_of_line(compute),
            OpKind::Statement(statement) => {
                return core.any_statement(program, statement, watch, sink);
            }
            OpKind::Empty if core.state.is_in_parameter_input && op.number.is_some() => {
                return Err(Alarm::ParameterFormat { what: "R is missing".into() }.located_at(core.block));
            }
            OpKind::Empty if op.number.is_some() => core.process_number_block(core.block, sink)?,
            OpKind::Empty | OpKind::If { .. } => {}
            OpKind::Alarm(alarm) => return Err(alarm.clone()),
            OpKind::Words(words) if core.state.is_in_parameter_input => {
                core.plan_parameter((words, op.number), given, plan, core.block)?;
                return self.execute_plan(library, sink);
            }
            OpKind::Words(words) => {
                if core.call_by_block(words, op.number, core.block)? {
                    core.state.codes.o = memory.get(core.frame.program).shown_number();
                    return Ok(());
                }
                core.plan_words(words, given, plan)?;
                if let Some(number) = op.number {
                    plan.state.codes.n = number;
                }
                return self.execute_plan(library, sink);
            }
        }
        if let Some(number) = op.number {
            core.state.codes.n = number;
        }
        Ok(())
    }

    /// Carries out the plan of a block of words. What can still alarm comes first.
    fn execute_plan<S: EventSink>(&mut self, library: &mut impl Library, sink: &mut S) -> ExecResult<()> {
        let span = self.executor.block;
        let mut flow = std::mem::take(&mut self.plan.flow);
        match &mut flow {
            BlockFlow::Call(call) => {
                let at = call.span;
                self.resolve_call(call, library).map_err(|alarm| alarm.located_at(at))?;
            }
            BlockFlow::Return { number, target } => {
                *target = self.find_return(*number).map_err(|alarm| alarm.located_at(span))?;
            }
            BlockFlow::Next if self.plan.commands_axes => {
                self.executor.check_call_after_move().map_err(|alarm| alarm.located_at(span))?;
            }
            BlockFlow::Next | BlockFlow::CancelModal | BlockFlow::End => {}
        }
        let skip_alarm = self.executor.resolve_skip_signal(&mut self.plan, sink);
        self.executor.commit(&mut self.plan, sink);
        if let Some(alarm) = skip_alarm {
            return Err(alarm);
        }
        match flow {
            BlockFlow::Next if self.plan.commands_axes => self.executor.call_after_move(span),
            BlockFlow::Next => {}
            BlockFlow::Call(call) => {
                self.executor.make_call(&call, span);
                let program = self.executor.frame.program;
                self.executor.state.codes.o = self.memory.get(program).shown_number();
            }
            BlockFlow::Return { number, target } => {
                if let Some(over) = self.return_to(number.zip(target)) {
                    self.executor.block_effects.end_run(over);
                }
                let program = self.executor.frame.program;
                self.executor.state.codes.o = self.memory.get(program).shown_number();
                if !self.executor.block_effects.is_run_ended() {
                    self.loop_detector.record_jump(&mut self.executor);
                }
            }
            BlockFlow::CancelModal => self.executor.cancel_modal(),
            BlockFlow::End => {
                self.executor.part_counters[0] += 1.0;
                self.executor.block_effects.end_run(RunEnd::ProgramEnd);
            }
        }
        Ok(())
    }
}

impl Executor {
    /// There is no block any more. A text may just stop; running into `%` or another program is running off the tape.
    #[cold]
    fn end_of_program(&mut self, memory: &Memory) -> ExecResult<()> {
        let frame = &self.frame;
        let main = frame.kind == FrameKind::Main;
        let Some(program) = memory.programs().get(frame.program.0 as usize) else {
            return Err(Alarm::EndOfRecord.located_at(Span::default()));
        };
        self.block = Span { start: program.span.end, ..program.span };
        if main && !program.is_closed {
            self.block_effects.end_run(RunEnd::ProgramEnd);
            return Ok(());
        }
        Err(Alarm::EndOfRecord.located_at(self.block))
    }

    /// Block skip, and ways of writing that not every control reads; whether the block isn't done.
    #[inline(never)]
    fn check_guards(&mut self, guarded: &GuardedOp) -> ExecResult<bool> {
        if let Some(switch) = guarded.skip {
            let is_on = self.is_skip_on(switch);
            self.notes.entry(Note::BlockSkip { switch: switch.max(1), is_on }).or_insert(self.block);
            if is_on {
                return Ok(true);
            }
        }
        for form in &guarded.dialect_syntax {
            if !form.node.is_accepted(&self.settings) {
                return Err(form.node.alarm().located_at(form.span));
            }
            if form.node == DialectSyntax::LowerCase {
                self.notes.entry(Note::LowerCase).or_insert(self.block);
            }
        }
        Ok(false)
    }
}
