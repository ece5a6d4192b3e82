//! `gcode-sim schema`: prints the JSON Schema of a file or of a result.
use clap::Args;
use clap::builder::{PossibleValue, PossibleValuesParser};

use super::{ExitStatus, UsageError, output};
use crate::schema::{FORMATS, Format};

#[derive(Debug, Args)]
pub(super) struct Arguments {
    /// The document
    #[arg(value_name = "NAME", value_parser = names(FORMATS))]
    name: String,
}

/// Returns the names of all formats for the help of either program.
pub fn names(formats: &[Format]) -> PossibleValuesParser {
    let value = |format: &Format| PossibleValue::new(format.name).help(format.about);
    formats.iter().map(value).collect::<Vec<_>>().into()
}

pub(super) fn run(arguments: &Arguments) -> Result<ExitStatus, UsageError> {
    print(&arguments.name, FORMATS)
}

/// Prints the schema of the named format.
pub fn print(name: &str, formats: &[Format]) -> Result<ExitStatus, UsageError> {
    let format = formats.iter().find(|format| format.name == name);
    let format = format.ok_or_else(|| UsageError::new(format!("no schema '{name}'")))?;
    output::json(&format.schema())?;
    Ok(ExitStatus::Passed)
}
