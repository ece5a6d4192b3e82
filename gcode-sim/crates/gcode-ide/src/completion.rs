//! Completion: codes, variables, sequence numbers, programs, arguments and keywords that fit at a place.
use crate::project::Project;
use crate::text::{FileId, TextRange};

/// Kind of a completion.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum CompletionKind {
    /// Argument that a called macro takes.
    Argument,
    /// Sequence number of the program.
    Number,
    /// Program of the project.
    Program,
    /// Local, common or system variable.
    Variable,
    /// G code.
    GCode,
    /// M code.
    MCode,
    /// Function.
    Function,
    /// Keyword or operator.
    Keyword,
}

/// One completion.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Completion {
    /// Text in the list.
    pub label: String,
    /// Meaning in a few words.
    pub detail: String,
    /// Kind.
    pub kind: CompletionKind,
    /// Text to insert.
    pub insert: String,
    /// Range that the text replaces: what is typed of the word.
    pub replace: TextRange,
}

impl Project {
    /// Returns the completions at an offset, the likeliest first.
    pub fn completions(&self, file: FileId, offset: u32) -> Vec<Completion> {
        let _ = (file, offset);
        Vec::new()
    }
}
