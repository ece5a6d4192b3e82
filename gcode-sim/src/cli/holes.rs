//! `gcode-sim holes`: the holes a program makes, in the part's frame.
use clap::Args;

use super::args::{ListFormat, ProgramArguments};
use super::{Refusal, Status, options, output, unused_machine};
use crate::part::hole::HoleList;
use crate::report::holes as report;
use crate::session;

#[derive(Debug, Args)]
pub(super) struct HolesArguments {
    #[command(flatten)]
    program: ProgramArguments,

    /// How the result is written
    #[arg(long, value_enum, default_value_t = ListFormat::Text)]
    format: ListFormat,
}

pub(super) fn run(arguments: &HolesArguments) -> Result<Status, Refusal> {
    let (request, mut folders) = options::request(&arguments.program)?;
    unused_machine::tell(&arguments.program, &request);
    let simulation =
        session::simulate(&request, &mut folders, None).map_err(|e| Refusal::new(e.to_string()))?;
    print(&simulation.list(), arguments.format)?;
    Ok(super::findings(&simulation.extracted.findings, &simulation.run))
}

/// A list of holes in the format asked for.
pub(super) fn print(list: &HoleList, format: ListFormat) -> Result<(), Refusal> {
    match format {
        ListFormat::Text => output::print(&report::text(list)),
        ListFormat::Json => output::json(list),
        ListFormat::Csv => output::print(&report::csv(list)),
    }
}
