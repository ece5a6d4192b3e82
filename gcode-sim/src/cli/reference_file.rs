//! The reference of a program: the one that a flag names, that of `gcode.toml`, or the one in the folder of the program.
use std::path::{Path, PathBuf};

use super::UsageError;
use super::conditions::ProgramArguments;
use super::project::say;
use super::test::reference_beside;

/// Completes the conditions of a program like [`ProgramArguments::completed`], and returns with them its reference: the named
/// one, else that of the project's file, else the one in the folder of the program, which is said.
pub(super) fn completed(
    program: &ProgramArguments,
    named: Option<&Path>,
) -> Result<(ProgramArguments, Option<PathBuf>), UsageError> {
    let (program, project) = program.completed()?;
    let beside = || {
        let path = reference_beside(&program.program, program.conditions.main_program.as_deref())?;
        say(&[format!("reference: {}", path.display())]);
        Some(path)
    };
    let reference = named.map(Path::to_owned).or_else(|| project.reference()).or_else(beside);
    Ok((program, reference))
}
