//! `gcode-sim verify`: verifies a program's holes or flutes against a reference.
use std::mem::ManuallyDrop;
use std::path::{Path, PathBuf};

use clap::Args;
use serde::Serialize;

use super::conditions::{DenyArguments, ProgramArguments};
use super::format::FindingFormat;
use super::library::Folders;
use super::picture_file::PictureFile;
use super::render::Style;
use super::{
    ExitStatus, UsageError, common, options, output, page, progress, reference_file, render, unused_machine,
};
use crate::report::sarif::{Finding, Invocation};
use crate::report::verdict_table::{Layout, table};
use crate::report::{flute_table, flute_view, top};
use gcode_draw::Picture;
use gcode_inspect::tool_path::{PathRecorder, ToolPath};
use gcode_inspect::verify::{Conclusion, Tolerances, Verdict};
use gcode_lang::diag::Diagnostic;
use gcode_part::Flutes;
use gcode_part::NominalPart;
use gcode_session::{Criteria, Request, Run, Simulation};

#[derive(Clone, Debug, Args)]
pub(super) struct Arguments {
    /// The reference: a hole list (JSON or CSV) or a job file (TOML) [default: that of the program in gcode.toml, or
    /// reference.csv beside it; without one the motion in the machine file's [stock] is judged, and the program may make no hole]
    #[arg(long, value_name = "REF", display_order = 0)]
    reference: Option<PathBuf>,

    /// Diameter of the tolerance zone, or tolerance of a burr's contact from its surface, mm [default: the job's,
    /// or 0.1]
    #[arg(long, value_name = "MM", allow_negative_numbers = true, value_parser = common::number)]
    tolerance: Option<f64>,

    /// Tolerance of a hole's depth either way, mm [default: the job's, or 0.1]
    #[arg(long, value_name = "MM", allow_negative_numbers = true, value_parser = common::number)]
    depth_tolerance: Option<f64>,

    #[command(flatten)]
    deny: DenyArguments,

    /// List the worst hole first
    #[arg(long)]
    worst_first: bool,

    /// All inspection columns: nominal and actual x y z i j k d l
    #[arg(long)]
    full: bool,

    /// Also draw to this file: the top view of holes, a cylinder unrolled, or a burr from the side
    #[arg(long, value_name = "OUT.png", value_parser = PictureFile::parser())]
    picture: Option<PictureFile>,

    /// Also write a page to this file: the holes with their deviations, the path, the blocks and the values of the
    /// variables; opens in any browser
    #[arg(long, value_name = "OUT.html")]
    page: Option<PathBuf>,

    /// Output format
    #[arg(long, value_enum, default_value_t = FindingFormat::Text)]
    format: FindingFormat,

    #[command(flatten)]
    program: ProgramArguments,
}

impl Arguments {
    /// Completes the arguments by the project of the program; returns them with the reference, if one is named.
    fn completed(&self) -> Result<(Self, Option<PathBuf>), UsageError> {
        let (program, reference) = reference_file::completed(&self.program, self.reference.as_deref())?;
        Ok((Self { program, ..self.clone() }, reference))
    }
}

pub(super) fn run(arguments: &Arguments) -> Result<ExitStatus, UsageError> {
    let (arguments, path) = &arguments.completed()?;
    let tolerance = options::tolerance("--tolerance", arguments.tolerance)?;
    let depth = options::tolerance("--depth-tolerance", arguments.depth_tolerance)?;
    let results = (arguments.picture.as_ref().map(PictureFile::path), arguments.page.as_deref());
    let (mut request, mut folders) =
        options::checked_request(&arguments.program, path.as_deref(), results.0, results.1)?;
    request.denies_assumptions = arguments.deny.denies_assumptions();
    let nominal = options::nominal_to_verify(path.as_deref(), &request, &mut folders)?.ok_or_else(|| {
        UsageError::new(
            "no reference: give --reference REF, name the program in [references] of gcode.toml, or put \
             reference.csv beside it; for a program without holes state [stock] in the machine file, and what it \
             mills as [[stock.pocket]]: its motion is judged",
        )
    })?;
    match nominal {
        NominalPart::Holes(reference) => {
            let mut tolerances = Tolerances::of(&reference, tolerance);
            tolerances.depth = depth.unwrap_or(tolerances.depth);
            let reference = ManuallyDrop::new(reference);
            holes(
                arguments,
                &mut request,
                folders,
                path.as_deref(),
                Criteria { reference: &reference, tolerances },
            )
        }
        NominalPart::Flutes(mut nominal) => {
            let of_holes = [
                ("--depth-tolerance", depth.is_some()),
                ("--worst-first", arguments.worst_first),
                ("--full", arguments.full),
                ("--page", arguments.page.is_some()),
            ];
            if let Some((flag, _)) = of_holes.iter().find(|(_, given)| *given) {
                return Err(UsageError::new(format!("{flag} is for holes, and the reference is a burr")));
            }
            nominal.surface_tolerance = tolerance.unwrap_or(nominal.surface_tolerance);
            flutes(arguments, &mut request, folders, &nominal)
        }
    }
}

