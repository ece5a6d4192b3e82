//! Reader of one line: skip, sequence number, words and statements in the order written.
use nom::Err;

use super::ast::{Address, Block, Decimal, DoLine, Item, Statement, Unreadable, Word, WordValue};
use super::number::integer;
use super::numbers::{MAX_SEQUENCE_NUMBER, continues_number, number_word, window};
use super::statement::{assignment, keyword, statement};
use super::token::{Input, LineInput, ReadFailure, ReadResult, fail, is_space, next, no_match, spaces};
use super::word::{name_word, word};
use crate::alarm::{Alarm, DigitLimit};
use crate::source::Spanned;

/// Reads one line without its end into an empty block; an unreadable rest becomes the last item.
///
/// `%`, a `;` with another block behind it, and an O word after M02, M30 or M99 (`M99O0810(TEXT)`), end the block.
/// Returns the input from there on.
pub(super) fn read_block<'a>(line: LineInput, input: Input<'a>, block: &mut Block) -> Input<'a> {
    let mut rest = spaces(input);
    while !rest.is_empty() && !ends_block(rest, block) {
        match read_item(line, rest, block) {
            Ok((after, ())) => rest = spaces(after),
            Err(error) => {
                block.items.push(Item::Unreadable(Box::new(unreadable(line, rest, error))));
                rest = &rest[rest.len()..];
            }
        }
    }
    if begins_statement(rest) && block.do_line == DoLine::No {
        block.do_line = DoLine::Begins(line.span(rest, &rest[rest.len()..]));
    }
    block.span = line.span(input, rest);
    rest
}

fn ends_block(rest: Input<'_>, block: &Block) -> bool {
    match rest.first() {
        Some(b'%') => true,
        Some(b';') => !block.items.is_empty(),
        Some(b'O' | b'o') => begins_program(rest) && block.items.last().is_some_and(ends_program),
        // Behind DO each statement is a block of its own.
        Some(_) if block.items.last().is_some_and(|last| is_do(last, block.do_line)) => {
            begins_statement(rest)
        }
        _ => false,
    }
}

/// Returns true for WHILE and DO, and for any statement behind one in its line.
fn is_do(item: &Item, line: DoLine) -> bool {
    let Item::Statement(statement) = item else { return false };
    line == DoLine::Behind || matches!(statement.node, Statement::While { .. } | Statement::Do(_))
}

/// Returns true at an assignment and at a keyword.
fn begins_statement(rest: Input<'_>) -> bool {
    matches!(rest.first(), Some(b'#' | b'[')) || keyword(rest).is_some()
}

fn ends_program(item: &Item) -> bool {
    let Item::Word(Word { address, value: WordValue::Literal(number), .. }) = item else { return false };
    address.letter == b'M' && matches!(number.digits, 2 | 30 | 99)
}

/// Returns true at `O0001` or `:0001`.
pub(super) fn begins_program(input: Input<'_>) -> bool {
    match input.split_first() {
        Some((b'O' | b'o' | b':', rest)) => matches!(next(rest), Some((b'0'..=b'9', _))),
        _ => false,
    }
}

/// Converts a read failure to the unreadable rest of the line; its text is filled in later.
fn unreadable(line: LineInput, from: Input<'_>, error: Err<ReadFailure>) -> Unreadable {
    let (alarm, left) = match error {
        Err::Error(fault) | Err::Failure(fault) => {
            let left = fault.remaining;
            (fault.into_alarm(), left)
        }
        Err::Incomplete(_) => (Alarm::NotAWord { text: String::new() }, from.len()),
    };
    let at = &from[from.len() - left.min(from.len())..];
    let end = &from[from.len()..];
    let behind = match alarm {
        // The words behind the number are none of its fault.
        Alarm::IllegalPoint { .. } | Alarm::TooManyDigits(_) => behind_number(at),
        _ => end,
    };
    Unreadable { alarm: line.spanned(alarm, at, behind), span: line.span(from, end), text: Vec::new() }
}

