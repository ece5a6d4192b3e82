//! Calls by codes and addresses that parameters make calls of.
use super::Executor;
use super::eval::{Checked, at};
use super::frames::CallOrigins;
use super::plan::{BlockFlow, BlockPlan, CallKind, CallPlan, TableWrite, Target};
use super::vars::{VACANT, Value};
use super::words::{WordNumber, count};
use gcode_lang::alarm::Alarm;
use gcode_lang::control::{CalledProgram, CodeCallKind};
use gcode_lang::program::{LoweredWord, Words};

/// A word that calls a subprogram, taken out of its block.
#[derive(Clone, Copy, Debug)]
pub(super) struct CallingWord {
    /// Its place in the block.
    place: usize,
    /// Behind an M code L repeats the call.
    repeats: bool,
    program: u32,
    /// The common variable that gets the word's number.
    value: Option<(u32, f64)>,
}

impl CallingWord {
    /// Whether a word of the block belongs to the call and not to what acts first.
    pub(super) fn takes(&self, place: usize, word: &LoweredWord) -> bool {
        place == self.place || self.repeats && word.letter == b'L'
    }
}

impl Executor {
    /// A code that calls a macro: it stands first, and the block's other words are the arguments.
    pub(super) fn macro_by_code(&self, words: &Words, plan: &mut BlockPlan) -> Checked<bool> {
        for (place, word) in words.list.iter().enumerate() {
            let Some(called) = self.called_by(words, word)? else { continue };
            if called.kind == CodeCallKind::Subprogram {
                continue;
            }
            if place > 0 {
                let what = "words before a code that calls a macro".into();
                return Err(Alarm::MacroFormat { what }.at(words.list[0].span));
            }
            if let Some(second) = words.call() {
                return Err(Alarm::TwoMacroCalls.at(second.span));
            }
            let call = self.macro_call(called, words, word)?;
            plan.flow = BlockFlow::Call(Box::new(call));
            return Ok(true);
        }
        Ok(false)
    }

    fn macro_call(&self, called: CalledProgram, words: &Words, code: &LoweredWord) -> Checked<CallPlan> {
        let arguments = &words.list[1..];
        let every = called.kind == CodeCallKind::Modal && self.settings.code_calls.every_block;
        for word in arguments.iter().filter(|_| !every) {
            match word.letter {
                b'G' => return Err(Alarm::GAsArgument.at(word.span)),
                // An option of some controls makes an argument of it.
                b'P' => {
                    let what = "P as an argument of a code that calls a macro".into();
                    return Err(Alarm::NotSimulated { what }.at(word.span));
                }
                _ => {}
            }
        }
        let repeats = match arguments.iter().find(|word| word.letter == b'L') {
            Some(word) => self.coded_count(words, word)?.unwrap_or(1),
            None => 1,
        };
        let own = self.settings.unsure.every_block_calls_itself && !arguments.is_empty();
        Ok(CallPlan {
            kind: match called.kind {
                CodeCallKind::Modal if every => CallKind::EveryBlock,
                CodeCallKind::Modal => CallKind::Modal,
                CodeCallKind::Macro | CodeCallKind::Subprogram => CallKind::Macro,
            },
            target: Target::Number(called.program),
            repeats,
            start: None,
            locals: self.arguments(words, arguments, every)?,
            calls_now: !every || own,
            by_code: by_code(code.letter),
            external: false,
            span: code.span,
        })
    }

    /// The word of a block that calls a subprogram; the words beside it act first.
    pub(super) fn subprogram_by_code(&self, words: &Words) -> Checked<Option<CallingWord>> {
        let mut found = None;
        for (place, word) in words.list.iter().enumerate() {
            let Some(calling) = self.calling_word(words, place, word)? else { continue };
            if found.is_some() || words.call().is_some() {
                return Err(Alarm::TwoSubprogramCalls.at(word.span));
            }
            found = Some(calling);
        }
        Ok(found)
    }

    fn calling_word(&self, words: &Words, place: usize, word: &LoweredWord) -> Checked<Option<CallingWord>> {
        let by_address = self.settings.code_calls.by_address(word.letter);
        if let Some(call) =
            by_address.filter(|_| self.code_may_call(word.letter) && !self.is_axis(word.letter))
        {
            let Some(raw) = self.raw(words, word)? else { return Ok(None) };
            let number = match word.letter {
                b'B' | b'S' | b'T' => f64::from(at(count(raw, word.letter), word.span)?),
                letter => self.argument(raw, letter),
            };
            let value = Some((call.variable, number));
            return Ok(Some(CallingWord { place, repeats: false, program: call.program, value }));
        }
        let called = self.called_by(words, word)?;
        let called = called.filter(|called| called.kind == CodeCallKind::Subprogram);
        Ok(called.map(|called| CallingWord { place, repeats: true, program: called.program, value: None }))
    }

    /// The call that a word has made a plan of, with its repetitions.
    pub(super) fn plan_calling_word(
        &self,
        words: &Words,
        calling: &CallingWord,
        plan: &mut BlockPlan,
    ) -> Checked<()> {
        let word = &words.list[calling.place];
        let repeats = match words.list.iter().find(|other| calling.repeats && other.letter == b'L') {
            Some(word) => self.coded_count(words, word)?.unwrap_or(1),
            None => 1,
        };
        if let Some((number, value)) = calling.value {
            plan.writes.push(TableWrite::Variable { number, value: Value::Number(value) });
        }
        plan.flow = BlockFlow::Call(Box::new(CallPlan {
            kind: CallKind::Subprogram,
            target: Target::Number(calling.program),
            repeats,
            start: None,
            locals: VACANT,
            calls_now: true,
            by_code: by_code(word.letter),
            external: false,
            span: word.span,
        }));
        Ok(())
    }

    /// What a G or M code calls here; inside a program that a code called it is an ordinary one.
    fn called_by(&self, words: &Words, word: &LoweredWord) -> Checked<Option<CalledProgram>> {
        if !matches!(word.letter, b'G' | b'M') || !self.code_may_call(word.letter) {
            return Ok(None);
        }
        let Some(raw) = self.raw(words, word)? else { return Ok(None) };
        let tenths = match (word.letter, raw) {
            (b'G', WordNumber::Computed(value)) => (value * 10.0).round(),
            (b'G', WordNumber::Literal(number)) => number.value() * 10.0,
            _ => 10.0 * f64::from(at(count(raw, b'M'), word.span)?),
        };
        let code = (0.0..=f64::from(u32::MAX)).contains(&tenths).then_some(tenths as u32);
        Ok(code.and_then(|code| self.settings.code_calls.find(word.letter, code)))
    }

    fn code_may_call(&self, letter: u8) -> bool {
        self.frame.by_code.allows_call(letter == b'G', self.settings.code_calls.inside_others)
    }

    fn is_axis(&self, letter: u8) -> bool {
        self.settings.axes.find(letter).is_some()
    }
}

fn by_code(letter: u8) -> CallOrigins {
    CallOrigins { g: letter == b'G', other: letter != b'G' }
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
