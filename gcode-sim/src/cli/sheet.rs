//! `gcode-sim sheet`: the set-up sheet of a program.
use std::path::PathBuf;

use clap::Args;

use super::conditions::ProgramArguments;
use super::render::{self, Style};
use super::{ExitStatus, UsageError, options, output, page, progress};
use crate::report::sheet::ProgramSheet;
use crate::report::sheet::recorder::{OffsetObserver, UseRecorder};
use crate::report::top;
use gcode_draw::{FileFormat, Size};
use gcode_inspect::tool_path::PathRecorder;
use gcode_inspect::verify::Tolerances;
use gcode_part::{Assumption, NominalPart};

#[derive(Debug, Args)]
pub(super) struct Arguments {
    /// The sheet to write
    #[arg(short, long, value_name = "SHEET.html", display_order = 0)]
    output: PathBuf,

    /// The reference, whose verdict the sheet shows: a hole list (JSON or CSV) or a job file (TOML) [default: that of the
    /// program in gcode.toml]
    #[arg(long, value_name = "REF")]
    reference: Option<PathBuf>,

    #[command(flatten)]
    program: ProgramArguments,
}

pub(super) fn run(arguments: &Arguments) -> Result<ExitStatus, UsageError> {
    let (program, project) = arguments.program.completed()?;
    let path = arguments.reference.clone().or_else(|| project.reference());
    let (mut request, mut folders) =
        options::checked_request(&program, path.as_deref(), None, Some(&arguments.output))?;
    let nominal =
        path.as_deref().map(|path| options::read_nominal(path, &request, &mut folders)).transpose()?;
    if let Some(NominalPart::Flutes(_)) = nominal {
        return Err(UsageError::new(
            "this sheet shows holes, and the reference is a burr: `gcode-gen sheet JOB.toml` writes that of a burr",
        ));
    }
    let reference = nominal.and_then(NominalPart::into_holes);
    let metal = reference.as_ref().map(|reference| request.metal(reference)).unwrap_or_default();
    request.process_limits = reference.as_ref().map(|one| one.process_limits.clone()).unwrap_or_default();
    let machine = request.machine.clone();
    let mut recorder = PathRecorder::new(&machine);
    let (mut uses, mut offsets) = (UseRecorder::default(), OffsetObserver::default());
    let simulation = progress::of_run(&mut request, |request| {
        gcode_session::simulate_observed(
            request,
            &mut folders,
            metal.clone(),
            &mut (&mut recorder, &mut uses),
            &mut offsets,
        )
    })?;
    let tool_path = recorder.finish();
    let verdict = reference.as_ref().map(|reference| {
        (reference, simulation.verify(reference, Tolerances::of(reference, None), &request))
    });
    let dependencies = simulation.dependencies(&request);
    let alone: Vec<Assumption> =
        dependencies.numbered(&simulation.run).into_iter().map(|(assumption, _)| assumption).collect();
    let name = render::name(&request);
    let (holes, findings, assumptions) = match &verdict {
        Some((reference, verdict)) => (
            top::of_verdict(&name, &simulation, reference, verdict, &machine),
            verdict.diagnostics.clone(),
            verdict.assumptions.clone(),
        ),
        None => {
            let findings = simulation.extracted.findings.clone();
            (top::of_holes(&name, &simulation, &machine, &alone), findings, alone)
        }
    };
    let picture = if tool_path.moves.is_empty() {
        None
    } else {
        let reference = reference.as_ref();
        let drawn = render::path_picture(
            &Style::default(),
            &request,
            &simulation,
            tool_path,
            holes,
            &findings,
            reference,
        )?;
        Some(gcode_draw::draw(&drawn, Size::default(), FileFormat::Png)?)
    };
    let documents = page::documents(&program.conditions, path.as_deref())?;
    let files: Vec<(&str, String, Vec<u8>)> =
        documents.into_iter().map(|file| (file.role, file.name, file.bytes)).collect();
    let sheet = ProgramSheet {
        request: &request,
        simulation: &simulation,
        uses: &uses,
        offsets: &offsets,
        verdict: verdict.as_ref().map(|(_, verdict)| (verdict.conclusion(), verdict.not_checked.as_slice())),
        findings: &findings,
        assumptions: &assumptions,
        files: &files,
        picture: picture.as_deref(),
    };
    output::write(&arguments.output, sheet.html().as_bytes())?;
    output::written("sheet", &arguments.output, true)?;
    let run = &simulation.run;
    Ok(match &verdict {
        Some((_, verdict)) => super::concluded(verdict.conclusion(), &verdict.diagnostics, run),
        None => super::findings(&findings, run),
    })
}
