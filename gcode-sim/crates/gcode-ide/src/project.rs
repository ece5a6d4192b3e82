//! Files of a project with their indexes, and the programs that calls find in them.
use std::collections::{BTreeMap, BTreeSet};

use gcode_lang::control::Settings;
use gcode_lang::source::Bytes;
use gcode_lang::syntax::ast::{Block, ProgramName};
use gcode_lang::syntax::block_at;
use gcode_lint::CalledProgramName;

use crate::entry::EntryKind;
use crate::file_index::{Call, FileIndex, ProgramOutline};
use crate::text::{FileId, SOURCE, TextEdit, TextRange, line_range};

/// Most controls whose indexes are kept: a project with documents of two controls is common, one with more is not.
const MAX_CONTROLS: usize = 3;

/// Files that an editor knows, read for one control.
#[derive(Clone, Debug, Default)]
pub struct Project {
    settings: Settings,
    /// Number of the control in force, and the controls that were in force before, the last one at the end.
    control: u32,
    before: Vec<(u32, Settings)>,
    files: BTreeMap<FileId, ProjectFile>,
    /// Files by name: in which order they were opened decides no answer.
    order: Vec<FileId>,
    /// Programs by the name that calls state.
    names: BTreeMap<ProgramName, BTreeSet<ProgramKey>>,
}

#[derive(Clone, Debug)]
struct ProjectFile {
    name: String,
    index: FileIndex,
    /// Indexes for other controls, of this text or of an earlier state of it.
    others: BTreeMap<u32, FileIndex>,
}

/// How late a call looks into a file: its place among files and folders, and whether its name is another one than the number.
type SearchRank = (u8, bool);

/// Program of a file of the project.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct ProgramKey {
    /// File.
    pub file: FileId,
    /// Index of the program in the file.
    pub program: usize,
}

impl Project {
    /// Creates a project without files.
    pub fn new(settings: Settings) -> Self {
        Self { settings, ..Self::default() }
    }

    /// Returns the settings of the control.
    pub fn settings(&self) -> &Settings {
        &self.settings
    }

    /// Changes the control. Files are read for a new one; for one that was in force before, the lines that were edited since.
    pub fn set_settings(&mut self, settings: Settings) {
        if settings == self.settings {
            return;
        }
        let known = self.before.iter().position(|(_, before)| *before == settings);
        let newest = self.before.iter().map(|(number, _)| *number).max();
        let number = match known {
            Some(place) => self.before.remove(place).0,
            None => newest.map_or(self.control, |newest| newest.max(self.control)) + 1,
        };
        let old = std::mem::replace(&mut self.control, number);
        self.before.push((old, std::mem::replace(&mut self.settings, settings)));
        let forgotten = (MAX_CONTROLS <= self.before.len()).then(|| self.before.remove(0).0);
        for file in self.files.values_mut() {
            let text = file.index.text().clone();
            let index = match file.others.remove(&number) {
                Some(known) => known.moved_to(text, &self.settings),
                None => FileIndex::new(text, &self.settings),
            };
            file.others.insert(old, std::mem::replace(&mut file.index, index));
            if let Some(forgotten) = forgotten {
                file.others.remove(&forgotten);
            }
        }
        // Where programs begin does not depend on the control.
    }

    /// Adds a file, or replaces its text. Of the name only the last part counts: `O9810.nc` may omit its O word.
    pub fn set_file(&mut self, file: FileId, name: impl Into<String>, text: impl Into<Bytes>) {
        let index = FileIndex::new(text, &self.settings);
        self.remove_file(file);
        let name = name.into();
        let place = self
            .order
            .partition_point(|other| (self.file_name(*other), *other) < (Some(name.as_str()), file));
        self.order.insert(place, file);
        self.files.insert(file, ProjectFile { name, index, others: BTreeMap::new() });
        self.add_names(file);
    }

    /// Applies one edit to a file; only the lines about it are read again.
    pub fn edit_file(&mut self, file: FileId, edit: &TextEdit) {
        let Some(found) = self.files.get_mut(&file) else { return };
        let edited = found.index.edited(edit, &self.settings);
        let names = |index: &FileIndex| index.programs().iter().map(|p| p.name.clone()).collect::<Vec<_>>();
        let has_same_names = names(&edited) == names(&found.index);
        if !has_same_names {
            self.remove_names(file);
        }
        if let Some(found) = self.files.get_mut(&file) {
            found.index = edited;
        }
        if !has_same_names {
            self.add_names(file);
        }
    }

    /// Removes a file.
    pub fn remove_file(&mut self, file: FileId) {
        self.remove_names(file);
        self.files.remove(&file);
        self.order.retain(|other| *other != file);
    }

    fn add_names(&mut self, file: FileId) {
        let count = self.file(file).map_or(0, |index| index.programs().len());
        for key in (0..count).map(|program| ProgramKey { file, program }) {
            if let Some(name) = self.name_of(key) {
                self.names.entry(name).or_default().insert(key);
            }
        }
    }

