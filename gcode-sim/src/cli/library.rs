//! Finds called programs in folders: `O8101.nc` and `PROBE.nc` by file name, all others by contents.
#![expect(clippy::disallowed_methods, reason = "the command line finds files")]

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use super::{UsageError, input, output};
use gcode_lang::program::Library;
use gcode_lang::source::{Bytes, SourceId};
use gcode_lang::syntax::{self, FileItem, ast::ProgramName};

/// Folders of called programs; the first folder that has a program wins.
pub struct Folders {
    folders: Vec<PathBuf>,
    /// The programs in all files; read at the first call that no file name answers.
    programs: Option<Vec<(ProgramName, PathBuf)>>,
    /// Folders and files that could not be read, with the reasons.
    unread: BTreeSet<String>,
    /// Printed notes.
    noted: BTreeSet<String>,
}

impl Folders {
    /// Searches the program's own folder first, then `folders`, which must exist: a misspelt folder would
    /// later look like a missing program.
    pub fn new(program: &Path, folders: &[PathBuf]) -> Result<Self, UsageError> {
        if let Some(missing) = folders.iter().find(|folder| !folder.is_dir()) {
            return Err(UsageError::new(format!("--lib {}: no such folder", missing.display())));
        }
        let own = input::folder_of(program).to_owned();
        let folders = std::iter::once(own).chain(folders.iter().cloned()).collect();
        Ok(Self { folders, programs: None, unread: BTreeSet::new(), noted: BTreeSet::new() })
    }

    /// Returns the first file, in the order of folders and names, that satisfies `is_chosen`.
    fn find(&mut self, is_chosen: impl Fn(&Path) -> bool) -> Option<PathBuf> {
        self.files().into_iter().find(|path| is_chosen(path))
    }

    /// Returns the files that may be programs, in the order of folders and names; known other extensions are
    /// skipped.
    fn files(&mut self) -> Vec<PathBuf> {
        const OTHERS: [&str; 11] =
            ["toml", "json", "csv", "png", "md", "html", "snap", "pdf", "zip", "rs", "new"];
        let mut files = Vec::new();
        for folder in &self.folders {
            match input::folder(folder) {
                Ok(paths) => files.extend(paths),
                Err(refusal) => _ = self.unread.insert(refusal.to_string()),
            }
        }
        files.retain(|path| {
            let ending = path.extension().and_then(|e| e.to_str()).unwrap_or("").to_ascii_lowercase();
            path.is_file() && !OTHERS.contains(&ending.as_str())
        });
        files
    }

    fn bytes(&mut self, path: &Path) -> Option<Bytes> {
        match input::program_text(path) {
            Ok(bytes) => Some(bytes),
            Err(refusal) => {
                self.unread.insert(refusal.to_string());
                None
            }
        }
    }

    /// Returns the first file that contains a program.
    fn find_holder(&mut self, program: &ProgramName) -> Option<PathBuf> {
        if self.programs.is_none() {
            let mut found = Vec::new();
            for path in self.files() {
                let Some(bytes) = self.bytes(&path) else { continue };
                // Other texts have this ending too.
                if path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("txt"))
                    && !begins_program(&bytes)
                {
                    continue;
                }
                found.extend(programs_in(&bytes).map(|name| (name, path.clone())));
            }
            self.programs = Some(found);
        }
        let holders = self.programs.iter().flatten().filter(|(name, _)| name == program);
        let holders: Vec<&PathBuf> = holders.map(|(_, path)| path).collect();
        let first = (*holders.first()?).clone();
        if let Some(note) = ambiguity(program, &holders)
            && self.noted.insert(note.clone())
        {
            output::print_message(&format!("note: {note}\n"));
        }
        Some(first)
    }
}

impl Library for Folders {
    fn program(&mut self, number: u32) -> Option<(String, Bytes)> {
        // A file name may announce a number that the file does not contain; the contents decide.
        let program = ProgramName::Number(number);
        let holds = |bytes: &[u8]| programs_in(bytes).any(|name| name == program);
        let named = self.find(|path| numbered(path) == Some(number));
        let named = named.and_then(|path| Some((self.bytes(&path)?, path)));
        let (bytes, path) = match named.filter(|(bytes, _)| holds(bytes)) {
            Some(found) => found,
            None => {
                let path = self.find_holder(&program)?;
                (self.bytes(&path)?, path)
            }
        };
        Some((path.display().to_string(), bytes))
    }

