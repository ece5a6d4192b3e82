//! One block from top to bottom: read, checked as a whole, then carried out.
//!
//! Order of execution in a block of words (operator's manual; the machine builder decides about M codes, this is the usual
//! choice):
//!  1. modal G codes, F S T D H;
//!  2. tool change, spindle and coolant on;
//!  3. tool length offset;
//!  4. dwell, G10, coordinate systems, reference return, or the move;
//!  5. spindle and coolant off;
//!  6. stop, end;
//!  7. call or return.
//!
//! Most blocks of long programs are plain moves, for which only step 4 has an effect: see [`super::plain_move`].
use super::control::Control;
use super::executor::Executor;
use super::flow::FrameKind;
use super::functions::{ExecResult, locate};
use super::lookahead::Lookahead;
use super::loop_detection::LoopDetector;
use super::notes::Note;
use super::outcome::RunEnd;
use super::plan::{BlockFlow, BlockPlan};
use super::planner::Planner;
use super::words::{BlockWords, CallingWord};
use gcode_lang::alarm::Alarm;
use gcode_lang::motion::EventSink;
use gcode_lang::program::m_codes::{self, MCodeEffect};
use gcode_lang::program::modes::{CutterSide, Motion};
use gcode_lang::program::{
    CallCode, DialectSyntax, GuardedOp, Library, Memory, Op, OpBody, OpIndex, OpKind, Program, Words,
};
use gcode_lang::source::Span;

impl Control {
    /// Executes the next block, and after a statement the blocks that follow it until the run [pauses]: a statement never
    /// leads into another program.
    ///
    /// [pauses]: super::outcome::BlockEffects::set_pause
    #[inline(always)]
    pub(super) fn execute_block<S: EventSink>(
        &mut self,
        library: &mut impl Library,
        sink: &mut S,
    ) -> ExecResult<()> {
        let Self { memory, executor, plan, block_words, loop_detector, .. } = self;
        let Some(program) = memory.get_mut(executor.flow.frame.program) else {
            return executor.end_of_program(memory);
        };
        let index = match executor.run_statements(program, loop_detector, sink) {
            StatementsEnd::ProgramEnd => return executor.end_of_program(memory),
            StatementsEnd::Paused(result) => return result,
            StatementsEnd::ReachedBlock(index) => index,
        };
        let Some((program, op)) = program.lower_block(index) else {
            return executor.end_of_program(memory);
        };
        let Some(kind) = executor.operation_to_execute(op)? else { return Ok(()) };
        let is_in_parameter_input = executor.registers.state.is_in_parameter_input;
        match kind {
            OpKind::AssignDirect(assign) => return executor.execute_assignment_out_of_line(assign),
            OpKind::Statement(statement) => {
                return executor.execute_statement_out_of_line(program, statement, loop_detector, sink);
            }
            OpKind::Empty if is_in_parameter_input && op.number.is_some() => {
                let alarm = Alarm::ParameterFormat { what: "R is missing".into() };
                return Err(alarm.located_at(executor.flow.block));
            }
            OpKind::Empty if op.number.is_some() => {
                executor.advance_lookahead(sink, Lookahead::count_sequence_number)?
            }
            OpKind::Empty | OpKind::If { .. } => {}
            OpKind::Alarm(alarm) => return Err(alarm.clone()),
            OpKind::Words(words) => {
                if !is_in_parameter_input && executor.call_for_every_block(words, op.number)? {
                    executor.registers.state.modal_words.o =
                        memory.get(executor.flow.frame.program).number_or_zero();
                    return Ok(());
                }
                plan.reset(&executor.registers.state);
                if is_in_parameter_input {
                    executor.registers.evaluate_words(words, None, block_words)?;
                    executor.planner(words, block_words).plan_parameter(op.number, plan)?;
                } else {
                    executor.plan_words(words, block_words, plan)?;
                    plan.state.modal_words.n = op.number.unwrap_or(plan.state.modal_words.n);
                }
                return self.execute_plan(library, sink);
            }
        }
        if let Some(number) = op.number {
            executor.registers.state.modal_words.n = number;
        }
        Ok(())
    }
}

/// End of a row of statements.
enum StatementsEnd {
    /// The program has no further block.
    ProgramEnd,
    /// The run pauses, or a plain move has been executed.
    Paused(ExecResult<()>),
    /// A block that is neither a statement nor a plain move; it counts as begun.
    ReachedBlock(OpIndex),
}

