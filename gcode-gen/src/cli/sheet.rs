//! `gcode-gen sheet`: verifies the programs of a job and writes their set-up sheet.
use std::path::Path;

use gcode_part::job::Rates;
use gcode_sim::cli::format::TextFormat;
use gcode_sim::cli::{ExitStatus, UsageError, input, output, overwrite_guard};

use super::emit::{VerifiedPackage, emit_verified, pictures};
use crate::report::SheetReport;
use crate::sheet::Sheet;

pub(super) fn run(
    path: &Path,
    out: &Path,
    rates: Option<&Path>,
    format: TextFormat,
) -> Result<ExitStatus, UsageError> {
    overwrite_guard::check_not_input(out, &std::iter::once(path).chain(rates).collect::<Vec<_>>())?;
    let rates = rates.map(read_rates).transpose()?;
    let VerifiedPackage { job, package, checked } = match emit_verified(path)? {
        Ok(verified) => verified,
        Err(refused) => {
            if format == TextFormat::Json {
                output::json(&SheetReport::refused(refused.plain()))?;
            }
            return Ok(ExitStatus::Failed);
        }
    };
    let pictures = pictures(&checked)?;
    let sheet = Sheet::new(&job, &package, &checked, rates.as_ref(), pictures)
        .map_err(|error| UsageError::new(error.to_string()))?;
    output::write(out, sheet.html().as_bytes())?;
    let (currency, costs) = sheet.costs();
    let report = SheetReport::new(out.display().to_string(), &sheet.machine_time(), currency, &costs);
    output::report(&report, SheetReport::text, format)?;
    Ok(ExitStatus::Passed)
}

fn read_rates(path: &Path) -> Result<Rates, UsageError> {
    Rates::parse(&input::text(path)?).map_err(|error| UsageError::in_file(path, error))
}
