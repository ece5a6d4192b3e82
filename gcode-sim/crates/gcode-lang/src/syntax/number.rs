//! Reader of literal numbers: digits with at most one decimal point, with spaces anywhere between them.
use super::ast::Decimal;
use super::token::{Input, ReadResult, fail, is_space, no_match, unspaced};
use crate::alarm::{Alarm, DigitLimit};

/// First number with too many digits: a literal in a macro expression has at most twelve.
pub(super) const EXPRESSION_LIMIT: u64 = 1_000_000_000_000;
/// First number with too many digits after an address: at most nine are allowed.
pub(super) const WORD_LIMIT: u64 = 1_000_000_000;
/// Most digits after the decimal point. Zeros do not count as digits, so the digit limit alone does not bound
/// them.
const MAX_DECIMAL_PLACES: usize = 18;

/// Reads an unsigned literal whose digits, taken as a whole number, are below `limit`.
pub(super) fn decimal(input: Input<'_>, negative: bool, limit: u64) -> ReadResult<'_, Decimal> {
    let (mut digits, mut count, mut rest) = (0u64, 0, input);
    let mut before_point = None;
    loop {
        let mut length = 0;
        for byte in rest {
            let digit = byte.wrapping_sub(b'0');
            if digit > 9 {
                break;
            }
            digits = digits * 10 + u64::from(digit);
            if digits >= limit {
                return fail(input, Alarm::TooManyDigits(DigitLimit::Written(limit.ilog10() as u8)));
            }
            length += 1;
        }
        (count, rest) = (count + length, &rest[length..]);
        match rest {
            [b'.', ..] if before_point.is_some() => return fail(input, Alarm::IllegalPoint { letter: None }),
            [b'.', after @ ..] => (before_point, rest) = (Some(count), after),
            // The most common end of a number.
            [b' ', b'A'..=b'Z', ..] => break,
            [byte, ..] if is_space(*byte) => match unspaced(rest) {
                // Spaces after the number are not part of it.
                behind @ [b'0'..=b'9' | b'.', ..] => rest = behind,
                _ => break,
            },
            _ => break,
        }
    }
    let places = before_point.map(|before| count - before);
    if places > Some(MAX_DECIMAL_PLACES) {
        return fail(input, Alarm::TooManyDigits(DigitLimit::Written(MAX_DECIMAL_PLACES as u8)));
    }
    let places = places.map(|places| places as u8);
    if count > 0 { Ok((rest, Decimal { negative, digits, places })) } else { no_match(input) }
}

/// Reads a whole number without a decimal point, as after N, O, DO and `/`.
pub(super) fn integer(input: Input<'_>) -> ReadResult<'_, u64> {
    let (rest, number) = decimal(input, false, EXPRESSION_LIMIT)?;
    match number.places {
        None => Ok((rest, number.digits)),
        Some(_) => fail(input, Alarm::IllegalPoint { letter: None }),
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn read(text: &str) -> Option<(u64, Option<u8>, usize)> {
        let (rest, number) = decimal(text.as_bytes(), false, WORD_LIMIT).ok()?;
        Some((number.digits, number.places, rest.len()))
    }

    proptest! {
        #[test]
        fn a_number_is_the_double_nearest_to_what_is_written(
            text in "[0-9]{0,11}\\.[0-9]{1,11}|[0-9]{1,12}\\.?|[0-9]{0,3}\\.0{0,6}[0-9]{1,9}",
        ) {
            let expected: f64 = text.parse().unwrap();
            match decimal(text.as_bytes(), false, EXPRESSION_LIMIT) {
                Ok((rest, number)) => {
                    prop_assert!(rest.is_empty());
                    prop_assert_eq!(number.value().to_bits(), expected.to_bits());
                }
                Err(_) => prop_assert!(text.replace('.', "").trim_start_matches('0').len() > 12),
            }
        }
    }

    #[test]
    fn numbers_may_contain_points_zeros_and_spaces() {
        assert_eq!(read("12.50"), Some((1250, Some(2), 0)));
        assert_eq!(read(".5"), Some((5, Some(1), 0)));
        assert_eq!(read("5."), Some((5, Some(0), 0)));
        assert_eq!(read("0000000000012"), Some((12, None, 0)), "leading zeros are no digits");
        assert_eq!(read("1 0. 5 Y"), Some((105, Some(1), 2)), "the space before Y is left");
        assert_eq!(read("123456789"), Some((123_456_789, None, 0)));
        assert_eq!(read("."), None);
        assert_eq!(read("1234567890"), None, "nine digits at most");
        assert_eq!(read("1..5"), None);
    }
}
