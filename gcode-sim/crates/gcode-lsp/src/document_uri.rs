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

/// Returns true for a text that is no program: a configuration file, which counts as it is edited.
pub(crate) fn is_other_text(path: &Path) -> bool {
    const OTHERS: [&str; 4] = ["toml", "json", "csv", "md"];
    let ending = path.extension().and_then(|ending| ending.to_str()).unwrap_or_default();
    OTHERS.iter().any(|other| ending.eq_ignore_ascii_case(other))
}
