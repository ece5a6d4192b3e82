//! Reader of blocks that consist of numbers after addresses, `N10 G1 X1.5 Y-2.`, the bulk of long files.
//!
//! The words are read one at a time, without a tree.
use super::ast::Decimal;
use super::digits::{Window, number};
use super::number::WORD_LIMIT;
use super::token::{Input, is_space, unspaced};
use crate::source::{SourceId, Span};

pub(super) const MAX_SEQUENCE_NUMBER: u32 = 99_999_999;

/// Address followed immediately by its number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct NumberWord {
    /// `A` to `Z` except O.
    pub letter: u8,
    /// Number as written.
    pub number: Decimal,
    /// Place of the word.
    pub span: Span,
}

/// Iterator over the words of one line.
///
/// It ends with the line or before the first other element: a comment, a statement, a lower-case letter or
/// further digits of the last number. It also ends shortly before the end of the text.
#[derive(Debug)]
pub(crate) struct NumberWords<'a> {
    source: SourceId,
    text: Input<'a>,
    /// Offset after the sequence number, or of the block start without one.
    pub words_start: u32,
    /// Offset of the next word or of the spaces before it.
    position: usize,
    /// Sequence number at the start of the block.
    pub sequence_number: Option<u32>,
}

impl<'a> NumberWords<'a> {
    /// Starts at the block at `start`; `text` may continue after the line.
    ///
    /// `None` if the block begins with an N that is not a plain sequence number.
    #[inline]
    pub(crate) fn new(source: SourceId, text: Input<'a>, start: u32) -> Option<Self> {
        let mut numbers =
            Self { source, text, words_start: start, position: start as usize, sequence_number: None };
        if text.get(start as usize) == Some(&b'N') {
            let window = numbers.window()?;
            let (number, None, length) = number(window, 1)? else { return None };
            numbers.sequence_number =
                u32::try_from(number).ok().filter(|number| *number <= MAX_SEQUENCE_NUMBER);
            numbers.sequence_number?;
            numbers.words_start = start + length as u32;
            numbers.position = word_end(window, length, numbers.position);
        }
        Some(numbers)
    }

    pub(crate) fn is_at_end(&self) -> bool {
        matches!(self.behind_spaces(), [] | [b'\n' | b'\r', ..])
    }

    /// Returns true if the next byte after spaces is a capital.
    pub(super) fn is_at_letter(&self) -> bool {
        self.behind_spaces().first().is_some_and(u8::is_ascii_uppercase)
    }

    #[inline]
    fn behind_spaces(&self) -> Input<'a> {
        let rest = self.text.get(self.position..).unwrap_or_default();
        if rest.first().is_some_and(|byte| is_space(*byte)) { unspaced(rest) } else { rest }
    }

    #[inline(always)]
    fn window(&self) -> Option<&'a Window> {
        self.text.get(self.position..)?.first_chunk()
    }
}

/// Returns the offset after a word of `length` bytes and one space, the usual separator.
#[inline(always)]
fn word_end(window: &Window, length: usize, place: usize) -> usize {
    place + length + usize::from(window.get(length) == Some(&b' '))
}

impl Iterator for NumberWords<'_> {
    type Item = NumberWord;

    #[inline(always)]
    fn next(&mut self) -> Option<NumberWord> {
        loop {
            let window = self.window()?;
            if let Some((letter, number, length)) = number_word(window) {
                let start = self.position as u32;
                let span = Span { source: self.source, start, end: start + length as u32 };
                self.position = word_end(window, length, self.position);
                return Some(NumberWord { letter, number, span });
            }
            if !is_space(window[0]) {
                return None;
            }
            self.position = self.text.len() - self.behind_spaces().len();
        }
    }
}

/// Bytes that may begin a word: capitals except O, which begins a program.
const BEGINS_WORD: [bool; 256] = {
    let mut all = [false; 256];
    let mut byte = b'A';
    while byte <= b'Z' {
        all[byte as usize] = byte != b'O';
        byte += 1;
    }
    all
};

/// Reads a capital, an optional sign and the number after them, with their length; `None` for anything else.
///
/// The number may continue afterwards: `X1 0.5`, `X1..5`.
#[inline(always)]
pub(super) fn number_word(window: &Window) -> Option<(u8, Decimal, usize)> {
    let [letter, sign, ..] = *window;
    if !BEGINS_WORD[usize::from(letter)] {
        return None;
    }
    let (negative, first) = (sign == b'-', 1 + usize::from(matches!(sign, b'-' | b'+')));
    let (digits, places, length) = number(window, first)?;
    (digits < WORD_LIMIT).then_some((letter, Decimal { negative, digits, places }, length))
}

/// Returns true if the text begins with further digits or a point of the same number.
pub(super) fn continues_number(text: Input<'_>) -> bool {
    matches!(unspaced(text), [b'0'..=b'9' | b'.', ..])
}
