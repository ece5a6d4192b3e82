//! Files on which the check of a document rests.
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// On what a check rests.
pub(crate) struct CheckBasis {
    pub called: BTreeSet<PathBuf>,
    pub surroundings: BTreeSet<PathBuf>,
    pub is_in_project: bool,
    /// Stamps of all these files.
    pub stamps: BTreeMap<PathBuf, Option<u64>>,
}

impl CheckBasis {
    /// Returns true if a change of a program file may change the check.
    pub(crate) fn rests_on(&self, path: &Path, has_other_programs: bool) -> bool {
        let is_near = || path.parent().is_some_and(|folder| self.surroundings.contains(folder));
        self.called.contains(path) || has_other_programs && is_near()
    }
}
