//! `gcode-sim explain`: explains an alarm or finding code.
use clap::Args;

use super::format::TextFormat;
use super::{ExitStatus, UsageError, output};
use crate::report::explain::{ExplainReport, similar_code};

#[derive(Debug, Args)]
pub(super) struct Arguments {
    /// An alarm as the control shows it (PS0112, 'PS 112', 112, MC3021) or a finding (hole-position)
    #[arg(value_name = "CODE", required_unless_present = "list")]
    code: Option<String>,

    /// List all codes
    #[arg(long, conflicts_with = "code")]
    list: bool,

    /// Output format
    #[arg(long, value_enum, default_value_t = TextFormat::Text)]
    format: TextFormat,
}

pub(super) fn run(arguments: &Arguments) -> Result<ExitStatus, UsageError> {
    let report = match &arguments.code {
        None => ExplainReport::list(),
        Some(code) => ExplainReport::of(code).ok_or_else(|| {
            let meant = similar_code(code).map(|meant| format!(" (did you mean '{meant}'?)"));
            UsageError::new(format!(
                "{code} is not a code of this simulator{}: gcode-sim explain --list lists all",
                meant.unwrap_or_default()
            ))
        })?,
    };
    output::report(&report, ExplainReport::text, arguments.format)?;
    Ok(ExitStatus::Passed)
}
