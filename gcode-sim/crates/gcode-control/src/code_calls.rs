//! Calls by codes and addresses that parameters make calls of.
use super::checked::{ExecResult, locate};
use super::flow::CallOrigins;
use super::plan::{BlockFlow, BlockPlan, CallKind, CallPlan, ProgramRef, TableWrite};
use super::planner::Planner;
use super::variables::{VACANT, Value};
use super::words::{CallingWord, WordNumber, count};
use gcode_lang::alarm::Alarm;
use gcode_lang::control::{CalledProgram, CodeCallKind};
use gcode_lang::program::{LoweredWord, Words};

impl Planner<'_> {
    /// A code that calls a macro: it stands first, and the block's other words are the arguments.
    pub(super) fn plan_macro_by_code(&self, words: &Words, plan: &mut BlockPlan) -> ExecResult<bool> {
        for (place, word) in words.list.iter().enumerate() {
            let Some(called) = self.program_called_by(words, word)? else { continue };
            if called.kind == CodeCallKind::Subprogram {
                continue;
            }
            if place > 0 {
                let what = "words before a code that calls a macro".into();
                return Err(Alarm::MacroFormat { what }.located_at(words.list[0].span));
            }
            if let Some(second) = words.call() {
                return Err(Alarm::TwoMacroCalls.located_at(second.span));
            }
            let call = self.macro_call(called, words, word)?;
            plan.flow = BlockFlow::Call(Box::new(call));
            return Ok(true);
        }
        Ok(false)
    }

    fn macro_call(&self, called: CalledProgram, words: &Words, code: &LoweredWord) -> ExecResult<CallPlan> {
        let arguments = &words.list[1..];
        let is_every_block =
            called.kind == CodeCallKind::Modal && self.data.settings.code_calls.modal_is_every_block;
        for word in arguments.iter().filter(|_| !is_every_block) {
            match word.letter {
                b'G' => return Err(Alarm::GAsArgument.located_at(word.span)),
                // An option of some controls makes an argument of it.
                b'P' => {
                    let what = "P as an argument of a code that calls a macro".into();
                    return Err(Alarm::NotSimulated { what }.located_at(word.span));
                }
                _ => {}
            }
        }
        let repeats = match arguments.iter().find(|word| word.letter == b'L') {
            Some(word) => self.registers.count_of_word(words, word)?.unwrap_or(1),
            None => 1,
        };
        let own = self.data.settings.undocumented.every_block_calls_itself && !arguments.is_empty();
        Ok(CallPlan {
            kind: match called.kind {
                CodeCallKind::Modal if is_every_block => CallKind::EveryBlock,
                CodeCallKind::Modal => CallKind::Modal,
                CodeCallKind::Macro | CodeCallKind::Subprogram => CallKind::Macro,
            },
            target: ProgramRef::Number(called.program),
            repeats,
            start: None,
            locals: self.registers.evaluate_arguments(words, arguments, is_every_block)?,
            is_immediate: !is_every_block || own,
            origins: call_origins(code.letter),
            is_external: false,
            span: code.span,
        })
    }

    /// The word of a block that calls a subprogram; the words beside it act first.
    pub(super) fn subprogram_by_code(&self, words: &Words) -> ExecResult<Option<CallingWord>> {
        let mut found = None;
        for (place, word) in words.list.iter().enumerate() {
            let Some(calling) = self.calling_word(words, place, word)? else { continue };
            if found.is_some() || words.call().is_some() {
                return Err(Alarm::TwoSubprogramCalls.located_at(word.span));
            }
            found = Some(calling);
        }
        Ok(found)
    }

    fn calling_word(
        &self,
        words: &Words,
        place: usize,
        word: &LoweredWord,
    ) -> ExecResult<Option<CallingWord>> {
        let by_address = self.data.settings.code_calls.address_call(word.letter);
        if let Some(call) =
            by_address.filter(|_| self.code_may_call(word.letter) && !self.is_axis(word.letter))
        {
            let Some(raw) = self.registers.evaluate_word(words, word)? else { return Ok(None) };
            let number = match word.letter {
                b'B' | b'S' | b'T' => f64::from(locate(count(raw, word.letter), word.span)?),
                letter => self.registers.argument_value(raw, letter),
            };
            let value = Some((call.variable, number));
            return Ok(Some(CallingWord {
                index: place,
                takes_repeats: false,
                program: call.program,
                value,
            }));
        }
        let called = self.program_called_by(words, word)?;
        let called = called.filter(|called| called.kind == CodeCallKind::Subprogram);
        Ok(called.map(|called| CallingWord {
            index: place,
            takes_repeats: true,
            program: called.program,
            value: None,
        }))
    }

    /// The call that a word has made a plan of, with its repetitions.
    pub(super) fn plan_calling_word(
        &self,
        words: &Words,
        calling: &CallingWord,
        plan: &mut BlockPlan,
    ) -> ExecResult<()> {
        let word = &words.list[calling.index];
        let repeats = match words.list.iter().find(|other| calling.takes_repeats && other.letter == b'L') {
            Some(word) => self.registers.count_of_word(words, word)?.unwrap_or(1),
            None => 1,
        };
        if let Some((number, value)) = calling.value {
            plan.writes.push(TableWrite::Variable { number, value: Value::Number(value) });
        }
        plan.flow = BlockFlow::Call(Box::new(CallPlan {
            kind: CallKind::Subprogram,
            target: ProgramRef::Number(calling.program),
            repeats,
            start: None,
            locals: VACANT,
            is_immediate: true,
            origins: call_origins(word.letter),
            is_external: false,
            span: word.span,
        }));
        Ok(())
    }

    /// What a G or M code calls here; inside a program that a code called it is an ordinary one.
    fn program_called_by(&self, words: &Words, word: &LoweredWord) -> ExecResult<Option<CalledProgram>> {
        if !matches!(word.letter, b'G' | b'M') || !self.code_may_call(word.letter) {
            return Ok(None);
        }
        let Some(raw) = self.registers.evaluate_word(words, word)? else { return Ok(None) };
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

    fn is_axis(&self, letter: u8) -> bool {
        self.data.settings.axes.find(letter).is_some()
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
