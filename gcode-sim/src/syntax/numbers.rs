//! Blocks of nothing but numbers behind their addresses, `N10 G1 X1.5 Y-2.`: most of what long files consist of.
//!
//! They are handed out word by word, so that nobody who only wants the words has to build a tree of them.
use super::ast::Decimal;
use super::block::MOST_SEQUENCE;
use super::digits::{Window, number};
use super::number::WORD_LIMIT;
use super::token::{Input, unspaced};
use crate::source::{SourceId, Span};

/// An address and the number right behind it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NumberWord {
    /// `A` to `Z` but O.
    pub letter: u8,
    pub number: Decimal,
    pub span: Span,
}

/// The words of one line, from where its block begins. They end where the line does, or before the first thing that is
/// something else: a comment, a statement, a letter in lower case, more digits of the last word's number; and shortly before
/// the end of the text.
#[derive(Debug)]
pub struct Numbers<'a> {
    source: SourceId,
    text: Input<'a>,
    /// Where the last word ends, and where the next one may begin, spaces before it.
    end: usize,
    next: usize,
    /// `N10` at its beginning.
    pub sequence_number: Option<u32>,
}

impl<'a> Numbers<'a> {
    /// `text` may go on behind the line. `None` where it begins with an N that is no plain sequence number.
    #[inline]
    pub fn new(source: SourceId, text: Input<'a>, start: u32) -> Option<Self> {
        let start = start as usize;
        let mut numbers = Self { source, text, end: start, next: start, sequence_number: None };
        if text.get(start) == Some(&b'N') {
            let window = numbers.window()?;
            let (number, None, length) = number(window, 1)? else { return None };
            numbers.sequence_number = u32::try_from(number).ok().filter(|number| *number <= MOST_SEQUENCE);
            numbers.sequence_number?;
            numbers.is_behind(window, length);
        }
        Some(numbers)
    }

    /// Where the last word ends, or the block begins where no word has been read.
    pub fn end(&self) -> u32 {
        self.end as u32
    }

    /// Whether the line ends here, so that nothing else stands in it.
    pub fn is_at_end(&self) -> bool {
        matches!(self.text.get(behind_spaces(self.text, self.next)), None | Some(b'\n' | b'\r'))
    }

    /// Whether a word, or what else begins with a capital, comes next.
    pub(super) fn is_at_letter(&self) -> bool {
        self.text.get(behind_spaces(self.text, self.next)).is_some_and(u8::is_ascii_uppercase)
    }

    #[inline(always)]
    fn window(&self) -> Option<&'a Window> {
        self.text.get(self.next..)?.first_chunk()
    }

    /// A word of some bytes has been read. Mostly a single space stands before the next one.
    #[inline(always)]
    fn is_behind(&mut self, window: &Window, length: usize) {
        self.end = self.next + length;
        self.next = self.end + usize::from(window.get(length) == Some(&b' '));
    }
}

impl Iterator for Numbers<'_> {
    type Item = NumberWord;

    #[inline(always)]
    fn next(&mut self) -> Option<NumberWord> {
        loop {
            let window = self.window()?;
            if let Some((letter, number, length)) = number_word(window) {
                let start = self.next;
                self.is_behind(window, length);
                let span = Span { source: self.source, start: start as u32, end: self.end as u32 };
                return Some(NumberWord { letter, number, span });
            }
            let behind = behind_spaces(self.text, self.next);
            if behind == self.next {
                return None;
            }
            self.next = behind;
        }
    }
}

/// A capital, perhaps a sign, and the number right behind them, and how long they are; `None` where something else stands at
/// the beginning. Behind it the number may go on: `X1 0.5`, `X1..5`.
#[inline(always)]
pub(super) fn number_word(window: &Window) -> Option<(u8, Decimal, usize)> {
    let letter = window[0];
    if !letter.is_ascii_uppercase() || letter == b'O' {
        return None;
    }
    let (negative, first) = match window[1] {
        b'-' => (true, 2),
        b'+' => (false, 2),
        _ => (false, 1),
    };
    let (digits, places, length) = number(window, first)?;
    (digits < WORD_LIMIT).then_some((letter, Decimal { negative, digits, places }, length))
}

/// Whether a number goes on at the beginning of a text.
pub(super) fn goes_on(text: Input<'_>) -> bool {
    matches!(unspaced(text), [b'0'..=b'9' | b'.', ..])
}

/// The place behind the spaces that stand at one.
#[inline(always)]
fn behind_spaces(text: Input<'_>, place: usize) -> usize {
    match text.get(place..) {
        Some([0x21..=0x7e, ..] | [b'\r' | b'\n', ..] | []) | None => place,
        Some(rest) => text.len() - unspaced(rest).len(),
    }
}
