//! Writes results to standard output, or to a file that is either complete or absent.
#![expect(clippy::disallowed_methods, reason = "the command line writes files")]

use std::io::Write;
use std::path::{Path, PathBuf};

use super::format::TextFormat;
use super::{UsageError, input};
use crate::report::sarif::{self, Finding, Invocation};

/// Prints a result. A reader that closes the pipe early (`| head`) is not an error.
pub fn print(text: &str) -> Result<(), UsageError> {
    let mut out = anstream::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(error) if error.kind() != std::io::ErrorKind::BrokenPipe => {
            Err(UsageError::new(format!("standard output cannot be written: {error}")))
        }
        _ => Ok(()),
    }
}

/// Prints a verdict: PASS and FAIL in colour where the output is a terminal.
pub(super) fn print_verdict(text: &str) -> Result<(), UsageError> {
    print(&coloured(text))
}

/// Colours the verdict at the beginning of a line, and those of single holes at the end of theirs.
fn coloured(text: &str) -> String {
    const GOOD: &str = "\x1b[1;32m";
    const BAD: &str = "\x1b[1;31m";
    const END: &str = "\x1b[0m";
    let line = |line: &str| {
        let in_front = [("PASS", GOOD), ("FAIL", BAD)].into_iter().find(|(word, _)| line.starts_with(word));
        let behind = || line.find("  FAIL ").map(|at| (at + 2, BAD));
        match (in_front, behind()) {
            (Some((word, style)), _) => format!("{style}{word}{END}{}", &line[word.len()..]),
            (None, Some((at, style))) => format!("{}{style}{}{END}", &line[..at], &line[at..]),
            (None, None) => line.to_owned(),
        }
    };
    let mut lines: String = text.lines().map(|one| line(one) + "\n").collect();
    if !text.ends_with('\n') {
        lines.pop();
    }
    lines
}

/// Prints one JSON document.
pub fn json(document: &impl serde::Serialize) -> Result<(), UsageError> {
    let text = serde_json::to_string_pretty(document)
        .map_err(|error| UsageError::new(format!("the result cannot be written as JSON: {error}")))?;
    print(&(text + "\n"))
}

/// Prints a report as text or as JSON.
pub fn report<R: serde::Serialize>(
    report: &R,
    text: impl Fn(&R) -> String,
    format: TextFormat,
) -> Result<(), UsageError> {
    match format {
        TextFormat::Text => print(&text(report)),
        TextFormat::Json => json(report),
    }
}

/// Prints findings as SARIF for a code review, those of a verdict with its conclusion.
pub(super) fn sarif(
    findings: impl IntoIterator<Item = Finding>,
    conclusion: Option<Invocation>,
) -> Result<(), UsageError> {
    let folder = std::env::current_dir().map(|folder| folder.display().to_string()).unwrap_or_default();
    json(&sarif::log(&findings.into_iter().collect::<Vec<_>>(), conclusion, &folder))
}

/// Prints `picture: top.png` for a further file that is written, if the results are text.
pub(super) fn written(what: &str, path: &Path, is_text: bool) -> Result<(), UsageError> {
    if is_text { print(&format!("{what}: {}\n", path.display())) } else { Ok(()) }
}

/// Prints a message to standard error.
pub fn print_message(text: &str) {
    // A closed standard error leaves no channel for the error itself.
    let _ = anstream::stderr().lock().write_all(text.as_bytes());
}

/// Writes a file through a temporary one in the same folder, so that it is never half-written.
pub fn write(path: &Path, bytes: &[u8]) -> Result<(), UsageError> {
    write_all(&[(path, bytes)])
}

