//! Files on the disk, as the search for programs and projects reads them.
#![expect(clippy::disallowed_methods, reason = "the command line finds files")]

use std::path::{Path, PathBuf};

use super::{UsageError, input};
use gcode_lang::source::Bytes;
use gcode_session::files::FileAccess;

/// The disk.
#[derive(Clone, Copy, Debug)]
pub(super) struct DiskFiles;

impl FileAccess for DiskFiles {
    fn program(&self, path: &Path) -> Result<Bytes, String> {
        input::program_text(path).map_err(sentence)
    }

    fn text(&self, path: &Path) -> Result<String, String> {
        input::text(path).map_err(sentence)
    }

    fn files(&self, folder: &Path) -> Result<Vec<PathBuf>, String> {
        let mut paths = input::folder(folder).map_err(sentence)?;
        paths.retain(|path| path.is_file());
        Ok(paths)
    }

    fn is_file(&self, path: &Path) -> bool {
        path.is_file()
    }

    fn canonical(&self, folder: &Path) -> Option<PathBuf> {
        input::canonical(folder).ok()
    }
}

#[expect(clippy::needless_pass_by_value, reason = "an error is mapped")]
fn sentence(error: UsageError) -> String {
    error.to_string()
}
