//! The smallest pieces of a line: spaces, words of letters, places; and how reading fails.
use nom::error::{ErrorKind, ParseError};
use nom::{Err, IResult, Parser};

use crate::alarm::Alarm;
use crate::source::{SourceId, Span, Spanned};

pub(super) type Input<'a> = &'a [u8];
pub(super) type ReadResult<'a, T> = IResult<Input<'a>, T, ReadFailure>;

/// Every byte of a comment is overwritten with this one before a line is read (see [`super::comment`]), so that a
/// comment may stand between any two words, numbers and brackets. No other byte of a line's code is a `(`.
pub(super) const COMMENT: u8 = b'(';

/// Why a piece can't be read, and how much of the line was left there. The text that an alarm shows is filled in
/// once it is known that the line can't be read in another way.
#[derive(Debug)]
pub(super) struct ReadFailure {
    /// `None` where the text is neither this nor that. Faults are handed on at every step, so they are small.
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

/// Reading can't go on in any other way.
#[cold]
pub(super) fn fail<T>(input: Input<'_>, alarm: Alarm) -> ReadResult<'_, T> {
    Err(Err::Failure(ReadFailure { alarm: Some(Box::new(alarm)), remaining: input.len() }))
}

/// Neither a number nor anything else an expression may have here.
pub(super) fn no_expression<T>(input: Input<'_>) -> ReadResult<'_, T> {
    fail(input, Alarm::Expression { text: String::new() })
}

/// `(` where a value or `[` must stand; [`comment_before`] holds.
pub(super) fn round_brackets<T>(input: Input<'_>, letter: Option<char>) -> ReadResult<'_, T> {
    let gap = input.iter().take_while(|b| is_space(**b)).count();
    fail(&input[gap..], Alarm::RoundBrackets { letter })
}

/// This isn't the piece looked for; another may be.
pub(super) fn no_match<T>(input: Input<'_>) -> ReadResult<'_, T> {
    Err(Err::Error(ReadFailure::from_error_kind(input, ErrorKind::Alt)))
}

/// What must follow: where it isn't there, the line can't be read.
pub(super) fn require<'a, T>(
    mut parser: impl Parser<Input<'a>, Output = T, Error = ReadFailure>,
    alarm: impl Fn() -> Alarm,
) -> impl FnMut(Input<'a>) -> ReadResult<'a, T> {
    move |input| match parser.parse(input) {
        Err(Err::Error(_)) => fail(spaces(input), alarm()),
        read => read,
    }
}

/// Where the line stands, so that what is left of it tells a place.
#[derive(Clone, Copy, Debug)]
pub(super) struct LineInput {
    pub source: SourceId,
    /// The offset of the byte after the last one of the line's code.
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

/// A space; also the feed and the rub-out of paper tape, which controls read over, and the sign that senders end a
/// file with, which stands inside one where files were put together.
pub(super) fn is_space(byte: u8) -> bool {
    matches!(byte, b' ' | b'\t' | 0 | 0x1a | 0x7f)
}

/// Spaces, but no comment, left out.
pub(super) fn unspaced(text: Input<'_>) -> Input<'_> {
    &text[text.iter().take_while(|b| is_space(**b)).count()..]
}

/// What is left after spaces and comments.
pub(super) fn spaces(input: Input<'_>) -> Input<'_> {
    let count = input.iter().take_while(|b| is_space(**b) || **b == COMMENT).count();
    &input[count..]
}

/// Whether a comment stands before the next piece: round brackets where square ones may have been meant.
pub(super) fn comment_before(input: Input<'_>) -> bool {
    input.iter().find(|b| !is_space(**b)) == Some(&COMMENT)
}

/// The next byte after spaces, and what is left after it.
pub(super) fn next(input: Input<'_>) -> Option<(u8, Input<'_>)> {
    spaces(input).split_first().map(|(byte, rest)| (*byte, rest))
}

/// One sign such as `[`, spaces before it.
pub(super) fn sign<'a>(expected: u8) -> impl Fn(Input<'a>) -> ReadResult<'a, ()> {
    move |input| match next(input) {
        Some((byte, rest)) if byte == expected => Ok((rest, ())),
        _ => no_match(input),
    }
}

/// A word of letters in either case, spaces before and between them.
pub(super) fn word<'a>(text: &'static str) -> impl Fn(Input<'a>) -> ReadResult<'a, ()> {
    move |input| match letters(spaces(input), text) {
        (rest, count) if count == text.len() => Ok((rest, ())),
        _ => no_match(input),
    }
}

/// How many letters of `text` the input begins with, and what is left after them.
pub(super) fn letters<'a>(input: Input<'a>, text: &str) -> (Input<'a>, usize) {
    let mut rest = input;
    for (count, wanted) in text.bytes().enumerate() {
        let gap = rest.iter().take_while(|b| is_space(**b)).count();
        match rest[gap..].split_first() {
            Some((byte, after)) if byte.to_ascii_uppercase() == wanted => rest = after,
            _ => return (rest, count),
        }
    }
    (rest, text.len())
}