/// Returns the input behind a letter and the digits and points that follow it.
fn behind_number(at: Input<'_>) -> Input<'_> {
    let is_of_number = |byte: &u8| byte.is_ascii_digit() || *byte == b'.' || is_space(*byte);
    let letter = usize::from(at.first().is_some_and(u8::is_ascii_alphabetic));
    let length = letter + at[letter..].iter().take_while(|byte| is_of_number(byte)).count();
    let spaces = at[..length].iter().rev().take_while(|byte| is_space(**byte)).count();
    &at[length - spaces..]
}

fn read_item<'a>(line: LineInput, at: Input<'a>, block: &mut Block) -> ReadResult<'a, ()> {
    let is_first_item = block.items.is_empty();
    let (rest, item) = match at {
        [b'/', ..] => {
            let (rest, switch) = skip(line, at)?;
            if is_first_item && block.skip.is_none() {
                block.skip = Some(switch);
                return Ok((rest, ()));
            }
            (rest, Item::Skip(switch))
        }
        [b'N' | b'n', ..] if is_first_item && block.number.is_none() => {
            let (rest, number) = sequence_number(line, at)?;
            block.number = Some(number);
            return Ok((rest, ()));
        }
        [b'#' | b'[', ..] => {
            let (rest, found) = assignment(line, at)?;
            (rest, Item::Statement(Box::new(line.spanned(found, at, rest))))
        }
        [b'<', ..] => {
            let (rest, word) = name_word(line, at)?;
            (rest, Item::Word(word))
        }
        [b'O' | b'o' | b':', ..] if is_first_item && begins_program(at) => {
            match integer(spaces(&at[1..])) {
                // Number 0 is none: the operator gives the program one, or the control refuses it.
                Ok((rest, 0)) => {
                    let number = Decimal { negative: false, digits: 0, places: None };
                    let address = Address { letter: b'O', comma: false };
                    let (value, span) = (WordValue::Literal(number), line.span(at, rest));
                    (rest, Item::Word(Word { address, axis: None, value, span }))
                }
                _ => return fail(at, Alarm::ProgramNumber),
            }
        }
        [b',' | b'A'..=b'Z' | b'a'..=b'z', ..] => match (number_word(&window(at)), keyword(at)) {
            (Some((letter, number, length)), _) if !continues_number(&at[length..]) => {
                let rest = &at[length..];
                let (address, value) = (Address { letter, comma: false }, WordValue::Literal(number));
                (rest, Item::Word(Word { address, axis: None, value, span: line.span(at, rest) }))
            }
            (_, Some(begun)) => {
                let (rest, (found, short)) = statement(line, &begun)?;
                let found = line.spanned(found, at, rest);
                if short {
                    block.short_word = block.short_word.or(Some(found.span));
                }
                (rest, Item::Statement(Box::new(found)))
            }
            (_, None) => {
                let (rest, word) = word(line, at)?;
                (rest, Item::Word(word))
            }
        },
        [b']', ..] => return fail(at, Alarm::MissingOpenBracket),
        [b';', ..] => return fail(at, Alarm::TwoBlocksInOneLine),
        _ => return no_match(at),
    };
    block.items.push(item);
    Ok((rest, ()))
}

/// Reads `/` or `/n` and returns the switch number.
fn skip(line: LineInput, at: Input<'_>) -> ReadResult<'_, Spanned<u8>> {
    let after = &at[1..];
    match next(after) {
        Some((digit @ b'1'..=b'9', rest)) if !matches!(next(rest), Some((b'0'..=b'9' | b'.', _))) => {
            Ok((rest, line.spanned(digit - b'0', at, rest)))
        }
        Some((b'0'..=b'9' | b'.', _)) => no_match(at),
        _ => Ok((after, line.spanned(1, at, after))),
    }
}

/// Reads a sequence number, `N10`. The input begins with the letter.
pub(super) fn sequence_number(line: LineInput, at: Input<'_>) -> ReadResult<'_, Spanned<u32>> {
    let start = spaces(&at[1..]);
    let (rest, number) = match integer(start) {
        Err(Err::Error(_)) => match start.first() {
            Some(b'#' | b'[') => return no_match(at),
            Some(b'-') => return fail(start, Alarm::IllegalMinus { letter: 'N' }),
            _ => return fail(at, Alarm::NoDataAfterAddress { letter: 'N' }),
        },
        Err(Err::Failure(fault)) if matches!(fault.alarm(), Some(Alarm::IllegalPoint { .. })) => {
            return fail(at, Alarm::IllegalPoint { letter: Some('N') });
        }
        read => read?,
    };
    match u32::try_from(number) {
        Ok(number) if number <= MAX_SEQUENCE_NUMBER => Ok((rest, line.spanned(number, at, rest))),
        _ => fail(at, Alarm::TooManyDigits(DigitLimit::Written(8))),
    }
}
