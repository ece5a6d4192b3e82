//! The words of a macro call to the locals they set.
use super::checked::ExecResult;
use super::evaluation::RoundingTarget;
use super::quantities::POWERS;
use super::registers::Registers;
use super::variables::{Locals, VACANT, Value};
use super::words::WordNumber;
use gcode_lang::alarm::Alarm;
use gcode_lang::control::ArgumentScale;
use gcode_lang::program::{ArgumentLocals, LoweredWord, WordOperand, Words};
use gcode_lang::syntax::ast::Decimal;

impl Registers {
    /// Words of a block, one by one in the order they stand in; a vacant value leaves its local vacant. `every` is
    /// G66.1, which takes G, L, N and P as well.
    pub(super) fn evaluate_arguments(
        &self,
        words: &Words,
        list: &[LoweredWord],
        is_every_block: bool,
    ) -> ExecResult<Locals> {
        let mut locals = VACANT;
        let mut letters = ArgumentLocals::new(self.data.settings.reads_ijk_plainly, is_every_block);
        for word in list {
            if word.comma {
                return Err(Alarm::ImproperAddress { letter: char::from(word.letter) }.located_at(word.span));
            }
            let local = letters.next(word.letter).map_err(|alarm| alarm.located_at(word.span))?;
            let Some(local) = local else { continue };
            if let Some(raw) = self.raw_argument(words, word)? {
                let decimals = self.argument_decimals(raw, word.letter);
                locals.set(local, Value::Number(self.argument_value(raw, word.letter)), decimals);
            }
        }
        Ok(locals)
    }

    /// The value of a word that is an argument of a macro.
    fn raw_argument(&self, words: &Words, word: &LoweredWord) -> ExecResult<Option<WordNumber>> {
        match word.value {
            WordOperand::Code(place) => {
                let value = self.run_code(words.code(place), RoundingTarget::Whole)?;
                Ok(value.as_number().map(WordNumber::Computed))
            }
            _ => self.evaluate_word(words, word),
        }
    }

    /// An argument of a macro call: computed values and points as they are, otherwise counted in the increments of
    /// the address (6007#4 CVA = 0).
    pub(super) fn argument_value(&self, raw: WordNumber, letter: u8) -> f64 {
        match raw {
            WordNumber::Computed(value) => value,
            WordNumber::Literal(number) => number.value() / POWERS[self.counted_decimals(raw, letter)],
        }
    }

    /// The decimals that ADP takes back from an argument: none with CVA 6007#4.
    fn argument_decimals(&self, raw: WordNumber, letter: u8) -> u8 {
        if self.data.settings.converts_arguments { 0 } else { self.counted_decimals(raw, letter) as u8 }
    }

    /// How many decimals an argument without a point has that counts the increments of its address.
    fn counted_decimals(&self, raw: WordNumber, letter: u8) -> usize {
        let WordNumber::Literal(Decimal { places: None, .. }) = raw else { return 0 };
        let scale = match letter {
            b'D' | b'G' | b'H' | b'L' | b'M' | b'N' | b'P' | b'S' | b'T' => ArgumentScale::Whole,
            b'E' => self.data.settings.undocumented.argument_e,
            b'F' => self.data.settings.undocumented.argument_f,
            _ => ArgumentScale::Increments,
        };
        match scale {
            ArgumentScale::Whole => 0,
            ArgumentScale::Feed => self.data.feed_decimals(&self.state),
            ArgumentScale::Increments if self.data.settings.uses_calculator_input => 0,
            ArgumentScale::Increments => self.data.decimals(letter, self.state.modal.unit),
        }
    }
}
