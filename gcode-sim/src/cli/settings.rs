//! `gcode-sim settings`: lists the control settings for `--control`.
use clap::Args;

use super::format::TextFormat;
use super::{ExitStatus, UsageError, output};
use crate::report::settings::SettingsReport;

#[derive(Debug, Args)]
pub(super) struct SettingsArguments {
    /// Output format
    #[arg(long, value_enum, default_value_t = TextFormat::Text)]
    format: TextFormat,
}

pub(super) fn run(arguments: &SettingsArguments) -> Result<ExitStatus, UsageError> {
    let report = SettingsReport::new();
    match arguments.format {
        TextFormat::Text => output::print(&report.text())?,
        TextFormat::Json => output::json(&report)?,
    }
    Ok(ExitStatus::Passed)
}
