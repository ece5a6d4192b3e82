//! `gcode-gen sheet`: the set-up sheet of a job's programs, after they have been run and held against the job.
use std::path::Path;

use gcode_sim::cli::{Refusal, Status, input, output};
use gcode_sim::job::Rates;

use super::emit::{Held, held, pictures};
use crate::sheet::Sheet;

pub(super) fn run(path: &Path, out: &Path, rates: Option<&Path>) -> Result<Status, Refusal> {
    let rates = rates.map(read_rates).transpose()?;
    let Some(Held { job, package, checked }) = held(path)? else { return Ok(Status::Fails) };
    let pictures = pictures(&checked)?;
    let sheet = Sheet::new(&job, &package, &checked, rates.as_ref(), pictures)
        .map_err(|error| Refusal::new(error.to_string()))?;
    output::write(out, sheet.html().as_bytes())?;
    output::print(&format!("{}written: {}\n", sheet.summary(), out.display()))?;
    Ok(Status::Holds)
}

fn read_rates(path: &Path) -> Result<Rates, Refusal> {
    Rates::parse(&input::text(path)?).map_err(|error| Refusal::new(format!("{}, {error}", path.display())))
}
