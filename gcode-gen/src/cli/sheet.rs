//! `gcode-gen sheet`: verifies the programs of a job and writes their set-up sheet.
use std::path::Path;

use gcode_part::job::Rates;
use gcode_sim::cli::format::TextFormat;
use gcode_sim::cli::{ExitStatus, UsageError, input, output, overwrite_guard};

use super::emit::{Emitted, emit_verified, pictures};
use crate::report::SheetReport;
use crate::sheet::Sheet;

pub(super) fn run(
    path: &Path,
    out: &Path,
    rates: Option<&Path>,
    format: TextFormat,
) -> Result<ExitStatus, UsageError> {
    overwrite_guard::check_not_input(out, &std::iter::once(path).chain(rates).collect::<Vec<_>>())?;
    let read =
        |path: &Path| Rates::parse(&input::text(path)?).map_err(|error| UsageError::in_toml(path, &error));
    let rates = rates.map(read).transpose()?;
    let Emitted { job, package, checked, refused } = emit_verified(path)?;
    let (Some(checked), None) = (&checked, &refused) else {
        if format == TextFormat::Json {
            output::json(&SheetReport::refused(refused))?;
        }
        return Ok(ExitStatus::Failed);
    };
    let sheet = Sheet::new(&job, &package, checked, rates.as_ref(), pictures(checked)?)
        .map_err(|error| UsageError::new(error.to_string()))?;
    output::write(out, sheet.html().as_bytes())?;
    let (currency, costs) = sheet.costs();
    let report = SheetReport::new(out.display().to_string(), &sheet.machine_time(), currency, &costs);
    output::report(&report, SheetReport::text, format)?;
    Ok(ExitStatus::Passed)
}
