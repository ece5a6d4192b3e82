//! Calls and returns carried out: programs found, frames pushed and popped, modal calls triggered.
use super::block_effects::RunEnd;
use super::checked::ExecResult;
use super::control::Control;
use super::executor::Executor;
use super::flow::{Frame, FrameKind, ModalCall};
use super::notes::Note;
use super::plan::{CallKind, CallPlan, ProgramRef};
use super::variables::{Locals, Value};
use gcode_lang::alarm::Alarm;
use gcode_lang::program::{CallCode, Library, OpIndex, Words};
use gcode_lang::source::Span;

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
                let found = self.memory.fetch(*number, library);
                found.ok_or(match call.is_external {
                    true => Alarm::DeviceFileNotFound { number: *number, read_error: library.read_error() },
                    false => Alarm::ProgramNotFound { number: *number, read_error: library.read_error() },
                })?
            }
            ProgramRef::Name(name) => {
                let found = self.memory.fetch_name(name, library);
                found.ok_or_else(|| Alarm::FileNotFound {
                    name: name.clone(),
                    read_error: library.read_error(),
                })?
            }
            ProgramRef::Resolved(program, _) => *program,
        };
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
    pub(super) fn make_call(&mut self, call: &CallPlan, block: Span) {
        let ProgramRef::Resolved(program, start) = call.target else { return };
        if call.repeats == 0 {
            self.log.note(Note::CallRepeatsZero, block);
            return;
        }
        let kind = match call.kind {
            CallKind::Modal | CallKind::EveryBlock => {
                let every = call.kind == CallKind::EveryBlock;
                let locals = call.locals;
                let by_code = call.origins;
                self.flow.modal_calls.push(ModalCall {
                    program,
                    repeats: call.repeats,
                    locals,
                    is_every_block: every,
                    origins: by_code,
                });
                self.update_modal_code();
                if call.is_immediate && every {
                    self.call_every_block_macro(&call.locals, block);
                }
                return;
            }
            CallKind::Subprogram => FrameKind::Subprogram,
            CallKind::Macro => FrameKind::Macro,
        };
        if kind == FrameKind::Macro {
            self.registers.variables.push_level(&call.locals);
        }
        let resets_arguments =
            self.registers.data.settings.undocumented.repeats_reset_locals && call.repeats > 1;
        let arguments = resets_arguments.then(|| Box::new(call.locals));
        let modal = self.flow.frame.modal_call_count;
        self.flow.push(Frame {
            arguments,
            modal_call_count: modal,
            is_external: call.is_external || self.flow.frame.is_external,
            ..self.flow.callee_frame(program, start, kind, call.repeats, call.origins, block)
        });
    }

    pub(super) fn check_levels(&self, is_macro: bool) -> Result<(), Alarm> {
        if is_macro && self.registers.variables.level() >= self.registers.data.settings.macro_levels {
            return Err(Alarm::TooManyMacroCalls { limit: self.registers.data.settings.macro_levels });
        }
        if self.flow.callers.len() >= self.registers.data.settings.call_levels {
            return Err(Alarm::TooManyCalls { limit: self.registers.data.settings.call_levels });
        }
        Ok(())
    }

    /// Back from a subprogram or macro to the program that called it.
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

    /// M99 without P in a called program: the next pass, or back.
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

    /// Whether a block with motion may make the modal call that waits for it.
    pub(super) fn check_call_after_move(&self) -> Result<(), Alarm> {
        self.flow.triggered_call().map_or(Ok(()), |_| self.check_levels(true))
    }

    /// After a block with motion: the last modal call that this program's moves can trigger.
    #[inline]
    pub(super) fn call_after_move(&mut self, block: Span) {
        if let Some(index) = self.flow.triggered_call() {
            self.make_modal_call(index, block);
        }
    }

    #[inline(never)]
    fn make_modal_call(&mut self, index: usize, block: Span) {
        let ModalCall { program, repeats, locals, origins: by_code, .. } =
            self.flow.modal_calls[index].clone();
        let frame = Frame {
            modal_call_count: index,
            ..self.flow.callee_frame(program, 0, FrameKind::Modal(index), repeats, by_code, block)
        };
        self.registers.variables.push_level(&locals);
        self.flow.push(frame);
    }

    /// Under G66.1 a block of words is not executed: its words, G L N P among them, are the macro's arguments.
    /// M99 and G67 stay what they are.
    #[inline]
    pub(super) fn call_by_block(
        &mut self,
        words: &Words,
        number: Option<u32>,
        block: Span,
    ) -> ExecResult<bool> {
        if !self.flow.triggered_call().is_some_and(|i| self.flow.modal_calls[i].is_every_block) {
            return Ok(false);
        }
        self.call_by_words(words, number, block)
    }

    #[inline(never)]
    fn call_by_words(&mut self, words: &Words, number: Option<u32>, block: Span) -> ExecResult<bool> {
        match words.call() {
            Some(call) if matches!(call.kind, CallCode::Cancel | CallCode::Return) => return Ok(false),
            Some(call) => {
                return Err(
                    Alarm::NotSimulated { what: "a call while G66.1 is on".into() }.located_at(call.span)
                );
            }
            None => {}
        }
        let mut locals = self.registers.evaluate_arguments(words, &words.list, true)?;
        if let Some(number) = number {
            locals.set(14, Value::Number(f64::from(number)), 0);
        }
        self.check_levels(true).map_err(|alarm| alarm.located_at(block))?;
        self.flow.block = block;
        self.call_every_block_macro(&locals, block);
        Ok(true)
    }

    /// Calls the macro of G66.1.
    pub(super) fn call_every_block_macro(&mut self, locals: &Locals, block: Span) {
        let Some(index) = self.flow.triggered_call() else { return };
        let ModalCall { program, repeats, origins: by_code, .. } = self.flow.modal_calls[index].clone();
        let frame = Frame {
            modal_call_count: index,
            ..self.flow.callee_frame(program, 0, FrameKind::Macro, repeats, by_code, block)
        };
        self.registers.variables.push_level(locals);
        self.flow.push(frame);
    }

    /// #4012.
    pub(super) fn update_modal_code(&mut self) {
        use gcode_lang::program::modes::ModalCall;
        self.registers.state.modal.call = match self.flow.modal_calls.last() {
            None => ModalCall::Off,
            Some(call) if call.is_every_block => ModalCall::EveryBlock,
            Some(_) => ModalCall::AfterMoves,
        };
    }

    /// G67: the last modal call ends.
    pub(super) fn cancel_modal(&mut self) {
        self.flow.modal_calls.pop();
        self.update_modal_code();
    }
}