impl Executor {
    /// Executes the next blocks while they are statements, and a plain move after them.
    #[inline(always)]
    fn run_statements<S: EventSink>(
        &mut self,
        program: &mut Program,
        loop_detector: &mut LoopDetector,
        sink: &mut S,
    ) -> StatementsEnd {
        loop {
            let index = self.flow.frame.next;
            let Some((program, op)) = program.lower_block(index) else { return StatementsEnd::ProgramEnd };
            self.log.blocks += 1;
            self.flow.frame.next = index + 1;
            let result = match op.body() {
                OpBody::Plain(OpKind::AssignDirect(assign)) => self.execute_assignment(assign),
                OpBody::Plain(OpKind::Statement(statement)) => {
                    self.flow.block = op.span;
                    self.execute_statement(program, statement, loop_detector, sink)
                }
                OpBody::Plain(OpKind::Words(words)) => {
                    self.flow.block = op.span;
                    if self.plain_move(op, words, sink).is_some() {
                        return StatementsEnd::Paused(Ok(()));
                    }
                    return StatementsEnd::ReachedBlock(index);
                }
                OpBody::Plain(OpKind::Empty | OpKind::If { .. } | OpKind::Alarm(_)) | OpBody::Guarded(_) => {
                    self.flow.block = op.span;
                    return StatementsEnd::ReachedBlock(index);
                }
            };
            // The span of an assignment is read only after an alarm or an effect.
            if result.is_err() || self.registers.block_effects.is_pause(self.log.blocks) {
                self.flow.block = op.span;
                return StatementsEnd::Paused(result);
            }
        }
    }

    /// Checks the guards and the condition of a block; returns what it executes, `None` if it is skipped.
    fn operation_to_execute<'p>(&mut self, op: &'p Op) -> ExecResult<Option<&'p OpKind>> {
        let kind = match op.body() {
            OpBody::Plain(kind) => kind,
            OpBody::Guarded(guarded) if self.is_skipped_or_refused(guarded)? => return Ok(None),
            OpBody::Guarded(guarded) => &guarded.kind,
        };
        match kind {
            OpKind::If { condition, then } if self.registers.evaluate_condition(condition)? => Ok(Some(then)),
            kind => Ok(Some(kind)),
        }
    }

    /// Checks a block of words and makes its plan. An alarm leaves no trace.
    pub(super) fn plan_words(
        &self,
        words: &Words,
        block_words: &mut BlockWords,
        plan: &mut BlockPlan,
    ) -> ExecResult<()> {
        if let Some((switch, _)) = words.form_if_skipped() {
            let is_on = self.registers.data.is_skip_on(*switch);
            let note = Note::BlockSkip { switch: (*switch).max(1), is_on };
            self.registers.block_effects.record_note(note);
        }
        let (words, _) = self.registers.data.words_not_skipped(words);
        let mut calling_word = None;
        if !self.registers.data.settings.code_calls.is_empty() {
            let planner = self.planner(words, block_words);
            if planner.plan_macro_call_by_code(plan)? {
                return Ok(());
            }
            calling_word = planner.find_subprogram_call_by_code()?;
        }
        self.registers.evaluate_words(words, calling_word.as_ref(), block_words)?;
        self.planner(words, block_words).plan_block(calling_word, plan)
    }
}

