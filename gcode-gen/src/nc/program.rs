//! A program from its O-number to the `%`: remarks, and blocks with sequence numbers for a restart.
use gcode_lang::control::Dialect;

use super::block::Block;
use super::text::displayable;

/// Length of the longest remark.
pub(crate) const REMARK: usize = 72;

/// Largest sequence number of all three dialects.
const LARGEST_N: usize = 99_999;

pub struct Program {
    head: String,
    lines: Vec<Line>,
}

enum Line {
    Remark(String),
    Block(Block),
}

impl Program {
    pub fn new(number: u32, title: &str, dialect: Dialect) -> Self {
        let head = format!("{}({})", name(number, dialect), displayable(title, REMARK));
        Self { head, lines: Vec::new() }
    }

    /// Adds a comment on a line of its own.
    pub fn remark(&mut self, text: impl AsRef<str>) {
        self.lines.push(Line::Remark(displayable(text.as_ref(), REMARK)));
    }

    pub fn block(&mut self, block: Block) {
        self.lines.push(Line::Block(block));
    }

    /// Returns the text; blocks are numbered in tens if possible, else in ones.
    pub fn finish(self) -> String {
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

/// Returns `O8100`; Haas writes five digits.
pub fn name(number: u32, dialect: Dialect) -> String {
    match dialect {
        Dialect::Fanuc31i | Dialect::Fanuc0iF => format!("O{number:04}"),
        Dialect::HaasNgc => format!("O{number:05}"),
    }
}
