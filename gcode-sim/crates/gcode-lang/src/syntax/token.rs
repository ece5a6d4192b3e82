//! Smallest elements of a line: spaces, keywords, places; and failures of reading.
use nom::error::{ErrorKind, ParseError};
use nom::{Err, IResult, Parser};

use crate::alarm::Alarm;
use crate::source::{SourceId, Span, Spanned};

pub(super) type Input<'a> = &'a [u8];
pub(super) type ReadResult<'a, T> = IResult<Input<'a>, T, ReadFailure>;

/// Byte that replaces every byte of a comment before a line is read (see [`super::comment`]).
///
/// A comment may thus lie between any two words, numbers or brackets. The code of a line has no other `(`.
pub(super) const COMMENT: u8 = b'(';

/// Failure to read an element: its alarm and the position.
///
/// The text shown by the alarm is filled in once no other reading of the line is possible.
#[derive(Debug)]
pub(super) struct ReadFailure {
    /// `None` if the text matches no alternative. Boxed, because every parser passes failures on.
    alarm: Option<Box<Alarm>>,
    pub(super) remaining: usize,
}

impl ReadFailure {
    pub(super) fn alarm(&self) -> Option<&Alarm> {
        self.alarm.as_deref()
    }

    pub(super) fn into_alarm(self) -> Alarm {
        self.alarm.map_or(Alarm::NotAWord { text: String::new() }, |alarm| *alarm)
    }
}

impl ParseError<Input<'_>> for ReadFailure {
    fn from_error_kind(input: Input<'_>, _: ErrorKind) -> Self {
        Self { alarm: None, remaining: input.len() }
    }

    fn append(_: Input<'_>, _: ErrorKind, other: Self) -> Self {
        other
    }
}

/// Fails with an alarm; no other alternative is tried.
#[cold]
pub(super) fn fail<T>(input: Input<'_>, alarm: Alarm) -> ReadResult<'_, T> {
    Err(Err::Failure(ReadFailure { alarm: Some(Box::new(alarm)), remaining: input.len() }))
}

/// Fails where an expression has neither a number nor another valid element.
pub(super) fn no_expression<T>(input: Input<'_>) -> ReadResult<'_, T> {
    fail(input, Alarm::Expression { text: String::new() })
}

/// Fails at `(` where the value of an address or `[` must follow. The input satisfies [`comment_before`].
pub(super) fn round_brackets<T>(input: Input<'_>, letter: Option<char>) -> ReadResult<'_, T> {
    fail(comment(input), Alarm::RoundBrackets { letter })
}

/// Returns the input from the comment on. The input satisfies [`comment_before`].
pub(super) fn comment(input: Input<'_>) -> Input<'_> {
    let gap = input.iter().take_while(|b| is_space(**b)).count();
    &input[gap..]
}

/// Reports a mismatch; another alternative may match.
pub(super) fn no_match<T>(input: Input<'_>) -> ReadResult<'_, T> {
    Err(Err::Error(ReadFailure::from_error_kind(input, ErrorKind::Alt)))
}

/// Wraps a parser so that a mismatch is an alarm instead.
pub(super) fn require<'a, T>(
    mut parser: impl Parser<Input<'a>, Output = T, Error = ReadFailure>,
    alarm: impl Fn() -> Alarm,
) -> impl FnMut(Input<'a>) -> ReadResult<'a, T> {
    move |input| match parser.parse(input) {
        Err(Err::Error(_)) => fail(spaces(input), alarm()),
        read => read,
    }
}

/// Position of the current line: converts remaining input to places.
#[derive(Clone, Copy, Debug)]
pub(super) struct LineInput {
    pub source: SourceId,
    /// Offset after the last byte of the line's code.
    pub end: u32,
}

impl LineInput {
    pub(super) fn span(self, from: Input<'_>, to: Input<'_>) -> Span {
        Span { source: self.source, start: self.end - from.len() as u32, end: self.end - to.len() as u32 }
    }

    pub(super) fn spanned<T>(self, node: T, from: Input<'_>, to: Input<'_>) -> Spanned<T> {
        Spanned::new(node, self.span(from, to))
    }
}

/// Returns true for a space.
///
/// Includes the feed and rub-out of paper tape, which controls ignore, and the end-of-file sign 0x1A, which
/// occurs inside joined files.
pub(super) fn is_space(byte: u8) -> bool {
    matches!(byte, b' ' | b'\t' | 0 | 0x1a | 0x7f)
}

/// Skips spaces but no comment.
pub(super) fn unspaced(text: Input<'_>) -> Input<'_> {
    &text[text.iter().take_while(|b| is_space(**b)).count()..]
}

/// Skips spaces and comments.
pub(super) fn spaces(input: Input<'_>) -> Input<'_> {
    let count = input.iter().take_while(|b| is_space(**b) || **b == COMMENT).count();
    &input[count..]
}

/// Returns true if a comment comes next: round brackets, possibly meant as square ones.
pub(super) fn comment_before(input: Input<'_>) -> bool {
    input.iter().find(|b| !is_space(**b)) == Some(&COMMENT)
}

/// Returns the next byte after spaces and comments, and the input after it.
pub(super) fn next(input: Input<'_>) -> Option<(u8, Input<'_>)> {
    spaces(input).split_first().map(|(byte, rest)| (*byte, rest))
}

/// Matches one sign such as `[` after spaces.
pub(super) fn sign<'a>(expected: u8) -> impl Fn(Input<'a>) -> ReadResult<'a, ()> {
    move |input| match next(input) {
        Some((byte, rest)) if byte == expected => Ok((rest, ())),
        _ => no_match(input),
    }
}

/// Matches a keyword in either case, with spaces before and between its letters.
pub(super) fn word<'a>(text: &'static str) -> impl Fn(Input<'a>) -> ReadResult<'a, ()> {
    move |input| match letters(spaces(input), text) {
        (rest, count) if count == text.len() => Ok((rest, ())),
        _ => no_match(input),
    }
}

/// Returns the number of leading letters that match `text`, and the input after them.
pub(super) fn letters<'a>(input: Input<'a>, text: &str) -> (Input<'a>, usize) {
    let mut rest = input;
    for (count, expected) in text.bytes().enumerate() {
        let gap = rest.iter().take_while(|b| is_space(**b)).count();
        match rest[gap..].split_first() {
            Some((byte, after)) if byte.to_ascii_uppercase() == expected => rest = after,
            _ => return (rest, count),
        }
    }
    (rest, text.len())
}
