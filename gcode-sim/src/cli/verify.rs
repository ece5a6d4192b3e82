//! `gcode-sim verify`: verifies a program's holes or flutes against a reference.
use std::path::PathBuf;

use clap::Args;

use super::conditions::ProgramArguments;
use super::format::FindingFormat;
use super::library::Folders;
use super::{
    ExitStatus, UsageError, options, output, overwrite_guard, page, progress, render, unused_machine,
};
use crate::report::sarif::{self, Finding};
use crate::report::verdict_table::{Layout, table};
use crate::report::{flute_table, flute_view};
use gcode_inspect::verify::{Answer, Tolerances, Verdict};
use gcode_lang::diag::Diagnostic;
use gcode_part::Flutes;
use gcode_part::NominalPart;
use gcode_part::Reference;
use gcode_session::{Request, Run, Simulation};

#[derive(Debug, Args)]
pub(super) struct VerifyArguments {
    #[command(flatten)]
    program: ProgramArguments,

    /// The reference: a hole list (JSON or CSV) or a job file (TOML)
    #[arg(long, value_name = "REF")]
    reference: PathBuf,

    /// Diameter of the tolerance zone, or tolerance of a burr's contact from its surface, mm [default: the job's,
    /// or 0.1]
    #[arg(long, value_name = "MM", allow_negative_numbers = true)]
    tolerance: Option<f64>,

    /// Tolerance of a hole's depth either way, mm [default: the job's, or 0.1]
    #[arg(long, value_name = "MM", allow_negative_numbers = true)]
    depth_tolerance: Option<f64>,

    /// List the worst hole first
    #[arg(long)]
    worst_first: bool,

    /// All inspection columns: nominal and actual x y z i j k d l
    #[arg(long)]
    full: bool,

    /// Also draw to this file: the top view of holes, a cylinder unrolled, or a burr from the side
    #[arg(long, value_name = "OUT.png")]
    picture: Option<PathBuf>,

    /// Also write a page to this file: the holes with their deviations, the path, the blocks and the values of the
    /// variables; opens in any browser
    #[arg(long, value_name = "OUT.html")]
    page: Option<PathBuf>,

    /// Output format
    #[arg(long, value_enum, default_value_t = FindingFormat::Text)]
    format: FindingFormat,
}

pub(super) fn run(arguments: &VerifyArguments) -> Result<ExitStatus, UsageError> {
    let asked = options::tolerance("--tolerance", arguments.tolerance)?;
    let depth = options::tolerance("--depth-tolerance", arguments.depth_tolerance)?;
    let files = arguments.program.files(Some(&arguments.reference))?;
    for result in [&arguments.picture, &arguments.page].into_iter().flatten() {
        overwrite_guard::check_not_input(result, &files)?;
    }
    arguments.page.as_deref().map(page::is_html).transpose()?;
    let (mut request, folders) = options::request(&arguments.program)?;
    unused_machine::warn_unused_machine(&arguments.program, &request);
    match options::read_nominal(&arguments.reference)? {
        NominalPart::Holes(reference) => {
            let mut tolerances = Tolerances::of(&reference, asked);
            tolerances.depth = depth.unwrap_or(tolerances.depth);
            holes(arguments, &mut request, folders, &reference, tolerances)
        }
        NominalPart::Flutes(mut wanted) => {
            let of_holes = [
                ("--depth-tolerance", depth.is_some()),
                ("--worst-first", arguments.worst_first),
                ("--full", arguments.full),
                ("--page", arguments.page.is_some()),
            ];
            if let Some((flag, _)) = of_holes.iter().find(|(_, given)| *given) {
                return Err(UsageError::new(format!("{flag} is for holes, and the reference is a burr")));
            }
            wanted.surface_tolerance = asked.unwrap_or(wanted.surface_tolerance);
            flutes(arguments, &mut request, folders, &wanted)
        }
    }
}

fn flutes(
    arguments: &VerifyArguments,
    request: &mut Request,
    mut folders: Folders,
    wanted: &Flutes,
) -> Result<ExitStatus, UsageError> {
    let grinding = progress::of_run(request, |request| gcode_session::grind(request, &mut folders, wanted))
        .map_err(|error| UsageError::new(error.to_string()))?;
    let verdict = grinding.verify();
    match arguments.format {
        FindingFormat::Json => output::json(&verdict)?,
        FindingFormat::Text => output::print(&flute_table::table(&verdict))?,
        FindingFormat::Sarif => sarif(&verdict.diagnostics, &grinding.run)?,
    }
    if let Some(path) = &arguments.picture {
        let picture = gcode_draw::side_view(&flute_view::of(&render::name(request), &grinding, &verdict));
        render::write(&picture, "1600x1200", path)?;
        if arguments.format == FindingFormat::Text {
            output::print(&format!("picture: {}\n", path.display()))?;
        }
    }
    Ok(combine_status(super::findings(&verdict.diagnostics, &grinding.run), verdict.verdict))
}

/// Prints the findings as SARIF for a code review.
fn sarif(findings: &[Diagnostic], run: &Run) -> Result<(), UsageError> {
    let sources = run.control.memory().sources();
    let findings: Vec<_> = findings.iter().map(|finding| Finding::of(finding, sources)).collect();
    output::json(&sarif::log(&findings, &options::working_folder()))
}

fn combine_status(status: ExitStatus, answer: Answer) -> ExitStatus {
    match answer {
        Answer::Fail if status == ExitStatus::Passed => ExitStatus::Failed,
        _ => status,
    }
}

fn holes(
    arguments: &VerifyArguments,
    request: &mut Request,
    mut folders: Folders,
    reference: &Reference,
    tolerances: Tolerances,
) -> Result<ExitStatus, UsageError> {
    request.conduct = reference.process_limits.clone();
    if let Some(path) = &arguments.page {
        let watched = page::simulate_traced(request, &mut folders, reference.surface)?;
        let simulation = &watched.0.simulation;
        let verdict = simulation.verify(reference, tolerances, &request.machine);
        let judged = Some((arguments.reference.as_path(), reference, &verdict));
        page::write_alone(request, &watched, judged, &arguments.program.conditions, path)?;
        let status = print_verdict(arguments, request, reference, simulation, &verdict)?;
        page::report_written(path, arguments.format == FindingFormat::Text)?;
        return Ok(status);
    }
    let simulation = progress::of_run(request, |request| {
        gcode_session::simulate(request, &mut folders, reference.surface)
    })
    .map_err(|error| UsageError::new(error.to_string()))?;
    let verdict = simulation.verify(reference, tolerances, &request.machine);
    print_verdict(arguments, request, reference, &simulation, &verdict)
}

fn print_verdict(
    arguments: &VerifyArguments,
    request: &Request,
    reference: &Reference,
    simulation: &Simulation,
    verdict: &Verdict,
) -> Result<ExitStatus, UsageError> {
    match arguments.format {
        FindingFormat::Json => output::json(verdict)?,
        FindingFormat::Text => {
            let layout = Layout { worst_first: arguments.worst_first, full: arguments.full };
            output::print(&table(verdict, layout))?;
        }
        FindingFormat::Sarif => sarif(&verdict.diagnostics, &simulation.run)?,
    }
    if let Some(path) = &arguments.picture {
        let view = render::view(request, simulation, reference, verdict);
        render::write(&gcode_draw::main_view(&view), "1600x1200", path)?;
        if arguments.format == FindingFormat::Text {
            output::print(&format!("picture: {}\n", path.display()))?;
        }
    }
    Ok(combine_status(super::findings(&verdict.diagnostics, &simulation.run), verdict.verdict))
}
