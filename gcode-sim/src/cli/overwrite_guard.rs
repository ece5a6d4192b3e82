//! Guards files: a result never overwrites an input or a file with other contents, and standard input is read once.
#![expect(clippy::disallowed_methods, reason = "the command line compares files")]

use std::path::Path;

use super::{UsageError, input, output};

/// Refuses a `result` that is one of `inputs`, with links resolved.
pub fn check_not_input(result: &Path, inputs: &[&Path]) -> Result<(), UsageError> {
    // A path that cannot be resolved does not exist yet.
    let Ok(result_path) = result.canonicalize() else { return Ok(()) };
    let is_result = |input: &&&Path| input.canonicalize().is_ok_and(|other| other == result_path);
    match inputs.iter().find(is_result) {
        None => Ok(()),
        Some(input) => {
            let (result, input) = (result.display(), input.display());
            Err(UsageError::new(format!(
                "{result} is an input, {input}, and would be overwritten: name another file"
            )))
        }
    }
}

/// Writes a file to start from. One with other contents is the user's and is kept, unless `force` replaces it.
pub fn write_new(path: &Path, text: &str, force: bool) -> Result<(), UsageError> {
    let is_kept = |bytes: Vec<u8>| !bytes.is_empty() && bytes != text.as_bytes();
    if !force && path.is_file() && is_kept(input::bytes(path)?) {
        let name = path.display();
        return Err(UsageError::new(format!(
            "{name} already exists: name another file, or replace it by --force"
        )));
    }
    output::write(path, text.as_bytes())
}

/// Refuses two inputs that are both standard input: the second would be empty.
pub(super) fn one_pipe(inputs: &[&Path]) -> Result<(), UsageError> {
    if inputs.iter().filter(|path| **path == Path::new("-")).count() > 1 {
        return Err(UsageError::new("only one file can be '-': standard input can be read once"));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_input_is_not_overwritten() {
        let folder = tempfile::tempdir().unwrap();
        let (program, other) = (folder.path().join("O1.nc"), folder.path().join("page.html"));
        output::write(&program, b"O1\nM30\n").unwrap();
        let round_about = folder.path().join(".").join("O1.nc");
        assert!(check_not_input(&round_about, &[&other, &program]).is_err());
        assert!(check_not_input(&other, &[&program]).is_ok(), "no file yet");
        output::write(&other, b"").unwrap();
        assert!(check_not_input(&other, &[&program, Path::new("-")]).is_ok());
    }

    #[test]
    fn a_file_with_other_contents_is_kept() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("machine.toml");
        let kept = |text| write_new(&path, text, false).is_err();
        output::write(&path, b"").unwrap();
        assert!(!kept("one") && !kept("one"), "an empty file, and the same contents");
        assert!(kept("two"));
        assert_eq!(input::bytes(&path).unwrap(), b"one");
        write_new(&path, "two", true).unwrap();
        assert_eq!(input::bytes(&path).unwrap(), b"two");
    }

    #[test]
    fn standard_input_is_read_once() {
        let (pipe, file) = (Path::new("-"), Path::new("O1.nc"));
        assert!(one_pipe(&[pipe, file]).is_ok());
        assert!(one_pipe(&[pipe, file, pipe]).is_err());
    }
}
