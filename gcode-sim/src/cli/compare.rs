//! `gcode-sim compare`: compares two pictures.
use std::path::PathBuf;

use clap::Args;

use super::format::TextFormat;
use super::{ExitStatus, UsageError, input, output, overwrite_guard};
use crate::report::pictures::CompareReport;

#[derive(Debug, Args)]
pub(super) struct Arguments {
    /// One picture
    #[arg(value_name = "A.png")]
    left: PathBuf,

    /// The other picture
    #[arg(value_name = "B.png")]
    right: PathBuf,

    /// The picture to write, with the differences marked
    #[arg(short, long, value_name = "DIFF.png")]
    output: Option<PathBuf>,

    /// Tolerance of a colour value, 0 to 255
    #[arg(long, value_name = "STEPS", default_value_t = 1)]
    tolerance: u8,

    /// Output format
    #[arg(long, value_enum, default_value_t = TextFormat::Text)]
    format: TextFormat,
}

pub(super) fn run(arguments: &Arguments) -> Result<ExitStatus, UsageError> {
    if let Some(path) = &arguments.output {
        overwrite_guard::check_not_input(path, &[&arguments.left, &arguments.right])?;
    }
    let (left, right) = (input::bytes(&arguments.left)?, input::bytes(&arguments.right)?);
    let difference = gcode_draw::compare(&left, &right, arguments.tolerance)?;
    let picture = arguments.output.as_ref().filter(|_| !difference.is_none());
    if let Some(path) = picture {
        output::write(path, &difference.png()?)?;
    }
    let report = CompareReport::new(&difference, picture.map(|path| path.display().to_string()));
    output::report(&report, CompareReport::text, arguments.format)?;
    Ok(if report.same { ExitStatus::Passed } else { ExitStatus::Failed })
}
