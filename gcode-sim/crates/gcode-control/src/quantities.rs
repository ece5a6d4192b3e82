//! What the number of a word is at its address: a length, an angle, a time, a feed.
use std::hint::cold_path;

use super::checked::{ExecResult, locate};
use super::data::ControlData;
use super::state::State;
use super::words::{BlockWords, WordNumber};
use crate::contour::Blend;
use gcode_lang::alarm::Alarm;
use gcode_lang::control::Increment;
use gcode_lang::program::modes::{FeedMode, Unit};
use gcode_lang::syntax::ast::Decimal;
use gcode_lang::units::round_scaled_within;

/// What [`ControlData::measure`] finds out once for all axes of a block.
#[derive(Clone, Copy, Debug)]
pub(super) struct Measure {
    /// Of the least increment in mm and degrees; inches have one more.
    decimals: usize,
    /// Increments in a mm or a degree.
    pub(super) scale: f64,
    is_in_inches: bool,
}

/// Nine digits in increments (8.1, PS0003).
const MAX_INCREMENTS: u64 = 999_999_999;

/// Powers of ten by their exponent.
pub(super) const POWERS: [f64; 8] = [1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7];

/// The same as integers; the last is more than any literal's digits are.
const INTEGER_POWERS: [u64; 20] = {
    let mut units = [1; 20];
    let mut place = 1;
    while place < units.len() {
        units[place] = units[place - 1] * 10;
        place += 1;
    }
    units
};

impl Measure {
    /// Whether an address counts in inches.
    #[inline(always)]
    fn is_inch(&self, letter: u8) -> bool {
        if self.is_in_inches {
            cold_path();
            return !is_rotary_letter(letter);
        }
        false
    }
}

/// The increments, `scale` in a unit, nearest to a computed value, half away from 0; `None` where they have too many digits.
#[inline(always)]
fn computed_increments(value: f64, scale: f64) -> Option<f64> {
    round_scaled_within(value, scale, MAX_INCREMENTS as f64).map(|number| number + 0.0)
}

impl ControlData {
    /// How many decimals the least increment of an address has in the unit in force.
    #[inline]
    pub(super) fn decimals(&self, letter: u8, unit: Unit) -> usize {
        let metric = match self.settings.increment {
            Increment::IsA => 2,
            Increment::IsB => 3,
            Increment::IsC => 4,
        };
        if unit == Unit::Inch && !is_rotary_letter(letter) { metric + 1 } else { metric }
    }

    /// Whole increments.
    fn increments(&self, raw: &WordNumber, decimals: usize) -> Result<f64, Alarm> {
        let number = match raw {
            WordNumber::Computed(value) => computed_increments(*value, POWERS[decimals]),
            WordNumber::Literal(number) => self.literal_increments(number, decimals),
        };
        number.ok_or(Alarm::TooManyDigits)
    }

    /// Increments of a literal: what is less than one is cut off, or rounded, by setting. `None` as of [`computed`].
    #[inline(always)]
    fn literal_increments(
        &self,
        Decimal { digits, places, negative }: &Decimal,
        decimals: usize,
    ) -> Option<f64> {
        let places = match places {
            Some(places) => usize::from(*places),
            // Without a point the digits count increments, or whole units in calculator notation.
            None => {
                cold_path();
                if self.settings.uses_calculator_input { 0 } else { decimals }
            }
        };
        let number = if places == decimals { *digits } else { self.scale_digits(*digits, places, decimals) };
        // Signed numbers become doubles in one step.
        let signed = if *negative { -(number as i64) } else { number as i64 };
        (number <= MAX_INCREMENTS).then_some(signed as f64)
    }

    /// Digits as increments that have some decimals. What is less than an increment is cut off, or rounded, by setting.
    #[inline]
    fn scale_digits(&self, digits: u64, places: usize, decimals: usize) -> u64 {
        let unit = INTEGER_POWERS[places.abs_diff(decimals).min(INTEGER_POWERS.len() - 1)];
        if places < decimals {
            return digits.saturating_mul(unit);
        }
        let half = if self.settings.undocumented.rounds_literals { unit / 2 } else { 0 };
        digits.saturating_add(half) / unit
    }

    /// A length in mm or an angle in degrees, a multiple of the increment of its address.
    pub(super) fn dimension(
        &self,
        block_words: &BlockWords,
        letter: u8,
        state: &State,
    ) -> ExecResult<Option<f64>> {
        let Some((raw, span)) = block_words.get(letter) else { return Ok(None) };
        locate(self.dimension_of(&raw, letter, &self.measure(state.modal.unit)), span).map(Some)
    }

    /// How the numbers of axis words are read while a unit is in force.
    #[inline]
    pub(super) fn measure(&self, unit: Unit) -> Measure {
        let decimals = self.decimals(b'A', unit);
        Measure { decimals, scale: POWERS[decimals], is_in_inches: unit == Unit::Inch }
    }

    /// As [`ControlData::dimension`], of a word's value.
    pub(super) fn dimension_of(&self, raw: &WordNumber, letter: u8, measure: &Measure) -> Result<f64, Alarm> {
        let value = match raw {
            WordNumber::Literal(number) => self.literal_dimension(number, letter, measure),
            WordNumber::Computed(value) => self.computed_dimension(*value, letter, measure),
        };
        value.ok_or(Alarm::TooManyDigits)
    }

