//! `gcode-sim reference`: what the part should get, from the job's geometry alone.
use std::path::PathBuf;

use clap::Args;

use super::format::ListFormat;
use super::{Refusal, Status, holes, input, output};
use crate::job::Job;
use crate::part::wanted::Wanted;
use crate::report::flute_table;
use crate::verify::flutes::WantedFlutes;

#[derive(Debug, Args)]
pub(super) struct ReferenceArguments {
    /// The job file
    #[arg(value_name = "JOB.toml")]
    job: PathBuf,

    /// Output format
    #[arg(long, value_enum, default_value_t = ListFormat::Json)]
    format: ListFormat,
}

pub(super) fn run(arguments: &ReferenceArguments) -> Result<Status, Refusal> {
    let named = |error: &dyn std::fmt::Display| Refusal::new(format!("{}, {error}", arguments.job.display()));
    let job = Job::parse(&input::text(&arguments.job)?).map_err(|e| named(&e))?;
    match Wanted::of_job(&job).map_err(|e| named(&e))? {
        Wanted::Holes(reference) => holes::print(&reference.list(), arguments.format)?,
        Wanted::Flutes(wanted) => {
            let burr = WantedFlutes::of(&wanted);
            match arguments.format {
                ListFormat::Json => output::json(&burr)?,
                ListFormat::Text => output::print(&flute_table::wanted(&burr))?,
                ListFormat::Csv => {
                    return Err(Refusal::new(
                        "--format csv lists holes, and a burr has none: use text or json",
                    ));
                }
            }
        }
    }
    Ok(Status::Holds)
}
