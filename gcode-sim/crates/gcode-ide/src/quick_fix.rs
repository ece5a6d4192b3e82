//! Quick fixes of findings.
use crate::project::Project;
use crate::text::{FileId, TextEdit, TextRange};

/// Correction of a finding.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct QuickFix {
    /// `Write X25.`.
    pub title: String,
    /// Edits of the file.
    pub edits: Vec<TextEdit>,
    /// True if this is the fix that the finding asks for.
    pub is_preferred: bool,
}

impl Project {
    /// Returns the fixes of a finding: its code, its exact part or block, and its remedy.
    pub fn quick_fixes(&self, file: FileId, code: &str, range: TextRange, help: Option<&str>) -> Vec<QuickFix> {
        let _ = (file, code, range, help);
        Vec::new()
    }
}
