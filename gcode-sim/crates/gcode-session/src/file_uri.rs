//! `file:` URIs of programs: the path of a URI, and the URI of a path.
use std::path::{Path, PathBuf};

use percent_encoding::{AsciiSet, NON_ALPHANUMERIC, percent_decode_str, utf8_percent_encode};

/// Bytes that a path in a URI has in another form.
const ESCAPED: &AsciiSet = &NON_ALPHANUMERIC.remove(b'/').remove(b'-').remove(b'_').remove(b'.').remove(b'~');

/// Returns the path of a `file:` URI; `None` for any other, such as `untitled:`.
pub fn path(uri: &str) -> Option<PathBuf> {
    let (scheme, rest) = uri.split_once(':')?;
    let rest = scheme.eq_ignore_ascii_case("file").then_some(rest)?;
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

/// Returns the `file:` URI of an absolute path; `None` if the path is no Unicode.
pub fn of_path(path: &Path) -> Option<String> {
    let text = path.to_str()?.replace('\\', "/");
    let root = if text.starts_with('/') { "" } else { "/" };
    Some(format!("file://{root}{}", utf8_percent_encode(&text, ESCAPED)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_uri_has_the_path_that_it_escapes() {
        let expected = |text: &str| Some(PathBuf::from(text));
        assert_eq!(path("file:///part%20one/%C3%98%235.nc"), expected("/part one/\u{d8}#5.nc"));
        assert_eq!(path("file:///c%3A/mill/O1.nc"), expected("c:/mill/O1.nc"));
        assert_eq!(path("file:///C:/mill/O1.nc"), expected("C:/mill/O1.nc"));
        assert_eq!(path("file://localhost/O1.nc"), expected("/O1.nc"));
        assert_eq!(path("file://server/share/O1.nc"), expected("//server/share/O1.nc"));
        assert_eq!(path("untitled:Untitled-1"), None);
        assert_eq!(path("/parts/O1.nc"), None);
    }

    #[test]
    fn the_uri_of_a_path_leads_back_to_it() {
        for text in ["/a b/\u{d8}#5+%.nc", "/plain/O1234", "/[x]/~o_1-2.nc", "C:/mill/O1.nc"] {
            let uri = of_path(Path::new(text)).unwrap();
            assert_eq!(path(&uri), Some(PathBuf::from(text)), "{uri}");
        }
        assert_eq!(of_path(Path::new("/a b/#1.nc")).unwrap(), "file:///a%20b/%231.nc");
        assert_eq!(of_path(Path::new("C:\\mill\\O1.nc")).unwrap(), "file:///C%3A/mill/O1.nc");
    }
}
