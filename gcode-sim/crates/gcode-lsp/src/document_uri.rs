//! Addresses of documents in the protocol's type.
use std::path::{Path, PathBuf};
use std::str::FromStr;

use gcode_session::file_uri;
use lsp_types::Uri;

/// Returns the path of a `file:` URI; `None` for any other, such as `untitled:`.
pub(crate) fn path(uri: &Uri) -> Option<PathBuf> {
    file_uri::path(uri.as_str())
}

/// Returns the `file:` URI of an absolute path.
pub(crate) fn of_path(path: &Path) -> Option<Uri> {
    Uri::from_str(&file_uri::of_path(path)?).ok()
}
