//! Finds the cases: every folder with a program, at any depth, also below another case.
#![expect(clippy::disallowed_methods, reason = "the command line finds files")]

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use super::case::{ACCEPTED, Case, REFERENCES};
use super::claims::CLAIMS;
use super::main_program::{self, MainProgram};
use super::other_endings::programs_of_other_endings;
use crate::cli::{UsageError, input, output};
use gcode_session::files::{MACHINE_FILE, PROGRAM_ENDINGS, begins_program};

/// Folder of a case's called programs; a folder below it is a case only if it has an accepted result.
const LIBRARY: &str = "lib";

/// Returns the cases in the folders and below them, sorted by name within each given folder. A folder that is
/// reached twice counts once, preferably by a path without links.
pub(super) fn cases(roots: &[PathBuf]) -> Result<Vec<Case>, UsageError> {
    let mut search = Search::default();
    for (root, folder) in roots.iter().enumerate() {
        search.look(CaseFolder { root, folder: folder.clone(), name: String::new(), in_library: false })?;
    }
    while let Some(link) = search.links.pop() {
        search.look(link)?;
    }
    for path in &search.unnamed {
        let endings = PROGRAM_ENDINGS.join(", .");
        output::print_message(&format!(
            "note: {}: begins as a program, and is no case: programs end with .{endings}\n",
            path.display()
        ));
    }
    let mut found = search.found;
    found.sort_by(|(a, one), (b, other)| (a, &one.name).cmp(&(b, &other.name)));
    let named = |(root, case): (usize, Case)| match roots {
        [_] => case,
        _ => Case { name: format!("{}/{}", roots[root].display(), case.name), ..case },
    };
    Ok(found.into_iter().map(named).collect())
}

/// A folder to be searched.
struct CaseFolder {
    /// Index of the given folder that it is below.
    root: usize,
    folder: PathBuf,
    /// Path below the given folder; empty for that folder itself.
    name: String,
    in_library: bool,
}

#[derive(Default)]
struct Search {
    found: Vec<(usize, Case)>,
    /// Folders behind links, searched last.
    links: Vec<CaseFolder>,
    seen: BTreeSet<PathBuf>,
    /// Files that begin as programs and have another ending, beside other programs or without files of a case.
    unnamed: Vec<PathBuf>,
}

impl Search {
    /// Searches a folder and everything below it except links.
    fn look(&mut self, from: CaseFolder) -> Result<(), UsageError> {
        let mut folders = vec![from];
        while let Some(CaseFolder { root, folder, name, in_library }) = folders.pop() {
            if !self.seen.insert(input::canonical(&folder)?) {
                continue;
            }
            if !folder.is_dir() {
                let of_file = input::folder_of(&folder).display().to_string();
                return Err(UsageError::new(format!(
                    "{} is a file: test takes folders with programs; write {of_file}",
                    folder.display()
                )));
            }
            let entries = input::folder(&folder)?;
            let accepted: Vec<String> = entries.iter().filter_map(|path| accepted_label(path)).collect();
            let programs: Vec<PathBuf> =
                entries.iter().filter(|path| !path.is_dir() && is_program(path)).cloned().collect();
            let others = if in_library { Vec::new() } else { programs_of_other_endings(&entries) };
            // Without a program the files of a case would guard nothing.
            let is_unread =
                programs.is_empty() && !others.is_empty() && entries.iter().any(|path| belongs_to_case(path));
            let is_case = !accepted.is_empty() || is_unread || !programs.is_empty() && !in_library;
            if !is_unread {
                self.unnamed.extend(others.iter().cloned());
            }
            for path in entries {
                let own = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
                let below = if name.is_empty() { own.clone() } else { format!("{name}/{own}") };
                if path.is_dir() {
                    let list = if path.is_symlink() { &mut self.links } else { &mut folders };
                    let in_library = in_library || is_case && own == LIBRARY;
                    list.push(CaseFolder { root, folder: path, name: below, in_library });
                } else if path.is_symlink() && !path.exists() && !own.starts_with('.') && !is_program(&path) {
                    // The link may have been a folder of cases.
                    let case = Case { name: below, folder: path, ..Case::default() };
                    self.found.push((root, case));
                }
            }
            if is_case {
                let name = if name.is_empty() { ".".to_owned() } else { name };
                let others = if is_unread { others } else { Vec::new() };
                let case = Case { name, folder, programs, others, ..Case::default() };
                self.found.extend(case.by_main_program(&accepted).into_iter().map(|case| (root, case)));
            }
        }
        Ok(())
    }
}

