//! Calls and returns as a block commands them: prepared, resolved, made.
use super::evaluation::{ExecResult, locate};
use super::frames::{CallOrigins, Frame, FrameKind};
use super::modal_calls::ModalCall;
use super::notes::Note;
use super::plan::{BlockFlow, BlockPlan, CallKind, CallPlan, ProgramRef};
use super::words::count;
use super::{Control, Executor};
use gcode_lang::alarm::Alarm;
use gcode_lang::program::m_codes;
use gcode_lang::program::{CallCode, CallOp, CallTarget, Library, LoweredWord, Words};
use gcode_lang::source::Span;

impl Executor {
    pub(super) fn count_of_word(&self, words: &Words, word: &LoweredWord) -> ExecResult<Option<u32>> {
        let Some(raw) = self.evaluate_word(words, word)? else { return Ok(None) };
        locate(count(raw, word.letter), word.span).map(Some)
    }

    /// 7. The call or return of a block.
    pub(super) fn plan_call(&self, words: &Words, call: &CallOp, plan: &mut BlockPlan) -> ExecResult<()> {
        let kind = match call.kind {
            CallCode::Return => {
                let to = match &call.target {
                    CallTarget::Number(word) => self.count_of_word(words, word)?,
                    CallTarget::Name(_) | CallTarget::None => None,
                };
                plan.flow = BlockFlow::Return { number: to, target: None };
                return Ok(());
            }
            CallCode::Cancel => {
                plan.flow = BlockFlow::CancelModal;
                if self.modal_calls.is_empty() && self.settings.undocumented.g67_alarms {
                    return Err(Alarm::CancelWithoutModalCall.located_at(call.span));
                }
                return Ok(());
            }
            // Its moves trigger the calls before its own, and a new one would stand behind those it can't.
            CallCode::EveryBlock | CallCode::AfterMoves
                if self.frame.modal_call_count < self.modal_calls.len() =>
            {
                let what = "a modal call inside a macro that a modal call runs".into();
                return Err(Alarm::NotSimulated { what }.located_at(call.span));
            }
            CallCode::EveryBlock => CallKind::EveryBlock,
            CallCode::Macro => CallKind::Macro,
            CallCode::AfterMoves => CallKind::Modal,
            CallCode::Local if !self.settings.has_local_calls => {
                let what = "M97 with P (a call of the program itself, for M97-CALLS=1)".into();
                return Err(Alarm::NotSimulated { what }.located_at(call.span));
            }
            CallCode::File if m_codes::find(198, self.settings.codes).is_none() => {
                return Err(Alarm::NotSimulated { what: "M198 on this control".into() }.located_at(call.span));
            }
            CallCode::Subprogram | CallCode::File | CallCode::Local => CallKind::Subprogram,
        };
        let start = match &call.start {
            Some(word) => self.count_of_word(words, word)?,
            None => None,
        };
        let undocumented = &self.settings.undocumented;
        let missing = match kind {
            CallKind::Subprogram if undocumented.missing_p_is_311 => {
                Alarm::NoNameInCall.located_at(call.span)
            }
            _ => Alarm::ProgramNotNamed.located_at(call.span),
        };
        let mut repeats = match &call.repeats {
            Some(word) => self.count_of_word(words, word)?,
            None => None,
        };
        let target = match &call.target {
            // M98 Q, M98 H and M97 P start in the same program.
            CallTarget::None if start.is_some() => ProgramRef::Resolved(self.frame.program, 0),
            CallTarget::None => return Err(missing),
            CallTarget::Name(name) => ProgramRef::Name(name.clone()),
            CallTarget::Number(word) => {
                let number = self.count_of_word(words, word)?.ok_or(missing)?;
                // M98 P with more than four digits: repeats in front of a four-digit program number.
                if call.kind == CallCode::Subprogram
                    && self.settings.reads_repeats_in_p
                    && repeats.is_none()
                    && number > 9999
                {
                    repeats = Some(number / 10_000);
                    ProgramRef::Number(number % 10_000)
                } else {
                    ProgramRef::Number(number)
                }
            }
        };
        let is_every_block = kind == CallKind::EveryBlock;
        let locals = self.evaluate_arguments(words, &call.arguments, is_every_block)?;
        let has_own_arguments =
            self.settings.undocumented.every_block_calls_itself && !call.arguments.is_empty();
        let calls_now = !is_every_block || has_own_arguments;
        let repeats = repeats.unwrap_or(1);
        plan.flow = BlockFlow::Call(Box::new(CallPlan {
            kind,
            target,
            repeats,
            start,
            locals,
            is_immediate: calls_now,
            origins: CallOrigins::default(),
            is_external: call.kind == CallCode::File,
            span: call.span,
        }));
        Ok(())
    }
}

impl Control {
    /// Finds the program of a call and checks the nesting, before anything of the block has happened.
    pub(super) fn resolve_call(
        &mut self,
        call: &mut CallPlan,
        library: &mut impl Library,
    ) -> Result<(), Alarm> {
        if call.is_external && self.executor.frame.is_external {
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
    /// Makes a call that [`Control::resolve`] has found.
    pub(super) fn make_call(&mut self, call: &CallPlan, block: Span) {
        let ProgramRef::Resolved(program, start) = call.target else { return };
        if call.repeats == 0 {
            self.notes.entry(Note::CallRepeatsZero).or_insert(block);
            return;
        }
        let kind = match call.kind {
            CallKind::Modal | CallKind::EveryBlock => {
                let every = call.kind == CallKind::EveryBlock;
                let locals = call.locals;
                let by_code = call.origins;
                self.modal_calls.push(ModalCall {
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
            self.vars.push_level(&call.locals);
        }
        let resets_arguments = self.settings.undocumented.repeats_reset_locals && call.repeats > 1;
        let arguments = resets_arguments.then(|| Box::new(call.locals));
        let modal = self.frame.modal_call_count;
        self.push(Frame {
            arguments,
            modal_call_count: modal,
            is_external: call.is_external || self.frame.is_external,
            ..self.callee_frame(program, start, kind, call.repeats, call.origins, block)
        });
    }
}
