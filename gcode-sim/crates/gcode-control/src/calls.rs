//! Calls and returns as a block commands them: prepared, resolved, made.
use super::checked::ExecResult;
use super::flow::CallOrigins;
use super::plan::{BlockFlow, BlockPlan, CallKind, CallPlan, ProgramRef};
use super::planner::Planner;
use gcode_lang::alarm::Alarm;
use gcode_lang::program::{CallCode, CallOp, CallTarget, Words, m_codes};
use gcode_lang::source::Span;

impl Planner<'_> {
    /// 7. The call or return of a block.
    pub(super) fn plan_call(&self, words: &Words, call: &CallOp, plan: &mut BlockPlan) -> ExecResult<()> {
        let kind = match call.kind {
            CallCode::Return => {
                let to = match &call.target {
                    CallTarget::Number(word) => self.registers.count_of_word(words, word)?,
                    CallTarget::Name(_) | CallTarget::None => None,
                };
                plan.flow = BlockFlow::Return { number: to, target: None };
                return Ok(());
            }
            CallCode::Cancel => {
                plan.flow = BlockFlow::CancelModal;
                if self.flow.modal_calls.is_empty() && self.data.settings.undocumented.g67_alarms {
                    return Err(Alarm::CancelWithoutModalCall.located_at(call.span));
                }
                return Ok(());
            }
            // Its moves trigger the calls before its own, and a new one would stand behind those it can't.
            CallCode::EveryBlock | CallCode::AfterMoves
                if self.flow.frame.modal_call_count < self.flow.modal_calls.len() =>
            {
                let what = "a modal call inside a macro that a modal call runs".into();
                return Err(Alarm::NotSimulated { what }.located_at(call.span));
            }
            CallCode::EveryBlock => CallKind::EveryBlock,
            CallCode::Macro => CallKind::Macro,
            CallCode::AfterMoves => CallKind::Modal,
            CallCode::Local if !self.data.settings.has_local_calls => {
                let what = "M97 with P (a call of the program itself, for M97-CALLS=1)".into();
                return Err(Alarm::NotSimulated { what }.located_at(call.span));
            }
            CallCode::File if m_codes::find(198, self.data.settings.codes).is_none() => {
                return Err(Alarm::NotSimulated { what: "M198 on this control".into() }.located_at(call.span));
            }
            CallCode::Subprogram | CallCode::File | CallCode::Local => CallKind::Subprogram,
        };
        let start = match &call.start {
            Some(word) => self.registers.count_of_word(words, word)?,
            None => None,
        };
        let undocumented = &self.data.settings.undocumented;
        let missing = match kind {
            CallKind::Subprogram if undocumented.missing_p_is_311 => {
                Alarm::NoNameInCall.located_at(call.span)
            }
            _ => Alarm::ProgramNotNamed.located_at(call.span),
        };
        let mut repeats = match &call.repeats {
            Some(word) => self.registers.count_of_word(words, word)?,
            None => None,
        };
        let target = match &call.target {
            // M98 Q, M98 H and M97 P start in the same program.
            CallTarget::None if start.is_some() => ProgramRef::Resolved(self.flow.frame.program, 0),
            CallTarget::None => return Err(missing),
            CallTarget::Name(name) => ProgramRef::Name(name.clone()),
            CallTarget::Number(word) => {
                let number = self.registers.count_of_word(words, word)?.ok_or(missing)?;
                // M98 P with more than four digits: repeats in front of a four-digit program number.
                if call.kind == CallCode::Subprogram
                    && self.data.settings.reads_repeats_in_p
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
        let locals = self.registers.evaluate_arguments(words, &call.arguments, is_every_block)?;
        let has_own_arguments =
            self.data.settings.undocumented.every_block_calls_itself && !call.arguments.is_empty();
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

    /// What comes first after a move is settled where its block does nothing else with the flow of the program.
    #[inline(always)]
    pub(super) fn check_flow_after_move(&self, flow: &BlockFlow, block: Span) -> ExecResult<()> {
        let what = match flow {
            _ if self.flow.triggered_call().is_none() => return Ok(()),
            BlockFlow::Next | BlockFlow::Return { .. } => return Ok(()),
            BlockFlow::Call(_) => "a modal macro call after a block that both moves and calls",
            BlockFlow::CancelModal => "a modal macro call after a block that moves and has G67",
            BlockFlow::End => "a modal macro call after a block that moves and ends the program",
        };
        let what = format!("{what} (write the move in a block of its own)");
        Err(Alarm::NotSimulated { what }.located_at(block))
    }
}
