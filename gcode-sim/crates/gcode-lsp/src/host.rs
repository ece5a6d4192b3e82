//! The host of the server: files, reports and pages, which the server itself does not read or write.
use std::path::{Path, PathBuf};

use gcode_lang::program::Library;
use gcode_session::Request;
use gcode_session::files::FileAccess;
use serde_json::Value;

/// Function that returns the called programs for one thread of a proof.
pub type LibrarySource<'a> = &'a (dyn Fn() -> Box<dyn Library> + Sync);

/// What the server needs of its surroundings.
pub trait Host: FileAccess + Send + Sync {
    /// Returns a stamp of a file that differs after a change; `None` for a file that does not exist.
    fn stamp(&self, path: &Path) -> Option<u64>;

    /// Returns false for a file whose first bytes are not those of a text.
    fn is_text(&self, _: &Path) -> bool {
        true
    }

    /// Returns the file of the page that explains a code of a finding; `None` without such a page.
    fn explanation(&self, _: &str) -> Option<PathBuf> {
        None
    }

    /// Returns false if no process of this computer has an id; true where that cannot be known.
    fn is_alive(&self, _process: u32) -> bool {
        true
    }

    /// Returns the folders in a folder, sorted by name.
    fn folders(&self, path: &Path) -> Vec<PathBuf>;

    /// Returns the text of a hole list or a job file.
    ///
    /// # Errors
    /// The file cannot be read.
    fn reference(&self, path: &Path) -> Result<String, String>;

    /// Runs a program and returns the document of `gcode-sim run --format json`.
    ///
    /// # Errors
    /// The run cannot begin.
    fn run_report(&self, request: &Request, library: &mut dyn Library) -> Result<Value, String>;

    /// Verifies a program as `gcode-sim verify` does and returns the document of `--format json`: against the reference at a path,
    /// without one against the list beside the program, or by its motion in the stock of the machine file. `None` if it has
    /// neither.
    ///
    /// # Errors
    /// The run cannot begin, or the reference cannot be used.
    fn verdict_report(
        &self,
        request: &Request,
        library: &mut dyn Library,
        reference: Option<&Path>,
    ) -> Result<Option<Value>, String>;

    /// Proves claims on a program for ranges of its variables and returns the document of `gcode-sim prove --format json`.
    ///
    /// # Errors
    /// A range or a claim cannot be read, or the run cannot begin.
    fn proof_report(
        &self,
        request: &Request,
        libraries: LibrarySource<'_>,
        ranges_and_claims: (&[String], &[String]),
    ) -> Result<Value, String>;

    /// Writes the page of a program, with its verdict if there is a reference, and returns the page's file.
    ///
    /// # Errors
    /// The run cannot begin, or the page cannot be written.
    fn write_page(
        &self,
        request: &Request,
        library: &mut dyn Library,
        reference: Option<&Path>,
    ) -> Result<PathBuf, String>;

    /// Returns the page of a program as HTML, with its verdict if there is a reference.
    ///
    /// # Errors
    /// The run cannot begin, or the reference cannot be used.
    fn page(
        &self,
        request: &Request,
        library: &mut dyn Library,
        reference: Option<&Path>,
    ) -> Result<String, String>;
}
