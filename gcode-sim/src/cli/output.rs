//! Writes results: to standard output, or to a file that is complete or not there at all.
use std::io::Write;
use std::path::Path;

use super::Refusal;

/// Prints a result. A reader that has heard enough (`| head`) is no error.
pub fn print(text: &str) -> Result<(), Refusal> {
    let mut out = anstream::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(error) if error.kind() != std::io::ErrorKind::BrokenPipe => {
            Err(Refusal::new(format!("standard output can't be written: {error}")))
        }
        _ => Ok(()),
    }
}

/// Prints one JSON document.
pub fn json(document: &impl serde::Serialize) -> Result<(), Refusal> {
    let text = serde_json::to_string_pretty(document);
    print(
        &(text.map_err(|error| Refusal::new(format!("the result can't be written as JSON: {error}")))?
            + "\n"),
    )
}

/// Tells something that isn't the result.
pub fn tell(text: &str) {
    // Where even standard error is closed there is nobody left to tell.
    let _ = anstream::stderr().lock().write_all(text.as_bytes());
}

/// Writes a file by way of a temporary one beside it, so that it is never half-written.
pub fn write(path: &Path, bytes: &[u8]) -> Result<(), Refusal> {
    write_all(&[(path, bytes)])
}

/// Writes several files: all are written beside their places before the first is put into its place.
pub fn write_all(files: &[(&Path, &[u8])]) -> Result<(), Refusal> {
    let mut waiting = Vec::new();
    for (path, bytes) in files {
        let unwritable = |error: &dyn std::fmt::Display| {
            Refusal::new(format!("{} can't be written: {error}", path.display()))
        };
        if path.is_dir() {
            return Err(unwritable(&"it is a folder"));
        }
        let folder = match path.parent() {
            Some(folder) if !folder.as_os_str().is_empty() => folder,
            _ => Path::new("."),
        };
        if !folder.is_dir() {
            return Err(unwritable(&format!("there is no folder {}", folder.display())));
        }
        let mut file =
            tempfile::Builder::new().prefix(".writing-").tempfile_in(folder).map_err(|e| unwritable(&e))?;
        file.write_all(bytes).map_err(|e| unwritable(&e))?;
        allow_reading(file.as_file()).map_err(|e| unwritable(&e))?;
        waiting.push((path, file));
    }
    for (path, file) in waiting {
        file.persist(path)
            .map_err(|e| Refusal::new(format!("{} can't be written: {}", path.display(), e.error)))?;
    }
    Ok(())
}

/// Temporary files are private; a result may be read by everyone who may read new files.
#[cfg(unix)]
fn allow_reading(file: &std::fs::File) -> std::io::Result<()> {
    use std::os::unix::fs::PermissionsExt;
    file.set_permissions(std::fs::Permissions::from_mode(0o644))
}

#[cfg(not(unix))]
fn allow_reading(_: &std::fs::File) -> std::io::Result<()> {
    Ok(())
}
