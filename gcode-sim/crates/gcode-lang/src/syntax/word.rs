//! Reader of words: an address and its value.
use super::ast::{AX, Address, Expr, ExprKind, Word, WordValue};
use super::expr::{close, expr, require_value, single_value};
use super::number::{WORD_LIMIT, decimal};
use super::token::{
    Input, LineInput, ReadResult, comment_before, fail, letters, next, no_match, round_brackets, spaces,
};
use crate::alarm::Alarm;

/// Longest program name.
const MAX_PROGRAM_NAME_LENGTH: usize = 32;

/// Reads `X10.`, `X-#1`, `F[#7/3.]`, `,R10.` or `P<NAME>`. The input begins with the letter or the comma.
#[inline]
pub(super) fn word(line: LineInput, input: Input<'_>) -> ReadResult<'_, Word> {
    let (comma, from) = match input {
        [b',', rest @ ..] => (true, spaces(rest)),
        _ => (false, input),
    };
    if let [b'A' | b'a', ..] = from
        && let (rest, 2) = letters(from, "AX")
        && !comma
        && let Some((b'[', inside)) = next(rest)
    {
        return axis_word(line, input, inside);
    }
    let letter = match from.first() {
        // O comes first in its line (see `file_items`) and takes no variable.
        Some(byte) if byte.is_ascii_alphabetic() && !matches!(byte, b'O' | b'o') => byte.to_ascii_uppercase(),
        _ => return no_match(input),
    };
    let (rest, value) = word_value(line, input, &from[1..], letter)?;
    let address = Address { letter, comma };
    Ok((rest, Word { address, axis: None, value, span: line.span(input, rest) }))
}

/// Reads the rest of `AX[1]=10.` or `AX[#1]10.` after the `[`.
fn axis_word<'a>(line: LineInput, input: Input<'a>, inside: Input<'a>) -> ReadResult<'a, Word> {
    let (rest, axis) = require_value(expr(line, inside, 1), inside)?;
    let (rest, ()) = close(rest)?;
    let behind = match next(rest) {
        Some((b'=', behind)) => behind,
        _ => rest,
    };
    let (rest, value) = word_value(line, input, behind, b'A')?;
    let address = Address { letter: AX, comma: false };
    Ok((rest, Word { address, axis: Some(Box::new(axis)), value, span: line.span(input, rest) }))
}

/// Reads the value after an address.
#[inline]
fn word_value<'a>(
    line: LineInput,
    input: Input<'a>,
    behind: Input<'a>,
    letter: u8,
) -> ReadResult<'a, WordValue> {
    let start = spaces(behind);
    let (negative, unsigned) = match start {
        [b'-', rest @ ..] => (true, spaces(rest)),
        [b'+', rest @ ..] => (false, spaces(rest)),
        _ => (false, start),
    };
    let missing_value = |after| match char::from(letter) {
        letter if comment_before(after) => round_brackets(after, Some(letter)),
        letter => fail(input, Alarm::NoDataAfterAddress { letter }),
    };
    match unsigned.first() {
        Some(b'0'..=b'9' | b'.') => match decimal(unsigned, negative, WORD_LIMIT) {
            Ok((rest, number)) => Ok((rest, WordValue::Literal(number))),
            Err(nom::Err::Error(_)) => missing_value(behind),
            Err(error) => Err(error),
        },
        Some(b'#' | b'[') => {
            let (rest, mut value) = single_value(line, unsigned)?;
            if negative {
                value = Expr { kind: ExprKind::Negate(Box::new(value)), span: line.span(start, rest) };
            }
            Ok((rest, WordValue::Expr(Box::new(value))))
        }
        Some(b'<') if letter == b'P' => {
            let (rest, name) = program_name(unsigned)?;
            Ok((rest, WordValue::Name(name)))
        }
        Some(b'-' | b'+') => fail(unsigned, Alarm::TwoSigns { letter: char::from(letter) }),
        _ => missing_value(behind),
    }
}

/// Reads `<NAME>` of `M98 <NAME>` as a word P.
pub(super) fn name_word(line: LineInput, input: Input<'_>) -> ReadResult<'_, Word> {
    let (rest, name) = program_name(input)?;
    let address = Address { letter: b'P', comma: false };
    Ok((rest, Word { address, axis: None, value: WordValue::Name(name), span: line.span(input, rest) }))
}

/// Reads `<NAME>`: letters, digits, `+ - _ .` and the blanks that some controls accept, in a call also `/` between folders.
pub(super) fn program_name(input: Input<'_>) -> ReadResult<'_, String> {
    let Some(inside) = input.strip_prefix(b"<") else { return no_match(input) };
    let fits = |b: &u8| b.is_ascii_alphanumeric() || matches!(b, b'+' | b'-' | b'_' | b'.' | b'/' | b' ');
    let length = inside.iter().take_while(|b| fits(b)).count();
    let name = String::from_utf8_lossy(&inside[..length]).to_ascii_uppercase();
    let last = name.rsplit('/').next().map_or(0, str::len);
    match inside.get(length) {
        Some(b'>') if (1..=MAX_PROGRAM_NAME_LENGTH).contains(&last) => Ok((&inside[length + 1..], name)),
        _ => fail(input, Alarm::NameFormat),
    }
}
