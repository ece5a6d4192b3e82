//! `gcode-sim holes`: the holes a program makes, in the part's frame.
use std::path::PathBuf;

use clap::Args;

use super::conditions::{DenyArguments, ProgramArguments};
use super::format::ListFormat;
use super::{ExitStatus, UsageError, options, output, page, progress, unused_machine};
use crate::report::holes::{self as report, Origin};
use gcode_part::{HoleList, Total};
use gcode_session::{Request, Simulation};

#[derive(Debug, Args)]
pub(super) struct Arguments {
    #[command(flatten)]
    deny: DenyArguments,

    /// Also write a page to this file: the holes, the path, the blocks and the values of the variables; opens in
    /// any browser
    #[arg(long, value_name = "OUT.html")]
    page: Option<PathBuf>,

    /// Output format
    #[arg(long, value_enum, default_value_t = ListFormat::Text)]
    format: ListFormat,

    #[command(flatten)]
    program: ProgramArguments,
}

pub(super) fn run(arguments: &Arguments) -> Result<ExitStatus, UsageError> {
    let (program, _) = arguments.program.completed()?;
    let (mut request, mut folders) =
        options::checked_request(&program, None, None, arguments.page.as_deref())?;
    if let Some(path) = &arguments.page {
        let traced = page::judge_traced(&mut request, &mut folders, None)?;
        page::write_alone(&request, &traced, None, &program.conditions, path)?;
        let status = print_result(arguments, &program, &request, &traced.0.simulation)?;
        output::written("page", path, arguments.format == ListFormat::Text)?;
        return Ok(status);
    }
    let simulation =
        progress::of_run(&mut request, |request| gcode_session::simulate(request, &mut folders, None))?;
    print_result(arguments, &program, &request, &simulation)
}

fn print_result(
    arguments: &Arguments,
    program: &ProgramArguments,
    request: &Request,
    simulation: &Simulation,
) -> Result<ExitStatus, UsageError> {
    let mut list = simulation.hole_list();
    let origin = match &request.part {
        Some(part) => {
            list.enter_at(&part.body());
            Origin::Surface
        }
        None => Origin::FeedStart,
    };
    let assumed = simulation.dependencies(request).numbered(&simulation.run);
    let denied = arguments.deny.errors(&assumed, Total::Holes(list.holes.len()));
    list.assumptions = Some(assumed.into_iter().map(|(assumption, _)| assumption).collect());
    list.stopped = simulation.run.stop_sentence();
    print(&list, origin, arguments.format)?;
    if let Some(sentence) = list.stopped.filter(|_| arguments.format == ListFormat::Text) {
        output::print(&format!("{sentence}\n"))?;
    }
    unused_machine::warn_missing_machine(program, &request.bytes, (&simulation.run, &simulation.extracted));
    let of_run = super::findings(&simulation.extracted.findings, &simulation.run);
    Ok(of_run.max(super::findings(&denied, &simulation.run)))
}

/// Prints a list of holes in the given format.
pub(super) fn print(list: &HoleList, origin: Origin, format: ListFormat) -> Result<(), UsageError> {
    match format {
        ListFormat::Text => output::print(&report::text(list, origin)),
        ListFormat::Json => output::json(list),
        ListFormat::Csv => output::print(&report::csv(list)),
    }
}
