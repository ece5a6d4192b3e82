//! The set-up sheet: one printable page for the people who set the machine up, watch the run and measure the part.
//!
//! Everything on it is of the emitted package and of its simulation; what only people know is the job's section `[sheet]`,
//! and what isn't known stands empty, to be filled in by hand. Results of measurements always do.
pub mod cost;
pub mod duty;
mod html;
pub mod measure;
pub mod record;
pub mod settings;

use gcode_sim::job::{Job, Rates};
use gcode_sim::report::figures::{count, near, signed_to};

use crate::check::{CheckError, Checked};
use crate::package::Package;
use record::Record;
use settings::Needed;

/// What the whole page says of its numbers, wherever it shows any.
pub const BASIS: &str = "Predicted by simulation, not measured";

/// A package that holds, with all that its sheet shows.
pub struct Sheet<'a> {
    job: &'a Job,
    package: &'a Package,
    checked: &'a Checked,
    record: Record,
    needed: Vec<Needed>,
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
        checked: &'a Checked,
        rates: Option<&'a Rates>,
        pictures: Vec<(String, Vec<u8>)>,
    ) -> Result<Self, CheckError> {
        let rates = rates.or(job.sheet().rates.as_ref());
        Ok(Self {
            job,
            package,
            checked,
            record: record::record(job, package)?,
            needed: settings::needed(package)?,
            rates,
            pictures,
        })
    }

    /// Time and money in two or three lines, for a terminal.
    pub fn summary(&self) -> String {
        let own = cost::taken(self.job.sheet(), &self.record);
        let stops = count(own.stops, "operator stop");
        let changes = count(own.tool_changes, "tool change");
        let (run, hours) = (near(own.run, 1), near(own.all() / 60.0, 2));
        let mut text =
            format!("run {run} min, {stops}, {changes}: {hours} machine hours; {}\n", BASIS.to_lowercase());
        let Some(rates) = self.rates else { return text + "no rate was given: the sheet shows time only\n" };
        let costs = cost::costs(rates, &own);
        for cost in &costs {
            let price = format!("{} {} a part", near(cost.cost(), 2), rates.currency);
            text += &match &cost.machine {
                None => format!("{price}\n"),
                Some(machine) => match costs[0].change(cost) {
                    Some(change) => format!("{price} on {machine}; this job {} %\n", signed_to(change, 1)),
                    None => {
                        format!("{price} on {machine}; not compared: a time is given for one of them only\n")
                    }
                },
            };
        }
        text
    }

    /// One self-contained HTML file.
    pub fn html(&self) -> String {
        html::page(self)
    }
}
