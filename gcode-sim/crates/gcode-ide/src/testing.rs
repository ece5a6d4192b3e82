//! Projects of tests: texts with a cursor, `$0`.
use gcode_lang::control::Settings;

use crate::entry::EntryKind;
use crate::file_index::FileIndex;
use crate::project::Project;
use crate::text::{FileEdit, FileId, TextRange};

/// Project with a cursor.
pub(crate) struct Fixture {
    pub project: Project,
    pub file: FileId,
    pub offset: u32,
}

/// Reads files, each after a line `//- NAME`; a text without one is `O1.nc`. `$0` is the cursor.
pub(crate) fn fixture(text: &str) -> Fixture {
    fixture_on(text, Settings::default())
}

/// Reads files for a control.
pub(crate) fn fixture_on(text: &str, settings: Settings) -> Fixture {
    let mut project = Project::new(settings);
    let (mut file, mut offset) = (FileId(0), 0);
    let parts = if text.starts_with("//- ") { text.to_owned() } else { format!("//- O1.nc\n{text}") };
    for (id, part) in (0..).zip(parts.split("//- ").skip(1)) {
        let (name, text) = part.split_once('\n').expect("a name and its text");
        if let Some(at) = text.find("$0") {
            (file, offset) = (FileId(id), at as u32);
        }
        project.set_file(FileId(id), name, text.replace("$0", "").into_bytes());
    }
    Fixture { project, file, offset }
}

/// Entry of an index: its place, its kind, and the place of the program that a call names.
pub(crate) type ShownEntry = (TextRange, EntryKind, Option<Option<TextRange>>);

/// Returns the entries of an index. Those that open a chunk depend on where the text is cut.
pub(crate) fn entries(index: &FileIndex) -> Vec<ShownEntry> {
    let is_cut = |kind: EntryKind| matches!(kind, EntryKind::FirstBlock | EntryKind::FirstReadable);
    let entries = index.all_entries().filter(|entry| !is_cut(entry.kind));
    entries.map(|entry| (entry.range, entry.kind, entry.call().map(|call| call.target_range()))).collect()
}

impl Fixture {
    /// Returns the text of a range in a file.
    pub(crate) fn text(&self, file: FileId, range: TextRange) -> String {
        String::from_utf8_lossy(range.of(self.project.file(file).unwrap().text())).into_owned()
    }

    /// Returns the texts of all files, joined, after edits.
    pub(crate) fn edited(&self, edits: &[FileEdit]) -> String {
        let changed = self.project.with_edits(edits);
        let texts = changed.files().map(|(_, index)| String::from_utf8_lossy(index.text()).into_owned());
        texts.collect::<Vec<_>>().concat()
    }

    /// Returns a place as `LINE:text`, counted from 1, with the file before it unless it is the first.
    pub(crate) fn place(&self, file: FileId, range: TextRange) -> String {
        let line = crate::text::line_number(self.project.file(file).unwrap().text(), range.start);
        let name = if file == FileId(0) { String::new() } else { format!("{}:", file.0) };
        format!("{name}{line}:{}", self.text(file, range))
    }
}
