//! Evaluated words of the current block. Words with vacant values are absent; increments and units are applied when a word
//! is read.
use std::cell::Cell;

use super::functions::{ExecResult, integer, locate};
use gcode_lang::alarm::{Alarm, DigitLimit};
use gcode_lang::control::Settings;
use gcode_lang::program::code_facts::Letters;
use gcode_lang::program::g_codes::{Effect, GCodeRow};
use gcode_lang::program::modes::Motion;
use gcode_lang::program::{LoweredWord, g_codes, m_codes};
use gcode_lang::source::Span;
use gcode_lang::syntax::ast::Decimal;
use gcode_lang::units::round;

/// Number of a word before its increment and unit are applied.
#[derive(Clone, Copy, Debug)]
pub(super) enum WordNumber {
    Literal(Decimal),
    Computed(f64),
}

impl Default for WordNumber {
    fn default() -> Self {
        Self::Computed(0.0)
    }
}

impl WordNumber {
    /// Returns the number as written or computed.
    pub(super) fn value(self) -> f64 {
        match self {
            Self::Literal(number) => number.value(),
            Self::Computed(value) => value,
        }
    }
}

/// Function of `,A`, which is not simulated.
pub(super) const DIRECT_DRAWING: &str = "direct drawing dimensions (,A)";

/// Largest number of G codes in a block: more than there are modal groups.
pub(super) const MAX_G_CODES: usize = 32;

/// Words of a block by letter. They are kept between blocks, and the mask of letters is all that is cleared of the values.
#[derive(Clone, Debug, Default)]
pub(super) struct BlockWords {
    pub(super) present_letters: u32,
    /// Letters whose value has been read.
    used_letters: Cell<u32>,
    pub(super) values: [(WordNumber, Span); 26],
    g_rows: Vec<&'static GCodeRow>,
    /// Last code of group 01.
    pub(super) motion: Option<Motion>,
    /// The block has a G code outside group 01.
    pub(super) has_other_g_codes: bool,
    pub(super) m_codes: Vec<(u32, Span)>,
    /// `,R` or `,C`.
    pub(super) corner: Option<(u8, WordNumber, Span)>,
    /// M codes that a later one of the block has replaced.
    pub(super) replaced_m_codes: Vec<u32>,
    /// Value in the comment of `G10 L85`.
    pub(super) punched_value: Option<u64>,
    /// Number of characters in the comment beside G47.
    pub(super) comment_length: Option<u32>,
}

impl BlockWords {
    pub(super) fn clear(&mut self) {
        self.present_letters = 0;
        self.used_letters.set(0);
        self.g_rows.clear();
        self.m_codes.clear();
        self.replaced_m_codes.clear();
        (self.motion, self.corner, self.punched_value) = (None, None, None);
        self.comment_length = None;
        self.has_other_g_codes = false;
    }

    /// Adds `,R` or `,C`.
    pub(super) fn put_corner(&mut self, word: &LoweredWord, raw: WordNumber) -> Result<(), Alarm> {
        if word.letter == b'A' {
            return Err(Alarm::NotSimulated { what: DIRECT_DRAWING.into() });
        }
        if !matches!(word.letter, b'R' | b'C') || self.corner.is_some() {
            return Err(Alarm::CornerWords);
        }
        self.corner = Some((word.letter, raw, word.span));
        Ok(())
    }

    pub(super) fn put_g(&mut self, row: &'static GCodeRow) -> Result<(), Alarm> {
        if self.g_rows.len() == MAX_G_CODES {
            let what = format!("more than {MAX_G_CODES} G codes in a block");
            return Err(Alarm::NotSimulated { what });
        }
        self.g_rows.push(row);
        match row.effect {
            Effect::Motion(motion) => self.motion = Some(motion),
            _ => self.has_other_g_codes = true,
        }
        Ok(())
    }

    /// Adds an M code. Without M3B it replaces the one before; a stop or an end raises an alarm instead.
    pub(super) fn put_m(&mut self, code: u32, span: Span, settings: &Settings) -> Result<(), Alarm> {
        let max = if settings.allows_three_m_codes { 3 } else { 1 };
        if self.m_codes.len() == max
            && let Some((first, _)) = self.m_codes.pop()
        {
            if m_codes::ends_or_stops(first) || settings.plural_m_alarms {
                return Err(Alarm::PluralM { first, second: code });
            }
            self.replaced_m_codes.push(first);
        }
        self.m_codes.push((code, span));
        Ok(())
    }

    pub(super) fn has(&self, letter: u8) -> bool {
        self.present_letters >> (letter - b'A') & 1 == 1
    }

    /// Returns true if the block has one of some letters, as bits.
    pub(super) fn has_letters(&self, letters: u32) -> bool {
        self.present_letters & letters != 0
    }

    #[inline]
    pub(super) fn has_any(&self, some: &[u8]) -> bool {
        self.has_letters(Letters::of(some).bits())
    }

