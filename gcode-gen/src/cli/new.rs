//! `gcode-gen new`: writes a job file to start from.
#![expect(clippy::disallowed_methods, reason = "the command line finds files")]

use std::path::Path;

use gcode_sim::cli::{ExitStatus, UsageError, input, output};

pub(super) fn run(family: &str, path: Option<&Path>) -> Result<ExitStatus, UsageError> {
    let known = crate::families::ALL.iter().find(|known| known.name == family);
    let Some(known) = known else {
        return Err(UsageError::new(format!("no family '{family}'")));
    };
    match path {
        None => output::print(known.new_job)?,
        // A job file with the user's values must not be overwritten.
        Some(path) if path.is_file() && !replaceable(path, known.new_job)? => {
            let name = path.display();
            return Err(UsageError::new(format!("{name} already exists: remove it, or name another file")));
        }
        Some(path) => output::write(path, known.new_job.as_bytes())?,
    }
    Ok(ExitStatus::Passed)
}

/// Returns true for an empty file and for an unchanged job file of this family.
fn replaceable(path: &Path, new_job: &str) -> Result<bool, UsageError> {
    let bytes = input::bytes(path)?;
    Ok(bytes.is_empty() || bytes == new_job.as_bytes())
}