    fn remove_names(&mut self, file: FileId) {
        let count = self.file(file).map_or(0, |index| index.programs().len());
        for key in (0..count).map(|program| ProgramKey { file, program }) {
            let Some(name) = self.name_of(key) else { continue };
            if let Some(keys) = self.names.get_mut(&name) {
                keys.remove(&key);
                if keys.is_empty() {
                    self.names.remove(&name);
                }
            }
        }
    }

    /// Returns the index of a file.
    pub fn file(&self, file: FileId) -> Option<&FileIndex> {
        self.files.get(&file).map(|found| &found.index)
    }

    /// Returns the name of a file.
    pub fn file_name(&self, file: FileId) -> Option<&str> {
        self.files.get(&file).map(|found| found.name.as_str())
    }

    /// Iterates over the files, by name.
    pub fn files(&self) -> impl Iterator<Item = (FileId, &FileIndex)> {
        self.order.iter().filter_map(|id| Some((*id, self.file(*id)?)))
    }

    /// Iterates over all programs, by file.
    pub fn programs(&self) -> impl Iterator<Item = (ProgramKey, &ProgramOutline)> {
        self.files().flat_map(|(file, index)| {
            let programs = index.programs().iter().enumerate();
            programs.map(move |(program, outline)| (ProgramKey { file, program }, outline))
        })
    }

    /// Returns a program.
    pub fn program(&self, key: ProgramKey) -> Option<&ProgramOutline> {
        self.file(key.file)?.programs().get(key.program)
    }

    /// Returns the program that contains an offset.
    pub fn program_at(&self, file: FileId, offset: u32) -> Option<ProgramKey> {
        let program = self.file(file)?.program_at(offset)?;
        Some(ProgramKey { file, program })
    }

    /// Returns the name by which calls find a program: its own, or that of its file if it has none.
    pub(crate) fn name_of(&self, key: ProgramKey) -> Option<ProgramName> {
        let outline = self.program(key)?;
        if outline.name != ProgramName::Unnamed {
            return Some(outline.name.clone());
        }
        let is_only = self.file(key.file)?.programs().len() == 1;
        self.number_of_file(key.file).filter(|_| is_only)
    }

    /// Returns the program number that a file's name states: `O8101.nc`.
    fn number_of_file(&self, file: FileId) -> Option<ProgramName> {
        let last = self.file_name(file)?.rsplit(['/', '\\']).next()?;
        let stem = last.split('.').next()?.to_ascii_uppercase();
        Some(ProgramName::of(stem)).filter(|name| matches!(name, ProgramName::Number(_)))
    }

    /// Returns the label of a program, `O8101`.
    pub fn label(&self, key: ProgramKey) -> String {
        let name = self.name_of(key).or_else(|| self.program(key).map(|program| program.name.clone()));
        name.map_or_else(String::new, |name| name.label())
    }

    /// Returns all programs of a name, those first that a call from a file finds first.
    pub(crate) fn programs_named(&self, name: &ProgramName, from: FileId) -> Vec<ProgramKey> {
        let mut found: Vec<_> = self.names.get(name).into_iter().flatten().copied().collect();
        found.sort_by_key(|key| self.call_order(*key, from));
        found
    }

    /// Returns the programs that a call from a file may find by a name. Those of the same file win, then those of its
    /// folder.
    pub(crate) fn reached_programs(&self, name: &ProgramName, from: FileId) -> Vec<ProgramKey> {
        let mut found = self.programs_named(name, from);
        let nearest = found.first().map(|key| self.distance(*key, from));
        found.retain(|key| Some(self.distance(*key, from)) == nearest);
        found
    }

    /// Returns the program that a call finds.
    pub(crate) fn called_program(&self, from: FileId, target: &CalledProgramName) -> Option<ProgramKey> {
        let keys = self.names.get(&program_name(target)?)?;
        keys.iter().min_by_key(|key| self.call_order(**key, from)).copied()
    }

    /// Returns the place of a program in the order in which a call from a file looks for its name, as a run does.
    fn call_order(&self, key: ProgramKey, from: FileId) -> (SearchRank, Option<&str>, ProgramKey) {
        (self.distance(key, from), self.file_name(key.file), key)
    }

    /// Returns how late a call from a file looks into the file of a program: itself, its folder, others; in a folder the file
    /// that is named after the number comes first.
    fn distance(&self, key: ProgramKey, from: FileId) -> SearchRank {
        let is_named_after = || {
            self.program(key)
                .is_some_and(|outline| Some(&outline.name) == self.number_of_file(key.file).as_ref())
        };
        (self.folder_distance(key, from), key.file != from && !is_named_after())
    }

    fn folder_distance(&self, key: ProgramKey, from: FileId) -> u8 {
        let folder = |file: FileId| {
            let name = self.file_name(file)?;
            Some(name.rfind(['/', '\\']).map_or("", |end| &name[..end]))
        };
        match key.file == from {
            true => 0,
            false if folder(key.file) == folder(from) => 1,
            false => 2,
        }
    }

