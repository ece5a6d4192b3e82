//! A block of words: checked as a whole, then carried out.
//!
//! What one block does, in this order (operator's manual, order of execution in a block; the machine builder
//! decides about M codes, this is the usual choice):
//!  1. modal G codes, F S T D H;
//!  2. tool change, spindle and coolant on;
//!  3. tool length offset;
//!  4. dwell, G10, coordinate systems, reference return, or the move;
//!  5. spindle and coolant off;
//!  6. stop, end;
//!  7. call or return.
//!
//! Most blocks of long programs are plain moves, for which six of these have nothing to do: see [`super::plain_move`].
use super::block_effects::RunEnd;
use super::checked::{ExecResult, locate};
use super::control::Control;
use super::executor::Executor;
use super::flow::FrameKind;
use super::notes::Note;
use super::plan::{BlockFlow, BlockPlan};
use super::planner::Planner;
use super::state::State;
use super::words::{BlockWords, CallingWord};
use gcode_lang::alarm::Alarm;
use gcode_lang::control::StrokeLimits;
use gcode_lang::motion::EventSink;
use gcode_lang::program::modes::CutterSide;
use gcode_lang::program::{CallCode, DialectSyntax, GuardedOp, Library, Memory, OpBody, OpKind, Words};
use gcode_lang::source::Span;

impl Control {
    /// Reads the next block and does what it says. A statement never leads into another program: behind one the next block
    /// is done at once, as long as there are fewer than `until`.
    #[inline(always)]
    pub(super) fn execute_block<S: EventSink>(
        &mut self,
        until: u64,
        library: &mut impl Library,
        sink: &mut S,
    ) -> ExecResult<()> {
        let Self { memory, executor, plan, block_words, loop_detector, .. } = self;
        let Some(program) = memory.get_mut(executor.flow.frame.program) else {
            return executor.end_of_program(memory);
        };
        let (program, op) = loop {
            let place = executor.flow.frame.next;
            let Some((program, op)) = program.lower_block(place) else {
                return executor.end_of_program(memory);
            };
            executor.flow.block = op.span;
            executor.log.blocks += 1;
            executor.flow.frame.next = place + 1;
            match op.body() {
                OpBody::Plain(OpKind::AssignFree(compute)) => executor.assign(compute)?,
                OpBody::Plain(OpKind::Statement(statement)) => {
                    executor.statement(program, statement, loop_detector, sink)?;
                }
                _ => break (program, op),
            }
            if executor.log.blocks >= until || !executor.registers.block_effects.is_none() {
                return Ok(());
            }
        };
        // In a long file most blocks are plain moves.
        if let OpBody::Plain(OpKind::Words(words)) = op.body()
            && executor.plain_move(op, words, sink).is_some()
        {
            return Ok(());
        }
        let mut kind = match op.body() {
            OpBody::Plain(kind) => kind,
            OpBody::Guarded(asked) if executor.check_guards(asked)? => return Ok(()),
            OpBody::Guarded(asked) => &asked.kind,
        };
        if let OpKind::If { condition, then } = kind
            && executor.registers.evaluate_condition(condition)?
        {
            kind = then;
        }
        match kind {
            OpKind::AssignFree(compute) => return executor.assign_out_of_line(compute),
            OpKind::Statement(statement) => {
                return executor.any_statement(program, statement, loop_detector, sink);
            }
            OpKind::Empty if executor.registers.state.is_in_parameter_input && op.number.is_some() => {
                return Err(
                    Alarm::ParameterFormat { what: "R is missing".into() }.located_at(executor.flow.block)
                );
            }
            OpKind::Empty if op.number.is_some() => {
                executor.process_number_block(executor.flow.block, sink)?
            }
            OpKind::Empty | OpKind::If { .. } => {}
            OpKind::Alarm(alarm) => return Err(alarm.clone()),
            OpKind::Words(words) if executor.registers.state.is_in_parameter_input => {
                executor.planner().plan_parameter(
                    (words, op.number),
                    block_words,
                    plan,
                    executor.flow.block,
                )?;
                return self.execute_plan(library, sink);
            }
            OpKind::Words(words) => {
                if executor.call_by_block(words, op.number, executor.flow.block)? {
                    executor.registers.state.codes.o = memory.get(executor.flow.frame.program).shown_number();
                    return Ok(());
                }
                executor.planner().plan_words(words, block_words, plan)?;
                if let Some(number) = op.number {
                    plan.state.codes.n = number;
                }
                return self.execute_plan(library, sink);
            }
        }
        if let Some(number) = op.number {
            executor.registers.state.codes.n = number;
        }
        Ok(())
    }
}

