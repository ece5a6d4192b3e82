//! Blocks of nothing but numbers behind their addresses, `N10 G1 X1.5 Y-2.`: most of what long files consist of.
//!
//! They are handed out word by word, so that nobody who only wants the words has to build a tree of them.
use super::ast::Decimal;
use super::digits::{Window, number};
use super::number::WORD_LIMIT;
use super::token::{Input, is_space, unspaced};
use crate::source::{SourceId, Span};

/// The largest sequence number.
pub(super) const MAX_SEQUENCE_NUMBER: u32 = 99_999_999;

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
pub struct NumberWords<'a> {
    source: SourceId,
    text: Input<'a>,
    /// Where the sequence number ends, or the block begins where there is none.
    pub words_start: u32,
    /// Where the next word may begin, spaces before it.
    position: usize,
    /// `N10` at its beginning.
    pub sequence_number: Option<u32>,
}

impl<'a> NumberWords<'a> {
    /// `text` may go on behind the line. `None` where it begins with an N that is no plain sequence number.
    #[inline]
    pub fn new(source: SourceId, text: Input<'a>, start: u32) -> Option<Self> {
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

    /// Whether the line ends here, so that nothing else stands in it.
    pub fn is_at_end(&self) -> bool {
        matches!(self.behind_spaces(), [] | [b'\n' | b'\r', ..])
    }

    /// Whether a word, or what else begins with a capital, comes next.
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

/// What is behind a word of some bytes that stands at a place: mostly a single space, and then the next one.
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

/// Whether a word may begin with a byte: it is a capital, and no O, which begins a program.
const BEGINS_WORD: [bool; 256] = {
    let mut all = [false; 256];
    let mut byte = b'A';
    while byte <= b'Z' {
        all[byte as usize] = byte != b'O';
        byte += 1;
    }
    all
};

/// A capital, perhaps a sign, and the number right behind them, and how long they are; `None` where something else stands at
/// the beginning. Behind it the number may go on: `X1 0.5`, `X1..5`.
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

/// Whether a number goes on at the beginning of a text.
pub(super) fn continues_number(text: Input<'_>) -> bool {
    matches!(unspaced(text), [b'0'..=b'9' | b'.', ..])
}
