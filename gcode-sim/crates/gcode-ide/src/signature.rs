//! Signature of a macro call: the arguments that the called program takes.
use crate::project::Project;
use crate::text::{FileId, TextRange};

/// Signature of a called macro.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SignatureHelp {
    /// `G65 P8101 A B C`.
    pub label: String,
    /// Title of the macro.
    pub documentation: String,
    /// Arguments in the order of the label.
    pub parameters: Vec<SignatureParameter>,
    /// Index of the argument at the cursor.
    pub active: Option<usize>,
}

/// Argument of a signature.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SignatureParameter {
    /// Place in the label, bytes.
    pub label: TextRange,
    /// Letter.
    pub letter: char,
    /// Local that it sets.
    pub local: u32,
    /// Meaning.
    pub documentation: String,
}

impl Project {
    /// Returns the signature of the macro call at an offset.
    pub fn signature_help(&self, file: FileId, offset: u32) -> Option<SignatureHelp> {
        let _ = (file, offset);
        None
    }
}
