//! `gcode-sim render`: draws the holes on the part, or a burr's flutes.
use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};

use super::conditions::{DenyArguments, ProgramArguments};
use super::format::TextFormat;
use super::{ExitStatus, UsageError, options, output, progress};
use crate::report::pictures::RenderReport;
use crate::report::{flute_view, top};
use gcode_draw::{FluteView, Picture, Size, TopView};
use gcode_inspect::verify::{Answer, Tolerances, denied_words};
use gcode_lang::diag::Diagnostic;
use gcode_part::{Assumption, NominalPart, Total};
use gcode_session::{Request, Run};

#[derive(Debug, Args)]
pub(super) struct Arguments {
    #[command(flatten)]
    program: ProgramArguments,

    /// The picture to write
    #[arg(short, long, value_name = "OUT.png")]
    output: PathBuf,

    /// The reference: draws the outline, each hole's verdict and its deviation
    #[arg(long, value_name = "REF")]
    reference: Option<PathBuf>,

    /// Diameter of the tolerance zone, mm [default: the job's, or 0.1]
    #[arg(long, value_name = "MM", allow_negative_numbers = true)]
    tolerance: Option<f64>,

    #[command(flatten)]
    deny: DenyArguments,

    /// The view [default: top, or side for a burr]
    #[arg(long, value_enum)]
    view: Option<View>,

    /// Width and height in pixels
    #[arg(long, value_name = "WxH", default_value = "1600x1200")]
    size: String,

