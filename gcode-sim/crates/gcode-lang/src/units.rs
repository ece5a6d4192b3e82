//! Lengths, angles, feeds, speeds and times as types, and the only trigonometric functions of the project.
//!
//! The functions come from `libm`: every machine computes the same bits, so stored results stay valid.
use std::ops::{Add, Mul, Neg, Sub};

use serde::{Deserialize, Serialize};

/// Returns `value` × `scale` rounded to the nearest whole number, halves away from 0.
///
/// A product within four epsilons of a half counts as that half: 0.5005 × 1000 is 500.49999999999994 as a
/// double and rounds to 501.
pub fn round_scaled(value: f64, scale: f64) -> f64 {
    round(value * scale * HALF_CORRECTION)
}

/// Rounds as [`round_scaled`] does; `None` if the magnitude of the result exceeds `max`.
#[inline]
pub fn round_scaled_within(value: f64, scale: f64, max: f64) -> Option<f64> {
    debug_assert!(max < FRACTION_LIMIT, "{max} has no room for a fraction");
    let rounded = round_small(value * scale * HALF_CORRECTION);
    (rounded.abs() <= max).then_some(rounded)
}

/// Factor that raises a product just below a half to that half.
const HALF_CORRECTION: f64 = 1.0 + 4.0 * f64::EPSILON;

macro_rules! unit {
    ($(#[$doc:meta])* $name:ident, $suffix:literal) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, Default, PartialEq, PartialOrd, Serialize, Deserialize)]
        #[serde(transparent)]
        pub struct $name(pub f64);

        impl $name {
            /// The value 0.
            pub const ZERO: Self = Self(0.0);

            /// Returns the magnitude.
            pub fn abs(self) -> Self {
                Self(self.0.abs())
            }
        }

        impl Add for $name {
            type Output = Self;
            fn add(self, other: Self) -> Self {
                Self(self.0 + other.0)
            }
        }

        impl Sub for $name {
            type Output = Self;
            fn sub(self, other: Self) -> Self {
                Self(self.0 - other.0)
            }
        }

        impl Neg for $name {
            type Output = Self;
            fn neg(self) -> Self {
                Self(-self.0)
            }
        }

        impl Mul<f64> for $name {
            type Output = Self;
            fn mul(self, factor: f64) -> Self {
                Self(self.0 * factor)
            }
        }

        impl std::fmt::Display for $name {
            /// Writes the number with the precision of the formatter, followed by the unit.
            fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                std::fmt::Display::fmt(&self.0, f)?;
                f.write_str($suffix)
            }
        }
    };
}

unit!(/// Length in millimetres.
    Mm, " mm");
unit!(/// Angle in degrees.
    Deg, "°");
unit!(/// Feed in millimetres per minute.
    MmPerMin, " mm/min");
unit!(/// Spindle speed in revolutions per minute.
    Rpm, " r/min");
unit!(/// Time in seconds.
    Seconds, " s");

impl Deg {
    /// Converts from radians.
    pub fn from_rad(rad: f64) -> Self {
        Self(rad.to_degrees())
    }

    /// Converts to radians.
    pub fn to_rad(self) -> f64 {
        self.0.to_radians()
    }

    /// Returns the sine.
    pub fn sin(self) -> f64 {
        libm::sin(self.to_rad())
    }

    /// Returns the cosine.
    pub fn cos(self) -> f64 {
        libm::cos(self.to_rad())
    }

    /// Returns the tangent.
    pub fn tan(self) -> f64 {
        libm::tan(self.to_rad())
    }

    /// Returns the arc sine, −90° to 90°.
    pub fn asin(sine: f64) -> Self {
        Self::from_rad(libm::asin(sine))
    }

    /// Returns the arc cosine, 0° to 180°.
    pub fn acos(cosine: f64) -> Self {
        Self::from_rad(libm::acos(cosine))
    }

