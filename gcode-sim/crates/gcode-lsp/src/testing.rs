//! A host without files for the tests of this crate.
use std::path::{Path, PathBuf};
use std::str::FromStr;
use std::sync::Arc;

use gcode_ide::FileId;
use gcode_lang::program::Library;
use gcode_lang::source::Bytes;
use gcode_session::Request;
use gcode_session::files::FileAccess;
use lsp_types::Uri;
use serde_json::Value;

use crate::host::{Host, LibrarySource};
use crate::overlay::Overlay;
use crate::snapshot::Snapshot;

struct NoFiles;

impl FileAccess for NoFiles {
    fn program(&self, path: &Path) -> Result<Bytes, String> {
        Err(format!("no {}", path.display()))
    }

    fn text(&self, path: &Path) -> Result<String, String> {
        Err(format!("no {}", path.display()))
    }

    fn files(&self, _: &Path) -> Result<Vec<PathBuf>, String> {
        Ok(Vec::new())
    }

    fn is_file(&self, _: &Path) -> bool {
        false
    }

    fn canonical(&self, folder: &Path) -> Option<PathBuf> {
        Some(folder.to_owned())
    }
}

impl Host for NoFiles {
    fn stamp(&self, _: &Path) -> Option<u64> {
        None
    }

    fn folders(&self, _: &Path) -> Vec<PathBuf> {
        Vec::new()
    }

    fn reference(&self, path: &Path) -> Result<String, String> {
        self.text(path)
    }

    fn run_report(&self, _: &Request, _: &mut dyn Library) -> Result<Value, String> {
        Err("no reports".to_owned())
    }

    fn verdict_report(
        &self,
        _: &Request,
        _: &mut dyn Library,
        _: Option<&Path>,
    ) -> Result<Option<Value>, String> {
        Err("no reports".to_owned())
    }

    fn proof_report(
        &self,
        _: &Request,
        _: LibrarySource<'_>,
        _: (&[String], &[String]),
    ) -> Result<Value, String> {
        Err("no proofs".to_owned())
    }

    fn write_page(&self, _: &Request, _: &mut dyn Library, _: Option<&Path>) -> Result<PathBuf, String> {
        Err("no pages".to_owned())
    }
    fn page(&self, _: &Request, _: &mut dyn Library, _: Option<&Path>) -> Result<String, String> {
        Err("no pages".to_owned())
    }
}

/// Returns the state in which documents are open: names in one folder with their texts.
pub(crate) fn opened(documents: &[(&str, &str)]) -> (Snapshot, Vec<FileId>) {
    let mut snapshot = Snapshot::new(Overlay::new(Arc::new(NoFiles)));
    let files = documents.iter().map(|(name, text)| {
        let uri = Uri::from_str(&format!("file:///parts/{name}")).unwrap();
        snapshot.open(uri, 1, (*text).to_owned())
    });
    let files = files.collect();
    (snapshot, files)
}
