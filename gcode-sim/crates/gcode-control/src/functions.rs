//! Operators, comparisons and functions with their domains and alarms; whole numbers.
use super::variables::Value;
use gcode_lang::alarm::{Alarm, LocatedAlarm};
use gcode_lang::control::{Settings, UndocumentedChoices};
use gcode_lang::source::Span;
use gcode_lang::syntax::ast::{BinaryOp, Function, Relation};
use gcode_lang::units::{Deg, round};

/// Returns true for the result of an operator or function inside its domain; otherwise it is infinite or NaN.
#[inline(always)]
pub(super) fn is_finite(value: f64) -> bool {
    value.abs() <= f64::MAX
}

/// Raises PS0111 for a result that a double can't hold.
fn check_finite(value: f64) -> Result<f64, Alarm> {
    if is_finite(value) { Ok(value) } else { Err(Alarm::FloatOverflow) }
}

/// Computes a binary operator.
#[inline(never)]
pub fn binary(op: BinaryOp, left: f64, right: f64, undocumented: &UndocumentedChoices) -> Result<f64, Alarm> {
    check_finite(match op {
        BinaryOp::Add => left + right,
        BinaryOp::Sub => left - right,
        BinaryOp::Mul => left * right,
        BinaryOp::Div if right != 0.0 => left / right,
        BinaryOp::Div => return Err(Alarm::DivideByZero),
        BinaryOp::Mod | BinaryOp::And | BinaryOp::Or | BinaryOp::Xor => {
            integer_operation(op, left, right, undocumented)?
        }
    })
}

/// Computes an operator on whole numbers.
#[inline(never)]
fn integer_operation(
    op: BinaryOp,
    left: f64,
    right: f64,
    undocumented: &UndocumentedChoices,
) -> Result<f64, Alarm> {
    if op == BinaryOp::Mod {
        let (left, right) = (round(left), round(right));
        // The remainder has the sign of the dividend.
        return if right == 0.0 { Err(Alarm::DivideByZero) } else { Ok(left % right) };
    }
    let (left, right) = (bits(left, undocumented)?, bits(right, undocumented)?);
    Ok(f64::from(match op {
        BinaryOp::And => left & right,
        BinaryOp::Or => left | right,
        _ => left ^ right,
    }))
}

/// Returns an operand of AND, OR and XOR as a 32-bit integer.
fn bits(value: f64, undocumented: &UndocumentedChoices) -> Result<i32, Alarm> {
    let value = round(value);
    if value < 0.0 && undocumented.negative_bits_alarm {
        return Err(Alarm::OutOfRange { function: "AND, OR, XOR".into(), value });
    }
    if (-2_147_483_648.0..=2_147_483_647.0).contains(&value) {
        Ok(value as i32)
    } else if (0.0..=4_294_967_295.0).contains(&value) {
        Ok(value as u32 as i32)
    } else {
        Err(Alarm::IntegerOverflow)
    }
}

/// Compares two values. Vacant equals vacant and differs from 0; larger and smaller take it for 0 (manual's comparison
/// table).
#[inline]
pub(super) fn compare(relation: Relation, left: Value, right: Value) -> bool {
    match relation {
        Relation::Eq => left == right,
        Relation::Ne => left != right,
        _ => relation.holds(left.number(), right.number()),
    }
}

/// Computes a function of one argument.
pub fn function(name: Function, x: f64, settings: &Settings) -> Result<f64, Alarm> {
    let value = function_value(name, x, settings);
    if is_finite(value) { Ok(value) } else { Err(function_alarm(name, x)) }
}

/// Returns the value of a function; NaN or infinite where it raises an alarm.
#[inline(never)]
pub(super) fn function_value(name: Function, x: f64, settings: &Settings) -> f64 {
    let residue = |y: f64| if settings.zeroes_residues && y.abs() < 1e-8 { 0.0 } else { y };
    match name {
        Function::Sqrt => x.sqrt(),
        Function::Sin => residue(Deg(x).sin()),
        Function::Cos => residue(Deg(x).cos()),
        Function::Tan if settings.undocumented.tan_90_alarms && (x % 180.0).abs() == 90.0 => f64::NAN,
        Function::Tan => residue(Deg(x).tan()),
        Function::Asin => apply_angle_range(Deg::asin(x).0, settings),
        Function::Acos => Deg::acos(x).0,
        Function::Atan => Deg::atan2(x, 1.0).0,
        Function::Abs => x.abs(),
        Function::Round => round(x),
        Function::Fix => x.trunc(),
        Function::Fup if x < 0.0 => x.floor(),
        Function::Fup => x.ceil(),
        Function::Ln => libm::log(x),
        Function::Exp => libm::exp(x),
        Function::Bcd if !(0.0..=99_999_999.0).contains(&round(x)) => f64::NAN,
        Function::Bcd => f64::from(to_bcd(round(x) as u32)),
        Function::Bin if !(0.0..=f64::from(u32::MAX)).contains(&round(x)) => f64::NAN,
        Function::Bin => from_bcd(round(x) as u32).map_or(f64::NAN, f64::from),
        // These take two values, or a variable.
        Function::Adp | Function::Pow => f64::NAN,
    }
}