    /// As [`ControlData::dimension_of`], of a literal; `None` where it has too many digits.
    #[inline(always)]
    pub(super) fn literal_dimension(&self, number: &Decimal, letter: u8, measure: &Measure) -> Option<f64> {
        if measure.is_inch(letter) {
            let decimals = measure.decimals + 1;
            return Some(
                self.remove_residue(self.literal_increments(number, decimals)? / POWERS[decimals] * 25.4),
            );
        }
        Some(self.literal_increments(number, measure.decimals)? / measure.scale)
    }

    /// As [`ControlData::literal_dimension`], of a computed value.
    #[inline(always)]
    pub(super) fn computed_dimension(&self, value: f64, letter: u8, measure: &Measure) -> Option<f64> {
        if measure.is_inch(letter) {
            let scale = POWERS[measure.decimals + 1];
            return Some(self.remove_residue(computed_increments(value, scale)? / scale * 25.4));
        }
        Some(computed_increments(value, measure.scale)? / measure.scale)
    }

    /// An angle at an address that is a length elsewhere: R of G68.
    pub(super) fn angle(&self, block_words: &BlockWords, letter: u8) -> ExecResult<Option<f64>> {
        let Some((raw, span)) = block_words.get(letter) else { return Ok(None) };
        let decimals = self.decimals(b'A', Unit::Metric);
        Ok(Some(locate(self.increments(&raw, decimals), span)? / POWERS[decimals]))
    }

    /// `,R` or `,C` of a cutting move.
    pub(super) fn corner_word(&self, block_words: &BlockWords, state: &State) -> ExecResult<Option<Blend>> {
        let Some((letter, raw, span)) = block_words.corner else { return Ok(None) };
        let decimals = self.decimals(b'X', state.modal.unit);
        let value = locate(self.increments(&raw, decimals), span)? / POWERS[decimals];
        if value < 0.0 {
            return Err(Alarm::IllegalMinus { letter: char::from(letter) }.located_at(span));
        }
        let length = if state.modal.unit == Unit::Inch { self.remove_residue(value * 25.4) } else { value };
        Ok(Some(if letter == b'R' { Blend::Round(length) } else { Blend::Chamfer(length) }))
    }

    /// A whole number with a sign: I J K of G51.
    pub(super) fn factor(&self, block_words: &BlockWords, letter: u8) -> ExecResult<Option<f64>> {
        let Some((raw, span)) = block_words.get(letter) else { return Ok(None) };
        match raw {
            WordNumber::Literal(number) if number.places.is_some() => {
                Err(Alarm::IllegalPoint { letter: Some(char::from(letter)) }.located_at(span))
            }
            WordNumber::Literal(number) => Ok(Some(number.value())),
            WordNumber::Computed(value) => Ok(Some(value.round())),
        }
    }

    /// A time in seconds: X and U count increments of 0.001 s without a point.
    pub(super) fn seconds(&self, block_words: &BlockWords, letter: u8) -> ExecResult<Option<f64>> {
        let Some((raw, span)) = block_words.get(letter) else { return Ok(None) };
        let decimals = self.decimals(b'A', Unit::Metric);
        let value = locate(self.increments(&raw, decimals), span)? / POWERS[decimals];
        if value < 0.0 {
            return Err(Alarm::IllegalMinus { letter: char::from(letter) }.located_at(span));
        }
        Ok(Some(value))
    }

    /// P of a dwell in seconds: milliseconds, or on some controls seconds where it has a point.
    pub(super) fn dwell_seconds(&self, block_words: &BlockWords) -> ExecResult<Option<f64>> {
        let Some((raw, span)) = block_words.get(b'P') else { return Ok(None) };
        match raw {
            WordNumber::Literal(number) if self.settings.dwell_in_seconds && number.places.is_some() => {
                if number.negative {
                    Err(Alarm::IllegalMinus { letter: 'P' }.located_at(span))
                } else {
                    Ok(Some(number.value()))
                }
            }
            WordNumber::Computed(_) if self.settings.dwell_in_seconds => {
                Err(Alarm::NotSimulated { what: "a computed P of a dwell".into() }.located_at(span))
            }
            _ => Ok(block_words.count(b'P')?.map(|milliseconds| f64::from(milliseconds) / 1000.0)),
        }
    }

    /// F in the unit of the feed mode.
    pub(super) fn feed_word(&self, block_words: &BlockWords, state: &State) -> ExecResult<Option<f64>> {
        let Some((raw, span)) = block_words.get(b'F') else { return Ok(None) };
        locate(self.feed_of(&raw, state), span).map(Some)
    }

    /// The same of the value of the word.
    pub(super) fn feed_of(&self, raw: &WordNumber, state: &State) -> Result<f64, Alarm> {
        let value = match raw {
            WordNumber::Literal(number) if number.places.is_some() => number.value(),
            WordNumber::Literal(number) => number.value() / POWERS[self.feed_decimals(state)],
            WordNumber::Computed(value) => *value,
        };
        if value < 0.0 { Err(Alarm::IllegalMinus { letter: 'F' }) } else { Ok(value) }
    }

    /// How many decimals F has where it is written without a point.
    pub(super) fn feed_decimals(&self, state: &State) -> usize {
        match (state.modal.feed_mode, state.modal.unit) {
            (_, unit) if self.settings.feed_in_increments => self.decimals(b'X', unit),
            (FeedMode::PerRevolution, Unit::Inch) => 4,
            (FeedMode::PerRevolution, Unit::Metric) => 2,
            (FeedMode::PerMinute | FeedMode::InverseTime, _) => 0,
        }
    }
}

/// Rotary axes are not affected by G20 and G21.
fn is_rotary_letter(letter: u8) -> bool {
    matches!(letter, b'A' | b'B' | b'C')
}