    /// Returns the first of some letters, as bits, in the order of the alphabet, that the block has.
    pub(super) fn first_present(&self, letters: u32) -> Option<u8> {
        let some = self.present_letters & letters;
        (some != 0).then(|| b'A' + some.trailing_zeros() as u8)
    }

    /// Returns the value of a word and marks it as read.
    pub(super) fn get(&self, letter: u8) -> Option<(WordNumber, Span)> {
        self.used_letters.set(self.used_letters.get() | 1 << (letter - b'A'));
        self.has(letter).then(|| self.values[usize::from(letter - b'A')])
    }

    /// Returns true if the block has one of some letters whose value nothing has read.
    pub(super) fn has_unread(&self, some: &[u8]) -> bool {
        self.has_letters(Letters::of(some).bits() & !self.used_letters.get())
    }

    /// Marks words without effect as read.
    pub(super) fn mark_read(&self, letters: Letters) {
        self.used_letters.set(self.used_letters.get() | letters.bits());
    }

    /// Returns the letters that only the codes of the block allow, as bits.
    pub(super) fn letters_of_codes(&self) -> u32 {
        if !self.has_other_g_codes {
            return 0;
        }
        self.g_codes().fold(0, |letters, row| letters | row.facts.words.own.bits())
    }

    /// Returns the first word, by its letter, that has not been read.
    pub(super) fn first_unused_word(&self) -> Option<(char, Span)> {
        let letter = self.first_present(!self.used_letters.get())?;
        Some((char::from(letter), self.span(letter)))
    }

    pub(super) fn span(&self, letter: u8) -> Span {
        self.values[usize::from(letter - b'A')].1
    }

    pub(super) fn g_codes(&self) -> impl Iterator<Item = &'static GCodeRow> + '_ {
        self.g_rows.iter().copied()
    }

    /// Returns true if a G code outside group 01 has an effect that satisfies a predicate.
    #[inline(always)]
    pub(super) fn has_non_motion_code(&self, predicate: impl Fn(Effect) -> bool) -> bool {
        self.has_other_g_codes && self.g_codes().any(|row| predicate(row.effect))
    }

    /// Returns the value of a word that is a count, see [`count`].
    pub(super) fn count(&self, letter: u8) -> ExecResult<Option<u32>> {
        let Some((raw, span)) = self.get(letter) else { return Ok(None) };
        locate(count(raw, letter), span).map(Some)
    }
}

/// Returns a value as a count: no point, no minus; a computed value is rounded.
pub(super) fn count(raw: WordNumber, letter: u8) -> Result<u32, Alarm> {
    let letter = char::from(letter);
    let number = match raw {
        WordNumber::Literal(number) if number.places.is_some() => {
            return Err(Alarm::IllegalPoint { letter: Some(letter) });
        }
        WordNumber::Literal(number) if number.negative && number.digits > 0 => {
            return Err(Alarm::IllegalMinus { letter });
        }
        WordNumber::Literal(number) => i64::try_from(number.digits).unwrap_or(i64::MAX),
        WordNumber::Computed(value) => integer(value)?,
    };
    if number < 0 {
        return Err(Alarm::IllegalMinus { letter });
    }
    // Operator's manual, range of command values: eight digits, S five.
    let digits: u8 = if letter == 'S' { 5 } else { 8 };
    if number >= 10_i64.pow(digits.into()) {
        return Err(Alarm::TooManyDigits(DigitLimit::Written(digits)));
    }
    Ok(number as u32)
}

/// Returns the row of a computed G code.
pub(super) fn computed_row(raw: WordNumber, settings: &Settings) -> Result<&'static GCodeRow, Alarm> {
    let value = match raw {
        WordNumber::Computed(value) => value,
        WordNumber::Literal(number) => {
            return Err(Alarm::ImproperGCode { code: number.value().to_string(), other: None });
        }
    };
    // A computed code is rounded to one decimal.
    let tenths = round(value * 10.0);
    if tenths < 0.0 {
        return Err(Alarm::IllegalMinus { letter: 'G' });
    }
    if !(0.0..=9999.0).contains(&tenths) {
        return Err(Alarm::ImproperGCode { code: value.to_string(), other: None });
    }
    let code = tenths as u32;
    let row = g_codes::row_on(code, g_codes::find(code), settings);
    row.ok_or_else(|| g_codes::improper(code))
}

/// Word that calls a subprogram.
#[derive(Clone, Copy, Debug)]
pub(super) struct CallingWord {
    /// Index in the block.
    pub(super) index: usize,
    /// L repeats the call, as with an M code.
    pub(super) takes_repeats: bool,
    pub(super) program: u32,
    /// Common variable that gets the word's number.
    pub(super) value: Option<(u32, f64)>,
}

impl CallingWord {
    /// Returns true if a word of the block belongs to the call.
    pub(super) fn contains(&self, index: usize, word: &LoweredWord) -> bool {
        index == self.index || self.takes_repeats && word.letter == b'L'
    }
}
