//! Addresses of documents: the path of a `file:` URI, and the URI of a path.
use std::path::{Path, PathBuf};
use std::str::FromStr;

use lsp_types::Uri;
use percent_encoding::{AsciiSet, NON_ALPHANUMERIC, percent_decode_str, utf8_percent_encode};

/// Bytes that a path in a URI has in another form.
const ESCAPED: &AsciiSet = &NON_ALPHANUMERIC.remove(b'/').remove(b'-').remove(b'_').remove(b'.').remove(b'~');

/// Returns the path of a `file:` URI; `None` for any other, such as `untitled:`.
pub(crate) fn path(uri: &Uri) -> Option<PathBuf> {
    let rest = strip_scheme(uri.as_str())?;
    let rest = rest.split(['?', '#']).next().unwrap_or(rest);
    let (authority, path) = match rest.strip_prefix("//") {
        Some(rest) => rest.split_at(rest.find('/').unwrap_or(rest.len())),
        None => ("", rest),
    };
    let path = percent_decode_str(path).decode_utf8().ok()?;
    let is_local = authority.is_empty() || authority.eq_ignore_ascii_case("localhost");
    if !is_local {
        return Some(PathBuf::from(format!("//{authority}{path}")));
    }
    // Windows: /C:/parts/O1.nc
    let is_drive = matches!(path.as_bytes(), [b'/', drive, b':', ..] if drive.is_ascii_alphabetic());
    Some(PathBuf::from(if is_drive { &path[1..] } else { &path[..] }))
}

fn strip_scheme(uri: &str) -> Option<&str> {
    let (scheme, rest) = uri.split_once(':')?;
    scheme.eq_ignore_ascii_case("file").then_some(rest)
}

/// Returns the `file:` URI of an absolute path.
pub(crate) fn of_path(path: &Path) -> Option<Uri> {
    let text = path.to_str()?.replace('\\', "/");
    let root = if text.starts_with('/') { "" } else { "/" };
    let path = utf8_percent_encode(&text, ESCAPED);
    Uri::from_str(&format!("file://{root}{path}")).ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parsed(text: &str) -> Option<PathBuf> {
        path(&Uri::from_str(text).unwrap())
    }

    #[test]
    fn a_file_uri_has_the_path_that_it_escapes() {
        let path = |text: &str| Some(PathBuf::from(text));
        assert_eq!(parsed("file:///part%20one/%C3%98%235.nc"), path("/part one/\u{d8}#5.nc"));
        assert_eq!(parsed("file:///c%3A/mill/O1.nc"), path("c:/mill/O1.nc"));
        assert_eq!(parsed("file://localhost/O1.nc"), path("/O1.nc"));
        assert_eq!(parsed("file://server/share/O1.nc"), path("//server/share/O1.nc"));
        assert_eq!(parsed("untitled:Untitled-1"), None);
    }

    #[test]
    fn the_uri_of_a_path_leads_back_to_it() {
        for text in ["/a b/\u{d8}#5+%.nc", "/plain/O1234", "/[x]/~o_1-2.nc"] {
            let uri = of_path(Path::new(text)).unwrap();
            assert_eq!(path(&uri), Some(PathBuf::from(text)), "{}", uri.as_str());
        }
        assert_eq!(of_path(Path::new("/a b/#1.nc")).unwrap().as_str(), "file:///a%20b/%231.nc");
    }
}
