//! Literal numbers: digits with at most one point, spaces anywhere between them.
use super::ast::Decimal;
use super::token::{Input, Read, fail, is_space, other, shown};
use crate::alarm::Alarm;

/// Digits a literal may have in a macro expression, and after an address.
pub(super) const EXPRESSION_DIGITS: u32 = 12;
pub(super) const WORD_DIGITS: u32 = 9;

/// An unsigned literal of at most `most` digits, leading zeros not counted.
pub(super) fn decimal(input: Input<'_>, negative: bool, most: u32) -> Read<'_, Decimal> {
    let mut digits: u64 = 0;
    let mut significant = 0;
    let mut any = false;
    let mut places: Option<u8> = None;
    let mut used = 0;
    for (at, byte) in input.iter().enumerate() {
        match byte {
            b'0'..=b'9' => {
                any = true;
                if digits > 0 || *byte != b'0' {
                    significant += 1;
                }
                if significant > most {
                    return fail(input, Alarm::TooManyDigits);
                }
                digits = digits * 10 + u64::from(byte - b'0');
                places = match places {
                    Some(n) if n >= 18 => return fail(input, Alarm::TooManyDigits),
                    Some(n) => Some(n + 1),
                    None => None,
                };
                used = at + 1;
            }
            b'.' if places.is_some() => return fail(input, Alarm::IllegalPoint { letter: None }),
            b'.' => {
                places = Some(0);
                used = at + 1;
            }
            byte if is_space(*byte) => {}
            _ => break,
        }
    }
    match (any, places) {
        (true, _) => Ok((&input[used..], Decimal { negative, digits, places })),
        (false, Some(_)) => fail(input, Alarm::NotAWord { text: shown(input) }),
        (false, None) => other(input),
    }
}

/// A whole number without a point, as after N, O, DO and `/`.
pub(super) fn integer(input: Input<'_>) -> Read<'_, u64> {
    let (rest, number) = decimal(input, false, EXPRESSION_DIGITS)?;
    match number.places {
        None => Ok((rest, number.digits)),
        Some(_) => fail(input, Alarm::IllegalPoint { letter: None }),
    }
}
