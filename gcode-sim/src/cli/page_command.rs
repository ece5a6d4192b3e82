//! `gcode-sim page`: one program as a page: its path to rotate and to play, its blocks and the values of its variables.
use std::path::PathBuf;

use clap::Args;

use super::conditions::ProgramArguments;
use super::{ExitStatus, UsageError, options, output, page};
use gcode_inspect::verify::Tolerances;
use gcode_part::NominalPart;

#[derive(Debug, Args)]
pub(super) struct Arguments {
    /// The page to write
    #[arg(short, long, value_name = "PAGE.html", display_order = 0)]
    output: PathBuf,

    /// The reference, whose holes the page compares: a hole list (JSON or CSV) or a job file (TOML) [default: that of the
    /// program in gcode.toml]
    #[arg(long, value_name = "REF")]
    reference: Option<PathBuf>,

    #[command(flatten)]
    program: ProgramArguments,
}

pub(super) fn run(arguments: &Arguments) -> Result<ExitStatus, UsageError> {
    let (program, project) = arguments.program.completed()?;
    let reference = arguments.reference.clone().or_else(|| project.reference());
    let (mut request, mut folders) =
        options::checked_request(&program, reference.as_deref(), None, Some(&arguments.output))?;
    let nominal =
        reference.as_deref().map(|path| options::read_nominal(path, &request, &mut folders)).transpose()?;
    if let Some(NominalPart::Flutes(_)) = nominal {
        return Err(UsageError::new("a page shows holes, and the reference is a burr: omit the reference"));
    }
    let nominal = nominal.and_then(NominalPart::into_holes);
    let metal = nominal.as_ref().map(|reference| request.metal(reference)).unwrap_or_default();
    request.process_limits =
        nominal.as_ref().map(|nominal| nominal.process_limits.clone()).unwrap_or_default();
    let traced = page::simulate_traced(&mut request, &mut folders, metal)?;
    let simulation = &traced.0.simulation;
    let verdict = nominal
        .as_ref()
        .map(|reference| simulation.verify(reference, Tolerances::of(reference, None), &request));
    let judged = reference.as_deref().zip(nominal.as_ref()).zip(verdict.as_ref());
    let judged = judged.map(|((path, reference), verdict)| (path, reference, verdict));
    page::write_alone(&request, &traced, judged, &program.conditions, &arguments.output)?;
    output::written("page", &arguments.output, true)?;
    let run = &traced.0.simulation.run;
    Ok(match &verdict {
        Some(verdict) => super::concluded(verdict.conclusion(), &verdict.diagnostics, run),
        None => super::findings(&traced.0.simulation.extracted.findings, run),
    })
}