/// Writes several files: all temporary files are complete before the first is renamed.
pub fn write_all<P: AsRef<Path>, B: AsRef<[u8]>>(files: &[(P, B)]) -> Result<(), UsageError> {
    let mut waiting = Vec::new();
    for (path, bytes) in files {
        let (path, bytes) = (path.as_ref(), bytes.as_ref());
        let unwritable = |error: &dyn std::fmt::Display| UsageError::unwritable(path, error);
        if path.is_dir() {
            return Err(unwritable(&"it is a folder"));
        }
        if is_device(path) {
            write_through(path, bytes).map_err(|e| unwritable(&e))?;
            continue;
        }
        let target = resolve_link(path);
        let folder = input::folder_of(&target);
        if !folder.is_dir() {
            return Err(unwritable(&format!("folder {} does not exist", folder.display())));
        }
        let mut file = tempfile::Builder::new()
            .prefix(".writing-")
            .tempfile_in(folder)
            .map_err(|e| unwritable(&plain(&e)))?;
        file.write_all(bytes).map_err(|e| unwritable(&e))?;
        allow_reading(file.as_file()).map_err(|e| unwritable(&e))?;
        waiting.push((target, file));
    }
    for (target, file) in waiting {
        file.persist(&target).map_err(|e| UsageError::unwritable(&target, e.error))?;
    }
    Ok(())
}

/// Formats the error without the name of the temporary file, which means nothing to the user.
fn plain(error: &std::io::Error) -> String {
    let text = error.to_string();
    text.split(" at path ").next().unwrap_or_default().to_owned()
}

/// Returns true for a device such as `/dev/null` or a pipe. A file renamed onto it would replace it for all
/// users.
fn is_device(path: &Path) -> bool {
    std::fs::metadata(path).is_ok_and(|about| !about.is_file() && !about.is_dir())
}

fn write_through(path: &Path, bytes: &[u8]) -> std::io::Result<()> {
    let mut device = std::fs::OpenOptions::new().write(true).open(path)?;
    device.write_all(bytes)?;
    device.flush()
}

/// Resolves a link, so that it stays a link.
fn resolve_link(path: &Path) -> PathBuf {
    path.canonicalize().unwrap_or_else(|_| path.to_owned())
}

/// Sets the permissions of a new file: temporary files are private, results readable like other files.
#[cfg(unix)]
fn allow_reading(file: &std::fs::File) -> std::io::Result<()> {
    use std::os::unix::fs::PermissionsExt;
    file.set_permissions(std::fs::Permissions::from_mode(0o644))
}

#[cfg(not(unix))]
fn allow_reading(_: &std::fs::File) -> std::io::Result<()> {
    Ok(())
}

#[cfg(test)]
mod colour_tests {
    use super::*;
    use anstream::adapter::strip_str;

    #[test]
    fn verdicts_are_coloured_and_nothing_else_changes() {
        let text = "1   10.000  pass\n2   20.000  FAIL position\n\nFAIL     1 of 2 holes in tolerance\nworst    PASS\n";
        let shown = coloured(text);
        assert_eq!(strip_str(&shown).to_string(), text);
        let coloured_lines: Vec<usize> = shown
            .lines()
            .enumerate()
            .filter(|(_, line)| line.contains('\x1b'))
            .map(|(index, _)| index)
            .collect();
        assert_eq!(coloured_lines, [1, 3]);
        assert!(
            coloured("PASS     all\n").starts_with("\x1b[1;32mPASS\x1b[0m "),
            "{:?}",
            coloured("PASS     all\n")
        );
    }
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;

    #[test]
    fn a_link_stays_a_link() {
        let folder = tempfile::tempdir().unwrap();
        let (file, link) = (folder.path().join("file"), folder.path().join("link"));
        write(&file, b"old").unwrap();
        std::os::unix::fs::symlink(&file, &link).unwrap();
        write(&link, b"new").unwrap();
        assert!(link.is_symlink());
        assert_eq!(super::super::input::bytes(&file).unwrap(), b"new");
    }

    #[test]
    fn an_error_does_not_name_the_temporary_file() {
        let error = std::io::Error::other("no room at path \"/part/.writing-XYZ\"");
        assert_eq!(plain(&error), "no room");
    }

    #[test]
    fn a_device_is_written_to_and_stays_a_device() {
        // The device is behind a link: a failing test could replace the link, never the device.
        let folder = tempfile::tempdir().unwrap();
        let (link, full) = (folder.path().join("null"), folder.path().join("full"));
        std::os::unix::fs::symlink("/dev/null", &link).unwrap();
        write(&link, b"gone").unwrap();
        assert!(link.is_symlink() && is_device(&link));
        if is_device(Path::new("/dev/full")) {
            std::os::unix::fs::symlink("/dev/full", &full).unwrap();
            assert!(write(&full, b"too much").is_err(), "a full device is an error");
            assert!(is_device(&full));
        }
    }
}
