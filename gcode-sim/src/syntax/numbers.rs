//! Blocks of nothing but numbers behind their addresses, `N10 G1 X1.5 Y-2.`: most of what long files consist of.
//!
//! They are handed out word by word, so that nobody who only wants the words has to build a tree of them.
use super::ast::Decimal;
use super::block::MOST_SEQUENCE;
use super::number::WORD_LIMIT;
use super::token::{Input, Line, unspaced};
use crate::source::{SourceId, Span, Spanned};

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
/// something else: a comment, a statement, a letter in lower case.
#[derive(Debug)]
pub struct Numbers<'a> {
    line: Line,
    rest: Input<'a>,
    /// `N10` at its beginning.
    pub sequence_number: Option<Spanned<u32>>,
}

impl<'a> Numbers<'a> {
    /// `bytes` may go on behind the line. `None` where it begins with an N that is no plain sequence number.
    pub fn new(source: SourceId, bytes: &'a [u8], start: u32) -> Option<Self> {
        let (line, rest) = (Line { source, end: bytes.len() as u32 }, &bytes[start as usize..]);
        let mut numbers = Self { line, rest, sequence_number: None };
        if let [b'N', first, ..] = rest {
            let plain = |word: &NumberWord| first.is_ascii_digit() && word.number.places.is_none();
            let NumberWord { number, span, .. } = numbers.next().filter(plain)?;
            let number = u32::try_from(number.digits).ok().filter(|number| *number <= MOST_SEQUENCE)?;
            numbers.sequence_number = Some(Spanned::new(number, span));
        }
        Some(numbers)
    }

    /// Whether the line ends here, so that nothing else stands in it.
    pub fn is_at_end(&self) -> bool {
        matches!(self.rest, [] | [b'\n' | b'\r', ..])
    }

    /// Whether a word, or what else begins with a capital, comes next.
    pub(super) fn is_at_letter(&self) -> bool {
        matches!(self.rest, [b'A'..=b'Z', ..])
    }
}

impl Iterator for Numbers<'_> {
    type Item = NumberWord;

    #[inline]
    fn next(&mut self) -> Option<NumberWord> {
        let (rest, letter, number) = number_word(self.rest)?;
        let span = self.line.span(self.rest, rest);
        self.rest = match rest {
            [b' ', behind @ ..] if matches!(behind, [b'A'..=b'Z', ..]) => behind,
            _ => unspaced(rest),
        };
        Some(NumberWord { letter, number, span })
    }
}

/// A capital, perhaps a sign, and a number, nothing between or inside them; `None` where something else stands there.
#[inline]
pub(super) fn number_word(at: Input<'_>) -> Option<(Input<'_>, u8, Decimal)> {
    let [letter @ (b'A'..=b'N' | b'P'..=b'Z'), behind @ ..] = at else { return None };
    let (negative, unsigned) = match behind {
        [b'-', unsigned @ ..] => (true, unsigned),
        [b'+', unsigned @ ..] => (false, unsigned),
        _ => (false, behind),
    };
    let (whole, before) = digits(0, unsigned);
    let (digits, count, places, rest) = match &unsigned[before..] {
        [b'.', behind @ ..] => {
            let (digits, places) = digits(whole, behind);
            (digits, before + places, Some(places as u8), &behind[places..])
        }
        rest => (whole, before, None, rest),
    };
    let goes_on = match rest {
        [b' ', b'A'..=b'Z', ..] => false,
        _ => matches!(unspaced(rest), [b'0'..=b'9' | b'.', ..]),
    };
    let fits = (1..=MOST_DIGITS).contains(&count) && digits < WORD_LIMIT && !goes_on;
    fits.then_some((rest, *letter, Decimal { negative, digits, places }))
}

/// A number that goes on with the digits that a text begins with, and how many they are.
#[inline]
fn digits(mut number: u64, text: Input<'_>) -> (u64, usize) {
    let mut count = 0;
    for byte in text {
        let digit = byte.wrapping_sub(b'0');
        if digit > 9 {
            break;
        }
        number = number.wrapping_mul(10).wrapping_add(u64::from(digit));
        count += 1;
    }
    (number, count)
}
