//! Hover: what a word, a variable or a function means.
use crate::project::Project;
use crate::symbol::Symbol;
use crate::text::{FileId, TextRange};

/// Explanation of a place.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Hover {
    /// Explained text.
    pub range: TextRange,
    /// Explanation, Markdown.
    pub markdown: String,
    /// Symbol at the place, for values of a run.
    pub symbol: Option<Symbol>,
}

impl Project {
    /// Returns the explanation of an offset.
    pub fn hover(&self, file: FileId, offset: u32) -> Option<Hover> {
        let (symbol, range) = self.symbol_at(file, offset)?;
        Some(Hover { range, markdown: String::new(), symbol: Some(symbol) })
    }
}
