//! The result of a check, and numbers that have to be whole.
use super::variables::Value;
use gcode_lang::alarm::{Alarm, LocatedAlarm};
use gcode_lang::source::Span;
use gcode_lang::units::round;

pub(super) type ExecResult<T> = Result<T, LocatedAlarm>;

/// A variable's number by an expression: rounded, never negative; vacant is #0.
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

/// A value as the integer that an index, a code or a count is: the nearest one.
pub(super) fn integer(value: f64) -> Result<i64, Alarm> {
    let rounded = round(value);
    if rounded.abs() <= 999_999_999_999.0 { Ok(rounded as i64) } else { Err(Alarm::IntegerOverflow) }
}

/// Where a value of a computed word stands.
pub(super) fn locate<T>(result: Result<T, Alarm>, span: Span) -> ExecResult<T> {
    result.map_err(|alarm| alarm.located_at(span))
}
