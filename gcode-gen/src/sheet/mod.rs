//! The set-up sheet: one printable page for setting up the machine, running the programs and measuring the
//! part.
//!
//! Its contents come from the emitted package and its simulation. Facts that only the user has come from the
//! job's section `[sheet]`; unknown ones are left blank for handwriting, as results of measurements always
//! are.
pub mod cost;
mod html;
mod measure;
mod record;
mod settings;
mod stop_instructions;

use gcode_part::job::{Job, Rates};

use crate::check::{CheckError, CheckedPackage};
use crate::package::Package;
use cost::{Cost, MachineTime};
use record::Record;
use settings::RequiredSetting;

/// A verified package with the data for its sheet.
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
    /// Runs the package once more for the sheet. `checked` must have passed; `rates` take precedence over
    /// those of the job; `pictures` are names and PNGs.
    ///
    /// # Errors
    /// [`CheckError::Broken`] if the package contradicts itself.
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

    /// Returns the time of one part.
    pub fn machine_time(&self) -> MachineTime {
        cost::machine_time(self.job.sheet(), &self.record)
    }

    /// Returns the currency and the costs, the job's own machine first; empty if no rate is given.
    pub fn costs(&self) -> (&str, Vec<Cost>) {
        self.rates
            .map_or(("", Vec::new()), |rates| (&rates.currency, cost::costs(rates, &self.machine_time())))
    }

    /// Returns the sheet as one self-contained HTML file.
    pub fn html(&self) -> String {
        html::page(self)
    }
}