    /// Output format
    #[arg(long, value_enum, default_value_t = TextFormat::Text)]
    format: TextFormat,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum View {
    /// Along the axis of revolution, or along a fixed spindle
    Top,
    /// A cylinder unrolled, with its seam; needs --reference with a cylinder job
    Development,
    /// A burr from the side
    Side,
    /// A burr from its tip
    Tip,
    /// A burr's helix angle along its flutes, with its tolerance
    Helix,
}

pub(super) fn run(arguments: &Arguments) -> Result<ExitStatus, UsageError> {
    let (program, _) = arguments.program.completed()?;
    let (mut request, mut folders) =
        options::checked_request(&program, arguments.reference.as_deref(), Some(&arguments.output), None)?;
    let nominal = arguments.reference.as_deref().map(options::read_nominal).transpose()?;
    let tolerance = options::tolerance("--tolerance", arguments.tolerance)?;
    request.denies_assumptions = arguments.deny.denies_assumptions();
    let drawn = match nominal {
        Some(NominalPart::Flutes(mut flutes)) => {
            flutes.surface_tolerance = tolerance.unwrap_or(flutes.surface_tolerance);
            let grind = |request: &Request| gcode_session::grind(request, &mut folders, &flutes);
            let grinding = progress::of_run(&mut request, grind)?;
            let verdict = grinding.verify(&request);
            let view = arguments.view.unwrap_or(View::Side);
            let picture = flute_picture(view, &flute_view::of(&name(&request), &grinding, &verdict))?;
            Drawn {
                picture,
                view,
                verdict: Some((verdict.verdict, verdict.summary.clone())),
                status: Some(verdict.conclusion().into()),
                findings: verdict.diagnostics,
                run: grinding.run,
            }
        }
        None | Some(NominalPart::Holes(_)) => {
            let reference = nominal.and_then(NominalPart::into_holes);
            let stock = request.machine.stock.clone();
            let metal = reference.as_ref().map(|r| r.metal(stock.as_ref())).unwrap_or_default();
            request.process_limits = reference.as_ref().map(|r| r.process_limits.clone()).unwrap_or_default();
            let simulate = |request: &Request| gcode_session::simulate(request, &mut folders, metal.clone());
            let simulation = progress::of_run(&mut request, simulate)?;
            let view = arguments.view.unwrap_or(View::Top);
            match &reference {
                Some(reference) => {
                    let tolerances = Tolerances::of(reference, tolerance);
                    let verdict = simulation.verify(reference, tolerances, &request);
                    let drawn =
                        top::of_verdict(&name(&request), &simulation, reference, &verdict, &request.machine);
                    Drawn {
                        picture: hole_picture(view, &drawn)?,
                        view,
                        verdict: Some((verdict.verdict, verdict.summary.clone())),
                        status: Some(verdict.conclusion().into()),
                        findings: verdict.diagnostics,
                        run: simulation.run,
                    }
                }
                None => {
                    let found = simulation.dependencies(&request);
                    let assumed = found.numbered(&simulation.run);
                    let denied = arguments.deny.errors(&assumed, Total::Holes(found.count()));
                    let assumed: Vec<Assumption> = assumed.into_iter().map(|(one, _)| one).collect();
                    let drawn = top::of_holes(&name(&request), &simulation, &request.machine, &assumed);
                    let denial = (!denied.is_empty()).then(|| denied_words(denied.len()));
                    let faults: Vec<String> =
                        simulation.run.stop_sentence().into_iter().chain(denial).collect();
                    let findings: Vec<Diagnostic> = simulation.run.findings().chain(denied).collect();
                    Drawn {
                        picture: hole_picture(view, &drawn)?,
                        view,
                        verdict: (!faults.is_empty()).then(|| (Answer::Fail, faults.join("; "))),
                        status: None,
                        findings,
                        run: simulation.run,
                    }
                }
            }
        }
    };
    write(&drawn.picture, &arguments.size, &arguments.output)?;
    let view = drawn.view.to_possible_value().map_or_else(String::new, |value| value.get_name().to_owned());
    let (verdict, summary) = drawn.verdict.unzip();
    let report = RenderReport { picture: arguments.output.display().to_string(), view, verdict, summary };
    output::report(&report, RenderReport::text, arguments.format)?;
    let of_findings = super::findings(&drawn.findings, &drawn.run);
    Ok(drawn.status.unwrap_or(of_findings))
}

/// A picture with the verdict that it shows.
struct Drawn {
    picture: Picture,
    view: View,
    /// Answer and summary; without a reference only of a run that fails.
    verdict: Option<(Answer, String)>,
    /// Exit status of the verdict; that of the findings without one.
    status: Option<ExitStatus>,
    findings: Vec<Diagnostic>,
    run: Run,
}

fn hole_picture(view: View, drawn: &TopView) -> Result<Picture, UsageError> {
    let message = match view {
        View::Top => return Ok(gcode_draw::top_view(drawn)),
        View::Development => match gcode_draw::development(drawn) {
            Some(picture) => return Ok(picture),
            None => "--view development unrolls a cylinder: give its job with --reference",
        },
        View::Side | View::Tip | View::Helix => {
            "the views side, tip and helix show a burr: give a burr job with --reference JOB.toml"
        }
    };
    Err(UsageError::new(message))
}

fn flute_picture(view: View, drawn: &FluteView) -> Result<Picture, UsageError> {
    match view {
        View::Side => Ok(gcode_draw::side_view(drawn)),
        View::Tip => Ok(gcode_draw::tip_view(drawn)),
        View::Helix => Ok(gcode_draw::helix_graph(drawn)),
        View::Top | View::Development => {
            Err(UsageError::new("this view shows holes; a burr has the views side, tip and helix"))
        }
    }
}

/// Draws a picture to a PNG file of exactly this size.
pub(super) fn write(picture: &Picture, size: &str, path: &Path) -> Result<(), UsageError> {
    let is_other = |extension: &std::ffi::OsStr| !extension.eq_ignore_ascii_case("png");
    if path.extension().is_some_and(is_other) {
        let (path, png) = (path.display(), path.with_extension("png"));
        return Err(UsageError::new(format!("{path}: a picture is a PNG file: name it {}", png.display())));
    }
    let size: Size = size.parse()?;
    output::write(path, &gcode_draw::draw(picture, size)?)
}

/// Returns the file name of the program without its folder.
pub(super) fn name(request: &Request) -> String {
    let file = Path::new(&request.name).file_name();
    file.map_or_else(|| request.name.clone(), |name| name.to_string_lossy().into_owned())
}
