//! Execution of calls and returns: finds programs, pushes and pops frames, triggers modal calls.
use super::control::Control;
use super::executor::Executor;
use super::flow::{CallFrame, FrameKind, ModalMacro};
use super::functions::{ExecResult, locate};
use super::notes::Note;
use super::outcome::RunEnd;
use super::plan::{CallKind, CallPlan, ProgramRef};
use super::variables::{Locals, Value};
use gcode_lang::alarm::{Alarm, repeats_in_p_help};
use gcode_lang::program::{CallCode, Library, OpIndex, Words};

impl Control {
    /// Finds the program of a call and checks the nesting, before anything of the block has happened.
    pub(super) fn resolve_call(
        &mut self,
        call: &mut CallPlan,
        library: &mut impl Library,
    ) -> Result<(), Alarm> {
        if call.is_external && self.executor.flow.frame.is_external {
            return Err(Alarm::DeviceCallInDeviceCall);
        }
        let program = match &call.target {
            ProgramRef::Number(number) => {
                let (number, found) = (*number, self.memory.fetch(*number, library));
                let found = found.ok_or_else(|| match (call.is_external, library.read_error()) {
                    (true, read_error) => Alarm::DeviceFileNotFound { number, read_error },
                    (false, read_error) => Alarm::ProgramNotFound { number, read_error },
                });
                match (found, call.digits_of_p) {
                    (Err(Alarm::ProgramNotFound { .. }), Some(digits))
                        if self.memory.fetch(digits, library).is_some() =>
                    {
                        let read_error = Some(repeats_in_p_help(digits));
                        return Err(Alarm::ProgramNotFound { number, read_error });
                    }
                    (found, _) => found?,
                }
            }
            ProgramRef::Name(name) => {
                let found = self.memory.fetch_name(name, library);
                let missing = || Alarm::FileNotFound { name: name.clone(), read_error: library.read_error() };
                found.ok_or_else(missing)?
            }
            ProgramRef::Resolved(program, _) => *program,
        };
        if self.memory.is_out_of_reach(program) {
            self.executor.log.note(Note::ProgramOutOfReach, self.executor.flow.block);
        }
        let start = match call.start {
            None => 0,
            Some(number) => {
                let found = self.memory.get(program).find_number(number, 0);
                found.ok_or(Alarm::SequenceNumberNotFound { number })?
            }
        };
        if call.kind != CallKind::Modal && call.is_immediate {
            self.executor.check_levels(call.kind != CallKind::Subprogram)?;
        }
        call.target = ProgramRef::Resolved(program, start);
        Ok(())
    }
}

impl Executor {
    /// Makes a call that [`Control::resolve_call`] has found.
    pub(super) fn make_call(&mut self, call: &CallPlan) {
        let ProgramRef::Resolved(program, start) = call.target else { return };
        let CallPlan { repeats, locals, origins, .. } = *call;
        if repeats == 0 {
            self.log.note(Note::CallRepeatsZero, self.flow.block);
            return;
        }
        let kind = match call.kind {
            CallKind::Modal | CallKind::EveryBlock => {
                let is_every_block = call.kind == CallKind::EveryBlock;
                self.flow.modal_calls.push(ModalMacro { program, repeats, locals, is_every_block, origins });
                self.update_modal_code();
                if call.is_immediate && is_every_block {
                    self.call_every_block_macro(&locals);
                }
                return;
            }
            CallKind::Subprogram => FrameKind::Subprogram,
            CallKind::Macro => FrameKind::Macro,
        };
        if kind == FrameKind::Macro {
            self.registers.variables.push_level(&locals);
        }
        let resets_arguments = self.registers.data.settings.undocumented.repeats_reset_locals && repeats > 1;
        self.flow.push(CallFrame {
            next: start,
            start,
            arguments: resets_arguments.then(|| Box::new(locals)),
            modal_call_count: self.flow.frame.modal_call_count,
            is_external: call.is_external || self.flow.frame.is_external,
            ..self.flow.callee_frame(program, kind, repeats, origins)
        });
    }

    /// Raises the alarm of a call that is nested too deeply.
    pub(super) fn check_levels(&self, is_macro: bool) -> Result<(), Alarm> {
        if is_macro && self.registers.variables.level() >= self.registers.data.settings.macro_levels {
            return Err(Alarm::TooManyMacroCalls { limit: self.registers.data.settings.macro_levels });
        }
        if self.flow.callers.len() >= self.registers.data.settings.call_levels {
            return Err(Alarm::TooManyCalls { limit: self.registers.data.settings.call_levels });
        }
        Ok(())
    }

    /// Returns from a subprogram or macro to the program that called it.
    pub(super) fn pop(&mut self) {
        match self.flow.frame.kind {
            FrameKind::Macro => self.registers.variables.pop_level(),
            FrameKind::Modal(index) => {
                let locals = self.registers.variables.locals();
                if let Some(call) = self.flow.modal_calls.get_mut(index)
                    && self.registers.data.settings.undocumented.modal_keeps_locals
                {
                    call.locals = locals;
                }
                self.registers.variables.pop_level();
            }
            FrameKind::Main | FrameKind::Subprogram => {}
        }
        if let Some(caller) = self.flow.callers.pop() {
            self.flow.frame = caller;
        }
    }

    /// M99 without P in a called program: begins the next pass or returns.
    pub(super) fn repeat_or_pop(&mut self) {
        let frame = &mut self.flow.frame;
        if frame.repeats == 0 {
            return self.pop();
        }
        frame.repeats -= 1;
        let start = frame.start;
        frame.loops = [None; 3];
        frame.next = start;
        if let Some(arguments) = frame.arguments.clone() {
            self.registers.variables.set_locals(&arguments);
        }
    }

