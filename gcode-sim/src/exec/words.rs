//! The words of the block at hand, evaluated: what is vacant is not there, and numbers become lengths, angles,
//! times or counts only where the block asks for them.
use std::cell::Cell;

use super::Core;
use super::code_calls::CallingWord;
use super::eval::{Checked, at, integer};
use super::state::State;
use crate::alarm::Alarm;
use crate::contour::Blend;
use crate::control::{ArgumentScale, CodeSet};
use crate::program::codes::{self, Row};
use crate::program::m_codes;
use crate::program::modes::{FeedMode, Unit};
use crate::program::{Coded, Input, Program, Words};
use crate::source::Span;
use crate::syntax::ast::Decimal;
use crate::units::nearest;

/// The value of a word before anything is made of it.
#[derive(Clone, Copy, Debug)]
pub(super) enum Raw {
    Literal(Decimal),
    Computed(f64),
}

const G_CODES: usize = 12;
const M_CODES: usize = 3;

/// The words of a block by letter. Kept between blocks and cleared by its mask, so that it costs nothing.
#[derive(Clone, Debug)]
pub(super) struct Given {
    present: u32,
    /// The letters whose value somebody has asked for.
    read: Cell<u32>,
    values: [(Raw, Span); 26],
    g: [Option<&'static Row>; G_CODES],
    g_count: usize,
    pub(super) m: [Option<(u32, Span)>; M_CODES],
    pub(super) m_count: usize,
    /// `,R` or `,C`.
    corner: Option<(u8, Raw, Span)>,
    /// An M code that a later one of the block has replaced.
    pub(super) lost_m: Option<u32>,
    /// The value in the comment of `G10 L85`.
    pub(super) punched: Option<u64>,
}

impl Default for Given {
    fn default() -> Self {
        Self {
            present: 0,
            read: Cell::new(0),
            values: [(Raw::Computed(0.0), Span::default()); 26],
            g: [None; G_CODES],
            g_count: 0,
            m: [None; M_CODES],
            m_count: 0,
            corner: None,
            lost_m: None,
            punched: None,
        }
    }
}

const POWERS: [f64; 8] = [1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7];

impl Given {
    pub(super) fn has(&self, letter: u8) -> bool {
        self.present >> (letter - b'A') & 1 == 1
    }

    pub(super) fn has_any(&self, letters: &[u8]) -> bool {
        letters.iter().any(|letter| self.has(*letter))
    }

    fn get(&self, letter: u8) -> Option<(Raw, Span)> {
        self.read.set(self.read.get() | 1 << (letter - b'A'));
        self.has(letter).then(|| self.values[usize::from(letter - b'A')])
    }

    /// Words that the block may have and that change nothing here.
    pub(super) fn accept(&self, letters: &[u8]) {
        for letter in letters {
            self.get(*letter);
        }
    }

    /// The first word, by its letter, that nothing in the block had a use for.
    pub(super) fn unread(&self) -> Option<(char, Span)> {
        let left = self.present & !self.read.get();
        let letter = (left != 0).then(|| b'A' + left.trailing_zeros() as u8)?;
        Some((char::from(letter), self.span(letter)))
    }

    /// A word's value before anything is made of it.
    pub(super) fn raw(&self, letter: u8) -> Option<Raw> {
        self.get(letter).map(|(raw, _)| raw)
    }

    /// Whether it has `,R` or `,C`.
    pub(super) fn has_corner(&self) -> bool {
        self.corner.is_some()
    }

    pub(super) fn span(&self, letter: u8) -> Span {
        self.values[usize::from(letter - b'A')].1
    }

    pub(super) fn g_codes(&self) -> impl Iterator<Item = &'static Row> + '_ {
        self.g[..self.g_count].iter().flatten().copied()
    }

