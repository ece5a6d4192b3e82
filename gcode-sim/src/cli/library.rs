//! Finds called programs in folders on the disk, and prints what is ambiguous.
#![expect(clippy::disallowed_methods, reason = "the command line finds files")]

use std::path::{Path, PathBuf};

use super::disk_files::DiskFiles;
use super::{UsageError, output};
use gcode_lang::program::Library;
use gcode_lang::source::Bytes;
use gcode_session::files::FolderLibrary;

/// Folders of called programs; the first folder that has a program wins.
pub struct Folders {
    library: FolderLibrary<DiskFiles>,
    /// Number of notes that are printed.
    printed: usize,
}

impl Folders {
    /// Searches the program's own folder first, then `folders`, which must exist: a misspelt folder would
    /// later look like a missing program.
    pub fn new(program: &Path, folders: &[PathBuf]) -> Result<Self, UsageError> {
        if let Some(missing) = folders.iter().find(|folder| !folder.is_dir()) {
            return Err(UsageError::new(format!("--lib {}: no such folder", missing.display())));
        }
        Ok(Self { library: FolderLibrary::new(DiskFiles, program, folders), printed: 0 })
    }

    /// Prints the notes of the last search.
    fn print_notes(&mut self) {
        for note in &self.library.notes()[self.printed..] {
            output::print_message(&format!("note: {note}\n"));
        }
        self.printed = self.library.notes().len();
    }
}

impl Library for Folders {
    fn program(&mut self, number: u32) -> Option<(String, Bytes)> {
        let found = self.library.program(number);
        self.print_notes();
        found
    }

    fn named(&mut self, name: &str) -> Option<(String, Bytes)> {
        let found = self.library.named(name);
        self.print_notes();
        found
    }

    fn read_error(&self) -> Option<String> {
        self.library.read_error()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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
