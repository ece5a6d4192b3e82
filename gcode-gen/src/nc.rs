//! NC text: numbers, blocks and programs in characters that every control can display.
use std::fmt::{Display, Write};

use gcode_lang::control::Dialect;

/// Length of the longest remark.
pub(crate) const REMARK: usize = 72;

/// Length of the longest comment after a block.
const COMMENT: usize = 48;

/// Largest sequence number of all three dialects.
const LARGEST_N: usize = 99_999;

/// Number of digits that all three dialects accept in one number.
const DIGITS: usize = 9;

/// Number of decimals. Six are a nanometre, or 0.02 µm at the end of a radius of 1000 mm: only the control
/// rounds noticeably, once, where the axis moves.
const PLACES: usize = 6;

/// Formats a value in mm, degrees or mm/min with a decimal point: `1158.8` stays `1158.8`, `420` becomes `420.`.
pub(crate) fn number(value: f64) -> String {
    let whole = format!("{:.0}", value.abs().trunc()).len();
    let places = PLACES.min(DIGITS.saturating_sub(whole));
    let text = format!("{value:.places$}");
    let text = if text.contains('.') { text.trim_end_matches('0').to_owned() } else { text + "." };
    if text == "-0." { "0.".to_owned() } else { text }
}

/// Converts `text` to characters allowed in a comment, at most `most`: brackets would end the comment, `%`
/// the whole file.
fn displayable(text: &str, most: usize) -> String {
    let displayed = |c: char| {
        let c = c.to_ascii_uppercase();
        if c.is_ascii_uppercase() || c.is_ascii_digit() || " .,+-*/=#[]".contains(c) { c } else { '-' }
    };
    text.chars().map(displayed).take(most).collect()
}

/// Returns `O8100`; Haas writes five digits.
pub(crate) fn name(number: u32, dialect: Dialect) -> String {
    match dialect {
        Dialect::Fanuc31i | Dialect::Fanuc0iF => format!("O{number:04}"),
        Dialect::HaasNgc => format!("O{number:05}"),
    }
}

/// A block without its sequence number: words in their order, and a comment after them.
pub(crate) struct Block(String);

impl Block {
    /// Builds a block from words as written: `G90 G00`.
    pub(crate) fn of(words: impl Into<String>) -> Self {
        Self(words.into())
    }

    /// Builds a call of a resident macro with numbers as arguments.
    pub(crate) fn call(program: u32, arguments: impl IntoIterator<Item = (char, f64)>) -> Self {
        Self::of(format!("G65 P{program}")).numbers(arguments)
    }

    /// Appends a word.
    pub(crate) fn word(mut self, letter: char, value: impl Display) -> Self {
        // Writing to a string cannot fail.
        let _ = write!(self.0, " {letter}{value}");
        self
    }

    /// Appends a word for each number.
    pub(crate) fn numbers(self, words: impl IntoIterator<Item = (char, f64)>) -> Self {
        words.into_iter().fold(self, |block, (letter, value)| block.word(letter, number(value)))
    }

    /// Appends a comment, in characters that a control can display.
    pub(crate) fn comment(mut self, text: impl AsRef<str>) -> Self {
        let _ = write!(self.0, " ({})", displayable(text.as_ref(), COMMENT));
        self
    }
}

impl Display for Block {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.0)
    }
}

/// A program from its O-number to the `%`: remarks, and blocks with sequence numbers for a restart.
pub(crate) struct ProgramText {
    head: String,
    lines: Vec<Line>,
}

enum Line {
    Remark(String),
    Block(String),
}

impl ProgramText {
    pub(crate) fn new(number: u32, title: &str, dialect: Dialect) -> Self {
        let head = format!("{}({})", name(number, dialect), displayable(title, REMARK));
        Self { head, lines: Vec::new() }
    }

    /// Adds a comment on a line of its own.
    pub(crate) fn remark(&mut self, text: impl AsRef<str>) {
        self.lines.push(Line::Remark(displayable(text.as_ref(), REMARK)));
    }

    pub(crate) fn remarks(&mut self, texts: impl IntoIterator<Item = impl AsRef<str>>) {
        texts.into_iter().for_each(|text| self.remark(text));
    }

    pub(crate) fn block(&mut self, block: impl Display) {
        self.lines.push(Line::Block(block.to_string()));
    }

    pub(crate) fn blocks(&mut self, blocks: impl IntoIterator<Item = impl Display>) {
        blocks.into_iter().for_each(|block| self.block(block));
    }

    /// Returns the text; blocks are numbered in tens if possible, else in ones.
    pub(crate) fn finish(self) -> String {
        let blocks = self.lines.iter().filter(|line| matches!(line, Line::Block(_))).count();
        let step = if blocks * 10 <= LARGEST_N { 10 } else { 1 };
        let mut text = format!("%\n{}\n", self.head);
        let mut number = 0;
        for line in self.lines {
            match line {
                Line::Remark(remark) => text.push_str(&format!("({remark})\n")),
                Line::Block(block) => {
                    number += step;
                    let name = if number <= LARGEST_N { format!("N{number} ") } else { String::new() };
                    text.push_str(&format!("{name}{block}\n"));
                }
            }
        }
        text.push_str("%\n");
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_number_has_a_point_and_at_most_nine_digits() {
        for (value, text) in [
            (420.0, "420."),
            (1158.8, "1158.8"),
            (0.1, "0.1"),
            (-720.0, "-720."),
            (-0.000_000_1, "0."),
            (100.0 / 3.0, "33.333333"),
            (10_000.0 / 3.0, "3333.33333"),
            (99_998.765_432, "99998.7654"),
            (240_000.0, "240000."),
        ] {
            assert_eq!(number(value), text);
        }
    }

    #[test]
    fn no_character_ends_the_comment() {
        assert_eq!(displayable("h1) M30 (\n%", 40), "H1- M30 ---");
        assert_eq!(displayable("孔1", 40), "-1");
        assert_eq!(displayable("abcdef", 3), "ABC");
    }
}
