//! The words of the block at hand, evaluated: what is vacant is not there, and numbers become something only where
//! the block asks for them.
use std::cell::Cell;

use super::checked::{ExecResult, integer, locate};
use gcode_lang::alarm::Alarm;
use gcode_lang::control::{Dialect, Settings};
use gcode_lang::program::code_facts::Letters;
use gcode_lang::program::g_codes::{Effect, GCodeRow};
use gcode_lang::program::modes::Motion;
use gcode_lang::program::{LoweredWord, g_codes, m_codes};
use gcode_lang::source::Span;
use gcode_lang::syntax::ast::Decimal;
use gcode_lang::units::round;

/// The value of a word before anything is made of it.
#[derive(Clone, Copy, Debug)]
pub(super) enum WordNumber {
    Literal(Decimal),
    Computed(f64),
}

impl WordNumber {
    /// The number that stands there, whatever it is at its address.
    pub(super) fn value(self) -> f64 {
        match self {
            Self::Literal(number) => number.value(),
            Self::Computed(value) => value,
        }
    }
}

/// Letters as bits, A the lowest.
pub(super) const fn letters(some: &[u8]) -> u32 {
    let (mut bits, mut place) = (0, 0);
    while place < some.len() {
        bits |= 1 << (some[place] - b'A');
        place += 1;
    }
    bits
}

pub(super) const G_CODES: usize = 12;

const M_CODES: usize = 3;

/// The words of a block by letter. Kept between blocks and cleared by its mask, so that it costs nothing.
#[derive(Clone, Debug)]
pub(super) struct BlockWords {
    pub(super) present_letters: u32,
    /// The letters whose value somebody has asked for.
    read_letters: Cell<u32>,
    pub(super) values: [(WordNumber, Span); 26],
    g_rows: [Option<&'static GCodeRow>; G_CODES],
    g_count: usize,
    /// The last code of group 01.
    pub(super) motion: Option<Motion>,
    /// A G code stands in the block that is not of group 01.
    has_other_g_codes: bool,
    pub(super) m_codes: [Option<(u32, Span)>; M_CODES],
    pub(super) m_code_count: usize,
    /// `,R` or `,C`.
    pub(super) corner: Option<(u8, WordNumber, Span)>,
    /// M codes that a later one of the block has replaced.
    pub(super) replaced_m_codes: Vec<u32>,
    /// The value in the comment of `G10 L85`.
    pub(super) punched_value: Option<u64>,
}

impl Default for BlockWords {
    fn default() -> Self {
        Self {
            present_letters: 0,
            read_letters: Cell::new(0),
            values: [(WordNumber::Computed(0.0), Span::default()); 26],
            g_rows: [None; G_CODES],
            g_count: 0,
            motion: None,
            has_other_g_codes: false,
            m_codes: [None; M_CODES],
            m_code_count: 0,
            corner: None,
            replaced_m_codes: Vec::new(),
            punched_value: None,
        }
    }
}

impl BlockWords {
    /// As before the first block.
    pub(super) fn clear(&mut self) {
        self.present_letters = 0;
        self.read_letters.set(0);
        self.g_count = 0;
        self.motion = None;
        self.has_other_g_codes = false;
        self.m_code_count = 0;
        self.corner = None;
        self.replaced_m_codes.clear();
        self.punched_value = None;
    }

    /// `,R` or `,C`.
    pub(super) fn put_corner(&mut self, word: &LoweredWord, raw: WordNumber) -> Result<(), Alarm> {
        if word.letter == b'A' {
            return Err(Alarm::NotSimulated { what: "direct drawing dimensions (,A)".into() });
        }
        if !matches!(word.letter, b'R' | b'C') || self.corner.is_some() {
            return Err(Alarm::CornerWords);
        }
        self.corner = Some((word.letter, raw, word.span));
        Ok(())
    }

    pub(super) fn put_g(&mut self, row: &'static GCodeRow) -> Result<(), Alarm> {
        if self.g_count == G_CODES {
            return Err(Alarm::MacroFormat { what: "too many G codes in one block".into() });
        }
        self.g_rows[self.g_count] = Some(row);
        self.g_count += 1;
        match row.effect {
            Effect::Motion(motion) => self.motion = Some(motion),
            _ => self.has_other_g_codes = true,
        }
        Ok(())
    }

    /// Without M3B the last M code of a block counts; a stop or an end isn't lost in silence.
    pub(super) fn put_m(&mut self, code: u32, span: Span, settings: &Settings) -> Result<(), Alarm> {
        let max = if settings.allows_three_m_codes { M_CODES } else { 1 };
        let place = self.m_code_count.min(max - 1);
        if self.m_code_count == max
            && let Some((first, _)) = self.m_codes[place]
        {
            if m_codes::ends_or_stops(first) || settings.plural_m_alarms {
                return Err(Alarm::PluralM { first, second: code });
            }
            self.replaced_m_codes.push(first);
        }
        self.m_codes[place] = Some((code, span));
        self.m_code_count = place + 1;
        Ok(())
    }

    pub(super) fn has(&self, letter: u8) -> bool {
        self.present_letters >> (letter - b'A') & 1 == 1
    }

    /// Whether it has one of some [`letters`].
    pub(super) fn has_letters(&self, letters: u32) -> bool {
        self.present_letters & letters != 0
    }

