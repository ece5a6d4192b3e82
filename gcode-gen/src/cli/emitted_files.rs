//! The files that `emit` has written into a folder, with their SHA-256: a file that has changed since, or that `emit` did not
//! write, is kept.
#![expect(clippy::disallowed_methods, reason = "the command line finds files")]

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use gcode_sim::cli::{UsageError, input};
use gcode_sim::report::encode::sha256;

use crate::report::IGNORED_BY_GIT;

/// Name of the list in the folder, in the form of `sha256sum`.
const LIST: &str = "emitted.sha256";

/// A folder with this name holds results alone: git leaves it out.
const RESULTS: &str = "out";

/// The files that are in a folder, by their names.
#[derive(Debug, Default)]
pub(super) struct EmittedFiles {
    /// Digests by file name, in hexadecimal digits.
    digests: BTreeMap<String, String>,
}

impl EmittedFiles {
    /// Reads the list of a folder; empty if the folder has none.
    pub(super) fn of(folder: &Path) -> Result<Self, UsageError> {
        let path = folder.join(LIST);
        if !path.is_file() {
            return Ok(Self::default());
        }
        let text = input::text(&path)?;
        let line =
            |line: &str| line.split_once("  ").map(|(digest, name)| (name.to_owned(), digest.to_owned()));
        Ok(Self { digests: text.lines().filter_map(line).collect() })
    }

    /// Returns those of the files that the folder has with other contents than `emit` wrote or is about to write.
    pub(super) fn edited<'f>(&self, files: &'f [(PathBuf, &[u8])]) -> Result<Vec<&'f Path>, UsageError> {
        let mut edited = Vec::new();
        for (path, contents) in files {
            if self.is_edited(path, contents)? {
                edited.push(path.as_path());
            }
        }
        Ok(edited)
    }

    /// Returns the text of a file that has other contents than `emit` wrote or is about to write.
    pub(super) fn edited_text(&self, path: &Path, contents: &str) -> Result<Option<String>, UsageError> {
        self.is_edited(path, contents.as_bytes())?.then(|| input::text(path)).transpose()
    }

    fn is_edited(&self, path: &Path, contents: &[u8]) -> Result<bool, UsageError> {
        if !path.is_file() {
            return Ok(false);
        }
        let is = input::bytes(path)?;
        let is_own = self.digests.get(&name(path)).is_some_and(|digest| *digest == sha256(&is));
        Ok(!is.is_empty() && !is_own && is != *contents)
    }

    /// Returns the list with the files that are written now, and its path.
    pub(super) fn with(mut self, folder: &Path, files: &[(PathBuf, &[u8])]) -> (PathBuf, String) {
        self.digests.extend(files.iter().map(|(path, contents)| (name(path), sha256(contents))));
        let lines = self.digests.iter().map(|(name, digest)| format!("{digest}  {name}\n"));
        (folder.join(LIST), lines.collect())
    }
}

fn name(path: &Path) -> String {
    path.file_name().unwrap_or_default().to_string_lossy().into_owned()
}

/// Returns the file that makes git leave out a folder of results that `emit` creates.
pub(super) fn ignored_by_git(folder: &Path) -> Option<(PathBuf, &'static [u8])> {
    let is_new_folder_of_results = !folder.exists() && folder.file_name().is_some_and(|name| name == RESULTS);
    is_new_folder_of_results.then(|| (folder.join(IGNORED_BY_GIT), b"*\n".as_slice()))
}

/// Returns the refusal that names files which are kept.
pub(super) fn refusal(edited: &[&Path]) -> String {
    let names: Vec<_> = edited.iter().map(|path| path.display().to_string()).collect();
    let (verb, they, them) =
        if names.len() == 1 { ("is", "it is", "it") } else { ("are", "they are", "them") };
    format!(
        "error: {} {verb} not as emit wrote {them}: edited, or written by others; {they} kept, and nothing is written: give \
         --force to replace {them}, or name another folder\n",
        names.join(", ")
    )
}

/// Returns the last sentence of a refusal: the programs pass on the job's machine, and fail with the kept machine file.
pub(super) fn failure_with_machine(job: &Path, machine: &Path) -> String {
    let (job, machine) = (job.display(), machine.display());
    format!(
        "the programs of {job} pass on the machine of the job and fail with {machine}, which was edited, or written by others: \
         correct it, or give --force to replace it"
    )
}