fn flutes(
    arguments: &Arguments,
    request: &mut Request,
    mut folders: Folders,
    nominal: &Flutes,
) -> Result<ExitStatus, UsageError> {
    let judge = |request: &Request| gcode_session::judge_flutes(request, &mut folders, nominal);
    let (grinding, verdict) = progress::of_run(request, judge)?;
    let table = || flute_table::table(&verdict);
    let picture = || Ok(gcode_draw::side_view(&flute_view::of(&render::name(request), &grinding, &verdict)));
    let result = (&verdict, verdict.conclusion(), verdict.diagnostics.as_slice());
    print_verdict(arguments, result, &grinding.run, table, picture)
}

/// Prints a verdict with its findings and draws its picture.
fn print_verdict(
    arguments: &Arguments,
    (verdict, conclusion, findings): (&impl Serialize, Conclusion<'_>, &[Diagnostic]),
    run: &Run,
    table: impl Fn() -> String,
    picture: impl FnOnce() -> Result<Picture, UsageError>,
) -> Result<ExitStatus, UsageError> {
    if let Some(file) = &arguments.picture {
        file.draw(&picture()?, gcode_draw::Size::default())?;
    }
    let sources = run.control.memory().sources();
    match arguments.format {
        FindingFormat::Json => output::json(verdict)?,
        FindingFormat::Text => output::print_verdict(&table())?,
        FindingFormat::Sarif => {
            let findings = findings.iter().map(|finding| Finding::of(finding, sources));
            let exit_code = ExitStatus::from(conclusion) as u8;
            output::sarif(findings, Some(Invocation::new(exit_code, conclusion.line())))?;
        }
    }
    if let Some(file) = &arguments.picture {
        output::written("picture", file.path(), arguments.format == FindingFormat::Text)?;
    }
    Ok(super::concluded(conclusion, findings, run))
}

fn holes(
    arguments: &Arguments,
    request: &mut Request,
    mut folders: Folders,
    path_of_reference: Option<&Path>,
    criteria: Criteria<'_>,
) -> Result<ExitStatus, UsageError> {
    let (machine, reference) = (request.machine.clone(), criteria.reference);
    let name = render::name(request);
    // A part of a family is drawn by its own view, any other with its path, as `render` draws it.
    let is_path_drawn =
        arguments.picture.is_some() && reference.surface.is_none() && reference.pattern.is_none();
    let print = |request: &Request, simulation: &Simulation, verdict: &Verdict, path: Option<ToolPath>| {
        let layout = Layout { worst_first: arguments.worst_first, full: arguments.full };
        let view = || top::of_verdict(&name, simulation, reference, verdict, &machine);
        let result = (verdict, verdict.conclusion(), verdict.diagnostics.as_slice());
        let picture = || match path {
            Some(path) => {
                let findings = &verdict.diagnostics;
                let style = Style::default();
                render::path_picture(&style, request, simulation, path, view(), findings, Some(reference))
            }
            None => Ok(gcode_draw::main_view(&view())),
        };
        let status = print_verdict(arguments, result, &simulation.run, || table(verdict, layout), picture)?;
        let made = (&simulation.run, &simulation.extracted);
        unused_machine::warn_missing_machine(&arguments.program, &request.bytes, made);
        Ok(status)
    };
    let mut recorder = PathRecorder::new(&machine);
    if let Some(path) = &arguments.page {
        let traced = page::judge_traced(request, &mut folders, Some(criteria))?;
        if is_path_drawn {
            gcode_session::judge_holes(request, &mut folders, criteria, &mut recorder, &mut ())?;
        }
        let path_drawn = is_path_drawn.then(|| recorder.finish());
        let judged = Some((path_of_reference, reference));
        page::write_alone(request, &traced, judged, &arguments.program.conditions, path)?;
        let status = traced.0.verdict.as_ref().map_or(Ok(ExitStatus::Failed), |verdict| {
            print(request, &traced.0.simulation, verdict, path_drawn)
        })?;
        output::written("page", path, arguments.format == FindingFormat::Text)?;
        return Ok(status);
    }
    let judge = |request: &Request| match is_path_drawn {
        true => gcode_session::judge_holes(request, &mut folders, criteria, &mut recorder, &mut ()),
        false => gcode_session::judge_holes(request, &mut folders, criteria, &mut (), &mut ()),
    };
    // The process ends with the result: the system takes its memory back as a whole.
    let judgement = ManuallyDrop::new(progress::of_run(request, judge)?);
    print(request, &judgement.0, &judgement.1, is_path_drawn.then(|| recorder.finish()))
}