/// Returns the alarm of a function without a value.
#[cold]
pub(super) fn function_alarm(name: Function, x: f64) -> Alarm {
    match name {
        Function::Adp => Alarm::ArgumentFormat { function: "ADP".into() },
        Function::Pow => Alarm::MissingComma,
        _ => Alarm::OutOfRange { function: format!("{name:?}").to_uppercase(), value: x },
    }
}

/// Returns an angle from 0 to 360, or with its sign if NAT is set.
fn apply_angle_range(degrees: f64, settings: &Settings) -> f64 {
    if degrees < 0.0 && !settings.returns_signed_angles { degrees + 360.0 } else { degrees }
}

/// Computes ATAN of two values, degrees; that of two zeros is 0 or an alarm.
pub fn atan2(y: f64, x: f64, settings: &Settings) -> Result<f64, Alarm> {
    if y != 0.0 || x != 0.0 {
        return Ok(angle(y, x, settings));
    }
    match settings.undocumented.atan_of_zeros_alarms {
        true => Err(Alarm::OutOfRange { function: "ATAN".into(), value: 0.0 }),
        false => Ok(0.0),
    }
}

/// Returns ATAN of two values of which at most one is 0.
#[inline]
pub(super) fn angle(y: f64, x: f64, settings: &Settings) -> f64 {
    // A negative zero must not change 180° into −180°.
    apply_angle_range(Deg::atan2(y + 0.0, x).0, settings)
}

/// Computes POW.
pub fn power(base: f64, exponent: f64) -> Result<f64, Alarm> {
    if base < 0.0 {
        return Err(Alarm::OutOfRange { function: "POW".into(), value: base });
    }
    if base == 0.0 && exponent < 0.0 {
        return Err(Alarm::DivideByZero);
    }
    check_finite(libm::pow(base, exponent))
}

fn to_bcd(number: u32) -> u32 {
    (0..8).fold(0, |bcd, digit| bcd | (number / 10_u32.pow(digit) % 10) << (4 * digit))
}

fn from_bcd(code: u32) -> Option<u32> {
    (0..8).rev().try_fold(0_u32, |number, digit| {
        let value = code >> (4 * digit) & 15;
        (value <= 9).then(|| number * 10 + value)
    })
}

/// Result of a step of execution, its alarm located.
pub(super) type ExecResult<T> = Result<T, LocatedAlarm>;

/// Returns the variable number of an expression: rounded, not negative; vacant is #0.
pub(super) fn variable_number(value: Value) -> Result<u32, Alarm> {
    let number = value.number();
    let whole = number as u32;
    if f64::from(whole) == number {
        return Ok(whole);
    }
    let number = round(number);
    if (0.0..=f64::from(u32::MAX)).contains(&number) {
        return Ok(number as u32);
    }
    Err(Alarm::NoSuchVariable { number: number as i64 })
}

/// Returns the nearest integer, for an index, a code or a count.
pub(super) fn integer(value: f64) -> Result<i64, Alarm> {
    let rounded = round(value);
    if rounded.abs() <= 999_999_999_999.0 { Ok(rounded as i64) } else { Err(Alarm::IntegerOverflow) }
}

/// Locates the alarm of a result.
pub(super) fn locate<T>(result: Result<T, Alarm>, span: Span) -> ExecResult<T> {
    result.map_err(|alarm| alarm.located_at(span))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn vacant_differs_from_zero_only_in_eq_and_ne() {
        let (vacant, zero) = (Value::Vacant, Value::Number(0.0));
        assert!(!compare(Relation::Eq, vacant, zero) && compare(Relation::Ne, vacant, zero));
        assert!(compare(Relation::Ge, vacant, zero) && !compare(Relation::Gt, vacant, zero));
        assert!(compare(Relation::Eq, vacant, vacant));
    }

    #[test]
    fn angles_are_positive_unless_nat_is_set() {
        let mut settings = Settings::default();
        assert_eq!(atan2(-1.0, -1.0, &settings), Ok(225.0));
        assert_eq!(atan2(-0.0, -1.0, &settings), Ok(180.0));
        settings.returns_signed_angles = true;
        assert_eq!(atan2(-1.0, -1.0, &settings), Ok(-135.0));
    }

    #[test]
    fn bcd_has_a_decimal_digit_in_four_bits() {
        assert_eq!((to_bcd(1234), from_bcd(0x1234), from_bcd(0x1A)), (0x1234, Some(1234), None));
    }

    #[test]
    fn fup_rounds_away_from_zero() {
        let settings = Settings::default();
        assert_eq!(function(Function::Fup, -1.2, &settings), Ok(-2.0));
        assert_eq!(function(Function::Fup, 3.0, &settings), Ok(3.0));
        assert_eq!(function(Function::Fix, -1.2, &settings), Ok(-1.0));
    }
}
