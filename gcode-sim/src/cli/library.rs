//! Finds called programs in folders: `O8101.nc` and `PROBE.nc` by their names, any other file by the programs it holds.
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use super::{Refusal, input};
use crate::program::Library;
use crate::source::SourceId;
use crate::syntax::{self, Piece, ast::ProgramName};

/// The folders to look in, the first that has a program wins.
pub struct Folders {
    folders: Vec<PathBuf>,
    /// What the files hold whose names don't tell; read at the first call that no name answers.
    contents: Option<Contents>,
}

/// The files by what they hold.
#[derive(Default)]
struct Contents {
    numbers: BTreeMap<u32, PathBuf>,
    names: BTreeMap<String, PathBuf>,
}

impl Folders {
    /// `folders` must exist: a misspelt one would look like a missing program later.
    pub fn new(program: &Path, folders: &[PathBuf]) -> Result<Self, Refusal> {
        if let Some(missing) = folders.iter().find(|folder| !folder.is_dir()) {
            return Err(Refusal::new(format!("--lib {}: no such folder", missing.display())));
        }
        let own = match program.parent() {
            Some(parent) if parent.as_os_str().is_empty() => PathBuf::from("."),
            Some(parent) => parent.to_owned(),
            None => PathBuf::from("."),
        };
        Ok(Self { folders: std::iter::once(own).chain(folders.iter().cloned()).collect(), contents: None })
    }

    fn by_name(&self, number: u32) -> Option<PathBuf> {
        let wanted = |path: &Path| numbered(path) == Some(number);
        self.folders.iter().find_map(|folder| files(folder).into_iter().find(|path| wanted(path)))
    }

    fn contents(&mut self) -> &Contents {
        self.contents.get_or_insert_with(|| {
            let mut found = Contents::default();
            for path in self.folders.iter().flat_map(|folder| files(folder)) {
                let Ok(bytes) = input::bytes(&path) else { continue };
                for program in programs_in(&bytes) {
                    match program {
                        ProgramName::Number(number) => {
                            found.numbers.entry(number).or_insert_with(|| path.clone());
                        }
                        ProgramName::Name(name) => {
                            found.names.entry(name).or_insert_with(|| path.clone());
                        }
                        ProgramName::Unnamed => {}
                    }
                }
            }
            found
        })
    }
}

impl Library for Folders {
    fn program(&mut self, number: u32) -> Option<(String, Vec<u8>)> {
        // A file's name may promise a number that isn't in it: then the contents decide.
        let named = self.by_name(number).and_then(|path| Some((input::bytes(&path).ok()?, path)));
        let holds = |bytes: &[u8]| programs_in(bytes).any(|name| name == ProgramName::Number(number));
        let (bytes, path) = match named.filter(|(bytes, _)| holds(bytes)) {
            Some(found) => found,
            None => {
                let path = self.contents().numbers.get(&number).cloned()?;
                (input::bytes(&path).ok()?, path)
            }
        };
        Some((path.display().to_string(), bytes))
    }

    fn named(&mut self, name: &str) -> Option<(String, Vec<u8>)> {
        let path = match self.contents().names.get(name).cloned() {
            Some(path) => path,
            // A file of this name that says neither name nor number itself.
            None => self.folders.iter().find_map(|folder| {
                let called = |path: &PathBuf| path.file_stem().is_some_and(|s| s.eq_ignore_ascii_case(name));
                files(folder).into_iter().find(called)
            })?,
        };
        let bytes = input::bytes(&path).ok()?;
        Some((path.display().to_string(), bytes))
    }
}

/// The programs in a file that have a number or a name.
fn programs_in(bytes: &[u8]) -> impl Iterator<Item = ProgramName> + '_ {
    syntax::Pieces::new(SourceId::default(), bytes).filter_map(|piece| match piece {
        Piece::Program { name, .. } => Some(name),
        _ => None,
    })
}

/// The number in `O8101.nc`, `o8101.NC`, `O8101`, `8101.tap`.
fn numbered(path: &Path) -> Option<u32> {
    let stem = path.file_stem()?.to_str()?;
    let digits = stem.strip_prefix(['O', 'o']).unwrap_or(stem);
    if digits.bytes().all(|b| b.is_ascii_digit()) { digits.parse().ok() } else { None }
}

/// What can be a program: files that aren't of another kind by their ending, in the order of their names.
fn files(folder: &Path) -> Vec<PathBuf> {
    const OTHERS: [&str; 12] =
        ["toml", "json", "csv", "png", "md", "txt", "html", "snap", "pdf", "zip", "rs", "new"];
    let Ok(entries) = std::fs::read_dir(folder) else { return Vec::new() };
    let mut files: Vec<_> = entries
        .filter_map(|entry| Some(entry.ok()?.path()))
        .filter(|path| {
            let ending = path.extension().and_then(|e| e.to_str()).unwrap_or("").to_ascii_lowercase();
            path.is_file() && !OTHERS.contains(&ending.as_str())
        })
        .collect();
    files.sort();
    files
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_tell_numbers() {
        for (name, number) in
            [("O8101.nc", Some(8101)), ("o0012", Some(12)), ("8101.TAP", Some(8101)), ("part.nc", None)]
        {
            assert_eq!(numbered(Path::new(name)), number, "{name}");
        }
    }
}
