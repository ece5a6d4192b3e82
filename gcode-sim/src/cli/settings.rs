//! `gcode-sim settings`: lists the control settings for `--control`.
use clap::Args;

use super::format::TextFormat;
use super::{ExitStatus, UsageError, output};
use crate::report::settings::SettingsReport;

#[derive(Debug, Args)]
pub(super) struct Arguments {
    /// Output format
    #[arg(long, value_enum, default_value_t = TextFormat::Text)]
    format: TextFormat,
}

pub(super) fn run(arguments: &Arguments) -> Result<ExitStatus, UsageError> {
    let report = SettingsReport::all();
    output::report(&report, SettingsReport::text, arguments.format)?;
    Ok(ExitStatus::Passed)
}
