//! `gcode-sim reference`: computes the nominal holes or flutes from the job's geometry alone.
use std::path::PathBuf;

use clap::Args;

use super::format::ListFormat;
use super::{ExitStatus, UsageError, holes, input, output};
use crate::report::flute_table;
use crate::report::holes::Origin;
use gcode_inspect::verify::flutes::NominalFlutes;
use gcode_part::NominalPart;
use gcode_part::job::Job;

#[derive(Debug, Args)]
pub(super) struct Arguments {
    /// The job file
    #[arg(value_name = "JOB.toml")]
    job: PathBuf,

    /// Output format
    #[arg(long, value_enum, default_value_t = ListFormat::Json)]
    format: ListFormat,
}

pub(super) fn run(arguments: &Arguments) -> Result<ExitStatus, UsageError> {
    let path = &arguments.job;
    let job = Job::parse(&input::text(path)?).map_err(|e| UsageError::in_toml(path, &e))?;
    match NominalPart::from_job(&job).map_err(|e| UsageError::in_file(path, e))? {
        NominalPart::Holes(reference) => holes::print(&reference.list(), Origin::Surface, arguments.format)?,
        NominalPart::Flutes(flutes) => {
            let burr = NominalFlutes::of(&flutes);
            match arguments.format {
                ListFormat::Json => output::json(&burr)?,
                ListFormat::Text => output::print(&flute_table::nominal_table(&burr))?,
                ListFormat::Csv => {
                    let message = "--format csv lists holes, and a burr has none: use text or json";
                    return Err(UsageError::new(message));
                }
            }
        }
    }
    Ok(ExitStatus::Passed)
}