impl Planner<'_> {
    /// Makes the plan of a block whose words are evaluated.
    pub(super) fn plan_block(
        &self,
        calling_word: Option<CallingWord>,
        plan: &mut BlockPlan,
    ) -> ExecResult<()> {
        self.check_words_with_return()?;
        let axis_word_use = self.apply_modal_codes(plan)?;
        // A block with nothing but axis words and codes of group 01 has no other codes.
        if self.words.has_letters(!self.data.settings.axes.letter_bits())
            || self.words.has_other_g_codes
            || !self.words.m_codes.is_empty()
            || plan.state.modal.cutter != CutterSide::Off
        {
            self.plan_modal_words(plan)?;
            self.plan_m_codes(plan)?;
        }
        let changes_length_offset = self.plan_length(plan)?;
        match axis_word_use {
            Some(axis_use) => {
                if changes_length_offset {
                    self.data.recompute_position(&mut plan.state);
                }
                self.plan_axis_word_use(axis_use, plan)?;
            }
            None => self.plan_motion(plan, changes_length_offset)?,
        }
        if let Some(call) = self.lowered_words.call() {
            self.plan_call(call, plan)?;
        }
        if let Some(calling) = calling_word {
            self.plan_calling_word(&calling, plan)?;
        }
        if plan.commands_axes {
            plan.state.end_before_transform = None;
            let drilling = plan.cycle_plan.as_ref().map(|cycle_plan| cycle_plan.axis);
            let is_in_work_coordinates = axis_word_use
                .is_none_or(|axis_use| axis_use.takes_work_coordinates(plan.state.modal.distance));
            if is_in_work_coordinates {
                plan.placed_axes = self.named_axes().chain(drilling).fold(0, |axes, axis| axes | 1 << axis);
            }
            let states = [&self.registers.state, &plan.state];
            if !states.iter().any(|state| state.modal.cycle.is_some_and(|cycle| cycle.taps())) {
                if states.iter().all(|state| self.checks_rigid_tapping(state)) {
                    return Err(Alarm::MoveBeforeRigidTapping.located_at(self.block));
                }
                plan.state.rigid_tapping.record_move();
            }
            self.check_flow_of_triggering_block(&plan.flow)?;
        }
        if self.needs_lookahead(&plan.state) {
            self.plan_lookahead(axis_word_use, plan)?;
        }
        let is_straight = axis_word_use.is_none()
            && plan.state.modal.cycle.is_none()
            && matches!(plan.state.modal.motion, Motion::Rapid | Motion::Linear);
        if let Some(unread) = self.words.first_unused_word() {
            self.pass_to_machine_builder(unread, is_straight && plan.commands_axes, plan)?;
        }
        self.check_stroke(plan)
    }

    /// Handles a word that nothing has read: with M06 or an M code of the machine builder and without axes it goes to that
    /// code's logic; P and Q of a straight move have no effect; any other raises an alarm.
    #[inline(never)]
    fn pass_to_machine_builder(
        &self,
        (letter, span): (char, Span),
        moves_straight: bool,
        plan: &mut BlockPlan,
    ) -> ExecResult<()> {
        // The builder's logic, often a macro, changes the tool.
        let is_change =
            |code: &u32| m_codes::find(*code, self.data.settings.dialect) == Some(MCodeEffect::ToolChange);
        let changes_tool = || self.words.m_codes.iter().map(|(code, _)| code).find(|code| is_change(code));
        match plan.builder_m_codes.last().or_else(changes_tool) {
            None if moves_straight && matches!(letter, 'P' | 'Q') => {
                plan.notes.push(Note::WordIgnored(letter));
                Ok(())
            }
            Some(code) if !self.names_axis() => {
                plan.notes.push(Note::WordsPassedOn { code: *code, letter });
                Ok(())
            }
            _ => Err(Alarm::WordNotSimulated(letter).located_at(span)),
        }
    }

    /// Raises the alarm of words other than N, P and L beside M99 while G66 is active.
    fn check_words_with_return(&self) -> ExecResult<()> {
        let returns = self.lowered_words.call().is_some_and(|call| call.kind == CallCode::Return);
        if !returns || self.flow.modal_calls.is_empty() {
            return Ok(());
        }
        match self.lowered_words.list.iter().find(|word| word.letter != b'L') {
            Some(word) => {
                Err(Alarm::WordsWithReturn { letter: char::from(word.letter) }.located_at(word.span))
            }
            None => Ok(()),
        }
    }

    /// Checks the stroke of every move of a block. A real control stops on the way; here nothing has moved.
    fn check_stroke(&self, plan: &BlockPlan) -> ExecResult<()> {
        if self.data.settings.stroke_limits.is_none() {
            return Ok(());
        }
        let mut result = self.data.check_moves_of(&plan.state, plan.events.iter().map(|(kind, _)| kind));
        if let Some(cycle_plan) = &plan.cycle_plan {
            cycle_plan.expand(self.data, &mut |kind, _| {
                if result.is_ok() {
                    result = self.data.check_move(&kind);
                }
            });
        }
        if plan.uses_lookahead {
            plan.lookahead.check_stroke(self.data, &plan.state)?;
        }
        self.locate(result)
    }
}

impl Executor {
    /// Ends a program after its last block: a text without `%` may end there, but `%`, cut off or not, or another program raises
    /// an alarm.
    #[cold]
    fn end_of_program(&mut self, memory: &Memory) -> ExecResult<()> {
        let frame = &self.flow.frame;
        let is_main = frame.kind == FrameKind::Main;
        let Some(program) = memory.programs().get(frame.program.0 as usize) else {
            return Err(Alarm::EndOfRecord.located_at(Span::default()));
        };
        self.flow.block = Span { start: program.span.end, ..program.span };
        if is_main && !program.is_closed {
            self.log.lacks_end = true;
            self.registers.block_effects.end_run(RunEnd::ProgramEnd);
            return Ok(());
        }
        Err(Alarm::EndOfRecord.located_at(self.flow.block))
    }

