//! Reads a case folder, compares its result with the files beside it, and knows the kinds of cases.
//!
//! A case is a folder `suite/<kind>/<behaviour in words>/`. What goes in stands there (`case.nc`, a job, a
//! picture's data), and what must come out stands beside it as snapshots. One file per kind in this folder.
#![expect(clippy::unwrap_used, clippy::disallowed_methods, reason = "tests read files and may panic")]

pub mod bench;
#[cfg(feature = "browser")]
pub mod browser;
mod burr_picture;
pub mod changes;
mod check;
mod cli;
mod control;
pub mod dap;
mod exec;
pub mod expect;
pub mod fuzz;
pub mod fuzz_sessions;
mod r#gen;
mod json;
mod lsp;
mod macros;
mod picture;
pub mod programs;
mod prove;
pub mod sheet;
mod syntax;
pub mod verify;

use std::path::{Path, PathBuf};

/// Runs a case; panics if the result differs.
type Run = fn(&Case);

/// The kinds of cases by their folder under `suite/`.
pub const KINDS: &[(&str, Run)] = &[
    ("alarm", exec::alarm),
    ("changes", changes::run),
    ("check", check::run),
    ("cli", cli::run),
    ("control", control::run),
    ("dap", dap::run),
    ("exec", exec::run),
    ("gen", r#gen::run),
    ("lsp", lsp::run),
    ("macro", macros::run),
    ("picture", picture::run),
    ("prove", prove::run),
    ("sheet", sheet::run),
    ("syntax", syntax::run),
    ("verify", verify::run),
];

/// The folder of one case.
pub struct Case {
    pub dir: PathBuf,
}

impl Case {
    /// The bytes of an input file.
    pub fn bytes(&self, name: &str) -> Vec<u8> {
        let path = self.dir.join(name);
        std::fs::read(&path).unwrap_or_else(|e| panic!("{}: {e}", path.display()))
    }

    /// An input file as text.
    pub fn text(&self, name: &str) -> String {
        String::from_utf8(self.bytes(name)).unwrap()
    }

    /// The text of a file that a case may have.
    pub fn optional(&self, name: &str) -> Option<String> {
        std::fs::read_to_string(self.dir.join(name)).ok()
    }

    /// The case's name as it stands on disk: `kind/behaviour`.
    pub fn name(&self) -> String {
        self.dir.strip_prefix(root()).unwrap().display().to_string()
    }

    /// Compares `shown` with `<name>.snap` beside the inputs. `INSTA_UPDATE=always` accepts what is new.
    pub fn snapshot(&self, name: &str, shown: &str) {
        let mut settings = insta::Settings::clone_current();
        settings.set_snapshot_path(&self.dir);
        settings.set_prepend_module_to_snapshot(false);
        settings.set_omit_expression(true);
        settings.bind(|| insta::assert_snapshot!(name.to_owned(), shown));
    }
}

/// A text with B in place of A, for an edit `A => B`, or of every A, for `A =>> B`; `;` is the end of a line.
pub(crate) fn edited(text: &str, edit: &str) -> String {
    let (from, to) = edit.split_once(" =>").unwrap();
    let (is_everywhere, to) = to.strip_prefix('>').map_or((false, to), |to| (true, to));
    let [from, to] = [from, to].map(|part| part.trim().replace(';', "\n"));
    let count = text.matches(&from).count();
    assert!(if is_everywhere { count > 1 } else { count == 1 }, "{from} is there {count} times:\n{text}");
    text.replace(&from, &to)
}

/// The files below a folder with an extension, in the order of their paths; build results are left out.
pub fn files_below(folder: &Path, extension: &str) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in std::fs::read_dir(folder).into_iter().flatten() {
        let path = entry.unwrap().path();
        if path.is_dir() && path.file_name().is_some_and(|name| name != "target") {
            found.extend(files_below(&path, extension));
        } else if path.extension().is_some_and(|own| own == extension) {
            found.push(path);
        }
    }
    found.sort();
    found
}

/// Copies a folder; snapshots of cases are left out.
pub fn copy_folder(from: &Path, to: &Path) {
    std::fs::create_dir_all(to).unwrap();
    for entry in std::fs::read_dir(from).unwrap() {
        let path = entry.unwrap().path();
        let target = to.join(path.file_name().unwrap());
        if path.is_dir() {
            copy_folder(&path, &target);
        } else if path.extension().is_none_or(|extension| extension != "snap" && extension != "new") {
            std::fs::copy(&path, target).unwrap();
        }
    }
}

/// The folder that holds the crates, the examples and the documentation.
pub fn workspace() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap().to_owned()
}

/// The folder of all cases.
pub fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("suite")
}

/// The folders of one kind in the order of their names.
pub fn cases(kind: &str) -> Vec<Case> {
    let Ok(entries) = std::fs::read_dir(root().join(kind)) else { return Vec::new() };
    let mut dirs: Vec<_> = entries.map(|e| e.unwrap().path()).filter(|p| p.is_dir()).collect();
    dirs.sort();
    dirs.into_iter().map(|dir| Case { dir }).collect()
}

/// The kinds that have folders, so that a folder without a kind is noticed.
pub fn folders() -> Vec<String> {
    let Ok(entries) = std::fs::read_dir(root()) else { return Vec::new() };
    let mut names: Vec<_> = entries
        .map(|e| e.unwrap())
        .filter(|e| e.path().is_dir())
        .map(|e| e.file_name().into_string().unwrap())
        .collect();
    names.sort();
    names
}
