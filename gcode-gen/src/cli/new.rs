//! `gcode-gen new`: writes a job file to start from.
use std::path::Path;

use gcode_sim::cli::{ExitStatus, UsageError, output, overwrite_guard};

pub(super) fn run(family: &str, path: Option<&Path>, force: bool) -> Result<ExitStatus, UsageError> {
    let known = crate::families::ALL.iter().find(|known| known.name == family);
    let Some(known) = known else {
        return Err(UsageError::new(format!("no family '{family}'")));
    };
    match path {
        None => output::print(known.new_job)?,
        Some(path) => overwrite_guard::write_new(path, known.new_job, force)?,
    }
    Ok(ExitStatus::Passed)
}
