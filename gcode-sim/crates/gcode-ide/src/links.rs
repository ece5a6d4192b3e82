//! Links of a document: the programs that it calls.
use crate::entry::EntryKind;
use crate::navigation::NavigationTarget;
use crate::project::{Project, program_name};
use crate::text::{FileId, TextRange};

/// Link to a called program.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct DocumentLink {
    /// Word P, or the code that calls.
    pub range: TextRange,
    /// `O8101`.
    pub label: String,
    /// Called program.
    pub target: NavigationTarget,
}

impl Project {
    /// Returns the links of a file: each call whose program the project has.
    pub fn document_links(&self, file: FileId) -> Vec<DocumentLink> {
        let Some(index) = self.file(file) else { return Vec::new() };
        let calls = index.all_entries().filter(|entry| entry.kind == EntryKind::Call);
        let links = calls.filter_map(|entry| {
            let call = entry.call()?;
            let name = program_name(&call.record.target)?;
            let target = *self.program_targets(&name, file).first()?;
            let range = call.target_range().unwrap_or(call.code);
            Some(DocumentLink { range, label: name.label(), target })
        });
        links.collect()
    }
}
