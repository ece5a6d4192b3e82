//! What the number of a word is at its address: a length, an angle, a time, a feed.
use super::Core;
use super::eval::{Checked, at};
use super::state::State;
use super::words::{Given, Raw};
use crate::alarm::Alarm;
use crate::contour::Blend;
use crate::control::Increment;
use crate::program::modes::{FeedMode, Unit};
use crate::syntax::ast::Decimal;
use crate::units::nearest;

/// What [`Core::measure`] finds out once for all axes of a block.
#[derive(Clone, Copy, Debug)]
pub(super) struct Measure {
    /// Of the least increment in mm and degrees; inches have one more.
    decimals: usize,
    /// Increments in a mm or a degree.
    scale: f64,
    inch: bool,
}

/// Powers of ten by their exponent.
pub(super) const POWERS: [f64; 8] = [1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7];

impl Core {
    /// How many decimals the least increment of an address has in the unit in force.
    #[inline]
    pub(super) fn decimals(&self, letter: u8, unit: Unit) -> usize {
        let metric = match self.settings.increment {
            Increment::IsA => 2,
            Increment::IsB => 3,
            Increment::IsC => 4,
        };
        if unit == Unit::Inch && !turns(letter) { metric + 1 } else { metric }
    }

    /// Whole increments: literals are cut off (or rounded, by setting), computed values rounded half away from 0.
    #[inline(always)]
    fn increments(&self, raw: &Raw, decimals: usize) -> Result<f64, Alarm> {
        let number = match raw {
            Raw::Computed(value) => nearest(*value, POWERS[decimals]),
            Raw::Literal(Decimal { digits, places, negative }) => {
                let places = match places {
                    // Without a point the digits count increments, or whole units in calculator notation.
                    None if self.settings.calculator_input => 0,
                    None => decimals,
                    Some(places) => usize::from(*places),
                };
                // Signed numbers become doubles in one step; no literal has as many digits.
                let magnitude = if places == decimals {
                    *digits as i64 as f64
                } else if places < decimals {
                    *digits as i64 as f64 * POWERS[decimals - places]
                } else {
                    self.cut(*digits, places - decimals)
                };
                if *negative { -magnitude } else { magnitude }
            }
        };
        // Nine digits in increments (8.1, PS0003).
        if number.abs() > 999_999_999.0 { Err(Alarm::TooManyDigits) } else { Ok(number + 0.0) }
    }

    /// Digits without some of the last, which are less than an increment.
    #[inline(always)]
    fn cut(&self, digits: u64, places: usize) -> f64 {
        let unit = 10_u64.saturating_pow(places as u32);
        let half = if self.settings.unsure.round_literals { unit / 2 } else { 0 };
        (digits.saturating_add(half) / unit) as f64
    }

    /// A length in mm or an angle in degrees, a multiple of the increment of its address.
    pub(super) fn dimension(&self, given: &Given, letter: u8, state: &State) -> Checked<Option<f64>> {
        let Some((raw, span)) = given.get(letter) else { return Ok(None) };
        at(self.dimension_of(&raw, letter, self.measure(state.modal.unit)), span).map(Some)
    }

    /// How the numbers of axis words are read while a unit is in force.
    #[inline]
    pub(super) fn measure(&self, unit: Unit) -> Measure {
        let decimals = self.decimals(b'A', unit);
        Measure { decimals, scale: POWERS[decimals], inch: unit == Unit::Inch }
    }

    /// As [`Core::dimension`], of a word's value.
    #[inline(always)]
    pub(super) fn dimension_of(&self, raw: &Raw, letter: u8, measure: Measure) -> Result<f64, Alarm> {
        let Measure { decimals, scale, inch } = measure;
        if inch && !turns(letter) {
            let inches = self.increments(raw, decimals + 1)? / POWERS[decimals + 1];
            return Ok(self.clean(inches * 25.4));
        }
        Ok(self.increments(raw, decimals)? / scale)
    }

    /// An angle at an address that is a length elsewhere: R of G68.
    pub(super) fn angle(&self, given: &Given, letter: u8) -> Checked<Option<f64>> {
        let Some((raw, span)) = given.get(letter) else { return Ok(None) };
        let decimals = self.decimals(b'A', Unit::Metric);
        Ok(Some(at(self.increments(&raw, decimals), span)? / POWERS[decimals]))
    }

    /// `,R` or `,C` of a cutting move.
    pub(super) fn corner_word(&self, given: &Given, state: &State) -> Checked<Option<Blend>> {
        let Some((letter, raw, span)) = given.corner else { return Ok(None) };
        let decimals = self.decimals(b'X', state.modal.unit);
        let value = at(self.increments(&raw, decimals), span)? / POWERS[decimals];
        if value < 0.0 {
            return Err(Alarm::IllegalMinus { letter: char::from(letter) }.at(span));
        }
        let length = if state.modal.unit == Unit::Inch { self.clean(value * 25.4) } else { value };
        Ok(Some(if letter == b'R' { Blend::Round(length) } else { Blend::Chamfer(length) }))
    }

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

    /// A time in seconds: X and U count increments of 0.001 s without a point.
    pub(super) fn seconds(&self, given: &Given, letter: u8) -> Checked<Option<f64>> {
        let Some((raw, span)) = given.get(letter) else { return Ok(None) };
        let decimals = self.decimals(b'A', Unit::Metric);
        let value = at(self.increments(&raw, decimals), span)? / POWERS[decimals];
        if value < 0.0 {
            return Err(Alarm::IllegalMinus { letter: char::from(letter) }.at(span));
        }
        Ok(Some(value))
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

    /// How many decimals F has where it is written without a point.
    pub(super) fn feed_decimals(&self, state: &State) -> usize {
        match (state.modal.feed_mode, state.modal.unit) {
            (_, unit) if self.settings.feed_in_increments => self.decimals(b'X', unit),
            (FeedMode::PerRevolution, Unit::Inch) => 4,
            (FeedMode::PerRevolution, Unit::Metric) => 2,
            (FeedMode::PerMinute | FeedMode::InverseTime, _) => 0,
        }
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
}

/// Rotary axes are not affected by G20 and G21.
fn turns(letter: u8) -> bool {
    matches!(letter, b'A' | b'B' | b'C')
}
