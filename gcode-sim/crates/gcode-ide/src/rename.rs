//! Rename of variables, sequence numbers and programs.
use crate::project::Project;
use crate::text::{FileEdit, FileId, Refusal, TextRange};

/// Symbol that can be renamed.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RenameTarget {
    /// Range of the name.
    pub range: TextRange,
    /// Name as it is, `#101`, `N10`, `O8101`.
    pub placeholder: String,
}

impl Project {
    /// Returns the symbol at an offset if it can be renamed.
    ///
    /// # Errors
    ///
    /// The reason why not.
    pub fn prepare_rename(&self, file: FileId, offset: u32) -> Result<RenameTarget, Refusal> {
        let _ = (file, offset);
        Err(Refusal::new("nothing here can be renamed"))
    }

    /// Returns the edits that rename the symbol at an offset, by file and place.
    ///
    /// # Errors
    ///
    /// The reason why a program could do something else afterwards.
    pub fn rename(&self, file: FileId, offset: u32, new_name: &str) -> Result<Vec<FileEdit>, Refusal> {
        let _ = (file, offset, new_name);
        Err(Refusal::new("nothing here can be renamed"))
    }
}
