//! `gcode-sim render`: draws the tool path and the holes on the part, or a burr's flutes.
use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};

use super::conditions::{DenyArguments, ProgramArguments};
use super::format::TextFormat;
use super::library::Folders;
use super::picture_file::PictureFile;
use super::{ExitStatus, UsageError, common, options, output, progress, reference_file};
use crate::report::pictures::RenderReport;
use crate::report::{flute_view, tool_path, top};
use gcode_draw::{Arrangement, ColorBy, FluteView, Picture, Projection, StandardView, TopView};
use gcode_inspect::machine::Machine;
use gcode_inspect::tool_path::{PathRecorder, ToolPath};
use gcode_inspect::verify::{Answer, Tolerances, denied_words};
use gcode_lang::control::StrokeLimits;
use gcode_lang::diag::{Diagnostic, Severity};
use gcode_part::{Assumption, NominalPart, Reference, Stock, Total};
use gcode_session::{Criteria, HoleJudgement, Request, Run, Simulation};

#[derive(Debug, Args)]
pub(super) struct Arguments {
    /// The picture to write: .png, .svg or .pdf
    #[arg(short, long, value_name = "OUT.png", display_order = 0, value_parser = PictureFile::parser())]
    output: PictureFile,

    /// The reference: draws the outline, each hole's verdict and its deviation [default: that of the program in gcode.toml, or
    /// reference.csv beside it]
    #[arg(long, value_name = "REF")]
    reference: Option<PathBuf>,

    /// Diameter of the tolerance zone, mm [default: the job's, or 0.1]
    #[arg(long, value_name = "MM", allow_negative_numbers = true, value_parser = common::number)]
    tolerance: Option<f64>,

    #[command(flatten)]
    deny: DenyArguments,

    /// The view, or several of top, front, right and iso, separated by commas [default: top, or side for a burr]
    #[arg(long, value_enum, value_delimiter = ',', value_name = "VIEW")]
    view: Vec<View>,

    /// Arrangement of several views [default: third]
    #[arg(long, value_enum, value_name = "ANGLE")]
    projection: Option<ProjectionAngle>,

    /// Meaning of the colours of the feeds [default: depth]
    #[arg(long, value_enum, value_name = "WHAT")]
    color_by: Option<ColorMeaning>,

    /// Width and height in pixels
    #[arg(long, value_name = "WxH", default_value = "1600x1200")]
    size: String,

    /// Output format
    #[arg(long, value_enum, default_value_t = TextFormat::Text)]
    format: TextFormat,

    #[command(flatten)]
    program: ProgramArguments,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum View {
    /// Along the tool in most feeds: a plate from above, a part of revolution along its axis
    Top,
    /// From the front, below the top view
    Front,
    /// From the right
    Right,
    /// From the front, the right and above
    Iso,
    /// A cylinder unrolled, with its seam; needs --reference with a cylinder job
    Development,
    /// A burr from the side
    Side,
    /// A burr from its tip
    Tip,
    /// A burr's helix angle along its flutes, with its tolerance
    Helix,
}

impl View {
    fn name(self) -> String {
        self.to_possible_value().map_or_else(String::new, |value| value.get_name().to_owned())
    }

