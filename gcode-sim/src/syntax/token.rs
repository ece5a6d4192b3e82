//! The smallest pieces of a line: spaces, digits, brackets, letters; and how reading fails.
use nom::error::{ErrorKind, ParseError};
use nom::{Err, IResult};

use crate::alarm::Alarm;
use crate::source::{SourceId, Span, Spanned};

pub(super) type Input<'a> = &'a [u8];
pub(super) type Read<'a, T> = IResult<Input<'a>, T, Fault>;

/// Why a piece can't be read, and how much of the line was left there.
#[derive(Debug)]
pub(super) struct Fault {
    pub alarm: Alarm,
    pub left: usize,
}

impl ParseError<Input<'_>> for Fault {
    fn from_error_kind(input: Input<'_>, _: ErrorKind) -> Self {
        Self { alarm: Alarm::NotAWord { text: shown(input) }, left: input.len() }
    }

    fn append(_: Input<'_>, _: ErrorKind, other: Self) -> Self {
        other
    }
}

/// Reading can't go on in any other way.
pub(super) fn fail<T>(input: Input<'_>, alarm: Alarm) -> Read<'_, T> {
    Err(Err::Failure(Fault { alarm, left: input.len() }))
}

/// This isn't the piece looked for; another may be.
pub(super) fn other<T>(input: Input<'_>) -> Read<'_, T> {
    Err(Err::Error(Fault { alarm: Alarm::NotAWord { text: shown(input) }, left: input.len() }))
}

/// The first few characters of what is left, for a message.
pub(super) fn shown(input: Input<'_>) -> String {
    let piece: Vec<u8> = input.iter().copied().take_while(|b| !matches!(b, b'\r' | b'\n')).take(12).collect();
    String::from_utf8_lossy(&piece).trim_end().to_owned()
}

/// Where the line stands, so that what is left of it tells a place.
#[derive(Clone, Copy, Debug)]
pub(super) struct Line {
    pub source: SourceId,
    /// The offset of the byte after the line's last.
    pub end: u32,
}

impl Line {
    pub(super) fn span(self, from: Input<'_>, to: Input<'_>) -> Span {
        Span { source: self.source, start: self.end - from.len() as u32, end: self.end - to.len() as u32 }
    }

    pub(super) fn spanned<T>(self, node: T, from: Input<'_>, to: Input<'_>) -> Spanned<T> {
        Spanned::new(node, self.span(from, to))
    }
}

pub(super) fn is_space(byte: u8) -> bool {
    matches!(byte, b' ' | b'\t')
}

/// What is left after spaces.
pub(super) fn spaces(input: Input<'_>) -> Input<'_> {
    let count = input.iter().take_while(|b| is_space(**b)).count();
    &input[count..]
}