    /// A count or a number: no point, no minus; a computed value is rounded.
    pub(super) fn count(&self, letter: u8) -> Checked<Option<u32>> {
        let Some((raw, span)) = self.get(letter) else { return Ok(None) };
        at(count(raw, letter), span).map(Some)
    }
}

/// A value where only a whole number may stand.
pub(super) fn count(raw: Raw, letter: u8) -> Result<u32, Alarm> {
    let letter = char::from(letter);
    let number = match raw {
        Raw::Literal(number) if number.places.is_some() => {
            return Err(Alarm::IllegalPoint { letter: Some(letter) });
        }
        Raw::Literal(number) if number.negative && number.digits > 0 => {
            return Err(Alarm::IllegalMinus { letter });
        }
        Raw::Literal(number) => i64::try_from(number.digits).map_err(|_| Alarm::TooManyDigits)?,
        Raw::Computed(value) => integer(value)?,
    };
    if number < 0 {
        return Err(Alarm::IllegalMinus { letter });
    }
    // Operator's manual, range of command values: eight digits, S five.
    let most = if letter == 'S' { 99_999 } else { 99_999_999 };
    if number > most { Err(Alarm::TooManyDigits) } else { Ok(number as u32) }
}

impl Core {
    /// Evaluates every word of a block into `given`, but for those that belong to a call.
    pub(super) fn collect(
        &self,
        program: &Program,
        words: &Words,
        calling: Option<&CallingWord>,
        given: &mut Given,
    ) -> Checked<()> {
        given.present = 0;
        given.read.set(0);
        given.g_count = 0;
        given.m_count = 0;
        given.lost_m = None;
        given.punched = words.punched;
        given.corner = None;
        for (place, word) in words.list.iter().enumerate() {
            if calling.is_some_and(|calling| calling.takes(place, word)) {
                continue;
            }
            let Some(raw) = self.raw(program, word)? else { continue };
            if word.comma {
                if word.letter == b'A' {
                    let what = "direct drawing dimensions (,A)".into();
                    return Err(Alarm::NotSimulated { what }.at(word.span));
                }
                if !matches!(word.letter, b'R' | b'C') || given.corner.is_some() {
                    return Err(Alarm::CornerWords.at(word.span));
                }
                given.corner = Some((word.letter, raw, word.span));
                continue;
            }
            let letter = match word.axis {
                Some(axis) => {
                    let number = self.operand(program, axis)?.number();
                    self.settings.axes.letter(at(self.axis_of(number), word.span)?) as u8
                }
                None => word.letter,
            };
            match letter {
                b'G' => {
                    let row = at(g_row(&word.value, raw, self.settings.codes), word.span)?;
                    if given.g_count == G_CODES {
                        let what = "too many G codes in one block".into();
                        return Err(Alarm::MacroFormat { what }.at(word.span));
                    }
                    given.g[given.g_count] = Some(row);
                    given.g_count += 1;
                }
                b'M' => {
                    let code = at(count(raw, b'M'), word.span)?;
                    let most = if self.settings.three_m_codes { M_CODES } else { 1 };
                    // Without M3B the last M code of a block counts; a stop or an end isn't lost in silence.
                    if let Some(Some((first, _))) = given.m.get(most - 1)
                        && given.m_count == most
                        && (m_codes::ends_or_stops(*first) || self.settings.plural_m_alarms)
                    {
                        return Err(Alarm::PluralM { first: *first, second: code }.at(word.span));
                    }
                    let place = given.m_count.min(most - 1);
                    if given.m_count == most {
                        given.lost_m = given.m[place].map(|(code, _)| code);
                    }
                    given.m[place] = Some((code, word.span));
                    given.m_count = place + 1;
                }
                letter => {
                    if self.settings.no_repeated_address && given.has(letter) {
                        return Err(Alarm::RepeatedAddress { letter: char::from(letter) }.at(word.span));
                    }
                    given.present |= 1 << (letter - b'A');
                    given.values[usize::from(letter - b'A')] = (raw, word.span);
                }
            }
        }
        Ok(())
    }

    /// The value of a word, or `None` where it is vacant and the word therefore not there.
    pub(super) fn raw(&self, program: &Program, word: &Coded) -> Checked<Option<Raw>> {
        Ok(match word.value {
            Input::Literal(number) => Some(Raw::Literal(number)),
            Input::G(code, _) => Some(Raw::Computed(f64::from(code) / 10.0)),
            Input::Operand(operand) => self.operand(program, operand)?.given().map(Raw::Computed),
        })
    }

    /// The value of a word that is an argument of a macro.
    pub(super) fn raw_argument(&self, program: &Program, word: &Coded) -> Checked<Option<Raw>> {
        match word.value {
            Input::Operand(operand) => {
                Ok(self.argument_operand(program, operand)?.given().map(Raw::Computed))
            }
            Input::Literal(_) | Input::G(..) => self.raw(program, word),
        }
    }

    /// How many decimals the least increment of an address has in the unit in force.
    fn decimals(&self, letter: u8, unit: Unit) -> usize {
        let metric = match self.settings.increment {
            crate::control::Increment::IsA => 2,
            crate::control::Increment::IsB => 3,
            crate::control::Increment::IsC => 4,
        };
        if unit == Unit::Inch && !turns(letter) { metric + 1 } else { metric }
    }