impl Case {
    /// Returns a case for each main program of the folder; the case of the folder if it has one main program or none, and no
    /// accepted result with a label.
    /// `accepted` are the labels of the accepted results: one without its program is a case too.
    fn by_main_program(self, accepted: &[String]) -> Vec<Self> {
        let mains = if self.programs.is_empty() {
            Ok(Vec::new())
        } else {
            main_program::of(&self.folder, &self.programs)
        };
        let mains = mains.unwrap_or_default();
        let labels: Vec<_> = mains.iter().map(MainProgram::label).collect();
        let is_plain = mains.len() < 2 && !labels.iter().any(|label| accepted.contains(label));
        let lost = accepted.iter().filter(|label| !label.is_empty() && !labels.contains(label));
        let lost: Vec<_> =
            lost.map(|label| Self { programs: Vec::new(), ..self.of_main(label, None) }).collect();
        let has_own =
            !self.programs.is_empty() || !self.others.is_empty() || accepted.iter().any(String::is_empty);
        let mut mains = mains.into_iter();
        let mut cases: Vec<_> = match is_plain {
            true => has_own.then(|| Self { main: mains.next(), ..self }).into_iter().collect(),
            false => mains.zip(&labels).map(|(main, label)| self.of_main(label, Some(main))).collect(),
        };
        cases.extend(lost);
        cases
    }

    fn of_main(&self, label: &str, main: Option<MainProgram>) -> Self {
        let (folder, programs) = (self.folder.clone(), self.programs.clone());
        let name = if self.name == "." { label.to_owned() } else { format!("{}/{label}", self.name) };
        Self { name, folder, programs, others: self.others.clone(), label: Some(label.to_owned()), main }
    }
}

/// Returns the label of an accepted result, empty for that of the folder; `None` for other files.
fn accepted_label(path: &Path) -> Option<String> {
    let label = path.file_name()?.to_str()?.strip_suffix(ACCEPTED)?;
    label.is_empty().then(String::new).or_else(|| Some(label.strip_suffix('.')?.to_owned()))
}

/// Returns the reference that a case of this program has in its folder: `reference.csv`, or with the name of the main program if the folder has
/// several. `path` chooses a program of the file.
pub(in crate::cli) fn reference_beside(program: &Path, path: Option<&str>) -> Option<PathBuf> {
    let folder = input::folder_of(program);
    let files = input::folder(folder).ok()?;
    let is_reference = |path: &PathBuf| REFERENCES.iter().any(|name| path.to_string_lossy().ends_with(name));
    // Most folders have none, and some have thousands of programs.
    files.iter().find(|path| is_reference(path))?;
    let programs: Vec<PathBuf> =
        files.into_iter().filter(|path| !path.is_dir() && is_program(path)).collect();
    let mains = main_program::of(folder, &programs).ok()?;
    let is_own = |main: &&MainProgram| {
        main.file.file_name() == program.file_name()
            && (main.path.is_none() || path.is_some() && main.path.as_deref() == path)
    };
    let own = mains.iter().find(is_own)?;
    let prefix = if mains.len() == 1 { String::new() } else { own.label() + "." };
    REFERENCES.iter().map(|name| folder.join(format!("{prefix}{name}"))).find(|path| path.is_file())
}

/// Returns true for a file that the program of a case uses.
fn belongs_to_case(path: &Path) -> bool {
    let files = [MACHINE_FILE, "control.toml", CLAIMS].into_iter().chain(REFERENCES);
    path.file_name().and_then(|name| name.to_str()).is_some_and(|name| {
        files.clone().any(|file| name == file || name.ends_with(&format!(".{file}")))
            || accepted_label(path).is_some()
    })
}

/// Returns true for a file with the ending of a program, and for one with `.txt` or without ending that begins as a program
/// does.
fn is_program(path: &Path) -> bool {
    let ending = path.extension().and_then(|ending| ending.to_str()).unwrap_or("").to_ascii_lowercase();
    match ending.as_str() {
        "txt" | "" => input::program(path).is_ok_and(|text| begins_program(&text)),
        ending => PROGRAM_ENDINGS.contains(&ending),
    }
}
