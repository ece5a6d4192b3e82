//! One block: words in their order, and a comment after them.
use super::text::displayable;

/// Length of the longest comment after a block.
const COMMENT: usize = 48;

/// A block without its sequence number.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Block {
    words: Vec<String>,
    comment: Option<String>,
}

impl Block {
    /// Builds a block from words as written: `G90 G00`.
    pub fn of(words: impl Into<String>) -> Self {
        Self { words: vec![words.into()], comment: None }
    }

    /// Builds a call of a resident macro; the arguments follow as words.
    pub fn call(program: u32) -> Self {
        Self::of(format!("G65 P{program}"))
    }

    /// Appends a word.
    #[must_use]
    pub fn word(mut self, letter: char, value: impl std::fmt::Display) -> Self {
        self.words.push(format!("{letter}{value}"));
        self
    }

    /// Sets the comment, in characters that a control can display.
    #[must_use]
    pub fn comment(mut self, text: impl AsRef<str>) -> Self {
        self.comment = Some(displayable(text.as_ref(), COMMENT));
        self
    }
}

impl std::fmt::Display for Block {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.words.join(" "))?;
        match &self.comment {
            Some(comment) => write!(f, " ({comment})"),
            None => Ok(()),
        }
    }
}
