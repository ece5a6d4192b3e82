//! Blocks of nothing but numbers behind their addresses, `N10 G1 X1.5 Y-2.`: most of what long files consist of.
//!
//! They are handed out word by word, so that nobody who only wants the words has to build a tree of them.
use super::ast::Decimal;
use super::block::MOST_SEQUENCE;
use super::number::WORD_LIMIT;
use super::token::{Input, unspaced};
use crate::source::{SourceId, Span};

/// As many digits fit into 64 bits, leading zeros among them.
const MOST_DIGITS: usize = 18;

/// An address and the number right behind it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NumberWord {
    /// `A` to `Z` but O.
    pub letter: u8,
    pub number: Decimal,
    pub span: Span,
}

/// The words of one line, from where its block begins. They end where the line does, or before the first thing that is
/// something else: a comment, a statement, a letter in lower case, more digits of the last word's number.
#[derive(Debug)]
pub struct Numbers<'a> {
    source: SourceId,
    text: Input<'a>,
    /// Where the last word ends, and where what is behind it begins, spaces left out.
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
            let (number, end) = digits(0, text, start + 1);
            let plain = (start + 2..start + MOST_DIGITS).contains(&end) && text.get(end) != Some(&b'.');
            let number = u32::try_from(number).ok().filter(|number| plain && *number <= MOST_SEQUENCE)?;
            (numbers.end, numbers.next, numbers.sequence_number) =
                (end, behind_spaces(text, end), Some(number));
        }
        Some(numbers)
    }

    /// Where the last word ends, or the block begins where no word has been read.
    pub fn end(&self) -> u32 {
        self.end as u32
    }

    /// Whether the line ends here, so that nothing else stands in it.
    pub fn is_at_end(&self) -> bool {
        matches!(self.text.get(self.next), None | Some(b'\n' | b'\r'))
    }

    /// Whether a word, or what else begins with a capital, comes next.
    pub(super) fn is_at_letter(&self) -> bool {
        self.text.get(self.next).is_some_and(u8::is_ascii_uppercase)
    }
}

impl Iterator for Numbers<'_> {
    type Item = NumberWord;

    #[inline]
    fn next(&mut self) -> Option<NumberWord> {
        let (letter, number, end) = number_word(self.text, self.next)?;
        let span = Span { source: self.source, start: self.next as u32, end: end as u32 };
        (self.end, self.next) = (end, behind_spaces(self.text, end));
        Some(NumberWord { letter, number, span })
    }
}

/// A capital, perhaps a sign, and the number right behind them, and where that ends; `None` where something else stands
/// at the place. Behind it the number may go on: `X1 0.5`, `X1..5`.
#[inline]
pub(super) fn number_word(text: Input<'_>, place: usize) -> Option<(u8, Decimal, usize)> {
    let letter = *text.get(place)?;
    if !letter.is_ascii_uppercase() || letter == b'O' {
        return None;
    }
    let (negative, first) = match text.get(place + 1) {
        Some(b'-') => (true, place + 2),
        Some(b'+') => (false, place + 2),
        _ => (false, place + 1),
    };
    let (whole, point) = digits(0, text, first);
    let (digits, end, places) = match text.get(point) {
        Some(b'.') => {
            let (digits, end) = digits(whole, text, point + 1);
            (digits, end, Some((end - point - 1) as u8))
        }
        _ => (whole, point, None),
    };
    let count = end - first - usize::from(places.is_some());
    if !(1..=MOST_DIGITS).contains(&count) || digits >= WORD_LIMIT {
        return None;
    }
    Some((letter, Decimal { negative, digits, places }, end))
}

/// Whether a number goes on behind a place.
pub(super) fn goes_on(text: Input<'_>, place: usize) -> bool {
    matches!(text.get(behind_spaces(text, place)), Some(b'0'..=b'9' | b'.'))
}

/// A number that goes on with the digits that stand at a place, and where they end.
#[inline]
fn digits(mut number: u64, text: Input<'_>, mut place: usize) -> (u64, usize) {
    while let Some(byte) = text.get(place)
        && byte.is_ascii_digit()
    {
        number = number.wrapping_mul(10).wrapping_add(u64::from(byte - b'0'));
        place += 1;
    }
    (number, place)
}

/// The place behind the spaces that stand at one; mostly it is a single one before the next word.
#[inline]
fn behind_spaces(text: Input<'_>, place: usize) -> usize {
    match text.get(place..) {
        Some([b' ', b'A'..=b'Z', ..]) => place + 1,
        Some([0x21..=0x7e, ..] | [b'\r' | b'\n', ..] | []) | None => place,
        Some(rest) => text.len() - unspaced(rest).len(),
    }
}
