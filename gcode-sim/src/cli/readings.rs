//! `gcode-sim readings`: shows the readings of an edge finder fed along the part's surface.

use clap::Args;

use super::conditions::ProgramArguments;
use super::format::ListFormat;
use super::picture_file::PictureFile;
use super::{ExitStatus, UsageError, common, options, output, render};
use crate::report::readings::ReadingsReport;
use gcode_draw::Size;
use gcode_inspect::verify::Answer;

#[derive(Debug, Args)]
pub(super) struct Arguments {
    /// Tolerance of a reading either way, mm [default: no verdict]
    #[arg(long, value_name = "MM", allow_negative_numbers = true, value_parser = common::number)]
    tolerance: Option<f64>,

    /// Also draw the readings along the path to this file
    #[arg(long, value_name = "OUT.png", value_parser = PictureFile::parser())]
    picture: Option<PictureFile>,

    /// Width and height of the picture in pixels
    #[arg(long, value_name = "WxH", default_value = "1600x900")]
    size: String,

    /// Output format
    #[arg(long, value_enum, default_value_t = ListFormat::Text)]
    format: ListFormat,

    #[command(flatten)]
    program: ProgramArguments,
}

pub(super) fn run(arguments: &Arguments) -> Result<ExitStatus, UsageError> {
    let (program, _) = arguments.program.completed()?;
    let (request, mut folders) =
        options::checked_request(&program, None, arguments.picture.as_ref().map(PictureFile::path), None)?;
    let tolerance = options::tolerance("--tolerance", arguments.tolerance)?;
    let (Some(part), Some(probe)) = (request.probed(), &request.machine.probe) else {
        return Err(UsageError::new(
            "readings need a part: give it with --part, or [probe] and [stock] in the machine file",
        ));
    };
    let following = gcode_session::read_stylus(&request, &mut folders, part, probe.radius)?;
    let report = ReadingsReport::new(&render::name(&request), &following, probe.radius, tolerance);
    match arguments.format {
        ListFormat::Text => output::print(&report.text())?,
        ListFormat::Json => output::json(&report)?,
        ListFormat::Csv => output::print(&report.csv())?,
    }
    if let Some(file) = &arguments.picture {
        let size: Size = arguments.size.parse()?;
        file.plot(&report.plot(), size)?;
        output::written("picture", file.path(), arguments.format == ListFormat::Text)?;
    }
    let status = super::findings(&following.readings.findings, &following.run);
    if status != ExitStatus::Passed {
        return Ok(status);
    }
    if report.is_empty() {
        output::print_message("error: no feed of the program follows the part's surface within 5 mm\n");
        return Ok(ExitStatus::Failed);
    }
    Ok(match report.verdict() {
        Some(Answer::Fail) => ExitStatus::Failed,
        Some(Answer::Pass) | None => ExitStatus::Passed,
    })
}
