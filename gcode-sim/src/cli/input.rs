//! Reads the files that the user names: programs, jobs, references, machine files. Errors are one sentence.
#![expect(clippy::disallowed_methods, reason = "the command line reads files")]

use std::io::Read;
use std::path::{Path, PathBuf};

use super::UsageError;

/// Largest input, bytes; no control holds a larger program.
const LARGEST: u64 = 1 << 30;

/// Reads a file's bytes; `-` is standard input.
pub fn bytes(path: &Path) -> Result<Vec<u8>, UsageError> {
    if path == Path::new("-") {
        let mut bytes = Vec::new();
        return match std::io::stdin().lock().take(LARGEST).read_to_end(&mut bytes) {
            Ok(_) => Ok(bytes),
            Err(error) => Err(UsageError::new(format!("standard input cannot be read: {error}"))),
        };
    }
    let unreadable = |error: std::io::Error| UsageError::unreadable(path, error);
    let about = std::fs::metadata(path).map_err(unreadable)?;
    if about.is_dir() {
        return Err(UsageError::new(format!("{} is a folder; name a file in it", path.display())));
    }
    if about.len() > LARGEST {
        return Err(UsageError::new(format!("{} is larger than 1 GiB", path.display())));
    }
    std::fs::read(path).map_err(unreadable)
}

/// Signatures of files that are not programs, and their kinds.
const OTHERS: [(&[u8], &str); 5] = [
    (b"\x89PNG", "a picture"),
    (b"\xff\xd8\xff", "a picture"),
    (b"%PDF-", "a PDF document"),
    (b"PK\x03\x04", "an archive or an office document"),
    (b"{\\rtf", "a word processor's document"),
];

/// Reads a program's bytes; refuses files of another kind.
pub fn program(path: &Path) -> Result<Vec<u8>, UsageError> {
    let bytes = bytes(path)?;
    let name = path.display();
    if let Some((_, what)) = OTHERS.iter().find(|(start, _)| bytes.starts_with(start)) {
        return Err(UsageError::new(format!("{name} is {what}, not a program")));
    }
    if path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("toml")) {
        return Err(UsageError::new(format!(
            "{name} is a job or a machine file, not a program: give it with --reference or --machine"
        )));
    }
    Ok(bytes)
}

/// Returns the entries of a folder, sorted by name.
pub fn folder(path: &Path) -> Result<Vec<PathBuf>, UsageError> {
    let unreadable = |error: std::io::Error| UsageError::unreadable(path, error);
    let entries = std::fs::read_dir(path).map_err(unreadable)?;
    let mut paths =
        entries.map(|entry| Ok(entry?.path())).collect::<Result<Vec<_>, _>>().map_err(unreadable)?;
    paths.sort();
    Ok(paths)
}

/// Returns the canonical path of a folder, with links resolved.
pub fn canonical(path: &Path) -> Result<PathBuf, UsageError> {
    path.canonicalize().map_err(|error| UsageError::unreadable(path, error))
}

/// Reads a file's text, which must be UTF-8 (jobs, machine files, references; programs are bytes).
pub fn text(path: &Path) -> Result<String, UsageError> {
    let text = String::from_utf8(bytes(path)?).map_err(|error| {
        let valid = &error.as_bytes()[..error.utf8_error().valid_up_to()];
        let line = valid.iter().filter(|byte| **byte == b'\n').count() + 1;
        UsageError::in_file(path, format!("line {line}: not UTF-8 text"))
    })?;
    Ok(text.strip_prefix('\u{feff}').map_or(text.clone(), str::to_owned))
}