    fn named(&mut self, name: &str) -> Option<(String, Bytes)> {
        let path = match self.find_holder(&ProgramName::Name(name.to_owned())) {
            Some(path) => path,
            // The file's name counts if the program in it has neither name nor number.
            None => self.find(|path| path.file_stem().is_some_and(|stem| stem.eq_ignore_ascii_case(name)))?,
        };
        let bytes = self.bytes(&path)?;
        Some((path.display().to_string(), bytes))
    }

    fn read_error(&self) -> Option<String> {
        let all: Vec<_> = self.unread.iter().map(String::as_str).collect();
        (!all.is_empty()).then(|| all.join("; "))
    }
}

/// Returns a note if the folder of the first file has further files with the same program.
fn ambiguity(program: &ProgramName, holders: &[&PathBuf]) -> Option<String> {
    let (first, rest) = holders.split_first()?;
    let other = rest.iter().find(|other| **other != *first && other.parent() == first.parent())?;
    let (label, first, other) = (program.label(), first.display(), other.display());
    Some(format!("{label} is in {first} and in {other}: the first is called; a control has one of them"))
}

/// Returns true if the first line of a text is `%`, a folder line or the head of a program, `O1234(PLATE)`: other texts have the
/// ending `.txt` too.
pub(super) fn begins_program(bytes: &[u8]) -> bool {
    let text = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes).trim_ascii_start();
    if let [b'O' | b'o' | b':', digits @ ..] = text {
        let count = digits.iter().take_while(|byte| byte.is_ascii_digit()).count();
        let is_code = |next: &u8| next.is_ascii_digit() || matches!(next, b'#' | b'-' | b'.');
        let follows = match digits[count..].trim_ascii_start() {
            [] | [b'(' | b'<' | b';', ..] => true,
            [letter, next, ..] => letter.is_ascii_alphabetic() && is_code(next),
            [_] => false,
        };
        let ends_line = matches!(digits.get(count), Some(b'\r' | b'\n'));
        return count > 0 && (ends_line || follows);
    }
    matches!(text, [b'%' | b'<', ..]) || text.starts_with(b"&F=")
}

/// Returns the programs in a file that have a number or a name.
fn programs_in(bytes: &[u8]) -> impl Iterator<Item = ProgramName> + '_ {
    syntax::FileItems::new(SourceId::default(), bytes).filter_map(|piece| match piece {
        FileItem::Program { name, .. } => Some(name),
        _ => None,
    })
}

/// Returns the program number of a file name: `O8101.nc`, `o8101.NC`, `O8101`, `8101.tap`.
fn numbered(path: &Path) -> Option<u32> {
    let stem = path.file_stem()?.to_str()?;
    let digits = stem.strip_prefix(['O', 'o']).unwrap_or(stem);
    if digits.bytes().all(|b| b.is_ascii_digit()) { digits.parse().ok() } else { None }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn file_names_give_program_numbers() {
        for (name, number) in
            [("O8101.nc", Some(8101)), ("o0012", Some(12)), ("8101.TAP", Some(8101)), ("part.nc", None)]
        {
            assert_eq!(numbered(Path::new(name)), number, "{name}");
        }
    }

    #[test]
    fn a_program_in_two_files_of_a_folder_is_noted() {
        let note = |paths: &[&str]| {
            let paths: Vec<PathBuf> = paths.iter().map(PathBuf::from).collect();
            ambiguity(&ProgramName::Number(5), &paths.iter().collect::<Vec<_>>())
        };
        assert_eq!(
            note(&["lib/a.nc", "lib/b.nc"]).unwrap(),
            "O0005 is in lib/a.nc and in lib/b.nc: the first is called; a control has one of them"
        );
        assert_eq!(note(&["lib/a.nc", "lib/a.nc"]), None, "a dump has folders of its own");
        assert_eq!(note(&["lib/a.nc", "other/b.nc"]), None, "the order of the folders decides");
        assert_eq!(note(&[]), None);
    }

    #[test]
    fn an_unreadable_folder_is_reported() {
        let folder = tempfile::tempdir().unwrap();
        let mut folders = Folders::new(&folder.path().join("main.nc"), &[]).unwrap();
        assert!(folders.program(1).is_none());
        assert_eq!(folders.read_error(), None, "an empty folder has been read");
        folder.close().unwrap();
        assert!(folders.program(1).is_none());
        let error = folders.read_error().unwrap();
        assert!(error.contains("cannot be read"), "{error}");
    }
}
