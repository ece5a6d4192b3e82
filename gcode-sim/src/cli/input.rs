//! Reads what the user names: programs, jobs, references, machine files; one clear sentence where it can't.
use std::io::Read;
use std::path::{Path, PathBuf};

use super::UsageError;

/// Nothing a control could hold is larger.
const LARGEST: u64 = 1 << 30;

/// A file's bytes; `-` is standard input.
#[expect(clippy::disallowed_methods, reason = "the command line reads files")]
pub fn bytes(path: &Path) -> Result<Vec<u8>, UsageError> {
    if path == Path::new("-") {
        let mut bytes = Vec::new();
        return match std::io::stdin().lock().take(LARGEST).read_to_end(&mut bytes) {
            Ok(_) => Ok(bytes),
            Err(error) => Err(UsageError::new(format!("standard input cannot be read: {error}"))),
        };
    }
    let unreadable =
        |error: std::io::Error| UsageError::new(format!("{} cannot be read: {error}", path.display()));
    let about = std::fs::metadata(path).map_err(unreadable)?;
    if about.is_dir() {
        return Err(UsageError::new(format!("{} is a folder; name a file in it", path.display())));
    }
    if about.len() > LARGEST {
        return Err(UsageError::new(format!("{} is larger than 1 GiB", path.display())));
    }
    std::fs::read(path).map_err(unreadable)
}

/// How files begin that are no programs, and what they are.
const OTHERS: [(&[u8], &str); 5] = [
    (b"\x89PNG", "a picture"),
    (b"\xff\xd8\xff", "a picture"),
    (b"%PDF-", "a PDF document"),
    (b"PK\x03\x04", "an archive or an office document"),
    (b"{\\rtf", "a word processor's document"),
];

/// A program's bytes; refuses what is plainly something else.
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

/// What is in a folder, by name.
pub fn folder(path: &Path) -> Result<Vec<PathBuf>, UsageError> {
    let unreadable =
        |error: std::io::Error| UsageError::new(format!("{} cannot be read: {error}", path.display()));
    let entries = std::fs::read_dir(path).map_err(unreadable)?;
    let mut paths =
        entries.map(|entry| Ok(entry?.path())).collect::<Result<Vec<_>, _>>().map_err(unreadable)?;
    paths.sort();
    Ok(paths)
}

/// A folder's one path, whatever links lead to it.
pub fn canonical(path: &Path) -> Result<PathBuf, UsageError> {
    path.canonicalize()
        .map_err(|error| UsageError::new(format!("{} cannot be read: {error}", path.display())))
}

/// A file's text, which must be UTF-8 (jobs, machine files, references; programs are bytes).
pub fn text(path: &Path) -> Result<String, UsageError> {
    let bytes = bytes(path)?;
    match String::from_utf8(bytes) {
        Ok(text) => Ok(text.strip_prefix('\u{feff}').map_or(text.clone(), str::to_owned)),
        Err(error) => {
            let line =
                error.as_bytes()[..error.utf8_error().valid_up_to()].iter().filter(|b| **b == b'\n').count()
                    + 1;
            Err(UsageError::new(format!("{}, line {line}: not UTF-8 text", path.display())))
        }
    }
}