    /// ROUND inside an address.
    pub(super) fn round_to(&self, letter: u8, value: f64) -> f64 {
        match letter {
            b'A'..=b'C' | b'I'..=b'K' | b'Q' | b'R' | b'U'..=b'Z' => {
                let scale = POWERS[self.decimals(letter, self.state.modal.unit)];
                nearest(value, scale) / scale
            }
            b'F' | b'E' => value,
            _ => value.round(),
        }
    }

    /// A length in mm or an angle in degrees, a multiple of the increment of its address.
    pub(super) fn dimension(&self, given: &Given, letter: u8, state: &State) -> Checked<Option<f64>> {
        let Some((raw, span)) = given.get(letter) else { return Ok(None) };
        let decimals = self.decimals(letter, state.modal.unit);
        let value = at(self.increments(raw, decimals), span)? / POWERS[decimals];
        let inch = state.modal.unit == Unit::Inch && !turns(letter);
        Ok(Some(if inch { self.clean(value * 25.4) } else { value }))
    }

    /// `,R` or `,C` of a cutting move.
    pub(super) fn corner_word(&self, given: &Given, state: &State) -> Checked<Option<Blend>> {
        let Some((letter, raw, span)) = given.corner else { return Ok(None) };
        let decimals = self.decimals(b'X', state.modal.unit);
        let value = at(self.increments(raw, decimals), span)? / POWERS[decimals];
        if value < 0.0 {
            return Err(Alarm::IllegalMinus { letter: char::from(letter) }.at(span));
        }
        let length = if state.modal.unit == Unit::Inch { self.clean(value * 25.4) } else { value };
        Ok(Some(if letter == b'R' { Blend::Round(length) } else { Blend::Chamfer(length) }))
    }

    /// An angle at an address that is a length elsewhere: R of G68.
    pub(super) fn angle(&self, given: &Given, letter: u8) -> Checked<Option<f64>> {
        let Some((raw, span)) = given.get(letter) else { return Ok(None) };
        let decimals = self.decimals(b'A', Unit::Metric);
        Ok(Some(at(self.increments(raw, decimals), span)? / POWERS[decimals]))
    }

    /// Whole increments: literals are cut off (or rounded, by setting), computed values rounded half away from 0.
    fn increments(&self, raw: Raw, decimals: usize) -> Result<f64, Alarm> {
        let number = match raw {
            Raw::Computed(value) => nearest(value, POWERS[decimals]),
            Raw::Literal(Decimal { digits, places, negative }) => {
                let places = match places {
                    // Without a point the digits count increments, or whole units in calculator notation.
                    None if self.settings.calculator_input => 0,
                    None => decimals,
                    Some(places) => usize::from(places),
                };
                let magnitude = if places <= decimals {
                    digits as f64 * POWERS[decimals - places]
                } else {
                    let unit = 10_u64.saturating_pow((places - decimals) as u32);
                    let half = if self.settings.unsure.round_literals { unit / 2 } else { 0 };
                    (digits.saturating_add(half) / unit) as f64
                };
                if negative { -magnitude } else { magnitude }
            }
        };
        // Nine digits in increments (8.1, PS0003).
        if number.abs() > 999_999_999.0 { Err(Alarm::TooManyDigits) } else { Ok(number + 0.0) }
    }

    /// A time in seconds: X and U count increments of 0.001 s without a point.
    pub(super) fn seconds(&self, given: &Given, letter: u8) -> Checked<Option<f64>> {
        let Some((raw, span)) = given.get(letter) else { return Ok(None) };
        let decimals = self.decimals(b'A', Unit::Metric);
        let value = at(self.increments(raw, decimals), span)? / POWERS[decimals];
        if value < 0.0 {
            return Err(Alarm::IllegalMinus { letter: char::from(letter) }.at(span));
        }
        Ok(Some(value))
    }

    /// F in the unit of the feed mode.
    pub(super) fn feed_word(&self, given: &Given, state: &State) -> Checked<Option<f64>> {
        let Some((raw, span)) = given.get(b'F') else { return Ok(None) };
        let value = match raw {
            Raw::Literal(number) if number.places.is_some() => number.value(),
            Raw::Literal(number) => number.value() / POWERS[self.feed_decimals(state)],
            Raw::Computed(value) => value,
        };
        if value < 0.0 {
            return Err(Alarm::IllegalMinus { letter: 'F' }.at(span));
        }
        Ok(Some(value))
    }