    #[inline]
    pub(super) fn has_any(&self, some: &[u8]) -> bool {
        self.has_letters(letters(some))
    }

    /// The first of some [`letters`], in the order of the alphabet, that it has.
    pub(super) fn first_letter_of(&self, letters: u32) -> Option<u8> {
        let some = self.present_letters & letters;
        (some != 0).then(|| b'A' + some.trailing_zeros() as u8)
    }

    /// Whether a G code stands in it that is not of group 01.
    pub(super) fn has_non_motion_words(&self) -> bool {
        self.has_other_g_codes
    }

    /// The value of a word, which is asked for with this.
    pub(super) fn get(&self, letter: u8) -> Option<(WordNumber, Span)> {
        self.read_letters.set(self.read_letters.get() | 1 << (letter - b'A'));
        self.has(letter).then(|| self.values[usize::from(letter - b'A')])
    }

    /// Words that the block may have and that change nothing here.
    pub(super) fn mark_read(&self, letters: &[u8]) {
        for letter in letters {
            self.get(*letter);
        }
    }

    /// As [`BlockWords::mark_read`].
    pub(super) fn mark_letters_read(&self, letters: Letters) {
        self.read_letters.set(self.read_letters.get() | letters.bits());
    }

    /// The letters that are refused without one of its codes, as bits.
    pub(super) fn letters_of_codes(&self) -> u32 {
        if !self.has_other_g_codes {
            return 0;
        }
        self.g_codes().fold(0, |letters, row| letters | row.facts.words.own.bits())
    }

    /// The first word, by its letter, that nothing in the block had a use for.
    pub(super) fn first_unread(&self) -> Option<(char, Span)> {
        let letter = self.first_letter_of(!self.read_letters.get())?;
        Some((char::from(letter), self.span(letter)))
    }

    /// Whether it has `,R` or `,C`.
    pub(super) fn has_corner(&self) -> bool {
        self.corner.is_some()
    }

    pub(super) fn span(&self, letter: u8) -> Span {
        self.values[usize::from(letter - b'A')].1
    }

    pub(super) fn g_codes(&self) -> impl Iterator<Item = &'static GCodeRow> + '_ {
        self.g_rows[..self.g_count].iter().flatten().copied()
    }

    /// Whether the block has a G code of an effect; those of group 01 are not asked.
    #[inline(always)]
    pub(super) fn has_non_motion_code(&self, predicate: impl Fn(Effect) -> bool) -> bool {
        self.has_other_g_codes && self.g_codes().any(|row| predicate(row.effect))
    }

    /// A count or a number: no point, no minus; a computed value is rounded.
    pub(super) fn count(&self, letter: u8) -> ExecResult<Option<u32>> {
        let Some((raw, span)) = self.get(letter) else { return Ok(None) };
        locate(count(raw, letter), span).map(Some)
    }
}

/// A value where only a whole number may stand.
pub(super) fn count(raw: WordNumber, letter: u8) -> Result<u32, Alarm> {
    let letter = char::from(letter);
    let number = match raw {
        WordNumber::Literal(number) if number.places.is_some() => {
            return Err(Alarm::IllegalPoint { letter: Some(letter) });
        }
        WordNumber::Literal(number) if number.negative && number.digits > 0 => {
            return Err(Alarm::IllegalMinus { letter });
        }
        WordNumber::Literal(number) => i64::try_from(number.digits).map_err(|_| Alarm::TooManyDigits)?,
        WordNumber::Computed(value) => integer(value)?,
    };
    if number < 0 {
        return Err(Alarm::IllegalMinus { letter });
    }
    // Operator's manual, range of command values: eight digits, S five.
    let max = if letter == 'S' { 99_999 } else { 99_999_999 };
    if number > max { Err(Alarm::TooManyDigits) } else { Ok(number as u32) }
}

/// The row of a G code that is computed.
pub(super) fn computed_row(raw: WordNumber, dialect: Dialect) -> Result<&'static GCodeRow, Alarm> {
    let value = match raw {
        WordNumber::Computed(value) => value,
        WordNumber::Literal(number) => return Err(Alarm::ImproperGCode { code: number.value().to_string() }),
    };
    // A computed code keeps one decimal.
    let tenths = round(value * 10.0);
    if !(0.0..=9999.0).contains(&tenths) {
        return Err(Alarm::ImproperGCode { code: value.to_string() });
    }
    let code = tenths as u32;
    g_codes::find(code).row_for(dialect).ok_or_else(|| Alarm::ImproperGCode { code: g_codes::spelled(code) })
}

/// A word that calls a subprogram, taken out of its block.
#[derive(Clone, Copy, Debug)]
pub(super) struct CallingWord {
    /// Its place in the block.
    pub(super) index: usize,
    /// Behind an M code L repeats the call.
    pub(super) takes_repeats: bool,
    pub(super) program: u32,
    /// The common variable that gets the word's number.
    pub(super) value: Option<(u32, f64)>,
}

impl CallingWord {
    /// Whether a word of the block belongs to the call and not to what acts first.
    pub(super) fn contains(&self, place: usize, word: &LoweredWord) -> bool {
        place == self.index || self.takes_repeats && word.letter == b'L'
    }
}
