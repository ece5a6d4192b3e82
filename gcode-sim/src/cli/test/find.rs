//! Finds the cases: every folder with a program, at any depth, also below another case.
#![expect(clippy::disallowed_methods, reason = "the command line finds files")]

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use super::case::{ACCEPTED, Case};
use crate::cli::{UsageError, input};

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
}

impl Search {
    /// Searches a folder and everything below it except links.
    fn look(&mut self, from: CaseFolder) -> Result<(), UsageError> {
        let mut folders = vec![from];
        while let Some(CaseFolder { root, folder, name, in_library }) = folders.pop() {
            if !self.seen.insert(input::canonical(&folder)?) {
                continue;
            }
            let entries = input::folder(&folder)?;
            let has_accepted =
                entries.iter().any(|path| path.file_name().is_some_and(|name| name == ACCEPTED));
            let programs: Vec<PathBuf> =
                entries.iter().filter(|path| is_program(path) && !path.is_dir()).cloned().collect();
            let is_case = has_accepted || !programs.is_empty() && !in_library;
            for path in entries {
                let own = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
                let below = if name.is_empty() { own.clone() } else { format!("{name}/{own}") };
                if path.is_dir() {
                    let list = if path.is_symlink() { &mut self.links } else { &mut folders };
                    let in_library = in_library || is_case && own == LIBRARY;
                    list.push(CaseFolder { root, folder: path, name: below, in_library });
                } else if path.is_symlink() && !path.exists() && !own.starts_with('.') && !is_program(&path) {
                    // The link may have been a folder of cases.
                    self.found.push((root, Case { name: below, folder: path, programs: Vec::new() }));
                }
            }
            if is_case {
                let name = if name.is_empty() { ".".to_owned() } else { name };
                self.found.push((root, Case { name, folder, programs }));
            }
        }
        Ok(())
    }
}

fn is_program(path: &Path) -> bool {
    path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("nc"))
}