impl Control {
    /// Where M99 P leads, before anything of its block has happened; `None` where it leads nowhere.
    pub(super) fn find_return(&self, number: Option<u32>) -> Result<Option<OpIndex>, Alarm> {
        let Some(number) = number.filter(|_| !self.is_last_cycle()) else { return Ok(None) };
        let program = self.memory.get(self.return_frame().program);
        let found = program.find_number(number, 0);
        found.map(Some).ok_or(Alarm::SequenceNumberNotFound { number })
    }

    /// Whether M99 of the main program ends the run.
    fn is_last_cycle(&self) -> bool {
        let last = self
            .executor
            .registers
            .data
            .settings
            .main_program_cycles
            .is_some_and(|cycles| self.executor.flow.main_passes + 1 >= cycles);
        last && self.executor.flow.frame.kind == FrameKind::Main
    }

    /// The frame in which the run goes on after M99.
    fn return_frame(&self) -> &Frame {
        match self.executor.flow.frame.kind {
            FrameKind::Main => &self.executor.flow.frame,
            _ => self.executor.flow.callers.last().unwrap_or(&self.executor.flow.frame),
        }
    }

    /// M99, and M99 P with its number and the place that [`Control::find_return`] has found.
    pub(super) fn return_to(&mut self, to: Option<(u32, OpIndex)>) -> Option<RunEnd> {
        let is_main = self.executor.flow.frame.kind == FrameKind::Main;
        let ends_run = self.is_last_cycle();
        if is_main {
            self.executor.flow.main_passes += 1;
        }
        if ends_run {
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