    /// Checks the modal call that a block with motion triggers.
    pub(super) fn check_call_after_move(&self) -> Result<(), Alarm> {
        self.flow.triggered_call().map_or(Ok(()), |_| self.check_levels(true))
    }

    /// Calls the macro of G66 after a block with motion, if there is one.
    #[inline]
    pub(super) fn call_after_move(&mut self) {
        if let Some(index) = self.flow.triggered_call() {
            let locals = self.flow.modal_calls[index].locals;
            self.make_modal_call(index, FrameKind::Modal(index), &locals);
        }
    }

    /// Calls the macro of G66.1 with the arguments of a block.
    fn call_every_block_macro(&mut self, locals: &Locals) {
        if let Some(index) = self.flow.triggered_call() {
            self.make_modal_call(index, FrameKind::Macro, locals);
        }
    }

    #[inline(never)]
    fn make_modal_call(&mut self, index: usize, kind: FrameKind, locals: &Locals) {
        let ModalMacro { program, repeats, origins, .. } = self.flow.modal_calls[index];
        let frame = self.flow.callee_frame(program, kind, repeats, origins);
        self.registers.variables.push_level(locals);
        self.flow.push(CallFrame { modal_call_count: index, ..frame });
    }

    /// Calls the macro of G66.1, if it is active, instead of executing a block of words; returns true if it has. The words,
    /// G L N P included, are the arguments; M99 and G67 are executed.
    #[inline]
    pub(super) fn call_for_every_block(&mut self, words: &Words, number: Option<u32>) -> ExecResult<bool> {
        if !self.flow.triggered_call().is_some_and(|index| self.flow.modal_calls[index].is_every_block) {
            return Ok(false);
        }
        self.call_by_words(words, number)
    }

    #[inline(never)]
    fn call_by_words(&mut self, words: &Words, number: Option<u32>) -> ExecResult<bool> {
        match words.call() {
            Some(call) if matches!(call.kind, CallCode::Cancel | CallCode::Return) => return Ok(false),
            Some(call) => {
                let what = "a call while G66.1 is on".into();
                return Err(Alarm::NotSimulated { what }.located_at(call.span));
            }
            None => {}
        }
        let mut locals = self.registers.evaluate_arguments(words, &words.list, true)?;
        if let Some(number) = number {
            locals.set(14, Value::Number(f64::from(number)), 0);
        }
        locate(self.check_levels(true), self.flow.block)?;
        self.call_every_block_macro(&locals);
        Ok(true)
    }

    /// Sets #4012.
    pub(super) fn update_modal_code(&mut self) {
        use gcode_lang::program::modes::ModalCall;
        self.registers.state.modal.call = match self.flow.modal_calls.last() {
            None => ModalCall::Off,
            Some(call) if call.is_every_block => ModalCall::EveryBlock,
            Some(_) => ModalCall::AfterMoves,
        };
    }

    /// G67: ends the last modal call.
    pub(super) fn cancel_modal(&mut self) {
        self.flow.modal_calls.pop();
        self.update_modal_code();
    }
}

impl Control {
    /// Returns the operation that M99 P jumps to, before anything of its block has happened; `None` without a jump.
    pub(super) fn find_return(&self, number: Option<u32>) -> Result<Option<OpIndex>, Alarm> {
        let Some(number) = number.filter(|_| !self.is_last_cycle(true)) else { return Ok(None) };
        let program = self.memory.get(self.return_frame().program);
        let found = program.find_number(number, 0);
        found.map(Some).ok_or(Alarm::SequenceNumberNotFound { number })
    }

    /// Returns true if M99 of the main program ends the run; without a number of cycles, one that jumps nowhere.
    fn is_last_cycle(&self, jumps: bool) -> bool {
        let Executor { registers, flow, .. } = &self.executor;
        let cycles = registers.data.settings.main_program_cycles;
        let is_last = cycles.map_or(!jumps, |cycles| flow.main_passes + 1 >= cycles);
        flow.frame.kind == FrameKind::Main && is_last
    }

    /// Returns the frame in which the run continues after M99.
    fn return_frame(&self) -> &CallFrame {
        match self.executor.flow.frame.kind {
            FrameKind::Main => &self.executor.flow.frame,
            _ => self.executor.flow.callers.last().unwrap_or(&self.executor.flow.frame),
        }
    }

    /// Executes M99, or M99 P with its number and the operation of [`Control::find_return`]; returns the end of the run, if
    /// any.
    pub(super) fn return_to(&mut self, to: Option<(u32, OpIndex)>) -> Option<RunEnd> {
        let is_main = self.executor.flow.frame.kind == FrameKind::Main;
        let ends_run = self.is_last_cycle(to.is_some());
        if is_main {
            self.executor.flow.main_passes += 1;
        }
        if ends_run {
            if self.executor.registers.data.settings.main_program_cycles.is_none() {
                self.executor.log.note(Note::MainRepeats, self.executor.flow.block);
            }
            return Some(RunEnd::ProgramEnd);
        }
        let Some((number, target)) = to else {
            if is_main {
                self.executor.flow.frame.jump(0);
            } else {
                self.executor.repeat_or_pop();
            }
            return None;
        };
        let program = self.memory.get(self.return_frame().program);
        if !is_main {
            self.executor.pop();
        }
        self.executor.note_ambiguous_jump(program, number, target);
        self.executor.flow.frame.jump(target);
        None
    }
}