    /// Returns the view of a part by its top; `None` for one that stands alone.
    fn standard(self) -> Option<StandardView> {
        match self {
            Self::Top => Some(StandardView::Top),
            Self::Front => Some(StandardView::Front),
            Self::Right => Some(StandardView::Right),
            Self::Iso => Some(StandardView::Isometric),
            Self::Development | Self::Side | Self::Tip | Self::Helix => None,
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum ProjectionAngle {
    /// The top view above the front view, the right view on its right
    Third,
    /// The top view below the front view, the right view on its left
    First,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum ColorMeaning {
    /// The coordinate along the line of sight of the top view, deeper is darker
    Depth,
    /// The tool
    Tool,
    /// The feed rate
    Feed,
    /// The program or macro that commands the move
    Program,
}

pub(super) fn run(arguments: &Arguments) -> Result<ExitStatus, UsageError> {
    let views = views(&arguments.view)?;
    let (program, reference) = reference_file::completed(&arguments.program, arguments.reference.as_deref())?;
    let (mut request, mut folders) =
        options::checked_request(&program, reference.as_deref(), Some(arguments.output.path()), None)?;
    // A burr beside the program is drawn as such; its path by a flag of paths.
    let has_path_flag = arguments.color_by.is_some() || arguments.projection.is_some();
    let is_path = has_path_flag || views.iter().any(|view| view.standard().is_some());
    let nominal =
        options::nominal_or_motion(reference.as_deref(), &request, &mut folders)?.filter(|nominal| {
            arguments.reference.is_some() || !is_path || matches!(nominal, NominalPart::Holes(_))
        });
    let tolerance = options::tolerance("--tolerance", arguments.tolerance)?;
    request.denies_assumptions = arguments.deny.denies_assumptions();
    let drawn = match nominal {
        Some(NominalPart::Flutes(_)) if arguments.color_by.is_some() || arguments.projection.is_some() => {
            return Err(UsageError::new(
                "--color-by and --projection are for tool paths, and the reference is a burr",
            ));
        }
        Some(NominalPart::Flutes(mut flutes)) => {
            flutes.surface_tolerance = tolerance.unwrap_or(flutes.surface_tolerance);
            let judge = |request: &Request| gcode_session::judge_flutes(request, &mut folders, &flutes);
            let (grinding, verdict) = progress::of_run(&mut request, judge)?;
            let view = views.first().copied().unwrap_or(View::Side);
            let picture = flute_picture(view, &flute_view::of(&name(&request), &grinding, &verdict))?;
            Drawn {
                picture,
                view: view.name(),
                verdict: Some((verdict.verdict, verdict.summary.clone())),
                status: Some(verdict.conclusion().into()),
                findings: verdict.diagnostics,
                run: grinding.run,
            }
        }
        None | Some(NominalPart::Holes(_)) => {
            let reference = nominal.and_then(NominalPart::into_holes);
            let style = Style { views, projection: arguments.projection, color_by: arguments.color_by };
            let criteria = reference
                .as_ref()
                .map(|reference| Criteria { reference, tolerances: Tolerances::of(reference, tolerance) });
            of_path(&style, arguments.deny, &mut request, &mut folders, criteria)?
        }
    };
    arguments.output.draw(&drawn.picture, arguments.size.parse()?)?;
    let (verdict, summary) = drawn.verdict.unzip();
    let picture = arguments.output.path().display().to_string();
    let report = RenderReport { picture, view: drawn.view, verdict, summary };
    output::report(&report, RenderReport::text, arguments.format)?;
    let of_findings = super::findings(&drawn.findings, &drawn.run);
    Ok(drawn.status.unwrap_or(of_findings))
}

/// Returns the views without repetitions; a view of a burr or a development stands alone.
fn views(all: &[View]) -> Result<Vec<View>, UsageError> {
    let mut views: Vec<View> = Vec::new();
    for view in all {
        if !views.contains(view) {
            views.push(*view);
        }
    }
    match views.iter().find(|view| view.standard().is_none()) {
        Some(alone) if 1 < views.len() => Err(UsageError::new(format!(
            "--view {} stands alone: only top, front, right and iso share a sheet",
            alone.name()
        ))),
        _ => Ok(views),
    }
}

/// What a picture of a path shows, and how.
#[derive(Debug, Default)]
pub(super) struct Style {
    views: Vec<View>,
    projection: Option<ProjectionAngle>,
    color_by: Option<ColorMeaning>,
}

/// A picture with the verdict that it shows.
struct Drawn {
    picture: Picture,
    /// Names of the views, separated by commas.
    view: String,
    /// Answer and summary; without a reference only of a run that fails.
    verdict: Option<(Answer, String)>,
    /// Exit status of the verdict; that of the findings without one.
    status: Option<ExitStatus>,
    findings: Vec<Diagnostic>,
    run: Run,
}

/// Runs a program and draws its path and its holes.
fn of_path(
    style: &Style,
    deny: DenyArguments,
    request: &mut Request,
    folders: &mut Folders,
    criteria: Option<Criteria<'_>>,
) -> Result<Drawn, UsageError> {
    let reference = criteria.map(|criteria| criteria.reference);
    let machine = request.machine.clone();
    let mut recorder = PathRecorder::new(&machine);
    let judge = |request: &Request| {
        gcode_session::simulate_judged(request, folders, criteria, &mut recorder, &mut ())
    };
    let HoleJudgement { simulation, verdict } = progress::of_run(request, judge)?;
    let path = recorder.finish();
    let (holes, verdict, status, findings) = match (reference, verdict) {
        (Some(reference), Some(verdict)) => {
            let holes = top::of_verdict(&name(request), &simulation, reference, &verdict, &machine);
            let status = Some(verdict.conclusion().into());
            (holes, Some((verdict.verdict, verdict.summary.clone())), status, verdict.diagnostics)
        }
        _ => {
            let found = simulation.dependencies(request);
            let assumed = found.numbered(&simulation.run);
            let denied = deny.errors(&assumed, Total::Holes(found.count()));
            let assumed: Vec<Assumption> = assumed.into_iter().map(|(one, _)| one).collect();
            let holes = top::of_holes(&name(request), &simulation, &machine, &assumed);
            let denial = (!denied.is_empty()).then(|| denied_words(denied.len()));
            let faults: Vec<String> = simulation.run.stop_sentence().into_iter().chain(denial).collect();
            let of_run: Vec<Diagnostic> = simulation.run.findings().collect();
            // An error in the motion fails a picture as it fails a page; warnings are about holes.
            let is_known = |error: &Diagnostic| {
                of_run.iter().any(|one| one.kind == error.kind && one.message == error.message)
            };
            let found = simulation.extracted.findings.iter();
            let errors = found.filter(|one| one.severity == Severity::Error && !is_known(one)).cloned();
            let findings = errors.chain(of_run.iter().cloned()).chain(denied).collect();
            (holes, (!faults.is_empty()).then(|| (Answer::Fail, faults.join("; "))), None, findings)
        }
    };
    let picture = path_picture(style, request, &simulation, path, holes, &findings, reference)?;
    let names = if style.views.is_empty() {
        vec![View::Top.name()]
    } else {
        style.views.iter().map(|view| view.name()).collect()
    };
    Ok(Drawn { picture, view: names.join(","), verdict, status, findings, run: simulation.run })
}

/// Builds the picture of a path with its holes and findings.
pub(super) fn path_picture(
    style: &Style,
    request: &Request,
    simulation: &Simulation,
    path: ToolPath,
    mut holes: TopView,
    findings: &[Diagnostic],
    reference: Option<&Reference>,
) -> Result<Picture, UsageError> {
    let findings: Vec<&Diagnostic> = match reference {
        Some(_) => findings.iter().collect(),
        None => simulation.findings_without_reference().collect(),
    };
    let errors = tool_path::finding_line(findings.iter().copied(), Severity::Error, "error");
    let warnings = tool_path::finding_line(findings.iter().copied(), Severity::Warning, "warning");
    let is_inch = simulation.run.control.is_inch();
    let unit = is_inch.then(|| "mm; the program is in inches".to_owned());
    holes.lines.extend(errors.into_iter().chain(warnings).chain(unit));
    let stock = reference.and_then(|reference| reference.stock.clone()).or(request.machine.stock.clone());
    let surroundings = (stock, request.settings.stroke_limits);
    hole_picture(style, holes, path, simulation, &request.machine, surroundings)
}

/// Builds the picture of a path with its holes, of the holes alone where the path shows no more, or of a development.
fn hole_picture(
    style: &Style,
    mut holes: TopView,
    path: ToolPath,
    simulation: &Simulation,
    machine: &Machine,
    (stock, strokes): (Option<Stock>, Option<StrokeLimits>),
) -> Result<Picture, UsageError> {
    let views = style.views.as_slice();
    match views {
        [View::Development] => {
            let missing = match holes.shaft {
                Some(_) => {
                    "--view development shows the rows of a honeycomb; holes of a pattern are drawn by --view top,front"
                }
                None => "--view development unrolls a cylinder: give the job of a honeycomb with --reference",
            };
            return gcode_draw::development(&holes).ok_or_else(|| UsageError::new(missing));
        }
        [View::Side | View::Tip | View::Helix] => {
            return Err(UsageError::new(
                "the views side, tip and helix show a burr: give a burr job with --reference JOB.toml",
            ));
        }
        _ => {}
    }
    let is_asked =
        style.color_by.is_some() || style.projection.is_some() || !matches!(views, [] | [View::Top]);
    // A run that stops is drawn without a path too: its alarm is in the title block.
    let is_empty = !tool_path::is_drawable(&path, &holes);
    if is_empty && simulation.run.stop_finding().is_none() {
        return Err(UsageError::new("nothing to draw: the program makes no move between known positions"));
    }
    if is_empty {
        holes.lines.push("nothing is drawn: the run stops before a move between known positions".to_owned());
    }
    let has_stock = !matches!(stock, None | Some(Stock::Surface { .. }));
    let is_part_known = holes.outline.is_some() || holes.cylinder.is_some();
    // A part of a family is drawn with its own outline, and its stops are those of the set-up sheet.
    let shows_more = !is_part_known && (has_stock || tool_path::has_curves_or_stops(&path))
        || tool_path::shows_more(&path, simulation);
    if !is_part_known {
        holes.side = tool_path::top_side(&path, &simulation.hole_list().holes, machine, holes.side);
    }
    if is_empty || !is_asked && !shows_more {
        return Ok(gcode_draw::top_view(&holes));
    }
    let standard: Vec<StandardView> = views.iter().filter_map(|view| view.standard()).collect();
    let arrangement = Arrangement {
        top: holes.side,
        views: if standard.is_empty() { vec![StandardView::Top] } else { standard },
        projection: match style.projection {
            Some(ProjectionAngle::First) => Projection::First,
            Some(ProjectionAngle::Third) | None => Projection::Third,
        },
        color_by: match style.color_by {
            Some(ColorMeaning::Tool) => ColorBy::Tool,
            Some(ColorMeaning::Feed) => ColorBy::Feed,
            Some(ColorMeaning::Program) => ColorBy::Program,
            Some(ColorMeaning::Depth) | None => ColorBy::Depth,
        },
    };
    let path = tool_path::of_path(path, simulation, machine, stock, strokes);
    Ok(gcode_draw::path_picture(&holes, &path, &arrangement))
}

fn flute_picture(view: View, drawn: &FluteView) -> Result<Picture, UsageError> {
    match view {
        View::Side => Ok(gcode_draw::side_view(drawn)),
        View::Tip => Ok(gcode_draw::tip_view(drawn)),
        View::Helix => Ok(gcode_draw::helix_graph(drawn)),
        View::Top | View::Front | View::Right | View::Iso | View::Development => {
            Err(UsageError::new("this view shows holes; a burr has the views side, tip and helix"))
        }
    }
}

/// Returns the file name of the program without its folder, and the program chosen among several of the file.
pub(super) fn name(request: &Request) -> String {
    let file = Path::new(&request.name).file_name();
    let file = file.map_or_else(|| request.name.clone(), |name| name.to_string_lossy().into_owned());
    match &request.main {
        Some(main) => format!("{file}, {}", main.name.label()),
        None => file,
    }
}
