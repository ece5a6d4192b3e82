//! Conversion of the number of a word to the quantity of its address: a length, an angle, a feed.
use std::hint::cold_path;

use super::data::ControlData;
use super::state::State;
use super::words::WordNumber;
use gcode_lang::alarm::{Alarm, DigitLimit};
use gcode_lang::control::Increment;
use gcode_lang::program::modes::{FeedMode, Unit};
use gcode_lang::syntax::ast::Decimal;
use gcode_lang::units::{POWERS, round_scaled_within};

/// Units of the axis words of a block, computed once for all of them.
#[derive(Clone, Copy, Debug)]
pub(super) struct Measure {
    /// Decimals of the least increment in mm and degrees; inches have one more.
    decimals: usize,
    /// Number of increments in a mm or a degree.
    pub(super) scale: f64,
    is_in_inches: bool,
}

/// Largest value in increments: nine digits (8.1, PS0003).
const MAX_INCREMENTS: u64 = 999_999_999;

/// Powers of ten as integers; the last exceeds the digits of any literal.
const INTEGER_POWERS: [u64; 20] = {
    let mut units = [1; 20];
    let mut exponent = 1;
    while exponent < units.len() {
        units[exponent] = units[exponent - 1] * 10;
        exponent += 1;
    }
    units
};

impl Measure {
    /// Returns true if an address is in inches.
    #[inline(always)]
    pub(super) fn is_inch(&self, letter: u8) -> bool {
        if self.is_in_inches {
            cold_path();
            return !is_rotary_letter(letter);
        }
        false
    }
}

/// Returns the increments, `scale` in a unit, nearest to a computed value, halves away from 0; `None` if too many digits.
#[inline(always)]
fn computed_increments(value: f64, scale: f64) -> Option<f64> {
    round_scaled_within(value, scale, MAX_INCREMENTS as f64).map(|number| number + 0.0)
}

impl ControlData {
    /// Returns the number of decimals of the least increment of an address.
    #[inline]
    pub(super) fn decimals(&self, letter: u8, unit: Unit) -> usize {
        let metric = match self.settings.increment {
            Increment::IsA => 2,
            Increment::IsB => 3,
            Increment::IsC => 4,
        };
        if unit == Unit::Inch && !is_rotary_letter(letter) { metric + 1 } else { metric }
    }

    pub(super) fn increments(&self, raw: &WordNumber, decimals: usize) -> Result<f64, Alarm> {
        let number = match raw {
            WordNumber::Computed(value) => computed_increments(*value, POWERS[decimals]),
            WordNumber::Literal(number) => self.literal_increments(number, decimals),
        };
        number.ok_or(Alarm::TooManyDigits(DigitLimit::Increments))
    }

    /// Returns the increments of a literal, truncated or rounded by setting; `None` if too many digits.
    #[inline(always)]
    fn literal_increments(
        &self,
        Decimal { digits, places, negative }: &Decimal,
        decimals: usize,
    ) -> Option<f64> {
        let places = match places {
            Some(places) => usize::from(*places),
            // Without a point the digits count increments, or units in calculator notation.
            None => {
                cold_path();
                if self.settings.uses_calculator_input { 0 } else { decimals }
            }
        };
        let number = if places == decimals { *digits } else { self.scale_digits(*digits, places, decimals) };
        // Signed integers convert to doubles in one instruction.
        let signed = if *negative { -(number as i64) } else { number as i64 };
        (number <= MAX_INCREMENTS).then_some(signed as f64)
    }

    /// Converts digits with `places` decimals to increments, truncated or rounded by setting.
    #[inline]
    fn scale_digits(&self, digits: u64, places: usize, decimals: usize) -> u64 {
        let unit = INTEGER_POWERS[places.abs_diff(decimals).min(INTEGER_POWERS.len() - 1)];
        if places < decimals {
            return digits.saturating_mul(unit);
        }
        let half = if self.settings.undocumented.rounds_literals { unit / 2 } else { 0 };
        digits.saturating_add(half) / unit
    }

    /// Returns the units of axis words.
    #[inline]
    pub(super) fn measure(&self, unit: Unit) -> Measure {
        let decimals = self.decimals(b'A', unit);
        Measure { decimals, scale: POWERS[decimals], is_in_inches: unit == Unit::Inch }
    }

    /// Converts the number of a word to mm or degrees.
    pub(super) fn dimension_of(&self, raw: &WordNumber, letter: u8, measure: &Measure) -> Result<f64, Alarm> {
        let value = match raw {
            WordNumber::Literal(number) => self.literal_dimension(number, letter, measure),
            WordNumber::Computed(value) => self.computed_dimension(*value, letter, measure),
        };
        value.ok_or(Alarm::TooManyDigits(DigitLimit::Increments))
    }

    /// Converts a literal to mm or degrees; `None` if it has too many digits.
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

    /// Converts a computed value to mm or degrees; `None` if it has too many digits.
    #[inline(always)]
    pub(super) fn computed_dimension(&self, value: f64, letter: u8, measure: &Measure) -> Option<f64> {
        if measure.is_inch(letter) {
            let scale = POWERS[measure.decimals + 1];
            return Some(self.remove_residue(computed_increments(value, scale)? / scale * 25.4));
        }
        Some(computed_increments(value, measure.scale)? / measure.scale)
    }

    /// Returns an angle or a time, which have the metric increment everywhere.
    pub(super) fn metric_value(&self, raw: &WordNumber) -> Result<f64, Alarm> {
        let decimals = self.decimals(b'A', Unit::Metric);
        Ok(self.increments(raw, decimals)? / POWERS[decimals])
    }

    /// Returns F in the unit of the feed mode.
    pub(super) fn feed_of(&self, raw: &WordNumber, state: &State) -> Result<f64, Alarm> {
        let value = match raw {
            WordNumber::Literal(number) if number.places.is_some() => number.value(),
            WordNumber::Literal(number) => number.value() / POWERS[self.feed_decimals(state)],
            WordNumber::Computed(value) => *value,
        };
        if value < 0.0 { Err(Alarm::IllegalMinus { letter: 'F' }) } else { Ok(value) }
    }

    /// Returns the number of decimals of an F without a point.
    pub(super) fn feed_decimals(&self, state: &State) -> usize {
        match (state.modal.feed_mode, state.modal.unit) {
            (_, unit) if self.settings.feed_in_increments => self.decimals(b'X', unit),
            (FeedMode::PerRevolution, Unit::Inch) => 4,
            (FeedMode::PerRevolution, Unit::Metric) => 2,
            (FeedMode::PerMinute | FeedMode::InverseTime, _) => 0,
        }
    }
}

/// Returns true for the letters that G20 and G21 don't affect.
fn is_rotary_letter(letter: u8) -> bool {
    matches!(letter, b'A' | b'B' | b'C')
}
