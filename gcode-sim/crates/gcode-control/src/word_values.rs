//! Values of the words of a block, and of the words of a macro call as arguments.
use super::evaluation::RoundingTarget;
use super::functions::{ExecResult, locate};
use super::registers::Registers;
use super::variables::{Locals, VACANT, Value};
use super::words::{BlockWords, CallingWord, WordNumber, computed_row, count};
use gcode_lang::alarm::Alarm;
use gcode_lang::control::ArgumentScale;
use gcode_lang::program::{ArgumentLocals, LoweredWord, WordOperand, Words, g_codes};
use gcode_lang::source::Span;
use gcode_lang::syntax::ast::Decimal;
use gcode_lang::units::POWERS;

impl Registers {
    /// Returns the count of a word; `None` without the word or with a vacant value.
    pub(super) fn count_of_word(&self, words: &Words, word: Option<&LoweredWord>) -> ExecResult<Option<u32>> {
        let Some(word) = word else { return Ok(None) };
        let Some(raw) = self.evaluate_word(words, word)? else { return Ok(None) };
        locate(count(raw, word.letter), word.span).map(Some)
    }

    /// Evaluates every word of a block except those of a call.
    pub(super) fn evaluate_words(
        &self,
        words: &Words,
        calling: Option<&CallingWord>,
        block_words: &mut BlockWords,
    ) -> ExecResult<()> {
        block_words.clear();
        block_words.punched_value = words.punched_value();
        block_words.comment_length = words.comment_length();
        for (index, word) in words.list.iter().enumerate() {
            if !calling.is_some_and(|calling| calling.contains(index, word)) {
                self.evaluate_into(words, word, block_words)?;
            }
        }
        Ok(())
    }

    /// Evaluates a word and adds it to those of its block.
    #[inline(always)]
    fn evaluate_into(
        &self,
        words: &Words,
        word: &LoweredWord,
        block_words: &mut BlockWords,
    ) -> ExecResult<()> {
        let raw = match &word.value {
            WordOperand::Literal(number) => WordNumber::Literal(*number),
            WordOperand::G(code, found) if !word.comma => {
                let row = g_codes::row_on(*code, *found, &self.data.settings);
                let improper = || g_codes::improper(*code).located_at(word.span);
                return locate(block_words.put_g(row.ok_or_else(improper)?), word.span);
            }
            value => match self.evaluate_operand(words, value)? {
                Value::Number(value) => WordNumber::Computed(value),
                Value::Vacant => return Ok(()),
            },
        };
        if word.comma || word.axis.is_some() || matches!(word.letter, b'G' | b'M') {
            return self.put(words, word, raw, block_words);
        }
        self.put_value(word.letter, word.span, raw, block_words)
    }

    /// Adds a word that isn't a simple value at an address to those of its block.
    #[inline(never)]
    fn put(
        &self,
        words: &Words,
        word: &LoweredWord,
        raw: WordNumber,
        block_words: &mut BlockWords,
    ) -> ExecResult<()> {
        if word.comma {
            return locate(block_words.put_corner(word, raw), word.span);
        }
        let letter = match word.axis.and_then(|index| words.axis(index)) {
            Some(axis) => {
                let number = self.operand(axis)?.number();
                self.data.settings.axes.letter(locate(self.data.axis_of(number), word.span)?) as u8
            }
            None => word.letter,
        };
        match letter {
            b'G' => {
                let row = locate(computed_row(raw, &self.data.settings), word.span)?;
                locate(block_words.put_g(row), word.span)
            }
            b'M' => {
                let code = locate(count(raw, b'M'), word.span)?;
                locate(block_words.put_m(code, word.span, &self.data.settings), word.span)
            }
            letter => self.put_value(letter, word.span, raw, block_words),
        }
    }

    #[inline(always)]
    fn put_value(
        &self,
        letter: u8,
        span: Span,
        raw: WordNumber,
        block_words: &mut BlockWords,
    ) -> ExecResult<()> {
        if self.data.settings.alarms_on_repeated_address && block_words.has(letter) {
            return Err(Alarm::RepeatedAddress { letter: char::from(letter) }.located_at(span));
        }
        block_words.present_letters |= 1 << (letter - b'A');
        block_words.values[usize::from(letter - b'A')] = (raw, span);
        Ok(())
    }

    /// Returns the number of a word; `None` for a vacant value, with which the word counts as absent.
    #[inline]
    pub(super) fn evaluate_word(&self, words: &Words, word: &LoweredWord) -> ExecResult<Option<WordNumber>> {
        match &word.value {
            WordOperand::Literal(number) => Ok(Some(WordNumber::Literal(*number))),
            value => Ok(self.evaluate_operand(words, value)?.as_number().map(WordNumber::Computed)),
        }
    }

    #[inline(always)]
    pub(super) fn evaluate_operand(&self, words: &Words, value: &WordOperand) -> ExecResult<Value> {
        match value {
            WordOperand::Variable { slot, span } => self.load(*slot, span),
            WordOperand::Code(index) => self.run_code(words.code(*index), RoundingTarget::Increment),
            WordOperand::Number(number) => Ok(Value::Number(*number)),
            WordOperand::G(code, _) => Ok(Value::Number(f64::from(*code) / 10.0)),
            WordOperand::Literal(number) => Ok(Value::Number(number.value())),
        }
    }

    /// Returns the locals that words set as arguments, in the order written; a vacant value leaves its local vacant. G66.1
    /// (`is_every_block`) also takes G, L, N and P.
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
                // CVA (6007#4) leaves no decimals for ADP to restore.
                let is_converted = self.data.settings.converts_arguments;
                let decimals = if is_converted { 0 } else { self.counted_decimals(raw, word.letter) as u8 };
                locals.set(local, Value::Number(self.argument_value(raw, word.letter)), decimals);
            }
        }
        Ok(locals)
    }

    /// Returns the number of a word as an argument of a macro.
    fn raw_argument(&self, words: &Words, word: &LoweredWord) -> ExecResult<Option<WordNumber>> {
        match word.value {
            WordOperand::Code(index) => {
                let value = self.run_code(words.code(index), RoundingTarget::Whole)?;
                Ok(value.as_number().map(WordNumber::Computed))
            }
            _ => self.evaluate_word(words, word),
        }
    }

    /// Returns the value of an argument: without a point a literal counts increments of its address (6007#4 CVA = 0).
    pub(super) fn argument_value(&self, raw: WordNumber, letter: u8) -> f64 {
        match raw {
            WordNumber::Computed(value) => value,
            WordNumber::Literal(number) => number.value() / POWERS[self.counted_decimals(raw, letter)],
        }
    }

    /// Returns the number of decimals of an argument without a point that counts the increments of its address.
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
