//! `gcode-sim schema`: the JSON Schema of a file or of a result.
use clap::Args;
use clap::builder::{PossibleValue, PossibleValuesParser};

use super::{Refusal, Status, output};
use crate::schema::FORMATS;

#[derive(Debug, Args)]
pub(super) struct SchemaArguments {
    /// Which document it describes
    #[arg(value_name = "NAME", value_parser = names())]
    name: String,
}

fn names() -> PossibleValuesParser {
    FORMATS.iter().map(|format| PossibleValue::new(format.name).help(format.about)).collect::<Vec<_>>().into()
}

pub(super) fn run(arguments: &SchemaArguments) -> Result<Status, Refusal> {
    let format = FORMATS.iter().find(|format| format.name == arguments.name);
    let format = format.ok_or_else(|| Refusal::new(format!("no schema '{}'", arguments.name)))?;
    output::json(&format.schema())?;
    Ok(Status::Holds)
}
