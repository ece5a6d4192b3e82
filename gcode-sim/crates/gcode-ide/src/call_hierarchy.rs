//! Call hierarchy: which programs call a program, and which it calls.
use std::collections::BTreeMap;

use crate::head_comment::title;
use crate::project::{ProgramKey, Project};
use crate::symbol::Symbol;
use crate::text::{FileId, TextRange};

/// Program in the hierarchy.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CallItem {
    /// Program.
    pub key: ProgramKey,
    /// `O8101`.
    pub name: String,
    /// Title.
    pub detail: String,
    /// Whole program.
    pub range: TextRange,
    /// O word.
    pub selection: TextRange,
}

/// Calls between two programs.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CallGroup {
    /// The caller of incoming calls, the called program of outgoing ones.
    pub item: CallItem,
    /// Places of the calls in the caller.
    pub places: Vec<TextRange>,
}

impl Project {
    /// Returns the program that the symbol at an offset names, otherwise the program that contains it.
    pub fn call_item(&self, file: FileId, offset: u32) -> Option<CallItem> {
        let key = match self.symbol_at(file, offset) {
            Some((Symbol::Program { name }, _)) => *self.programs_named(&name, file).first()?,
            _ => self.program_at(file, offset)?,
        };
        self.item(key)
    }

    fn item(&self, key: ProgramKey) -> Option<CallItem> {
        let outline = self.program(key)?;
        let detail = title(self.file(key.file)?, key.program).unwrap_or_default();
        let (range, selection) = (outline.range, outline.name_range);
        Some(CallItem { key, name: self.label(key), detail, range, selection })
    }

    /// Returns the callers of a program with the places of their calls.
    pub fn incoming_calls(&self, key: ProgramKey) -> Vec<CallGroup> {
        let mut places: BTreeMap<ProgramKey, Vec<TextRange>> = BTreeMap::new();
        for (from, call) in self.calls_to(key) {
            places.entry(from).or_default().push(call.target_range().unwrap_or(call.code));
        }
        self.groups(places)
    }

    /// Returns the other files with calls of a file's programs, in the order of their names.
    pub fn calling_files(&self, file: FileId) -> Vec<FileId> {
        let finds = |(from, target)| self.called_program(from, target).is_some_and(|key| key.file == file);
        let others = self.all_calls().filter(|(from, _)| from.file != file);
        let calling = others.filter(|(from, call)| finds((from.file, &call.record.target)));
        let mut files: Vec<_> = calling.map(|(from, _)| from.file).collect();
        files.sort_by_key(|file| (self.file_name(*file), *file));
        files.dedup();
        files
    }

    /// Returns the programs that a program calls, as far as the project has them, with the places of the calls.
    pub fn outgoing_calls(&self, key: ProgramKey) -> Vec<CallGroup> {
        let mut places: BTreeMap<ProgramKey, Vec<TextRange>> = BTreeMap::new();
        for call in self.calls_of(key) {
            if let Some(called) = self.called_program(key.file, &call.record.target) {
                places.entry(called).or_default().push(call.target_range().unwrap_or(call.code));
            }
        }
        self.groups(places)
    }

    fn groups(&self, places: BTreeMap<ProgramKey, Vec<TextRange>>) -> Vec<CallGroup> {
        let mut groups: Vec<_> = places.into_iter().collect();
        groups.sort_by_key(|(key, _)| (self.file_name(key.file), key.program));
        groups
            .into_iter()
            .filter_map(|(key, places)| Some(CallGroup { item: self.item(key)?, places }))
            .collect()
    }
}
