//! The section `[sheet]` of a job of any family: additional data for the set-up sheet.
use schemars::JsonSchema;
use serde::Deserialize;

use crate::reader::bounds::{DurationMinutes, HourlyRate};
use crate::reader::{FileError, FileKey, Items, Optional, Reader, Section};

/// Additional data for the set-up sheet. Omitted fields are printed empty, for entry by hand.
#[derive(Clone, Debug, Default, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SheetInfo {
    /// The part's name.
    pub part: Option<String>,
    /// The number of its drawing.
    pub drawing: Option<String>,
    /// The revision of its drawing.
    pub revision: Option<String>,
    /// Its material.
    pub material: Option<String>,
    /// The machine's name in the shop.
    pub machine: Option<String>,
    /// Set-up and alignment of one part, minutes.
    #[serde(default, with = "Optional::<DurationMinutes>")]
    setup_minutes: Option<f64>,
    /// An operator stop, from standstill to start, minutes.
    #[serde(default, with = "Optional::<DurationMinutes>")]
    stop_minutes: Option<f64>,
    /// A tool change, minutes.
    #[serde(default, with = "Optional::<DurationMinutes>")]
    tool_change_minutes: Option<f64>,
    /// Machine-hour rates.
    #[serde(default, with = "Optional::<Section<Rates>>")]
    pub rates: Option<Rates>,
}

/// Times that the simulation cannot determine, in minutes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Minutes {
    /// Set-up and alignment of one part.
    pub setup: Option<f64>,
    /// Time of an operator stop, from standstill to start.
    pub stop: Option<f64>,
    /// Time of a tool change.
    pub tool_change: Option<f64>,
}

/// Machine-hour rates of the job's machine and of alternative machines.
#[derive(Clone, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Rates {
    /// Printed unchanged.
    pub currency: String,
    /// Price of a machine hour, in that currency.
    #[serde(with = "HourlyRate")]
    pub rate: f64,
    /// Alternative machines for the part.
    #[serde(default, rename = "beside", with = "Items::<Section<AlternativeMachine>>")]
    pub alternatives: Vec<AlternativeMachine>,
}

/// The same part on another machine. Omitted times are equal to those of the job's machine.
#[derive(Clone, Debug, Default, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct AlternativeMachine {
    /// Its name in the shop.
    pub machine: String,
    /// Price of a machine hour, in the same currency.
    #[serde(with = "HourlyRate")]
    pub rate: f64,
    /// The program, minutes.
    #[serde(default, with = "Optional::<DurationMinutes>")]
    pub run_minutes: Option<f64>,
    /// Set-up and alignment of one part, minutes.
    #[serde(default, with = "Optional::<DurationMinutes>")]
    pub setup_minutes: Option<f64>,
    /// An operator stop, from standstill to start, minutes.
    #[serde(default, with = "Optional::<DurationMinutes>")]
    pub stop_minutes: Option<f64>,
    /// A tool change, minutes.
    #[serde(default, with = "Optional::<DurationMinutes>")]
    pub tool_change_minutes: Option<f64>,
}

impl SheetInfo {
    /// Returns the times that the simulation cannot determine.
    pub fn minutes(&self) -> Minutes {
        Minutes { setup: self.setup_minutes, stop: self.stop_minutes, tool_change: self.tool_change_minutes }
    }
}

impl Rates {
    /// Parses a file of rates, which has the keys of a job's `[sheet.rates]`.
    ///
    /// # Errors
    /// A key that is unknown, missing or out of range, with its line and the allowed values.
    pub fn parse(text: &str) -> Result<Self, FileError> {
        Reader { text }.parse()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::job::Job;

    const BURR: &str = "family = \"burr\"\n[burr]\ndiameter = 12.0\nlength = 25.0\nflutes = 16\nhelix = 20.0\n\
                        law = \"published\"\ntip_angle = 5.0\nchord_error = 0.002\n[machine]\nc_offset = [40.0, -15.0]\n";

    fn words(section: &str) -> Result<SheetInfo, String> {
        Job::parse(&format!("{BURR}{section}")).map(|job| job.sheet().clone()).map_err(|e| e.to_string())
    }

    #[test]
    fn a_sheet_may_be_left_out_or_empty() {
        assert_eq!(words("").unwrap(), SheetInfo::default());
        assert_eq!(words("[sheet]\n").unwrap(), SheetInfo::default());
    }

    #[test]
    fn every_key_of_the_sheet_is_read() {
        let words = words(
            "[sheet]\npart = \"Burr <12>\"\nsetup_minutes = 20\nstop_minutes = 0\n[sheet.rates]\ncurrency = \"CNY\"\n\
             rate = 250\n[[sheet.rates.beside]]\nmachine = \"other\"\nrate = 1e3\nrun_minutes = 4.5\n",
        )
        .unwrap();
        assert_eq!((words.part.as_deref(), words.drawing.as_deref()), (Some("Burr <12>"), None));
        assert_eq!(words.minutes(), Minutes { setup: Some(20.0), stop: Some(0.0), tool_change: None });
        let rates = words.rates.unwrap();
        assert_eq!((rates.currency.as_str(), rates.rate), ("CNY", 250.0));
        let other = AlternativeMachine {
            machine: "other".into(),
            rate: 1000.0,
            run_minutes: Some(4.5),
            ..AlternativeMachine::default()
        };
        assert_eq!(rates.alternatives, [other]);
    }

    #[test]
    fn a_refused_key_is_named_with_its_line() {
        for (section, message) in [
            ("[sheet]\nname = \"x\"\n", "line 13: key 'sheet.name' is unknown; allowed: part, drawing"),
            (
                "[sheet]\nsetup_minutes = -1\n",
                "line 13: key 'sheet.setup_minutes' is -1: 0 to 1000000 minutes",
            ),
            ("[sheet.rates]\nrate = 1\n", "line 12: key 'sheet.rates.currency' is missing"),
            (
                "[sheet.rates]\ncurrency = \"EUR\"\nrate = 0\n",
                "line 14: key 'sheet.rates.rate' is 0: 0.01 to 1000000000",
            ),
            (
                "[sheet.rates]\ncurrency = \"EUR\"\nrate = 1\n[[sheet.rates.beside]]\nmachine = \"m\"\n",
                "line 15: key 'sheet.rates.beside.rate' is missing",
            ),
        ] {
            let found = words(section).unwrap_err();
            assert!(found.starts_with(message), "{found}\n{message}");
        }
    }

    #[test]
    fn a_file_of_rates_has_the_same_keys() {
        let text = "currency = \"EUR\"\nrate = 80\n[[beside]]\nmachine = \"5-axis\"\nrate = inf\n";
        let found = Rates::parse(text).unwrap_err().to_string();
        assert_eq!(found, "line 5: key 'beside.rate' is inf: 0.01 to 1000000000");
        assert_eq!(Rates::parse(&text.replace("inf", "200")).unwrap().alternatives[0].rate, 200.0);
    }
}