    /// An argument of a macro call: computed values and points as they are, otherwise counted in the increments of
    /// the address (6007#4 CVA = 0).
    pub(super) fn argument(&self, raw: Raw, letter: u8) -> f64 {
        match raw {
            Raw::Computed(value) => value,
            Raw::Literal(number) => number.value() / POWERS[self.counted_decimals(raw, letter)],
        }
    }

    /// The decimals that ADP takes back from an argument: none with CVA 6007#4.
    pub(super) fn argument_decimals(&self, raw: Raw, letter: u8) -> u8 {
        if self.settings.converts_arguments { 0 } else { self.counted_decimals(raw, letter) as u8 }
    }

    /// How many decimals an argument without a point has that counts the increments of its address.
    fn counted_decimals(&self, raw: Raw, letter: u8) -> usize {
        let Raw::Literal(Decimal { places: None, .. }) = raw else { return 0 };
        let scale = match letter {
            b'D' | b'G' | b'H' | b'L' | b'M' | b'N' | b'P' | b'S' | b'T' => ArgumentScale::Whole,
            b'E' => self.settings.unsure.argument_e,
            b'F' => self.settings.unsure.argument_f,
            _ => ArgumentScale::Increments,
        };
        match scale {
            ArgumentScale::Whole => 0,
            ArgumentScale::Feed => self.feed_decimals(&self.state),
            ArgumentScale::Increments if self.settings.calculator_input => 0,
            ArgumentScale::Increments => self.decimals(letter, self.state.modal.unit),
        }
    }
}

impl Core {
    /// How many decimals F has where it is written without a point.
    fn feed_decimals(&self, state: &State) -> usize {
        match (state.modal.feed_mode, state.modal.unit) {
            (_, unit) if self.settings.feed_in_increments => self.decimals(b'X', unit),
            (FeedMode::PerRevolution, Unit::Inch) => 4,
            (FeedMode::PerRevolution, Unit::Metric) => 2,
            (FeedMode::PerMinute | FeedMode::InverseTime, _) => 0,
        }
    }

    /// P of a dwell in seconds: milliseconds, or on some controls seconds where it has a point.
    pub(super) fn pause(&self, given: &Given) -> Checked<Option<f64>> {
        let Some((raw, span)) = given.get(b'P') else { return Ok(None) };
        match raw {
            Raw::Literal(number) if self.settings.dwell_in_seconds && number.places.is_some() => {
                if number.negative {
                    Err(Alarm::IllegalMinus { letter: 'P' }.at(span))
                } else {
                    Ok(Some(number.value()))
                }
            }
            Raw::Computed(_) if self.settings.dwell_in_seconds => {
                Err(Alarm::NotSimulated { what: "a computed P of a dwell".into() }.at(span))
            }
            _ => Ok(given.count(b'P')?.map(|milliseconds| f64::from(milliseconds) / 1000.0)),
        }
    }
}

/// Rotary axes are not affected by G20 and G21.
fn turns(letter: u8) -> bool {
    matches!(letter, b'A' | b'B' | b'C')
}

fn g_row(input: &Input, raw: Raw, set: CodeSet) -> Result<&'static Row, Alarm> {
    let (code, found) = match (input, raw) {
        (Input::G(code, found), _) => (*code, *found),
        (_, Raw::Computed(value)) => {
            // A computed code keeps one decimal.
            let tenths = (value * 10.0).round();
            if !(0.0..=9999.0).contains(&tenths) {
                return Err(Alarm::ImproperGCode { code: value.to_string() });
            }
            (tenths as u32, codes::find(tenths as u32))
        }
        (_, Raw::Literal(number)) => return Err(Alarm::ImproperGCode { code: number.value().to_string() }),
    };
    found.on(set).ok_or_else(|| Alarm::ImproperGCode { code: codes::spelled(code) })
}

impl Core {
    /// A whole number with a sign: I J K of G51.
    pub(super) fn factor(&self, given: &Given, letter: u8) -> Checked<Option<f64>> {
        let Some((raw, span)) = given.get(letter) else { return Ok(None) };
        match raw {
            Raw::Literal(number) if number.places.is_some() => {
                Err(Alarm::IllegalPoint { letter: Some(char::from(letter)) }.at(span))
            }
            Raw::Literal(number) => Ok(Some(number.value())),
            Raw::Computed(value) => Ok(Some(value.round())),
        }
    }
}
