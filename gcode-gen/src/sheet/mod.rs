//! The set-up sheet: one printable page for the people who set the machine up, watch the run and measure the part.
//!
//! Everything on it is of the emitted package and of its simulation; what only people know is the job's section `[sheet]`,
//! and what isn't known stands empty, to be filled in by hand. Results of measurements always do.
pub mod cost;
mod html;
pub mod measure;
pub mod record;
pub mod settings;
pub mod stop_instructions;

use gcode_part::job::{Job, Rates};

use crate::check::{CheckError, CheckedPackage};
use crate::package::Package;
use cost::{Cost, MachineTime};
use record::Record;
use settings::RequiredSetting;

/// What the whole page says of its numbers, wherever it shows any.
pub const BASIS: &str = "Predicted by simulation, not measured";

/// A package that holds, with all that its sheet shows.
pub struct Sheet<'a> {
    job: &'a Job,
    package: &'a Package,
    checked: &'a CheckedPackage,
    record: Record,
    required_settings: Vec<RequiredSetting>,
    rates: Option<&'a Rates>,
    /// Names and PNGs.
    pictures: Vec<(String, Vec<u8>)>,
}

impl<'a> Sheet<'a> {
    /// `checked` holds; `rates` go before those of the job. `pictures` are names and PNGs.
    ///
    /// # Errors
    /// A package that contradicts itself.
    pub fn new(
        job: &'a Job,
        package: &'a Package,
        checked: &'a CheckedPackage,
        rates: Option<&'a Rates>,
        pictures: Vec<(String, Vec<u8>)>,
    ) -> Result<Self, CheckError> {
        let rates = rates.or(job.sheet().rates.as_ref());
        let record = record::record(job, package)?;
        Ok(Self {
            job,
            package,
            checked,
            required_settings: settings::required_settings(job, package, &record.program_starts)?,
            record,
            rates,
            pictures,
        })
    }

    /// The time that a part takes.
    pub fn machine_time(&self) -> MachineTime {
        cost::machine_time(self.job.sheet(), &self.record)
    }

    /// What it costs, on the job's own machine first, and the currency; nothing where no rate was given.
    pub fn costs(&self) -> (&str, Vec<Cost>) {
        self.rates
            .map_or(("", Vec::new()), |rates| (&rates.currency, cost::costs(rates, &self.machine_time())))
    }

    /// One self-contained HTML file.
    pub fn html(&self) -> String {
        html::page(self)
    }
}