impl Planner<'_> {
    /// Checks a block of words and makes the plan of it. An alarm leaves no trace.
    pub(super) fn plan_words(
        &self,
        words: &Words,
        block_words: &mut BlockWords,
        plan: &mut BlockPlan,
    ) -> ExecResult<()> {
        let words = self.without_skipped(words);
        plan.reset(&self.registers.state);
        let mut calling_word = None;
        if !self.data.settings.code_calls.is_empty() {
            if self.plan_macro_by_code(words, plan)? {
                return Ok(());
            }
            calling_word = self.subprogram_by_code(words)?;
        }
        self.registers.evaluate_words(words, calling_word.as_ref(), block_words)?;
        self.plan_block(words, calling_word, block_words, plan)
    }

    /// The words of a block but for those behind a block skip that is on.
    #[inline(always)]
    fn without_skipped<'a>(&self, words: &'a Words) -> &'a Words {
        let Some((switch, short)) = words.skipped_form() else { return words };
        let is_on = self.data.is_skip_on(*switch);
        self.registers.block_effects.record_note(Note::BlockSkip { switch: (*switch).max(1), is_on });
        if is_on { short } else { words }
    }

    /// Makes the plan of a block of words that are collected. Nothing changes.
    fn plan_block(
        &self,
        words: &Words,
        calling_word: Option<CallingWord>,
        block_words: &BlockWords,
        plan: &mut BlockPlan,
    ) -> ExecResult<()> {
        let span = self.flow.block;
        self.check_words_with_return(words)?;
        let axis_use = self.apply_modal_codes(block_words, plan, span)?;
        if self.has_codes(block_words, &plan.state) {
            self.plan_coded_words(block_words, plan, span)?;
            self.plan_m_codes(block_words, plan)?;
        }
        let has_new_length = self.plan_length(block_words, plan, span)?;
        match axis_use {
            Some(axis_use) => {
                if has_new_length {
                    self.data.recompute_position(&mut plan.state);
                }
                self.execute_axis_use(axis_use, block_words, plan, span)?;
            }
            None => self.plan_motion(block_words, plan, has_new_length, span)?,
        }
        if let Some(call) = words.call() {
            self.plan_call(words, call, plan)?;
        }
        if let Some(calling) = calling_word {
            self.plan_calling_word(words, &calling, plan)?;
        }
        if plan.commands_axes {
            plan.state.last_end_point = None;
            self.check_flow_after_move(&plan.flow, span)?;
        }
        if self.needs_lookahead(block_words, &plan.state) {
            self.plan_lookahead(axis_use, block_words, plan, span)?;
        }
        self.check_unread(block_words, plan)?;
        match &self.data.settings.stroke_limits {
            Some(stroke) => self.check_stroke(stroke, plan, span),
            None => Ok(()),
        }
    }

    /// Whether a block has anything else than axis words and codes of group 01, or the state depends on D and F alone.
    #[inline]
    fn has_codes(&self, block_words: &BlockWords, state: &State) -> bool {
        block_words.has_letters(!self.data.settings.axes.letter_bits())
            || block_words.has_non_motion_words()
            || block_words.m_code_count > 0
            || state.modal.cutter != CutterSide::Off
    }

    /// What nothing has read may still mean something to a control: it isn't passed over in silence. In a block
    /// without axes such words go to the machine builder's logic with his M code.
    #[inline(always)]
    fn check_unread(&self, block_words: &BlockWords, plan: &mut BlockPlan) -> ExecResult<()> {
        match block_words.first_unread() {
            Some(unread) => self.pass_to_machine_builder(unread, block_words, plan),
            None => Ok(()),
        }
    }

    #[inline(never)]
    fn pass_to_machine_builder(
        &self,
        (letter, span): (char, Span),
        block_words: &BlockWords,
        plan: &mut BlockPlan,
    ) -> ExecResult<()> {
        match plan.auxiliary_codes.last() {
            Some(code) if !self.data.names_axis(block_words) => {
                plan.notes.push(Note::WordsPassedOn { code: *code, letter });
                Ok(())
            }
            _ => Err(Alarm::NotSimulated { what: format!("{letter} in this block") }.located_at(span)),
        }
    }

    /// Only N, P and L may stand beside M99 while G66 is on.
    fn check_words_with_return(&self, words: &Words) -> ExecResult<()> {
        let returns = words.call().is_some_and(|call| call.kind == CallCode::Return);
        if !returns || self.flow.modal_calls.is_empty() {
            return Ok(());
        }
        match words.list.iter().find(|word| word.letter != b'L') {
            Some(word) => {
                Err(Alarm::WordsWithReturn { letter: char::from(word.letter) }.located_at(word.span))
            }
            None => Ok(()),
        }
    }
}