    /// Checks block skip and syntax that some controls refuse; returns true if the block is skipped.
    #[inline(never)]
    pub(super) fn is_skipped_or_refused(&mut self, guarded: &GuardedOp) -> ExecResult<bool> {
        if let Some(switch) = guarded.skip {
            let is_on = self.registers.data.is_skip_on(switch);
            self.log.note(Note::BlockSkip { switch: switch.max(1), is_on }, self.flow.block);
            if is_on {
                return Ok(true);
            }
        }
        for syntax in &guarded.dialect_syntax {
            if !syntax.node.is_accepted(&self.registers.data.settings) {
                return Err(syntax.node.alarm().located_at(syntax.span));
            }
            let note = match syntax.node {
                DialectSyntax::LowerCase => Note::LowerCase,
                DialectSyntax::UnclosedComment => Note::UnclosedComment,
                DialectSyntax::NestedComment => Note::NestedComment,
                DialectSyntax::ProgramZero => Note::ProgramZero,
                DialectSyntax::BlockAfterSemicolon => Note::SecondBlock,
                _ => continue,
            };
            self.log.note(note, self.flow.block);
        }
        Ok(false)
    }
}

impl Control {
    /// Carries out the plan of a block of words. Steps that can still raise an alarm come first.
    pub(super) fn execute_plan<S: EventSink>(
        &mut self,
        library: &mut impl Library,
        sink: &mut S,
    ) -> ExecResult<()> {
        let span = self.executor.flow.block;
        let mut flow = std::mem::take(&mut self.plan.flow);
        match &mut flow {
            BlockFlow::Call(call) => {
                let at = call.span;
                locate(self.resolve_call(call, library), at)?;
            }
            BlockFlow::Return { number, target } => *target = locate(self.find_return(*number), span)?,
            BlockFlow::Jump { number, target } => {
                let frame = &self.executor.flow.frame;
                let found = self.memory.get(frame.program).find_number(*number, frame.next);
                let missing = Alarm::SequenceNumberNotFound { number: *number };
                *target = locate(found.ok_or(missing), span)?;
            }
            BlockFlow::Next if self.plan.commands_axes => {
                locate(self.executor.check_call_after_move(), span)?;
            }
            BlockFlow::Next | BlockFlow::CancelModal | BlockFlow::End => {}
        }
        let skip_alarm = self.executor.registers.resolve_probe_skip(&mut self.plan, sink);
        self.executor.commit(&mut self.plan, sink);
        if let Some(alarm) = skip_alarm {
            return Err(alarm);
        }
        match flow {
            BlockFlow::Next if self.plan.commands_axes => self.executor.call_after_move(),
            BlockFlow::Next => {}
            BlockFlow::Call(call) => {
                self.executor.make_call(&call);
                self.update_program_number();
            }
            BlockFlow::Return { number, target } => {
                if let Some(end) = self.return_to(number.zip(target)) {
                    self.executor.registers.block_effects.end_run(end);
                }
                self.update_program_number();
                if !self.executor.registers.block_effects.is_run_ended() {
                    self.loop_detector.record_jump(&mut self.executor);
                }
            }
            BlockFlow::Jump { number, target } => {
                let program = self.memory.get(self.executor.flow.frame.program);
                self.executor.note_ambiguous_jump(program, number, target);
                self.executor.flow.frame.jump(target);
                self.loop_detector.record_jump(&mut self.executor);
            }
            BlockFlow::CancelModal => self.executor.cancel_modal(),
            BlockFlow::End => {
                if self.executor.flow.frame.kind != FrameKind::Main {
                    self.executor.log.note(Note::EndInCall, self.executor.flow.block);
                }
                self.executor.registers.panel.part_counters[0] += 1.0;
                self.executor.registers.block_effects.end_run(RunEnd::ProgramEnd);
            }
        }
        Ok(())
    }

    /// Sets #4115 to the number of the current program.
    fn update_program_number(&mut self) {
        let program = self.executor.flow.frame.program;
        self.executor.registers.state.modal_words.o = self.memory.get(program).number_or_zero();
    }
}
