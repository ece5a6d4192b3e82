//! One line: skip, sequence number, words, statements and comments in the order they stand in.
use nom::Err;

use super::ast::{Address, Block, Comment, Expr, ExprKind, Item, Word, WordValue};
use super::expr::{bracketed, target};
use super::number::{WORD_DIGITS, decimal, integer};
use super::statement::{assignment, keyword, statement};
use super::token::{Fault, Input, Line, Read, fail, shown, spaces};
use crate::alarm::Alarm;
use crate::source::Spanned;

/// Reads one line, its end not included. What can't be read is the block's last item.
///
/// An `O` word after other words begins the next program (`M99O0810(TEXT)`); it and the rest are handed back.
pub(super) fn block(line: Line, input: Input<'_>) -> (Block, Input<'_>) {
    let empty = line.span(input, input);
    let mut block = Block { span: empty, skip: None, number: None, items: Vec::new(), comments: Vec::new() };
    let left = match fill(line, input, &mut block) {
        Ok((left, ())) => left,
        Err(Err::Error(fault) | Err::Failure(fault)) => {
            block.items.push(Item::Unreadable(unreadable(line, input, fault)));
            &input[input.len()..]
        }
        Err(Err::Incomplete(_)) => &input[input.len()..],
    };
    block.span = line.span(input, left);
    (block, left)
}

fn unreadable(line: Line, input: Input<'_>, fault: Fault) -> Spanned<Alarm> {
    let at = &input[input.len() - fault.left.min(input.len())..];
    let end = at.iter().rposition(|b| !b.is_ascii_whitespace()).map_or(0, |last| last + 1);
    line.spanned(fault.alarm, at, &at[end..])
}

fn fill<'a>(line: Line, input: Input<'a>, block: &mut Block) -> Read<'a, ()> {
    let mut rest = spaces(input);
    loop {
        rest = spaces(rest);
        let at = rest;
        let beginning = block.items.is_empty();
        rest = match at {
            [] => return Ok((rest, ())),
            [b'(', ..] => comment(line, at, block),
            [b';', ..] | [b'/', b'/', ..] => remark(line, at, block),
            [b'/', after @ ..] => {
                let (after, switch) = skip(line, at, after)?;
                if beginning && block.number.is_none() && block.skip.is_none() {
                    block.skip = Some(switch);
                } else {
                    block.items.push(Item::Skip(switch));
                }
                after
            }
            [b'#' | b'[', ..] => {
                let (after, found) = assignment(line, at)?;
                block.items.push(Item::Statement(line.spanned(found, at, after)));
                after
            }
            [b'O' | b'o', ..] if !beginning && begins_program(at) => return Ok((at, ())),
            [b'N' | b'n', after @ ..] if beginning && block.number.is_none() => {
                let (after, number) = sequence_number(line, at, after)?;
                block.number = Some(number);
                after
            }
            [b'<', ..] => {
                let (after, word) = name_word(line, at)?;
                block.items.push(Item::Word(word));
                after
            }
            [b',' | b'A'..=b'Z' | b'a'..=b'z', ..] => match keyword(at) {
                Some((after, keyword)) => {
                    let (after, found) = statement(line, after, keyword)?;
                    block.items.push(Item::Statement(line.spanned(found, at, after)));
                    after
                }
                None => {
                    let (after, word) = word(line, at)?;
                    block.items.push(Item::Word(word));
                    after
                }
            },
            _ => return fail(at, Alarm::NotAWord { text: shown(at) }),
        };
    }
}

/// `O` and a digit: the next program of the file.
pub(super) fn begins_program(at: Input<'_>) -> bool {
    matches!(at.split_first(), Some((b'O' | b'o' | b':', rest)) if spaces(rest).first().is_some_and(u8::is_ascii_digit))
}

/// `(TEXT)`; brackets inside a text count, so that `(O9804: D (RING ID) REQUIRED)` is one comment. A comment that is
/// never closed is the rest of the line.
fn comment<'a>(line: Line, at: Input<'a>, block: &mut Block) -> Input<'a> {
    let mut depth = 0;
    let mut first_close = None;
    for (index, byte) in at.iter().enumerate() {
        match byte {
            b'(' => depth += 1,
            b')' => {
                depth -= 1;
                first_close.get_or_insert(index);
                if depth == 0 {
                    return push_comment(line, at, index, block);
                }
            }
            _ => {}
        }
    }
    match first_close {
        Some(index) => push_comment(line, at, index, block),
        None => {
            block.comments.push(Comment { span: line.span(at, &at[at.len()..]), text: at[1..].to_vec() });
            &at[at.len()..]
        }
    }
}

