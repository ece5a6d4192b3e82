//! The results of `emit` and `sheet`, as text and as data, and their schemas.
use std::fmt::Write;

use gcode_sim::report::figures::{count, rounded, signed_to};
use gcode_sim::schema::{Format, result};
use schemars::JsonSchema;
use serde::Serialize;

use crate::check::{CheckedPackage, PackageVerdict};
use crate::package::Package;
use crate::proof::report::JobProof;
use crate::proved::{ProvedMacros, not_proved, proved};
use crate::sheet::cost::{Cost, MachineTime};

/// Name of the file by which git leaves out its folder.
pub(crate) const IGNORED_BY_GIT: &str = ".gitignore";

const BASIS: &str = "predicted by simulation, not measured";

/// The schemas of results.
pub const FORMATS: &[Format] = &[
    result::<EmitReport<'_>>("emit", "the result of emit"),
    result::<SheetReport>("sheet", "the result of sheet"),
    result::<JobProof>("prove", "the result of prove"),
];

/// The document of `emit --format json`.
#[derive(Debug, Serialize, JsonSchema)]
pub struct EmitReport<'c> {
    /// Basis of the numbers.
    pub basis: &'static str,
    /// The reason why nothing is written; null if the programs pass verification.
    pub refused: Option<String>,
    /// The files that were written.
    pub written: Vec<String>,
    /// The machine file of the folder, if it has other contents than emit writes: it is kept, and the verdict is with it.
    pub kept: Option<String>,
    /// Macros of an earlier job in the folder that these programs do not call.
    pub left_over: Vec<String>,
    /// Running time without operator stops; null if nothing could be run.
    pub seconds: Option<f64>,
    /// What is proved of the macros as they are written.
    pub proved: Vec<ProvedMacros>,
    /// Macros of which no proof is recorded in this form.
    pub not_proved: Vec<String>,
    /// The result of `verify` for the programs; null for measurements, and if nothing could be run.
    pub verdict: Option<&'c PackageVerdict>,
    #[serde(skip)]
    table: &'c str,
}

impl<'c> EmitReport<'c> {
    /// Builds the report of programs; `checked` is given if they could be run, `refused` if they are not written.
    pub(crate) fn new(
        checked: Option<&'c CheckedPackage>,
        refused: Option<String>,
        written: Vec<String>,
        left_over: Vec<String>,
    ) -> Self {
        let verdict = checked.map(|checked| &checked.verdict);
        Self {
            basis: BASIS,
            refused,
            written,
            kept: None,
            left_over,
            seconds: checked.map(|checked| checked.seconds),
            proved: Vec::new(),
            not_proved: Vec::new(),
            verdict: verdict.filter(|verdict| !matches!(verdict, PackageVerdict::Measured)),
            table: checked.map_or("", |checked| &checked.report),
        }
    }

    /// Adds what is proved of the package's macros.
    pub(crate) fn with_proofs(mut self, package: &Package) -> Self {
        self.proved = proved(package);
        self.not_proved = not_proved(package, &self.proved);
        self
    }

    /// Adds the machine file that is kept.
    pub(crate) fn with_kept(mut self, kept: Option<String>) -> Self {
        self.kept = kept;
        self
    }

    /// Formats the result for a terminal.
    pub(crate) fn text(&self) -> String {
        let mut text = self.table.to_owned();
        let minutes = self.seconds.unwrap_or_default() / 60.0;
        let _ = writeln!(text, "running time {minutes:.0} min without the operator's stops\n");
        for ProvedMacros { macros, says } in &self.proved {
            let _ = writeln!(text, "proved of {}: {says}", macros.join(", "));
        }
        if !self.not_proved.is_empty() {
            let _ = writeln!(
                text,
                "no proof for all values is recorded of {} as written for this job: the verdict holds for its values",
                self.not_proved.join(", ")
            );
        }
        if !self.proved.is_empty() || !self.not_proved.is_empty() {
            text.push('\n');
        }
        for path in &self.written {
            let effect = if path.ends_with(IGNORED_BY_GIT) { " (git leaves the folder out)" } else { "" };
            let _ = writeln!(text, "written: {path}{effect}");
        }
        if let Some(path) = &self.kept {
            let _ = writeln!(text, "kept: {path} (edited, or written by others: the verdict is with it)");
        }
        text
    }
}

/// The document of `sheet --format json`. Times in minutes.
#[derive(Debug, Serialize, JsonSchema)]
pub struct SheetReport {
    /// Basis of the numbers.
    pub basis: &'static str,
    /// The reason why nothing is written; null if the programs pass verification.
    pub refused: Option<String>,
    /// The file that was written.
    pub written: Option<String>,
    /// Time of a part; null if the programs fail verification.
    pub time: Option<TimeReport>,
    /// Costs on the job's machine, then on the alternative machines; empty without a rate.
    pub costs: Vec<CostReport>,
}

/// Time of a part on the job's machine.
#[derive(Debug, Serialize, JsonSchema)]
pub struct TimeReport {
    /// Running time of the program, minutes.
    pub run: f64,
    /// Number of operator stops.
    pub stops: usize,
    /// Number of tool changes.
    pub tool_changes: usize,
    /// Machine time in minutes, including the given times for set-up, stops and tool changes.
    pub all: f64,
    /// The keys of the job's `[sheet]` that are not given and therefore not counted.
    pub not_counted: Vec<&'static str>,
}

/// Cost of a part on one machine.
#[derive(Debug, Serialize, JsonSchema)]
pub struct CostReport {
    /// Name of the machine; null for the job's own.
    pub machine: Option<String>,
    /// Currency of the cost.
    pub currency: String,
    /// Cost of a part.
    pub cost: f64,
    /// Extra cost of the job's own machine in percent, below 0 cheaper; null if not comparable.
    pub change: Option<f64>,
}

impl SheetReport {
    /// Builds the report of a sheet written to a file; costs in one currency, the job's own machine first.
    pub(crate) fn new(written: String, taken: &MachineTime, currency: &str, costs: &[Cost]) -> Self {
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

    /// Builds the report of programs that fail.
    pub(crate) fn refused(refused: Option<String>) -> Self {
        Self { basis: BASIS, refused, written: None, time: None, costs: Vec::new() }
    }

    /// Formats time and money in two or three lines for a terminal.
    pub(crate) fn text(&self) -> String {
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
