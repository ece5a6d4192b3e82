//! What `emit` and `sheet` answer, as text and as data, and the schemas of that.
use std::fmt::Write;

use gcode_sim::report::figures::{count, rounded, signed_to};
use gcode_sim::schema::{Format, result};
use schemars::JsonSchema;
use serde::Serialize;

use crate::check::{CheckedPackage, PackageVerdict};
use crate::sheet::cost::{Cost, MachineTime};

const BASIS: &str = "predicted by simulation, not measured";

/// The schemas of results.
pub const FORMATS: &[Format] = &[
    result::<EmitReport<'_>>("emit", "the result of emit"),
    result::<SheetReport>("sheet", "the result of sheet"),
];

/// The document of `emit --format json`.
#[derive(Debug, Serialize, JsonSchema)]
pub struct EmitReport<'c> {
    /// Says what kind of numbers these are.
    pub basis: &'static str,
    /// Why nothing is written, in words; null where the programs hold.
    pub refused: Option<String>,
    /// The files.
    pub written: Vec<String>,
    /// Macros of an earlier job in the folder, which these programs don't call.
    pub left_over: Vec<String>,
    /// Running time, operator stops left out; null where nothing could be run.
    pub seconds: Option<f64>,
    /// What `verify` says of the programs; null of measurements, and where nothing could be run.
    pub verdict: Option<&'c PackageVerdict>,
    #[serde(skip)]
    table: &'c str,
}

impl<'c> EmitReport<'c> {
    /// Of programs that hold.
    pub fn new(checked: &'c CheckedPackage, written: Vec<String>, left_over: Vec<String>) -> Self {
        Self { written, left_over, ..Self::of(Some(checked), None) }
    }

    /// Of programs that aren't written; `checked` where they could be run.
    pub fn refused(checked: Option<&'c CheckedPackage>, why: String) -> Self {
        Self::of(checked, Some(why))
    }

    fn of(checked: Option<&'c CheckedPackage>, refused: Option<String>) -> Self {
        Self {
            basis: BASIS,
            refused,
            written: Vec::new(),
            left_over: Vec::new(),
            seconds: checked.map(|checked| checked.seconds),
            verdict: checked
                .map(|checked| &checked.verdict)
                .filter(|of| !matches!(of, PackageVerdict::Measured)),
            table: checked.map_or("", |checked| &checked.report),
        }
    }

    /// The same for people.
    pub fn text(&self) -> String {
        let mut text = self.table.to_owned();
        let minutes = self.seconds.unwrap_or_default() / 60.0;
        let _ = writeln!(text, "running time {minutes:.0} min without the operator's stops\n");
        for path in &self.written {
            let _ = writeln!(text, "written: {path}");
        }
        text
    }
}

/// The document of `sheet --format json`. Times in minutes.
#[derive(Debug, Serialize, JsonSchema)]
pub struct SheetReport {
    /// Says what kind of numbers these are.
    pub basis: &'static str,
    /// Why nothing is written, in words; null where the programs hold.
    pub refused: Option<String>,
    /// The file.
    pub written: Option<String>,
    /// What a part takes; null where the programs don't hold.
    pub time: Option<TimeReport>,
    /// On the job's machine first, then on those beside it; none where no rate was given.
    pub costs: Vec<CostReport>,
}

/// What a part takes on the job's machine.
#[derive(Debug, Serialize, JsonSchema)]
pub struct TimeReport {
    /// The program, minutes.
    pub run: f64,
    pub stops: usize,
    pub tool_changes: usize,
    /// The machine is taken for so many minutes: what was given for set-up, stops and tool changes included.
    pub all: f64,
    /// The keys of the job's `[sheet]` that aren't given and so aren't counted.
    pub not_counted: Vec<&'static str>,
}

/// What a part costs on one machine.
#[derive(Debug, Serialize, JsonSchema)]
pub struct CostReport {
    /// Null for the job's own.
    pub machine: Option<String>,
    pub currency: String,
    pub cost: f64,
    /// By how many percent of it the job's own machine is dearer, below 0 cheaper; null where that can't be compared.
    pub change: Option<f64>,
}

impl SheetReport {
    /// Of a sheet that is written to a file; costs in one currency, the job's own machine first.
    pub fn new(written: String, taken: &MachineTime, currency: &str, costs: &[Cost]) -> Self {
        let cost = |cost: &Cost| CostReport {
            machine: cost.machine.clone(),
            currency: currency.to_owned(),
            cost: cost.cost(),
            change: cost.machine.as_ref().and_then(|_| costs[0].change(cost)),
        };
        let time = TimeReport {
            run: taken.run,
            stops: taken.stops,
            tool_changes: taken.tool_changes,
            all: taken.total(),
            not_counted: taken.not_counted(),
        };
        let costs = costs.iter().map(cost).collect();
        Self { basis: BASIS, refused: None, written: Some(written), time: Some(time), costs }
    }

    /// Of programs that don't hold.
    pub fn refused(why: String) -> Self {
        Self { basis: BASIS, refused: Some(why), written: None, time: None, costs: Vec::new() }
    }

    /// The same for people: time and money in two or three lines.
    pub fn text(&self) -> String {
        let mut text = String::new();
        if let Some(TimeReport { run, stops, tool_changes, all, .. }) = &self.time {
            let (stops, changes) = (count(*stops, "operator stop"), count(*tool_changes, "tool change"));
            let (run, hours) = (rounded(*run, 1), rounded(all / 60.0, 2));
            let basis = self.basis;
            let _ = writeln!(text, "run {run} min, {stops}, {changes}: {hours} machine hours; {basis}");
        }
        if self.costs.is_empty() {
            text.push_str("no rate given: the sheet shows time only\n");
        }
        for CostReport { machine, currency, cost, change } in &self.costs {
            let price = format!("{} {currency} a part", rounded(*cost, 2));
            let _ = match (machine, change) {
                (None, _) => writeln!(text, "{price}"),
                (Some(machine), Some(change)) => {
                    writeln!(text, "{price} on {machine}; this job {} %", signed_to(*change, 1))
                }
                (Some(machine), None) => {
                    writeln!(text, "{price} on {machine}; not compared: a time is given for one of them only")
                }
            };
        }
        if let Some(path) = &self.written {
            let _ = writeln!(text, "written: {path}");
        }
        text
    }
}