fn push_comment<'a>(line: Line, at: Input<'a>, close: usize, block: &mut Block) -> Input<'a> {
    let rest = &at[close + 1..];
    block.comments.push(Comment { span: line.span(at, rest), text: at[1..close].to_vec() });
    rest
}

/// `;` ends a block on a control's screen; files also write `; TEXT` and `// TEXT` as remarks.
fn remark<'a>(line: Line, at: Input<'a>, block: &mut Block) -> Input<'a> {
    let marks = if at[0] == b';' { 1 } else { 2 };
    let end = &at[at.len()..];
    let text = &at[marks..];
    if text.iter().any(|b| !b.is_ascii_whitespace()) {
        block.comments.push(Comment { span: line.span(at, end), text: text.to_vec() });
    }
    end
}

/// `/` or `/n`: the number of the switch.
fn skip<'a>(line: Line, at: Input<'a>, after: Input<'a>) -> Read<'a, Spanned<u8>> {
    match spaces(after).first() {
        Some(digit @ b'1'..=b'9') => {
            let rest = &spaces(after)[1..];
            Ok((rest, line.spanned(digit - b'0', at, rest)))
        }
        Some(b'0') => fail(at, Alarm::NotAWord { text: shown(at) }),
        _ => Ok((after, line.spanned(1, at, after))),
    }
}

fn sequence_number<'a>(line: Line, at: Input<'a>, after: Input<'a>) -> Read<'a, Spanned<u32>> {
    let start = spaces(after);
    let (rest, number) = match integer(start) {
        Err(Err::Error(_)) if start.first().is_none_or(u8::is_ascii_alphabetic) => {
            return fail(at, Alarm::NoDataAfterAddress { letter: 'N' });
        }
        Err(Err::Error(_)) => return fail(at, Alarm::NotAWord { text: shown(at) }),
        read => read?,
    };
    match u32::try_from(number) {
        Ok(number) if number <= 99_999_999 => Ok((rest, line.spanned(number, at, rest))),
        _ => fail(at, Alarm::TooManyDigits),
    }
}

/// `M98 <NAME>`: the name stands for the word P.
fn name_word(line: Line, at: Input<'_>) -> Read<'_, Word> {
    let Some(end) = at.iter().position(|b| *b == b'>') else {
        return fail(at, Alarm::NotAWord { text: shown(at) });
    };
    let rest = &at[end + 1..];
    let name = String::from_utf8_lossy(&at[1..end]).into_owned();
    let address = Address { letter: b'P', comma: false };
    Ok((rest, Word { address, value: WordValue::Name(name), span: line.span(at, rest) }))
}

fn word(line: Line, at: Input<'_>) -> Read<'_, Word> {
    let (comma, from) = match at {
        [b',', rest @ ..] => (true, spaces(rest)),
        _ => (false, at),
    };
    let Some(letter) = from.first().filter(|b| b.is_ascii_alphabetic()) else {
        return fail(at, Alarm::NotAWord { text: shown(at) });
    };
    let letter = letter.to_ascii_uppercase();
    let address = Address { letter, comma };
    let start = spaces(&from[1..]);
    let (negative, unsigned) = match start {
        [b'-', rest @ ..] => (true, spaces(rest)),
        [b'+', rest @ ..] => (false, spaces(rest)),
        _ => (false, start),
    };
    let (rest, value) = match unsigned.first() {
        Some(b'0'..=b'9' | b'.') => {
            let (rest, number) = decimal(unsigned, negative, WORD_DIGITS)?;
            (rest, WordValue::Literal(number))
        }
        Some(b'#' | b'[') => {
            let (rest, value) = single(line, unsigned)?;
            let value = if negative {
                Expr { kind: ExprKind::Negate(Box::new(value)), span: line.span(start, rest) }
            } else {
                value
            };
            (rest, WordValue::Expr(value))
        }
        Some(b'<') if letter == b'P' => {
            let (rest, word) = name_word(line, unsigned)?;
            (rest, word.value)
        }
        Some(b'(') => return fail(unsigned, Alarm::MissingOpenBracket),
        _ => return fail(at, Alarm::NoDataAfterAddress { letter: char::from(letter) }),
    };
    Ok((rest, Word { address, value, span: line.span(at, rest) }))
}

/// One value after an address: `#n` or `[…]`. `X#1+#2` is no sum on a control, so nothing more is read.
fn single(line: Line, at: Input<'_>) -> Read<'_, Expr> {
    if at.first() == Some(&b'[') { bracketed(line, at) } else { target(line, at) }
}
