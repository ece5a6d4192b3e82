//! `gcode-sim sheet`: the set-up sheet of a program.
use std::path::PathBuf;

use clap::Args;

use super::conditions::ProgramArguments;
use super::render::{self, Style};
use super::{ExitStatus, UsageError, options, output, page, progress, reference_file};
use crate::report::sheet::ProgramSheet;
use crate::report::sheet::recorder::{OffsetObserver, UseRecorder};
use crate::report::top;
use gcode_draw::{FileFormat, Size};
use gcode_inspect::tool_path::PathRecorder;
use gcode_part::Assumption;
use gcode_session::{Criteria, HoleJudgement};

/// Width and height of the picture, pixels: on paper its letters are 2 mm high.
const WIDTH: u32 = 1100;
const HEIGHT: u32 = 825;

#[derive(Debug, Args)]
pub(super) struct Arguments {
    /// The sheet to write
    #[arg(short, long, value_name = "SHEET.html", display_order = 0)]
    output: PathBuf,

    /// The reference, whose verdict the sheet shows: a hole list (JSON or CSV) or a job file (TOML) [default: that of the
    /// program in gcode.toml, or reference.csv beside it]
    #[arg(long, value_name = "REF")]
    reference: Option<PathBuf>,

    #[command(flatten)]
    program: ProgramArguments,
}

pub(super) fn run(arguments: &Arguments) -> Result<ExitStatus, UsageError> {
    let (program, path) = reference_file::completed(&arguments.program, arguments.reference.as_deref())?;
    let (mut request, mut folders) =
        options::checked_request(&program, path.as_deref(), None, Some(&arguments.output))?;
    let refusal = "this sheet shows holes, and the reference is a burr: `gcode-gen sheet JOB.toml` writes that of a burr";
    let nominal = options::nominal_or_motion(path.as_deref(), &request, &mut folders)?;
    let reference = options::holes_of(nominal, refusal)?;
    let machine = request.machine.clone();
    let mut recorder = PathRecorder::new(&machine);
    let (mut uses, mut offsets) = (UseRecorder::default(), OffsetObserver::default());
    let criteria = reference.as_ref().map(Criteria::of);
    let HoleJudgement { simulation, verdict } = progress::of_run(&mut request, |request| {
        let sink = &mut (&mut recorder, &mut uses);
        gcode_session::simulate_judged(request, &mut folders, criteria, sink, &mut offsets)
    })?;
    page::check_has_moves("sheet", &simulation)?;
    let tool_path = recorder.finish();
    let name = render::name(&request);
    let (holes, findings, assumptions) = match (&reference, &verdict) {
        (Some(reference), Some(verdict)) => (
            top::of_verdict(&name, &simulation, reference, verdict, &machine),
            verdict.diagnostics.clone(),
            verdict.assumptions.clone(),
        ),
        _ => {
            let dependencies = simulation.dependencies(&request).numbered(&simulation.run);
            let alone: Vec<Assumption> = dependencies.into_iter().map(|(assumption, _)| assumption).collect();
            let findings = simulation.findings_without_reference().cloned().collect();
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
        Some(gcode_draw::draw(&drawn, Size::new(WIDTH, HEIGHT)?, FileFormat::Png)?)
    };
    let documents = page::documents(&program.conditions, path.as_deref())?;
    let files: Vec<(&str, String, Vec<u8>)> =
        documents.into_iter().map(|file| (file.role, file.name, file.bytes)).collect();
    let sheet = ProgramSheet {
        request: &request,
        simulation: &simulation,
        uses: &uses,
        offsets: &offsets,
        verdict: verdict.as_ref().map(|verdict| (verdict.conclusion(), verdict.not_checked.as_slice())),
        findings: &findings,
        assumptions: &assumptions,
        files: &files,
        picture: picture.as_deref(),
    };
    output::write(&arguments.output, sheet.html().as_bytes())?;
    output::written("sheet", &arguments.output, true)?;
    Ok(super::judged(&simulation, verdict.as_ref()))
}