impl Executor {
    /// There is no block any more. A text may just stop; running into `%` or another program is running off the tape.
    #[cold]
    pub(super) fn end_of_program(&mut self, memory: &Memory) -> ExecResult<()> {
        let frame = &self.flow.frame;
        let main = frame.kind == FrameKind::Main;
        let Some(program) = memory.programs().get(frame.program.0 as usize) else {
            return Err(Alarm::EndOfRecord.located_at(Span::default()));
        };
        self.flow.block = Span { start: program.span.end, ..program.span };
        if main && !program.is_closed {
            self.registers.block_effects.end_run(RunEnd::ProgramEnd);
            return Ok(());
        }
        Err(Alarm::EndOfRecord.located_at(self.flow.block))
    }

    /// Block skip, and ways of writing that not every control reads; whether the block isn't done.
    #[inline(never)]
    pub(super) fn check_guards(&mut self, guarded: &GuardedOp) -> ExecResult<bool> {
        if let Some(switch) = guarded.skip {
            let is_on = self.registers.data.is_skip_on(switch);
            self.log.note(Note::BlockSkip { switch: switch.max(1), is_on }, self.flow.block);
            if is_on {
                return Ok(true);
            }
        }
        for form in &guarded.dialect_syntax {
            if !form.node.is_accepted(&self.registers.data.settings) {
                return Err(form.node.alarm().located_at(form.span));
            }
            if form.node == DialectSyntax::LowerCase {
                self.log.note(Note::LowerCase, self.flow.block);
            }
        }
        Ok(false)
    }
}

impl Planner<'_> {
    /// Looks at every move of a block before it happens. A real control stops on the way; here nothing has moved.
    pub(super) fn check_stroke(&self, stroke: &StrokeLimits, plan: &BlockPlan, span: Span) -> ExecResult<()> {
        for (kind, _) in &plan.events {
            locate(self.data.check_event(stroke, kind), span)?;
        }
        if plan.uses_lookahead {
            self.data.check_ready_moves(&plan.lookahead)?;
        }
        let mut result = Ok(());
        if let Some(cycle_plan) = &plan.cycle_plan {
            cycle_plan.expand(self.data, &mut |kind, _| {
                if result.is_ok() {
                    result = self.data.check_event(stroke, &kind);
                }
            });
        }
        locate(result, span)
    }
}

impl Control {
    /// Carries out the plan of a block of words. What can still alarm comes first.
    fn execute_plan<S: EventSink>(&mut self, library: &mut impl Library, sink: &mut S) -> ExecResult<()> {
        let span = self.executor.flow.block;
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
        let skip_alarm = self.executor.registers.resolve_skip_signal(&mut self.plan, sink);
        self.executor.commit(&mut self.plan, sink);
        if let Some(alarm) = skip_alarm {
            return Err(alarm);
        }
        match flow {
            BlockFlow::Next if self.plan.commands_axes => self.executor.call_after_move(span),
            BlockFlow::Next => {}
            BlockFlow::Call(call) => {
                self.executor.make_call(&call, span);
                let program = self.executor.flow.frame.program;
                self.executor.registers.state.codes.o = self.memory.get(program).shown_number();
            }
            BlockFlow::Return { number, target } => {
                if let Some(over) = self.return_to(number.zip(target)) {
                    self.executor.registers.block_effects.end_run(over);
                }
                let program = self.executor.flow.frame.program;
                self.executor.registers.state.codes.o = self.memory.get(program).shown_number();
                if !self.executor.registers.block_effects.is_run_ended() {
                    self.loop_detector.record_jump(&mut self.executor);
                }
            }
            BlockFlow::CancelModal => self.executor.cancel_modal(),
            BlockFlow::End => {
                self.executor.registers.panel.part_counters[0] += 1.0;
                self.executor.registers.block_effects.end_run(RunEnd::ProgramEnd);
            }
        }
        Ok(())
    }
}
