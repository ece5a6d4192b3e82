//! Alarms that an operation can raise for operands in given ranges.
use gcode_lang::units::round;

use crate::interval::Interval;
use crate::node::{AlarmKind, Binary, Semantics, Unary};
use crate::values::{self, BCD_MAX};

/// An alarm that an operation can raise, given that its operands have values.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PossibleAlarm {
    /// Its kind.
    pub kind: AlarmKind,
    /// True if the operation raises it for every value of the operands.
    pub is_certain: bool,
}

/// Collects the alarms whose condition isn't false.
fn alarms<const N: usize>(cases: [(AlarmKind, bool, bool); N]) -> Vec<PossibleAlarm> {
    let possible = cases.into_iter().filter(|(_, is_possible, _)| *is_possible);
    possible.map(|(kind, _, is_certain)| PossibleAlarm { kind, is_certain }).collect()
}

/// Returns the alarm of an operation on numbers.
fn of_point(value: Result<f64, AlarmKind>) -> Vec<PossibleAlarm> {
    value.err().map(|kind| PossibleAlarm { kind, is_certain: true }).into_iter().collect()
}

/// Returns the alarms of a function of one value.
pub(crate) fn unary(function: Unary, x: Interval, semantics: Semantics) -> Vec<PossibleAlarm> {
    if let Some(point) = x.as_point() {
        return of_point(values::unary(function, point, semantics));
    }
    let (lo, hi) = (x.lo(), x.hi());
    let (is_possible, is_certain) = match function {
        Unary::Sqrt => (lo < 0.0, hi < 0.0),
        Unary::Ln => (lo <= 0.0, hi <= 0.0),
        Unary::Asin | Unary::Acos => (lo < -1.0 || hi > 1.0, hi < -1.0 || lo > 1.0),
        // The logarithm of the largest double is 709.7827….
        Unary::Exp => (hi > 709.78, lo > 709.79),
        Unary::Tan if semantics.tan_90_alarms => (has_right_angle(x), false),
        Unary::Bcd => (round(lo) < 0.0 || round(hi) > BCD_MAX, round(hi) < 0.0 || round(lo) > BCD_MAX),
        Unary::Bin => {
            let codes = f64::from(u32::MAX);
            (round(lo) < 0.0 || round(hi) > 9.0, round(hi) < 0.0 || round(lo) > codes)
        }
        _ => (false, false),
    };
    alarms([(AlarmKind::OutOfRange, is_possible, is_certain)])
}

/// Returns true if a range can have an odd multiple of 90°.
fn has_right_angle(x: Interval) -> bool {
    let next = ((x.lo() - 90.0) / 180.0 - 1e-9).ceil() * 180.0 + 90.0;
    x.magnitude() > 1e9 || next <= x.hi() || x.hi() - x.lo() >= 180.0
}

/// Returns the alarms of an operator or a function of two values.
pub(crate) fn binary(operator: Binary, a: Interval, b: Interval, semantics: Semantics) -> Vec<PossibleAlarm> {
    if let (Some(left), Some(right)) = (a.as_point(), b.as_point()) {
        return of_point(values::binary(operator, left, right, semantics));
    }
    let (largest, least) = (a.magnitude(), a.mignitude());
    match operator {
        Binary::Add => alarms([overflow(a.lo() + b.lo(), a.hi() + b.hi())]),
        Binary::Sub => alarms([overflow(a.lo() - b.hi(), a.hi() - b.lo())]),
        Binary::Mul => alarms([(
            AlarmKind::Overflow,
            !(largest * b.magnitude()).is_finite(),
            !(least * b.mignitude()).is_finite(),
        )]),
        Binary::Div => alarms([
            (AlarmKind::DivideByZero, b.contains(0.0), b.magnitude() == 0.0),
            (
                AlarmKind::Overflow,
                !(largest / b.mignitude().max(f64::from_bits(1))).is_finite() && b.magnitude() > 0.0,
                b.mignitude() > 0.0 && !(least / b.magnitude()).is_finite(),
            ),
        ]),
        Binary::Mod => alarms([(AlarmKind::DivideByZero, b.mignitude() < 0.5, b.magnitude() < 0.5)]),
        Binary::And | Binary::Or | Binary::Xor => {
            let (lo, hi) = (round(a.lo().min(b.lo())), round(a.hi().max(b.hi())));
            let (lower, upper) = (f64::from(i32::MIN), f64::from(u32::MAX));
            alarms([
                (AlarmKind::OutOfRange, semantics.negative_bits_alarm && lo < 0.0, false),
                (AlarmKind::IntegerOverflow, lo < lower || hi > upper, false),
            ])
        }
        Binary::Pow => {
            let positive = a.intersect(Interval::new(0.0, f64::MAX));
            let ends = [positive.lo(), positive.hi()].into_iter().flat_map(|a| [(a, b.lo()), (a, b.hi())]);
            // The margin covers the error of a value between the corners.
            let is_large = |(a, b)| libm::pow(a, b) > f64::MAX / 2.0;
            alarms([
                (AlarmKind::OutOfRange, a.lo() < 0.0, a.hi() < 0.0),
                (
                    AlarmKind::DivideByZero,
                    a.contains(0.0) && b.lo() < 0.0,
                    a.magnitude() == 0.0 && b.hi() < 0.0,
                ),
                (AlarmKind::Overflow, !positive.is_empty() && ends.into_iter().any(is_large), false),
            ])
        }
        Binary::Atan => {
            let is_possible = semantics.atan_of_zeros_alarms && a.contains(0.0) && b.contains(0.0);
            alarms([(AlarmKind::OutOfRange, is_possible, false)])
        }
        Binary::Compare(_) => Vec::new(),
    }
}

/// Returns the case of a sum between two ends.
fn overflow(lo: f64, hi: f64) -> (AlarmKind, bool, bool) {
    let is_certain = lo == f64::INFINITY || hi == f64::NEG_INFINITY;
    (AlarmKind::Overflow, !lo.is_finite() || !hi.is_finite(), is_certain)
}
