//! Files around a program: access to them, the libraries of called programs, and the project. The access is a trait, so that
//! nothing here reads a disk itself.
mod folder_library;
mod project;

pub use folder_library::{FolderLibrary, PROGRAM_ENDINGS, begins_program, program_number};
pub use project::{MACHINE_FILE, Project, ProjectError, ProjectPaths, project_folder};

use std::path::{Path, PathBuf};
use std::sync::Arc;

use gcode_lang::source::Bytes;
use gcode_lang::syntax::ast::ProgramName;

/// Access to files and folders. Errors are sentences that name the file.
pub trait FileAccess {
    /// Returns a file that may hold programs, as UTF-8 text.
    ///
    /// # Errors
    /// The file cannot be read, or is of another kind.
    fn program(&self, path: &Path) -> Result<Bytes, String>;

    /// Returns the text of a machine file, a job, a control file or a project's file.
    ///
    /// # Errors
    /// The file cannot be read, or is not UTF-8.
    fn text(&self, path: &Path) -> Result<String, String>;

    /// Returns the paths of the files in a folder, sorted by name; folders in it are left out.
    ///
    /// # Errors
    /// The folder cannot be read.
    fn files(&self, folder: &Path) -> Result<Vec<PathBuf>, String>;

    /// Returns true for an existing file.
    fn is_file(&self, path: &Path) -> bool;

    /// Returns the path of a folder with links resolved; `None` if it does not exist.
    fn canonical(&self, folder: &Path) -> Option<PathBuf>;

    /// Returns the numbers and names of the programs in a file.
    ///
    /// # Errors
    /// See [`FileAccess::program`].
    fn programs(&self, path: &Path) -> Result<Arc<[ProgramName]>, String> {
        Ok(folder_library::programs_in(&self.program(path)?).collect())
    }
}

impl<F: FileAccess + ?Sized> FileAccess for &F {
    fn program(&self, path: &Path) -> Result<Bytes, String> {
        (**self).program(path)
    }

    fn text(&self, path: &Path) -> Result<String, String> {
        (**self).text(path)
    }

    fn files(&self, folder: &Path) -> Result<Vec<PathBuf>, String> {
        (**self).files(folder)
    }

    fn is_file(&self, path: &Path) -> bool {
        (**self).is_file(path)
    }

    fn canonical(&self, folder: &Path) -> Option<PathBuf> {
        (**self).canonical(folder)
    }

    fn programs(&self, path: &Path) -> Result<Arc<[ProgramName]>, String> {
        (**self).programs(path)
    }
}

/// Returns the folder that a file is in; that of a bare name is `.`.
pub fn folder_of(path: &Path) -> &Path {
    path.parent().filter(|parent| !parent.as_os_str().is_empty()).unwrap_or(Path::new("."))
}