    /// Iterates over the calls of a program.
    pub(crate) fn calls_of(&self, key: ProgramKey) -> impl Iterator<Item = Call<'_>> {
        let index = self.file(key.file).into_iter();
        let entries = index.flat_map(move |index| index.program_entries(key.program));
        entries.filter(|entry| entry.kind == EntryKind::Call).filter_map(|entry| entry.call())
    }

    /// Iterates over the calls of all programs.
    pub(crate) fn all_calls(&self) -> impl Iterator<Item = (ProgramKey, Call<'_>)> {
        self.programs().flat_map(|(key, _)| self.calls_of(key).map(move |call| (key, call)))
    }

    /// Iterates over the calls that go to a program.
    pub(crate) fn calls_to(&self, key: ProgramKey) -> impl Iterator<Item = (ProgramKey, Call<'_>)> {
        self.all_calls()
            .filter(move |(from, call)| self.called_program(from.file, &call.record.target) == Some(key))
    }

    /// Returns the tree of the line of an offset, if it is a block.
    pub(crate) fn block(&self, file: FileId, offset: u32) -> Option<Block> {
        let text = self.file(file)?.text();
        let line = line_range(text, offset);
        let block = block_at(SOURCE, &text[..line.end as usize], line.start)?;
        TextRange::from(block.span).overlaps(line).then_some(block)
    }
}

/// Returns the name that a call states.
pub(crate) fn program_name(target: &CalledProgramName) -> Option<ProgramName> {
    match target {
        CalledProgramName::Number(number) => Some(ProgramName::Number(*number)),
        CalledProgramName::Name(name) => {
            let last = name.rsplit('/').next().unwrap_or(name);
            Some(ProgramName::of(last.to_owned()))
        }
        CalledProgramName::Computed | CalledProgramName::Missing => None,
    }
}

#[cfg(test)]
mod tests {
    use gcode_lang::control::Dialect;

    use super::*;
    use crate::testing::entries;

    #[test]
    fn a_call_finds_the_file_named_after_its_number_before_others_of_the_folder() {
        let mut project = Project::new(Settings::default());
        let texts = [("a/O0102.nc", "O0102\nM98 P903\nM30\n"), ("a/O0903.nc", "O0903\nM99\n")];
        let copies = [("a/O0101.nc", "O0101\nM98 P903\nM30\nO0903\nM99\n"), ("b/O0903.nc", "O0903\nM99\n")];
        // The order in which files are opened decides nothing.
        for (id, (name, text)) in copies.into_iter().chain(texts).enumerate() {
            project.set_file(FileId(id as u32), name, text.as_bytes().to_vec());
        }
        let called = |from| project.called_program(FileId(from), &CalledProgramName::Number(903));
        assert_eq!(called(2), Some(ProgramKey { file: FileId(3), program: 0 }), "not the copy in O0101.nc");
        assert_eq!(called(0), Some(ProgramKey { file: FileId(0), program: 1 }), "its own file first");
        let name = ProgramName::Number(903);
        assert_eq!(project.reached_programs(&name, FileId(2)), [ProgramKey { file: FileId(3), program: 0 }]);
    }

    /// M96 P10 is a jump on a Haas, and calls O0010 at an interrupt on a Fanuc.
    #[test]
    fn a_control_that_comes_back_finds_the_edited_text() {
        let line = "N10 G1 X#100 Y2.\nM96 P10\nGOTO 10\nG65 P9000 A1.\n";
        let mut haas = Settings::default();
        haas.apply_dialect(Dialect::HaasNgc);
        let mut third = Settings::default();
        third.apply_dialect(Dialect::Fanuc0iF);
        let controls = [
            Settings::default(),
            haas,
            third,
            Settings { uses_calculator_input: true, ..Settings::default() },
        ];
        let (one, other) = (FileId(0), FileId(1));
        let mut project = Project::new(controls[0].clone());
        project.set_file(one, "O1.nc", line.repeat(500).into_bytes());
        project.set_file(other, "O2.nc", *b"O2\nM96 P10\nM99\n");
        let edits = [(0, 0, "O1\n"), (4000, 4003, ""), (20, 9000, "G3 X1.\n"), (0, 0, ""), (100, 101, "\n")];
        let read = |which: usize| FileIndex::new(project.file(one).unwrap().text().clone(), &controls[which]);
        assert_ne!(entries(&read(0)), entries(&read(1)));
        // Each control comes back after others, the fourth has the first forgotten.
        for (step, which) in [1, 0, 1, 2, 0, 3, 1, 2, 0, 0, 3].into_iter().enumerate() {
            let (from, to, new) = edits[step % edits.len()];
            project.edit_file(one, &TextEdit { range: TextRange::new(from, to), text: new.to_owned() });
            project.set_settings(controls[which].clone());
            for file in [one, other] {
                let index = project.file(file).unwrap();
                let fresh = FileIndex::new(index.text().clone(), &controls[which]);
                assert_eq!(entries(index), entries(&fresh), "step {step}, control {which}");
            }
        }
    }
}
