//! The project of a program: `gcode.toml` in its folder or one above, and `machine.toml` beside it.
use std::path::{Path, PathBuf};

use super::{FileAccess, folder_of};
use gcode_lint::rules;
use gcode_part::job::project::{PROJECT_FILE, ProjectFile};
use gcode_part::reader::FileError;

/// Name of a machine file that counts beside a program, as the generator writes it.
pub const MACHINE_FILE: &str = "machine.toml";

/// The project's file that holds for a program.
#[derive(Debug, Default)]
pub struct Project {
    /// The program's path below the folder of the file, as the file names it.
    program: PathBuf,
    found: Option<FoundFile>,
}

#[derive(Debug)]
struct FoundFile {
    /// The folder of the file, with links resolved.
    folder: PathBuf,
    /// The same folder as messages show it.
    shown: PathBuf,
    file: ProjectFile,
}

/// An unusable project's file.
#[derive(Debug, thiserror::Error)]
pub enum ProjectError {
    /// The file cannot be read.
    #[error("{0}")]
    Unreadable(String),
    /// The file has an unknown key or value.
    #[error("{}, {error}", path.display())]
    Contents {
        /// The file.
        path: PathBuf,
        /// The fault with its line.
        error: FileError,
    },
    /// The file names a rule that `check` does not have.
    #[error("{}, key 'allow': '{name}' is not a rule of check: docs/checks.md lists them", path.display())]
    UnknownRule {
        /// The file.
        path: PathBuf,
        /// The unknown name.
        name: String,
    },
}

/// Files that a project gives a program.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ProjectPaths {
    /// Machine file: that of the project, otherwise the one beside the program.
    pub machine: Option<PathBuf>,
    /// Control file.
    pub control: Option<PathBuf>,
    /// Family of controls.
    pub dialect: Option<String>,
    /// Folders of called programs.
    pub libraries: Vec<PathBuf>,
    /// Reference.
    pub reference: Option<PathBuf>,
}

impl Project {
    /// Finds the project of a program; `shown` gives a folder as messages show it.
    ///
    /// # Errors
    /// A file that cannot be read, or with an unknown key or value.
    pub fn of(
        program: &Path,
        files: &impl FileAccess,
        shown: impl Fn(&Path) -> PathBuf,
    ) -> Result<Self, ProjectError> {
        let name = program.file_name().map(PathBuf::from).unwrap_or_default();
        let folder = files.canonical(folder_of(program));
        let root = folder.as_deref().and_then(|folder| project_folder(folder, files));
        let (Some(folder), Some(root)) = (&folder, root) else {
            return Ok(Self { program: name, found: None });
        };
        let below = folder.strip_prefix(root).unwrap_or(Path::new(""));
        let shown = shown(root);
        let path = shown.join(PROJECT_FILE);
        let text = files.text(&path).map_err(ProjectError::Unreadable)?;
        let file = ProjectFile::parse(&text).map_err(|error| ProjectError::Contents { path, error })?;
        let found = FoundFile { folder: root.to_owned(), shown, file };
        Ok(Self { program: below.join(name), found: Some(found) })
    }

    /// Returns the files that the project gives the program at `path`, which is `-` for standard input.
    pub fn paths(&self, path: &Path, files: &impl FileAccess) -> ProjectPaths {
        let entry = self.found.as_ref().map(|found| found.file.entry(&self.program)).unwrap_or_default();
        let beside = path.with_file_name(MACHINE_FILE);
        let beside = Some(beside).filter(|file| path != Path::new("-") && files.is_file(file));
        ProjectPaths {
            machine: entry.machine.map(|path| self.shown(&path)).or(beside),
            control: entry.control.map(|path| self.shown(&path)),
            dialect: entry.dialect,
            libraries: entry.libraries.iter().map(|path| self.shown(path)).collect(),
            reference: self.reference(),
        }
    }

    /// Returns the reference that the project's file gives the program.
    pub fn reference(&self) -> Option<PathBuf> {
        let entry = self.found.as_ref()?.file.entry(&self.program);
        entry.reference.map(|path| self.shown(&path))
    }

    /// Returns a path among the references of the project's file that names no file, but is like that of the program; with the
    /// program's own.
    pub fn misnamed_reference(&self, files: &impl FileAccess) -> Option<(&Path, &Path)> {
        let other = self.found.as_ref()?.file.misnamed_reference(&self.program)?;
        (!files.is_file(&self.shown(other))).then_some((other, &self.program))
    }

    /// Returns the folder of the project's file, with links resolved.
    pub fn folder(&self) -> Option<&Path> {
        self.found.as_ref().map(|found| found.folder.as_path())
    }

    /// Returns true if the project's file leaves out the findings of a rule in a file.
    pub fn allows(&self, rule: &str, file: &Path, files: &impl FileAccess) -> bool {
        let Some(found) = &self.found else { return false };
        let Some(folder) = files.canonical(folder_of(file)) else { return false };
        let below = folder.strip_prefix(&found.folder).ok();
        below.is_some_and(|below| found.file.allows(rule, &below.join(file.file_name().unwrap_or_default())))
    }

    /// Refuses a name in `allow` that is not a rule of `check`.
    ///
    /// # Errors
    /// [`ProjectError::UnknownRule`].
    pub fn check_rules(&self) -> Result<(), ProjectError> {
        let Some(found) = &self.found else { return Ok(()) };
        let is_rule = |name: &str| rules::ALL.iter().any(|rule| rule.kind.code.eq_ignore_ascii_case(name));
        match found.file.allowed_rules().find(|name| !is_rule(name)) {
            Some(name) => {
                let path = found.shown.join(PROJECT_FILE);
                Err(ProjectError::UnknownRule { path, name: name.to_owned() })
            }
            None => Ok(()),
        }
    }

    /// Returns a path of the project's file as messages show it.
    fn shown(&self, path: &Path) -> PathBuf {
        self.found.as_ref().map_or_else(|| path.to_owned(), |found| found.shown.join(path))
    }
}

/// Returns the nearest folder with a project's file, from a folder upwards.
pub fn project_folder<'a>(folder: &'a Path, files: &impl FileAccess) -> Option<&'a Path> {
    folder.ancestors().find(|folder| files.is_file(&folder.join(PROJECT_FILE)))
}
