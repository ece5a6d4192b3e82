//! `gcode-gen sheet`: the set-up sheet of a job's programs, after they have been run and held against the job.
use std::path::Path;

use gcode_sim::cli::format::TextFormat;
use gcode_sim::cli::{Refusal, Status, apart, input, output};
use gcode_sim::job::Rates;

use super::emit::{Held, held, pictures};
use crate::report::SheetReport;
use crate::sheet::Sheet;

pub(super) fn run(
    path: &Path,
    out: &Path,
    rates: Option<&Path>,
    format: TextFormat,
) -> Result<Status, Refusal> {
    apart::keep(out, &std::iter::once(path).chain(rates).collect::<Vec<_>>())?;
    let rates = rates.map(read_rates).transpose()?;
    let Held { job, package, checked } = match held(path)? {
        Ok(held) => held,
        Err(refused) => {
            if format == TextFormat::Json {
                output::json(&SheetReport::refused(refused.plain()))?;
            }
            return Ok(Status::Fails);
        }
    };
    let pictures = pictures(&checked)?;
    let sheet = Sheet::new(&job, &package, &checked, rates.as_ref(), pictures)
        .map_err(|error| Refusal::new(error.to_string()))?;
    output::write(out, sheet.html().as_bytes())?;
    let (currency, costs) = sheet.costs();
    let report = SheetReport::new(out.display().to_string(), &sheet.taken(), currency, &costs);
    match format {
        TextFormat::Text => output::print(&report.text())?,
        TextFormat::Json => output::json(&report)?,
    }
    Ok(Status::Holds)
}

fn read_rates(path: &Path) -> Result<Rates, Refusal> {
    Rates::parse(&input::text(path)?).map_err(|error| Refusal::new(format!("{}, {error}", path.display())))
}
