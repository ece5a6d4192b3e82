//! Operations on numbers, with the bits and the alarms of the control's interpreter.
use gcode_lang::units::{Deg, round};

use crate::node::{AlarmKind, Binary, Semantics, Unary};

/// Computes a function of one number.
pub(crate) fn unary(function: Unary, x: f64, semantics: Semantics) -> Result<f64, AlarmKind> {
    let value = match function {
        Unary::Neg => -x,
        Unary::Abs => x.abs(),
        Unary::Sqrt => x.sqrt(),
        Unary::Sin => Deg(x).sin(),
        Unary::Cos => Deg(x).cos(),
        Unary::Tan if semantics.tan_90_alarms && is_right_angle(x) => f64::NAN,
        Unary::Tan => Deg(x).tan(),
        Unary::Asin => angle_range(Deg::asin(x).0, semantics),
        Unary::Acos => Deg::acos(x).0,
        Unary::Atan => Deg::atan2(x, 1.0).0,
        Unary::Exp => libm::exp(x),
        Unary::Ln => libm::log(x),
        Unary::Fix => x.trunc(),
        Unary::Fup if x < 0.0 => x.floor(),
        Unary::Fup => x.ceil(),
        Unary::Round => round(x),
        Unary::Bin => from_bcd(round(x)).unwrap_or(f64::NAN),
        Unary::Bcd => to_bcd(round(x)).unwrap_or(f64::NAN),
        Unary::Residue if x.abs() < RESIDUE => 0.0,
        Unary::Residue => x,
    };
    if value.is_finite() { Ok(value) } else { Err(AlarmKind::OutOfRange) }
}

/// Magnitude below which setting MFZ zeroes a sine.
pub(crate) const RESIDUE: f64 = 1e-8;

/// Returns true for 90° and every angle that differs by half turns.
pub(crate) fn is_right_angle(x: f64) -> bool {
    (x % 180.0).abs() == 90.0
}

/// Computes an operator or a function of two numbers.
pub(crate) fn binary(operator: Binary, a: f64, b: f64, semantics: Semantics) -> Result<f64, AlarmKind> {
    let value = match operator {
        Binary::Add => a + b,
        Binary::Sub => a - b,
        Binary::Mul => a * b,
        Binary::Div if b == 0.0 => return Err(AlarmKind::DivideByZero),
        Binary::Div => a / b,
        Binary::Mod => {
            let divisor = round(b);
            if divisor == 0.0 {
                return Err(AlarmKind::DivideByZero);
            }
            round(a) % divisor
        }
        Binary::And => f64::from(bits(a, semantics)? & bits(b, semantics)?),
        Binary::Or => f64::from(bits(a, semantics)? | bits(b, semantics)?),
        Binary::Xor => f64::from(bits(a, semantics)? ^ bits(b, semantics)?),
        Binary::Pow if a < 0.0 => return Err(AlarmKind::OutOfRange),
        Binary::Pow if a == 0.0 && b < 0.0 => return Err(AlarmKind::DivideByZero),
        Binary::Pow => libm::pow(a, b),
        Binary::Atan if a == 0.0 && b == 0.0 => {
            return if semantics.atan_of_zeros_alarms { Err(AlarmKind::OutOfRange) } else { Ok(0.0) };
        }
        // A negative zero must not change 180° into −180°.
        Binary::Atan => angle_range(Deg::atan2(a + 0.0, b).0, semantics),
        Binary::Compare(relation) => f64::from(u8::from(relation.holds(a, b))),
    };
    if value.is_finite() { Ok(value) } else { Err(AlarmKind::Overflow) }
}

/// Returns an angle from 0° to 360°, or with its sign if the setting says so.
fn angle_range(degrees: f64, semantics: Semantics) -> f64 {
    if degrees < 0.0 && !semantics.returns_signed_angles { degrees + 360.0 } else { degrees }
}

/// Returns an operand of AND, OR and XOR as 32 bits.
fn bits(value: f64, semantics: Semantics) -> Result<i32, AlarmKind> {
    let value = round(value);
    if value < 0.0 && semantics.negative_bits_alarm {
        Err(AlarmKind::OutOfRange)
    } else if (f64::from(i32::MIN)..=f64::from(i32::MAX)).contains(&value) {
        Ok(value as i32)
    } else if (0.0..=f64::from(u32::MAX)).contains(&value) {
        Ok((value as u32).cast_signed())
    } else {
        Err(AlarmKind::IntegerOverflow)
    }
}

/// Largest number that BCD takes.
pub(crate) const BCD_MAX: f64 = 99_999_999.0;

/// Returns a whole number with a decimal digit in four bits.
fn to_bcd(whole: f64) -> Option<f64> {
    let number = (0.0..=BCD_MAX).contains(&whole).then_some(whole as u32)?;
    let code = (0..8).fold(0_u32, |code, digit| code | (number / 10_u32.pow(digit) % 10) << (4 * digit));
    Some(f64::from(code))
}

/// Returns the number whose decimal digits have four bits each.
fn from_bcd(whole: f64) -> Option<f64> {
    let code = (0.0..=f64::from(u32::MAX)).contains(&whole).then_some(whole as u32)?;
    let number = (0..8).rev().try_fold(0_u32, |number, digit| {
        let value = code >> (4 * digit) & 15;
        (value <= 9).then(|| number * 10 + value)
    })?;
    Some(f64::from(number))
}
