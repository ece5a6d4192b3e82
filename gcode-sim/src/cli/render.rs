//! `gcode-sim render`: draws the holes on the part, or a burr's flutes.
use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};

use super::conditions::ProgramArguments;
use super::format::TextFormat;
use super::{ExitStatus, UsageError, options, output, overwrite_guard, progress, unused_machine};
use crate::report::pictures::RenderReport;
use crate::report::{flute_view, top};
use gcode_draw::{Picture, Size, TopView};
use gcode_inspect::verify::{Tolerances, Verdict};
use gcode_part::Flutes;
use gcode_part::NominalPart;
use gcode_part::Reference;
use gcode_session::{Request, Simulation};

#[derive(Debug, Args)]
pub(super) struct RenderArguments {
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

impl View {
    /// Returns the value of `--view`.
    fn name(self) -> &'static str {
        match self {
            Self::Top => "top",
            Self::Development => "development",
            Self::Side => "side",
            Self::Tip => "tip",
            Self::Helix => "helix",
        }
    }
}

pub(super) fn run(arguments: &RenderArguments) -> Result<ExitStatus, UsageError> {
    overwrite_guard::check_not_input(
        &arguments.output,
        &arguments.program.files(arguments.reference.as_deref())?,
    )?;
    match arguments.reference.as_deref().map(options::read_nominal).transpose()? {
        Some(NominalPart::Holes(reference)) => holes(arguments, Some(reference)),
        Some(NominalPart::Flutes(wanted)) => flutes(arguments, wanted),
        None => holes(arguments, None),
    }
}

fn holes(arguments: &RenderArguments, reference: Option<Reference>) -> Result<ExitStatus, UsageError> {
    let (mut request, mut folders) = options::request(&arguments.program)?;
    unused_machine::warn_unused_machine(&arguments.program, &request);
    let asked = options::tolerance("--tolerance", arguments.tolerance)?;
    let surface = reference.as_ref().and_then(|r| r.surface);
    request.conduct = reference.as_ref().map(|r| r.process_limits.clone()).unwrap_or_default();
    let simulation =
        progress::of_run(&mut request, |request| gcode_session::simulate(request, &mut folders, surface))
            .map_err(|e| UsageError::new(e.to_string()))?;
    let drawn = match &reference {
        Some(reference) => {
            let verdict = simulation.verify(reference, Tolerances::of(reference, asked), &request.machine);
            view(&request, &simulation, reference, &verdict)
        }
        None => top::of_holes(&name(&request), &simulation, &request.machine),
    };
    let asked = arguments.view.unwrap_or(View::Top);
    let picture = match asked {
        View::Top => gcode_draw::top_view(&drawn),
        View::Side | View::Tip | View::Helix => {
            let message =
                "the views side, tip and helix show a burr: give a burr job with --reference JOB.toml";
            return Err(UsageError::new(message));
        }
        View::Development => gcode_draw::development(&drawn).ok_or_else(|| {
            let message = "--view development unrolls a cylinder: give its job with --reference";
            UsageError::new(message)
        })?,
    };
    write(&picture, &arguments.size, &arguments.output)?;
    tell(arguments, asked)?;
    Ok(super::stopped(&simulation.run).unwrap_or(ExitStatus::Passed))
}

fn flutes(arguments: &RenderArguments, mut wanted: Flutes) -> Result<ExitStatus, UsageError> {
    let (mut request, mut folders) = options::request(&arguments.program)?;
    unused_machine::warn_unused_machine(&arguments.program, &request);
    let asked = options::tolerance("--tolerance", arguments.tolerance)?;
    wanted.surface_tolerance = asked.unwrap_or(wanted.surface_tolerance);
    let grinding =
        progress::of_run(&mut request, |request| gcode_session::grind(request, &mut folders, &wanted))
            .map_err(|e| UsageError::new(e.to_string()))?;
    let verdict = grinding.verify();
    let view = flute_view::of(&name(&request), &grinding, &verdict);
    let asked = arguments.view.unwrap_or(View::Side);
    let picture = match asked {
        View::Side => gcode_draw::side_view(&view),
        View::Tip => gcode_draw::tip_view(&view),
        View::Helix => gcode_draw::helix_graph(&view),
        View::Top | View::Development => {
            return Err(UsageError::new("this view shows holes; a burr has the views side, tip and helix"));
        }
    };
    write(&picture, &arguments.size, &arguments.output)?;
    tell(arguments, asked)?;
    Ok(super::stopped(&grinding.run).unwrap_or(ExitStatus::Passed))
}

/// Prints the view and the path of the picture.
fn tell(arguments: &RenderArguments, view: View) -> Result<(), UsageError> {
    let report = RenderReport { picture: arguments.output.display().to_string(), view: view.name() };
    match arguments.format {
        TextFormat::Text => output::print(&report.text()),
        TextFormat::Json => output::json(&report),
    }
}

/// Builds the contents of the views from a verdict.
pub(super) fn view(
    request: &Request,
    simulation: &Simulation,
    reference: &Reference,
    verdict: &Verdict,
) -> TopView {
    top::of_verdict(&name(request), simulation, reference, verdict, &request.machine)
}

/// Draws a picture to a PNG file of exactly this size.
pub(super) fn write(picture: &Picture, size: &str, path: &Path) -> Result<(), UsageError> {
    let is_other = |extension: &std::ffi::OsStr| !extension.eq_ignore_ascii_case("png");
    if path.extension().is_some_and(is_other) {
        let png = path.with_extension("png");
        return Err(UsageError::new(format!(
            "{}: a picture is a PNG file: name it {}",
            path.display(),
            png.display()
        )));
    }
    let refused = |error: gcode_draw::PictureError| UsageError::new(error.to_string());
    let size: Size = size.parse().map_err(refused)?;
    let png = gcode_draw::draw(picture, size).map_err(refused)?;
    output::write(path, &png)
}

/// Returns the file name of the program without its folder.
pub(super) fn name(request: &Request) -> String {
    let file = Path::new(&request.name).file_name();
    file.map_or_else(|| request.name.clone(), |name| name.to_string_lossy().into_owned())
}
