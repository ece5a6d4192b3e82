//! Words: an address and its value.
use super::ast::{Address, Expr, ExprKind, Word, WordValue};
use super::expr::single;
use super::number::{WORD_DIGITS, decimal};
use super::token::{Input, Line, Read, comment_before, fail, other, round_brackets, spaces};
use crate::alarm::Alarm;

/// The longest program name.
const LONGEST_NAME: usize = 32;

/// `X10.`, `X-#1`, `F[#7/3.]`, `,R10.`, `P<NAME>`. The input begins with the letter or the comma.
pub(super) fn word(line: Line, input: Input<'_>) -> Read<'_, Word> {
    let (comma, from) = match input {
        [b',', rest @ ..] => (true, spaces(rest)),
        _ => (false, input),
    };
    let letter = match from.first() {
        // O stands first in its line (see `file`) and takes no variable.
        Some(byte) if byte.is_ascii_alphabetic() && !matches!(byte, b'O' | b'o') => byte.to_ascii_uppercase(),
        _ => return other(input),
    };
    let start = spaces(&from[1..]);
    let (negative, unsigned) = match start {
        [b'-', rest @ ..] => (true, spaces(rest)),
        [b'+', rest @ ..] => (false, spaces(rest)),
        _ => (false, start),
    };
    let nothing = |after| match char::from(letter) {
        letter if comment_before(after) => round_brackets(after, Some(letter)),
        letter => fail(input, Alarm::NoDataAfterAddress { letter }),
    };
    let (rest, value) = match unsigned.first() {
        Some(b'0'..=b'9' | b'.') => match decimal(unsigned, negative, WORD_DIGITS) {
            Ok((rest, number)) => (rest, WordValue::Literal(number)),
            Err(nom::Err::Error(_)) => return nothing(&from[1..]),
            Err(error) => return Err(error),
        },
        Some(b'#' | b'[') => {
            let (rest, mut value) = single(line, unsigned)?;
            if negative {
                value = Expr { kind: ExprKind::Negate(Box::new(value)), span: line.span(start, rest) };
            }
            (rest, WordValue::Expr(value))
        }
        Some(b'<') if letter == b'P' => {
            let (rest, name) = program_name(unsigned)?;
            (rest, WordValue::Name(name))
        }
        Some(b'-' | b'+') => return fail(unsigned, Alarm::IllegalMinus { letter: char::from(letter) }),
        _ => return nothing(&from[1..]),
    };
    Ok((rest, Word { address: Address { letter, comma }, value, span: line.span(input, rest) }))
}

/// `M98 <NAME>`: the name stands for the word P.
pub(super) fn name_word(line: Line, input: Input<'_>) -> Read<'_, Word> {
    let (rest, name) = program_name(input)?;
    let address = Address { letter: b'P', comma: false };
    Ok((rest, Word { address, value: WordValue::Name(name), span: line.span(input, rest) }))
}

/// `<NAME>`: letters, digits and `+ - _ .`; with folders in a call also `/`.
pub(super) fn program_name(input: Input<'_>) -> Read<'_, String> {
    let Some(inside) = input.strip_prefix(b"<") else { return other(input) };
    let fits = |b: &u8| b.is_ascii_alphanumeric() || matches!(b, b'+' | b'-' | b'_' | b'.' | b'/');
    let length = inside.iter().take_while(|b| fits(b)).count();
    let name = String::from_utf8_lossy(&inside[..length]).to_ascii_uppercase();
    let last = name.rsplit('/').next().map_or(0, str::len);
    match inside.get(length) {
        Some(b'>') if (1..=LONGEST_NAME).contains(&last) => Ok((&inside[length + 1..], name)),
        _ => fail(input, Alarm::NameFormat),
    }
}
