//! The values of the words of a block.
use super::checked::{ExecResult, locate};
use super::evaluation::RoundingTarget;
use super::registers::Registers;
use super::variables::Value;
use super::words::{BlockWords, CallingWord, WordNumber, computed_row, count};
use gcode_lang::alarm::Alarm;
use gcode_lang::program::{LoweredWord, WordOperand, Words, g_codes};
use gcode_lang::source::Span;

impl Registers {
    pub(super) fn count_of_word(&self, words: &Words, word: &LoweredWord) -> ExecResult<Option<u32>> {
        let Some(raw) = self.evaluate_word(words, word)? else { return Ok(None) };
        locate(count(raw, word.letter), word.span).map(Some)
    }

    /// Evaluates every word of a block into `given`, but for those that belong to a call.
    pub(super) fn evaluate_words(
        &self,
        words: &Words,
        calling: Option<&CallingWord>,
        block_words: &mut BlockWords,
    ) -> ExecResult<()> {
        block_words.clear();
        block_words.punched_value = words.punched_value();
        match calling {
            None => words.list.iter().try_for_each(|word| self.evaluate_into(words, word, block_words)),
            Some(calling) => {
                let mut others =
                    words.list.iter().enumerate().filter(|(place, word)| !calling.contains(*place, word));
                others.try_for_each(|(_, word)| self.evaluate_into(words, word, block_words))
            }
        }
    }

    /// Evaluates a word and puts it to those of its block.
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
                let row = found.row_for(self.data.settings.codes);
                let improper =
                    || Alarm::ImproperGCode { code: g_codes::spelled(*code) }.located_at(word.span);
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

    /// Puts a word that is more than a value at an address to those of its block.
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
        let letter = match word.axis.and_then(|place| words.axis(place)) {
            Some(axis) => {
                let number = self.operand(axis)?.number();
                self.data.settings.axes.letter(locate(self.data.axis_of(number), word.span)?) as u8
            }
            None => word.letter,
        };
        match letter {
            b'G' => {
                let row = locate(computed_row(raw, self.data.settings.codes), word.span)?;
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

    /// The value of a word, or `None` where it is vacant and the word therefore not there.
    #[inline]
    pub(super) fn evaluate_word(&self, words: &Words, word: &LoweredWord) -> ExecResult<Option<WordNumber>> {
        match &word.value {
            WordOperand::Literal(number) => Ok(Some(WordNumber::Literal(*number))),
            value => Ok(self.evaluate_operand(words, value)?.as_number().map(WordNumber::Computed)),
        }
    }

    /// What a value behind an address is that is more than a literal.
    #[inline(always)]
    pub(super) fn evaluate_operand(&self, words: &Words, value: &WordOperand) -> ExecResult<Value> {
        match value {
            WordOperand::Variable { slot, span } => self.load(*slot, span),
            WordOperand::Code(place) => self.run_code(words.code(*place), RoundingTarget::Increment),
            WordOperand::Number(number) => Ok(Value::Number(*number)),
            WordOperand::G(code, _) => Ok(Value::Number(f64::from(*code) / 10.0)),
            WordOperand::Literal(number) => Ok(Value::Number(number.value())),
        }
    }
}