    /// Returns the direction of the point (x, y), −180° to 180°.
    #[inline]
    pub fn atan2(y: f64, x: f64) -> Self {
        Self::from_rad(libm::atan2(y, x))
    }
}

/// 2^52: a double of this magnitude or above has no fraction.
const FRACTION_LIMIT: f64 = 4_503_599_627_370_496.0;

/// Rounds to the nearest whole number, halves away from 0.
///
/// Gives the bits of `f64::round` without a branch, so that several numbers can be rounded at once.
#[inline]
pub fn round(value: f64) -> f64 {
    if value.abs() < FRACTION_LIMIT { round_small(value) } else { value }
}

/// Rounds a number below [`FRACTION_LIMIT`]; the result for larger numbers is inexact.
#[inline]
fn round_small(value: f64) -> f64 {
    let magnitude = value.abs();
    // The sum has no bits for a fraction: it is the nearest whole number, ties to even.
    let even = (magnitude + FRACTION_LIMIT) - FRACTION_LIMIT;
    let half_step = if magnitude - even == 0.5 { 1.0 } else { 0.0 };
    (even + half_step).copysign(value)
}

/// Powers of ten by their exponent, exact.
pub const POWERS: [f64; 10] = [1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9];

/// Returns the natural logarithm, with the same bits on every machine.
pub fn ln(value: f64) -> f64 {
    libm::log(value)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn any_double_rounds_as_in_the_standard_library(value in any::<f64>(), near in -4e15..4e15) {
            for value in [value, near, near / 1e9] {
                prop_assert_eq!(round(value).to_bits(), value.round().to_bits());
            }
        }

        #[test]
        fn rounding_within_a_bound_gives_the_same_number(value in any::<f64>(), near in -2e6..2e6, tenths in 0_usize..5) {
            let (scale, max) = (POWERS[tenths], 999_999_999.0);
            for value in [value, near, near * 1e4, (near * 2.0).round() / 2.0 / scale] {
                let expected = Some(round_scaled(value, scale)).filter(|number| number.abs() <= max);
                prop_assert_eq!(round_scaled_within(value, scale, max).map(f64::to_bits), expected.map(f64::to_bits));
            }
        }
    }

    #[test]
    fn a_number_beyond_the_bound_is_not_rounded() {
        for value in [1e9, 4e15, 1e300, f64::MAX, f64::INFINITY, f64::NAN] {
            for value in [value, -value] {
                assert_eq!(round_scaled_within(value, 1.0, 999_999_999.0), None, "{value}");
            }
        }
        assert_eq!(round_scaled_within(999_999.999_4, 1000.0, 999_999_999.0), Some(999_999_999.0));
        assert_eq!(round_scaled_within(-0.5005, 1000.0, 999_999_999.0), Some(-501.0));
    }

    #[test]
    fn rounding_at_halves_and_limits_has_the_bits_of_the_standard_library() {
        const LIMIT: f64 = FRACTION_LIMIT;
        let small = [0.0, 0.5, 1.0, 1.5, 2.5, 1e9 + 0.5];
        let large = [LIMIT / 2.0 - 0.5, LIMIT, 1e300, f64::INFINITY, f64::MAX];
        let values =
            small.into_iter().chain(large).flat_map(|value| [value.next_down(), value, value.next_up()]);
        for value in values.chain([f64::MIN_POSITIVE, 0.3, 123_456.789]).flat_map(|value| [value, -value]) {
            assert_eq!(round(value).to_bits(), value.round().to_bits(), "{value:?}");
        }
        assert!(round(f64::NAN).is_nan());
    }

    #[test]
    fn angles_are_degrees() {
        assert!((Deg(30.0).sin() - 0.5).abs() < 1e-15);
        assert!((Deg::atan2(1.0, -1.0).0 - 135.0).abs() < 1e-12);
        assert_eq!(format!("{:.3}", Mm(1.5)), "1.500 mm");
    }
}
