//! Reader of blocks that consist of numbers after addresses, `N10 G1 X1.5 Y-2.`, the bulk of long files.
//!
//! The words are read one at a time, without a tree, and their digits four bytes at a time.
use super::ast::Decimal;
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
    /// Span of the word.
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
    #[inline(always)]
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

    #[inline]
    pub(crate) fn is_at_end(&self) -> bool {
        matches!(self.behind_spaces(), [] | [b'\n' | b'\r', ..])
    }

    /// Returns the text of the comment that is the rest of the line, and the offset behind it; `None` for any other rest.
    pub(crate) fn comment_at_end(&self) -> Option<(Input<'a>, u32)> {
        let rest = self.behind_spaces();
        let inside = rest.strip_prefix(b"(")?;
        let length = inside.iter().position(|byte| b"()\r\n%;".contains(byte))?;
        let (comment, behind) = inside.split_at(length);
        let behind = behind.strip_prefix(b")")?;
        let is_last = matches!(unspaced(behind), [] | [b'\n' | b'\r', ..]);
        is_last.then_some((comment, (self.text.len() - behind.len()) as u32))
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
fn word_end(window: &Window, length: usize, offset: usize) -> usize {
    offset + length + usize::from(window.get(length) == Some(&b' '))
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

/// Bytes examined for one word. A longer number, with more than eight digits on one side of the point, is
/// left to `number`.
pub(super) type Window = [u8; 24];

/// Returns the first bytes of a text, padded with zeros.
pub(super) fn window(text: &[u8]) -> Window {
    let mut window = Window::default();
    let length = text.len().min(window.len());
    window[..length].copy_from_slice(&text[..length]);
    window
}

/// Reads an unsigned number at `first`: its digits without the point, its decimal places and its end.
///
/// The number may continue after spaces.
#[inline(always)]
pub(super) fn number(window: &Window, first: usize) -> Option<(u64, Option<u8>, usize)> {
    let (whole, point) = digits(0, window, first)?;
    let Some(b'.') = window.get(point) else { return (point > first).then_some((whole, None, point)) };
    let (digits, end) = digits(whole, window, point + 1)?;
    (end > first + 1).then_some((digits, Some((end - point - 1) as u8), end))
}

/// Appends the digits at `offset` to `number` and returns their end; `None` for more than eight digits.
#[inline(always)]
fn digits(number: u64, window: &Window, offset: usize) -> Option<(u64, usize)> {
    let bytes = u32::from_le_bytes(*window.get(offset..)?.first_chunk()?);
    // Each digit becomes its value; the top bit marks other bytes. Bytes after the first such byte may be
    // wrong.
    let values = bytes ^ 0x3030_3030;
    let others = (values.wrapping_add(0x7676_7676) | bytes) & 0x8080_8080;
    if others == 0 {
        return four_and_more(number, values, window, offset + 4).filter(|(_, end)| *end <= offset + 8);
    }
    // Moves the digits to the top bytes, with zeros before them.
    let top = others.trailing_zeros();
    let (digits, count) = (values << (31 - top) << 8, top as usize / 8);
    Some((number * POWERS[count] + value(digits), offset + count))
}

const POWERS: [u64; 4] = [1, 10, 100, 1_000];

/// Returns the number of four digits, the first in the lowest byte, by combining pairs.
#[inline(always)]
fn value(digits: u32) -> u64 {
    let pairs = digits.wrapping_mul(10 << 8 | 1) >> 8 & 0x00ff_00ff;
    u64::from(pairs.wrapping_mul(100 << 16 | 1) >> 16)
}

/// Appends four known digits and those that follow; `None` for more than four further digits.
#[inline(never)]
fn four_and_more(number: u64, values: u32, window: &Window, offset: usize) -> Option<(u64, usize)> {
    let text = window.get(offset..)?;
    let count = text.iter().take_while(|byte| byte.is_ascii_digit()).count();
    let further = |number, byte: &u8| number * 10 + u64::from(byte - b'0');
    let known = number * 10_000 + value(values);
    (count <= 4).then(|| (text[..count].iter().fold(known, further), offset + count))
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn the_digits_of_a_word_give_its_number(
            before in "[XN][-+]?", whole in "[0-9]{0,9}", point in any::<bool>(), fraction in "[0-9]{0,9}", after in "[ A-Z.:/\r\né]{0,9}",
        ) {
            let written = if point { format!("{whole}.{fraction}") } else { whole.clone() };
            let text = format!("{before}{written}{after}");
            let found = number(&window(text.as_bytes()), before.len());
            let fraction = if point { fraction } else { String::new() };
            prop_assume!(point || !after.starts_with('.'));
            let expected = (1..=8).contains(&whole.len().max(fraction.len())).then(|| {
                let digits = format!("{whole}{fraction}").parse().unwrap();
                (digits, point.then_some(fraction.len() as u8), before.len() + written.len())
            });
            prop_assert_eq!(found, expected, "{:?}", text);
        }
    }

    #[test]
    fn digits_end_at_the_first_other_byte() {
        for after in 0..=u8::MAX {
            for length in 1..=8 {
                let mut text = b"X98765432?1234567890".to_vec();
                text[1 + length] = after;
                let read = number(&window(&text), 1);
                match after {
                    b'0'..=b'9' | b'.' => {}
                    _ => {
                        assert_eq!(read, Some((98_765_432 / 10_u64.pow(8 - length as u32), None, 1 + length)))
                    }
                }
            }
        }
    }

    #[test]
    fn a_number_ends_after_its_decimals() {
        let read = |text: &str| number(&window(text.as_bytes()), 1);
        assert_eq!(read("X12.345 Y1"), Some((12_345, Some(3), 7)));
        assert_eq!(read("X1234.5678"), Some((12_345_678, Some(4), 10)));
        assert_eq!(read("X12345678.00000001Z"), Some((1_234_567_800_000_001, Some(8), 18)));
        assert_eq!(read("X5."), Some((5, Some(0), 3)));
        assert_eq!(read("X.5.5"), Some((5, Some(1), 3)));
        assert_eq!(read("X007\0"), Some((7, None, 4)));
        for none in ["X", "X.", "X-1", "X .5", "X123456789", "X1.123456789", "X#1"] {
            assert_eq!(read(none), None, "{none}");
        }
    }
}
