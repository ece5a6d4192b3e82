//! Calls and returns as a block commands them: prepared, resolved, made.
use super::eval::{Checked, at};
use super::frames::{CallOrigins, Frame, FrameKind};
use super::modal_calls::ModalCall;
use super::notes::Note;
use super::plan::{BlockFlow, BlockPlan, CallKind, CallPlan, Target};
use super::words::count;
use super::{Control, Executor};
use gcode_lang::alarm::Alarm;
use gcode_lang::program::m_codes;
use gcode_lang::program::{CallCode, CallOp, CallTarget, Library, LoweredWord, Words};
use gcode_lang::source::Span;

impl Executor {
    pub(super) fn coded_count(&self, words: &Words, word: &LoweredWord) -> Checked<Option<u32>> {
        let Some(raw) = self.raw(words, word)? else { return Ok(None) };
        at(count(raw, word.letter), word.span).map(Some)
    }

    /// 7. The call or return of a block.
    pub(super) fn prepare_call(&self, words: &Words, call: &CallOp, plan: &mut BlockPlan) -> Checked<()> {
        let kind = match call.kind {
            CallCode::Return => {
                let to = match &call.target {
                    CallTarget::Number(word) => self.coded_count(words, word)?,
                    CallTarget::Name(_) | CallTarget::None => None,
                };
                plan.flow = BlockFlow::Return { number: to, target: None };
                return Ok(());
            }
            CallCode::Cancel => {
                plan.flow = BlockFlow::CancelModal;
                if self.modal_calls.is_empty() && self.settings.unsure.g67_alarms {
                    return Err(Alarm::CancelWithoutModalCall.at(call.span));
                }
                return Ok(());
            }
            // Its moves trigger the calls before its own, and a new one would stand behind those it can't.
            CallCode::EveryBlock | CallCode::AfterMoves if self.frame.modal < self.modal_calls.len() => {
                let what = "a modal call inside a macro that a modal call runs".into();
                return Err(Alarm::NotSimulated { what }.at(call.span));
            }
            CallCode::EveryBlock => CallKind::EveryBlock,
            CallCode::Macro => CallKind::Macro,
            CallCode::AfterMoves => CallKind::Modal,
            CallCode::Local if !self.settings.local_calls => {
                let what = "M97 with P (a call of the program itself, for M97-CALLS=1)".into();
                return Err(Alarm::NotSimulated { what }.at(call.span));
            }
            CallCode::File if m_codes::find(198, self.settings.codes).is_none() => {
                return Err(Alarm::NotSimulated { what: "M198 on this control".into() }.at(call.span));
            }
            CallCode::Subprogram | CallCode::File | CallCode::Local => CallKind::Subprogram,
        };
        let start = match &call.start {
            Some(word) => self.coded_count(words, word)?,
            None => None,
        };
        let unsure = &self.settings.unsure;
        let missing = match kind {
            CallKind::Subprogram if unsure.missing_p_is_311 => Alarm::NoNameInCall.at(call.span),
            _ => Alarm::ProgramNotNamed.at(call.span),
        };
        let mut repeats = match &call.repeats {
            Some(word) => self.coded_count(words, word)?,
            None => None,
        };
        let target = match &call.target {
            // M98 Q, M98 H and M97 P start in the same program.
            CallTarget::None if start.is_some() => Target::Found(self.frame.program, 0),
            CallTarget::None => return Err(missing),
            CallTarget::Name(name) => Target::Name(name.clone()),
            CallTarget::Number(word) => {
                let number = self.coded_count(words, word)?.ok_or(missing)?;
                // M98 P with more than four digits: repeats in front of a four-digit program number.
                if call.kind == CallCode::Subprogram
                    && self.settings.repeats_in_p
                    && repeats.is_none()
                    && number > 9999
                {
                    repeats = Some(number / 10_000);
                    Target::Number(number % 10_000)
                } else {
                    Target::Number(number)
                }
            }
        };
        let every = kind == CallKind::EveryBlock;
        let locals = self.arguments(words, &call.arguments, every)?;
        let own = self.settings.unsure.every_block_calls_itself && !call.arguments.is_empty();
        let calls_now = !every || own;
        let repeats = repeats.unwrap_or(1);
        plan.flow = BlockFlow::Call(Box::new(CallPlan {
            kind,
            target,
            repeats,
            start,
            locals,
            calls_now,
            by_code: CallOrigins::default(),
            external: call.kind == CallCode::File,
            span: call.span,
        }));
        Ok(())
    }
}

impl Control {
    /// Finds the program of a call and checks the nesting, before anything of the block has happened.
    pub(super) fn resolve(&mut self, call: &mut CallPlan, library: &mut impl Library) -> Result<(), Alarm> {
        if call.external && self.core.frame.external {
            return Err(Alarm::DeviceCallInDeviceCall);
        }
        let program = match &call.target {
            Target::Number(number) => {
                let found = self.memory.fetch(*number, library);
                found.ok_or(match call.external {
                    true => Alarm::DeviceFileNotFound { number: *number, unread: library.unread() },
                    false => Alarm::ProgramNotFound { number: *number, unread: library.unread() },
                })?
            }
            Target::Name(name) => {
                let found = self.memory.fetch_name(name, library);
                found.ok_or_else(|| Alarm::FileNotFound { name: name.clone(), unread: library.unread() })?
            }
            Target::Found(program, _) => *program,
        };
        let start = match call.start {
            None => 0,
            Some(number) => {
                let found = self.memory.get(program).find_number(number, 0);
                found.ok_or(Alarm::SequenceNumberNotFound { number })?
            }
        };
        if call.kind != CallKind::Modal && call.calls_now {
            self.core.check_levels(call.kind != CallKind::Subprogram)?;
        }
        call.target = Target::Found(program, start);
        Ok(())
    }
}

impl Executor {
    /// Makes a call that [`Control::resolve`] has found.
    pub(super) fn enter(&mut self, call: &CallPlan, block: Span) {
        let Target::Found(program, start) = call.target else { return };
        if call.repeats == 0 {
            self.notes.entry(Note::CallRepeatsZero).or_insert(block);
            return;
        }
        let kind = match call.kind {
            CallKind::Modal | CallKind::EveryBlock => {
                let every = call.kind == CallKind::EveryBlock;
                let locals = call.locals;
                let by_code = call.by_code;
                self.modal_calls.push(ModalCall { program, repeats: call.repeats, locals, every, by_code });
                self.show_modal_call();
                if call.calls_now && every {
                    self.call_with(&call.locals, block);
                }
                return;
            }
            CallKind::Subprogram => FrameKind::Subprogram,
            CallKind::Macro => FrameKind::Macro,
        };
        if kind == FrameKind::Macro {
            self.vars.enter(&call.locals);
        }
        let again = self.settings.unsure.repeats_reset_locals && call.repeats > 1;
        let arguments = again.then(|| Box::new(call.locals));
        let modal = self.frame.modal;
        self.push(Frame {
            arguments,
            modal,
            external: call.external || self.frame.external,
            ..self.called(program, start, kind, call.repeats, call.by_code, block)
        });
    }
}
