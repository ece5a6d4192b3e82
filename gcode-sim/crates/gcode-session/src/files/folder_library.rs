//! Finds called programs in folders: `O8101.nc` and `PROBE.nc` by file name, all others by contents.
use std::collections::BTreeSet;
use std::ffi::OsStr;
use std::path::{Path, PathBuf};

use super::{FileAccess, folder_of};
use gcode_lang::program::Library;
use gcode_lang::source::{Bytes, SourceId};
use gcode_lang::syntax::{self, FileItem, ast::ProgramName};

/// Endings that only programs have.
pub const PROGRAM_ENDINGS: [&str; 7] = ["nc", "tap", "eia", "min", "cnc", "ncd", "ngc"];

/// Folders of called programs; the first folder that has a program wins, and in it the file named after its number.
#[derive(Debug)]
pub struct FolderLibrary<F> {
    files: F,
    folders: Vec<PathBuf>,
    /// The programs in all files; read at the first call that no file name answers.
    programs: Option<Vec<(ProgramName, PathBuf)>>,
    /// Folders and files that could not be read, with the reasons.
    unread: BTreeSet<String>,
    /// Notes on programs that several files hold.
    notes: Vec<String>,
}

impl<F: FileAccess> FolderLibrary<F> {
    /// Searches the program's own folder first, then `folders`.
    pub fn new(files: F, program: &Path, folders: &[PathBuf]) -> Self {
        let own = folder_of(program).to_owned();
        Self::of_folders(files, std::iter::once(own).chain(folders.iter().cloned()).collect())
    }

    /// Searches folders in this order.
    pub fn of_folders(files: F, folders: Vec<PathBuf>) -> Self {
        Self { files, folders, programs: None, unread: BTreeSet::new(), notes: Vec::new() }
    }

    /// Returns the notes on programs that several files of a folder hold, in the order found.
    pub fn notes(&self) -> &[String] {
        &self.notes
    }

    /// Returns the first file, in the order of folders and names, that satisfies `is_chosen`.
    fn find(&mut self, is_chosen: impl Fn(&Path) -> bool) -> Option<PathBuf> {
        self.candidates().into_iter().find(|path| is_chosen(path))
    }

    /// Returns the files that may be programs, in the order of folders and names; known other extensions are
    /// skipped.
    fn candidates(&mut self) -> Vec<PathBuf> {
        const OTHERS: [&str; 16] = [
            "toml", "lock", "json", "csv", "tsv", "xml", "log", "svg", "png", "md", "html", "snap", "pdf",
            "zip", "rs", "new",
        ];
        let mut files = Vec::new();
        for folder in &self.folders {
            match self.files.files(folder) {
                Ok(paths) => files.extend(paths),
                Err(refusal) => _ = self.unread.insert(refusal),
            }
        }
        files.retain(|path| {
            let ending = path.extension().and_then(|e| e.to_str()).unwrap_or("").to_ascii_lowercase();
            !OTHERS.contains(&ending.as_str())
        });
        files
    }

    /// Returns a value read from a file, or records why it cannot be read.
    fn read<T>(&mut self, value: impl FnOnce(&F) -> Result<T, String>) -> Option<T> {
        match value(&self.files) {
            Ok(value) => Some(value),
            Err(refusal) => {
                self.unread.insert(refusal);
                None
            }
        }
    }

    fn bytes(&mut self, path: &Path) -> Option<Bytes> {
        self.read(|files| files.program(path))
    }

    /// Returns the first file with the number in its name that contains the program: a name may announce a number that the
    /// file does not have.
    fn find_named(&mut self, number: u32, program: &ProgramName) -> Option<PathBuf> {
        let mut named = self.candidates();
        named.retain(|path| program_number(path) == Some(number));
        named.into_iter().find(|path| {
            self.read(|files| files.programs(path)).is_some_and(|programs| programs.contains(program))
        })
    }

    /// Returns the first file that contains a program.
    fn find_holder(&mut self, program: &ProgramName) -> Option<PathBuf> {
        if self.programs.is_none() {
            let mut found = Vec::new();
            for path in self.candidates() {
                if !has_ending_of_programs(&path)
                    && !self.bytes(&path).is_some_and(|bytes| begins_program(&bytes))
                {
                    continue;
                }
                let Some(programs) = self.read(|files| files.programs(&path)) else { continue };
                found.extend(programs.iter().map(|name| (name.clone(), path.clone())));
            }
            self.programs = Some(found);
        }
        let holders = self.programs.iter().flatten().filter(|(name, _)| name == program);
        let holders: Vec<&PathBuf> = holders.map(|(_, path)| path).collect();
        let first = (*holders.first()?).clone();
        let note = ambiguity(program, &holders);
        self.notes.extend(note.filter(|note| !self.notes.contains(note)));
        Some(first)
    }
}

impl<F: FileAccess> Library for FolderLibrary<F> {
    fn program(&mut self, number: u32) -> Option<(String, Bytes)> {
        let program = ProgramName::Number(number);
        let named = self.find_named(number, &program);
        // An earlier folder wins, also where another file name has the program.
        let path = match named {
            Some(path) if self.folders.first().is_some_and(|own| path.parent() == Some(own)) => path,
            named => match (named, self.find_holder(&program)) {
                (Some(named), Some(holder)) if named.parent() != holder.parent() => holder,
                (named, holder) => named.or(holder)?,
            },
        };
        Some((path.display().to_string(), self.bytes(&path)?))
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

/// Returns true if a file has an ending that only programs have, or none: texts of other kinds may have a line that looks like
/// the head of a program.
fn has_ending_of_programs(path: &Path) -> bool {
    let is_listed =
        |ending: &OsStr| PROGRAM_ENDINGS.iter().any(|program| ending.eq_ignore_ascii_case(program));
    path.extension().is_none_or(is_listed)
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
pub fn begins_program(bytes: &[u8]) -> bool {
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
    matches!(text, [b'%' | b'<', ..]) || matches!(text, [b'&', b'F' | b'f', b'=', ..])
}

/// Returns the programs in a file that have a number or a name.
pub(super) fn programs_in(bytes: &[u8]) -> impl Iterator<Item = ProgramName> + '_ {
    syntax::FileItems::new(SourceId::default(), bytes).filter_map(|piece| match piece {
        FileItem::Program { name, .. } => Some(name),
        _ => None,
    })
}

/// Returns the program number of a file name: `O8101.nc`, `o8101.NC`, `O8101`, `8101.tap`.
pub fn program_number(path: &Path) -> Option<u32> {
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
            assert_eq!(program_number(Path::new(name)), number, "{name}");
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
}
