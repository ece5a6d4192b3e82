//! Calls and returns that a block commands: by G65, G66 and M98, and by codes and addresses that parameters define.
use super::flow::CallOrigins;
use super::functions::{ExecResult, locate};
use super::notes::Note;
use super::plan::{BlockFlow, BlockPlan, CallKind, CallPlan, ProgramRef, TableWrite};
use super::planner::Planner;
use super::variables::{VACANT, Value};
use super::words::{CallingWord, WordNumber, count};
use gcode_lang::alarm::Alarm;
use gcode_lang::control::{CalledProgram, CodeCallKind};
use gcode_lang::program::{CallCode, CallOp, CallTarget, LoweredWord, m_codes};

impl Planner<'_> {
    /// 7. Plans the call or return of a block.
    pub(super) fn plan_call(&self, call: &CallOp, plan: &mut BlockPlan) -> ExecResult<()> {
        match call.kind {
            CallCode::Return => self.plan_return(call, plan),
            CallCode::Cancel => self.plan_cancel(call, plan),
            CallCode::Macro
            | CallCode::AfterMoves
            | CallCode::EveryBlock
            | CallCode::Subprogram
            | CallCode::File
            | CallCode::Local => self.plan_program_call(call, plan),
        }
    }

    /// Plans M99.
    fn plan_return(&self, call: &CallOp, plan: &mut BlockPlan) -> ExecResult<()> {
        let number = match &call.target {
            CallTarget::Number(word) => self.count_of(Some(word))?,
            CallTarget::Name(_) | CallTarget::None => None,
        };
        plan.flow = BlockFlow::Return { number, target: None };
        Ok(())
    }

    /// Plans G67.
    fn plan_cancel(&self, call: &CallOp, plan: &mut BlockPlan) -> ExecResult<()> {
        plan.flow = BlockFlow::CancelModal;
        if self.flow.modal_calls.is_empty() {
            let resets_modes = self.words.g_codes().next().is_some();
            if self.data.settings.g67_alarms.unwrap_or(!resets_modes) {
                return Err(Alarm::CancelWithoutModalCall.located_at(call.span));
            }
            if self.data.settings.g67_alarms.is_none() {
                plan.notes.push(Note::NothingToCancel);
            }
        }
        Ok(())
    }

    /// Plans the call of a program.
    fn plan_program_call(&self, call: &CallOp, plan: &mut BlockPlan) -> ExecResult<()> {
        let kind = self.call_kind(call)?;
        let start = self.count_of(call.start.as_ref())?;
        let repeats = self.count_of(call.repeats.as_ref())?;
        let (target, repeats, digits_of_p) = self.call_target(call, kind, start, repeats)?;
        let is_every_block = kind == CallKind::EveryBlock;
        let locals =
            self.registers.evaluate_arguments(self.lowered_words, &call.arguments, is_every_block)?;
        let has_own_arguments =
            self.data.settings.undocumented.every_block_calls_itself && !call.arguments.is_empty();
        plan.flow = BlockFlow::Call(Box::new(CallPlan {
            kind,
            target,
            repeats,
            digits_of_p,
            start,
            locals,
            is_immediate: !is_every_block || has_own_arguments,
            origins: CallOrigins::default(),
            is_external: call.kind == CallCode::File,
            span: call.span,
        }));
        Ok(())
    }

    fn count_of(&self, word: Option<&LoweredWord>) -> ExecResult<Option<u32>> {
        self.registers.count_of_word(self.lowered_words, word)
    }

    /// Returns the kind of a call; an alarm for one that this control lacks or the simulator does not execute.
    fn call_kind(&self, call: &CallOp) -> ExecResult<CallKind> {
        let refuse = |what: &str| Err(Alarm::NotSimulated { what: what.to_owned() }.located_at(call.span));
        // The moves of the macro trigger the calls before its own; a new call would follow those it can't trigger.
        let is_inside_modal_macro = self.flow.frame.modal_call_count < self.flow.modal_calls.len();
        match call.kind {
            CallCode::EveryBlock | CallCode::AfterMoves if is_inside_modal_macro => {
                refuse("a modal call inside a macro that a modal call runs")
            }
            CallCode::EveryBlock => Ok(CallKind::EveryBlock),
            CallCode::AfterMoves => Ok(CallKind::Modal),
            CallCode::Macro => Ok(CallKind::Macro),
            CallCode::Local if !self.data.settings.has_local_calls => {
                refuse("M97 with P (a call of the program itself, with --control M97-CALLS=1)")
            }
            CallCode::File if m_codes::find(198, self.data.settings.codes).is_none() => {
                refuse("M198 on this control")
            }
            CallCode::Subprogram | CallCode::File | CallCode::Local | CallCode::Return | CallCode::Cancel => {
                Ok(CallKind::Subprogram)
            }
        }
    }

    /// Returns the called program, the number of its passes, and all digits of P if the first ones are that number.
    fn call_target(
        &self,
        call: &CallOp,
        kind: CallKind,
        start: Option<u32>,
        repeats: Option<u32>,
    ) -> ExecResult<(ProgramRef, u32, Option<u32>)> {
        let missing = match kind {
            CallKind::Subprogram if self.data.settings.undocumented.missing_p_is_311 => Alarm::NoNameInCall,
            CallKind::Subprogram | CallKind::Macro | CallKind::Modal | CallKind::EveryBlock => {
                Alarm::ProgramNotNamed
            }
        };
        let missing = missing.located_at(call.span);
        let target = match &call.target {
            // M98 Q, M98 H and M97 P start in the same program.
            CallTarget::None if start.is_some() => ProgramRef::Resolved(self.flow.frame.program, 0),
            CallTarget::None => return Err(missing),
            CallTarget::Name(name) => ProgramRef::Name(name.clone()),
            CallTarget::Number(word) => {
                let number = self.count_of(Some(word))?.ok_or(missing)?;
                // M98 P with more than four digits: repeats in front of a four-digit program number.
                let has_repeats_in_p = call.kind == CallCode::Subprogram
                    && self.data.settings.reads_repeats_in_p
                    && repeats.is_none()
                    && number > 9999;
                if has_repeats_in_p {
                    return Ok((ProgramRef::Number(number % 10_000), number / 10_000, Some(number)));
                }
                ProgramRef::Number(number)
            }
        };
        Ok((target, repeats.unwrap_or(1), None))
    }

    /// Raises the alarm of a block that triggers a modal call by a move and does something else with the program flow.
    #[inline(always)]
    pub(super) fn check_flow_of_triggering_block(&self, flow: &BlockFlow) -> ExecResult<()> {
        let what = match flow {
            _ if self.flow.triggered_call().is_none() => return Ok(()),
            BlockFlow::Next | BlockFlow::Return { .. } | BlockFlow::Jump { .. } => return Ok(()),
            BlockFlow::Call(_) => "a modal macro call after a block that both moves and calls",
            BlockFlow::CancelModal => "a modal macro call after a block that moves and has G67",
            BlockFlow::End => "a modal macro call after a block that moves and ends the program",
        };
        Err(self.not_simulated(format!("{what} (write the move in a block of its own)")))
    }

    /// Plans the call of a macro by a code, which stands first in the block; the other words are the arguments. Returns
    /// true if there is one.
    pub(super) fn plan_macro_call_by_code(&self, plan: &mut BlockPlan) -> ExecResult<bool> {
        for (index, word) in self.lowered_words.list.iter().enumerate() {
            let Some(called) = self.program_called_by(word)? else { continue };
            if called.kind == CodeCallKind::Subprogram {
                continue;
            }
            if index > 0 {
                let what = "words before a code that calls a macro".into();
                return Err(Alarm::MacroFormat { what }.located_at(self.lowered_words.list[0].span));
            }
            if let Some(second) = self.lowered_words.call() {
                return Err(Alarm::TwoMacroCalls.located_at(second.span));
            }
            let call = self.macro_call(called, word)?;
            plan.flow = BlockFlow::Call(Box::new(call));
            return Ok(true);
        }
        Ok(false)
    }

    fn macro_call(&self, called: CalledProgram, code: &LoweredWord) -> ExecResult<CallPlan> {
        let arguments = &self.lowered_words.list[1..];
        let is_every_block =
            called.kind == CodeCallKind::Modal && self.data.settings.code_calls.modal_is_every_block;
        for word in arguments.iter().filter(|_| !is_every_block) {
            match word.letter {
                b'G' => return Err(Alarm::GAsArgument.located_at(word.span)),
                // An option of some controls makes an argument of it.
                b'P' if called.kind != CodeCallKind::MacroInP => {
                    let what = "P as an argument of a code that calls a macro".into();
                    return Err(Alarm::NotSimulated { what }.located_at(word.span));
                }
                _ => {}
            }
        }
        let repeats = arguments.iter().find(|word| word.letter == b'L');
        let program = match called.kind {
            CodeCallKind::MacroInP => {
                let p = arguments.iter().find(|word| word.letter == b'P');
                let number = self.registers.count_of_word(self.lowered_words, p)?;
                number.ok_or_else(|| Alarm::ProgramNotNamed.located_at(code.span))?
            }
            CodeCallKind::Macro | CodeCallKind::Modal | CodeCallKind::Subprogram => called.program,
        };
        let has_own_arguments =
            self.data.settings.undocumented.every_block_calls_itself && !arguments.is_empty();
        Ok(CallPlan {
            kind: match called.kind {
                CodeCallKind::Modal if is_every_block => CallKind::EveryBlock,
                CodeCallKind::Modal => CallKind::Modal,
                CodeCallKind::Macro | CodeCallKind::MacroInP | CodeCallKind::Subprogram => CallKind::Macro,
            },
            target: ProgramRef::Number(program),
            repeats: self.registers.count_of_word(self.lowered_words, repeats)?.unwrap_or(1),
            digits_of_p: None,
            start: None,
            locals: self.registers.evaluate_arguments(self.lowered_words, arguments, is_every_block)?,
            is_immediate: !is_every_block || has_own_arguments,
            origins: call_origins(code.letter),
            is_external: false,
            span: code.span,
        })
    }

    /// Returns the word of a block that calls a subprogram; the other words of the block act first.
    pub(super) fn find_subprogram_call_by_code(&self) -> ExecResult<Option<CallingWord>> {
        let mut found = None;
        for (index, word) in self.lowered_words.list.iter().enumerate() {
            let Some(calling) = self.read_calling_word(index, word)? else { continue };
            if found.is_some() || self.lowered_words.call().is_some() {
                return Err(Alarm::TwoSubprogramCalls.located_at(word.span));
            }
            found = Some(calling);
        }
        Ok(found)
    }

    fn read_calling_word(&self, index: usize, word: &LoweredWord) -> ExecResult<Option<CallingWord>> {
        if let Some(call) = self.data.settings.code_calls.address_call(word.letter)
            && self.code_may_call(word.letter)
            && self.data.settings.axes.find(word.letter).is_none()
        {
            let Some(raw) = self.registers.evaluate_word(self.lowered_words, word)? else { return Ok(None) };
            let number = match word.letter {
                b'B' | b'S' | b'T' => f64::from(locate(count(raw, word.letter), word.span)?),
                letter => self.registers.argument_value(raw, letter),
            };
            let (program, value) = (call.program, Some((call.variable, number)));
            return Ok(Some(CallingWord { index, takes_repeats: false, program, value }));
        }
        let called = self.program_called_by(word)?;
        let program =
            called.filter(|called| called.kind == CodeCallKind::Subprogram).map(|called| called.program);
        Ok(program.map(|program| CallingWord { index, takes_repeats: true, program, value: None }))
    }

    /// Plans the subprogram call of a word, with its repetitions.
    pub(super) fn plan_calling_word(&self, calling: &CallingWord, plan: &mut BlockPlan) -> ExecResult<()> {
        let word = &self.lowered_words.list[calling.index];
        let repeats =
            self.lowered_words.list.iter().find(|other| calling.takes_repeats && other.letter == b'L');
        if let Some((number, value)) = calling.value {
            plan.writes.push(TableWrite::Variable { number, value: Value::Number(value) });
        }
        plan.flow = BlockFlow::Call(Box::new(CallPlan {
            kind: CallKind::Subprogram,
            target: ProgramRef::Number(calling.program),
            repeats: self.registers.count_of_word(self.lowered_words, repeats)?.unwrap_or(1),
            digits_of_p: None,
            start: None,
            locals: VACANT,
            is_immediate: true,
            origins: call_origins(word.letter),
            is_external: false,
            span: word.span,
        }));
        Ok(())
    }

    /// Returns the program that a G or M code calls; inside a program that a code has called it is an ordinary code.
    fn program_called_by(&self, word: &LoweredWord) -> ExecResult<Option<CalledProgram>> {
        if !matches!(word.letter, b'G' | b'M') || !self.code_may_call(word.letter) {
            return Ok(None);
        }
        let Some(raw) = self.registers.evaluate_word(self.lowered_words, word)? else { return Ok(None) };
        let tenths = match (word.letter, raw) {
            (b'G', WordNumber::Computed(value)) => (value * 10.0).round(),
            (b'G', WordNumber::Literal(number)) => number.value() * 10.0,
            _ => 10.0 * f64::from(locate(count(raw, b'M'), word.span)?),
        };
        let code = (0.0..=f64::from(u32::MAX)).contains(&tenths).then_some(tenths as u32);
        Ok(code.and_then(|code| self.data.settings.code_calls.find_call(word.letter, code)))
    }

    fn code_may_call(&self, letter: u8) -> bool {
        self.flow.frame.origins.allows_call(letter == b'G', self.data.settings.code_calls.allows_nested_calls)
    }
}

fn call_origins(letter: u8) -> CallOrigins {
    CallOrigins { has_g_code: letter == b'G', has_other_code: letter != b'G' }
}

#[cfg(test)]
mod tests {
    use crate::{Control, Limits, Value};
    use gcode_lang::control::Settings;
    use gcode_lang::motion::Axes;
    use gcode_lang::program::{Memory, NoLibrary};

    #[test]
    fn b_calls_where_it_is_no_axis() {
        for (axes, number) in [("XYZ", Value::Number(7.0)), ("XYZB", Value::Vacant)] {
            let mut memory = Memory::default();
            memory.load("b.nc", *b"O1\nB7\nM30\nO9028\n#100=#146\nM99\n");
            let mut settings = Settings { axes: Axes::new(axes).unwrap(), ..Settings::default() };
            settings.set("BCS", "1").unwrap();
            let mut control = Control::new(memory, settings);
            control.run(Limits::default(), &mut NoLibrary, &mut ());
            assert_eq!(control.variable(100).unwrap(), number, "{axes}");
        }
    }
}
