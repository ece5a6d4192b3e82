//! `gcode-sim test --merge`: merges the results of shards that ran on separate machines.
use std::collections::BTreeSet;
use std::path::PathBuf;

use crate::cli::{UsageError, input};
use crate::report::test_report::TestReport;

/// Merges the results, with the cases in the order of their names. A missing shard is refused, because its
/// cases would look unchanged; so is a duplicated case.
pub(super) fn merged(files: &[PathBuf]) -> Result<TestReport, UsageError> {
    let mut reports = Vec::with_capacity(files.len());
    for file in files {
        let refused = |why: &dyn std::fmt::Display| UsageError::new(format!("{}: {why}", file.display()));
        let report: TestReport =
            serde_json::from_str(&input::text(file)?).map_err(|error| refused(&error))?;
        if report.shard.is_some_and(|shard| !(1..=shard.of).contains(&shard.number)) {
            return Err(refused(&"a shard number is 1 to the number of shards"));
        }
        reports.push(report);
    }
    complete(&reports)?;
    let tolerance = same_tolerance(&reports)?;
    let accepted = reports.iter_mut().flat_map(|report| std::mem::take(&mut report.accepted)).collect();
    let cases = reports.into_iter().flat_map(|report| report.cases).collect();
    let report = TestReport::new(None, tolerance, cases, accepted);
    if let Some([first, _]) = report.cases.array_windows().find(|[a, b]| a.name == b.name) {
        return Err(UsageError::new(format!("case {} is in two of the results", first.name)));
    }
    Ok(report)
}

/// Returns the common tolerance of all results; results with different tolerances cannot be merged.
fn same_tolerance(reports: &[TestReport]) -> Result<f64, UsageError> {
    let first = reports.first().map_or(0.0, |report| report.tolerance);
    match reports.iter().find(|report| report.tolerance != first) {
        None => Ok(first),
        Some(other) => Err(UsageError::new(format!(
            "--merge: some results were made with --tolerance {first} and some with {}: run all shards with one",
            other.tolerance
        ))),
    }
}

/// Checks that all shards of one collection are present.
fn complete(reports: &[TestReport]) -> Result<(), UsageError> {
    let shards: Vec<_> = reports.iter().filter_map(|report| report.shard).collect();
    let Some(first) = shards.first() else { return Ok(()) };
    let is_alike =
        |shard: &crate::report::test_report::Shard| (shard.of, shard.cases) == (first.of, first.cases);
    if shards.len() < reports.len() || !shards.iter().all(is_alike) {
        return Err(UsageError::new("--merge: these are not shards of one collection of cases"));
    }
    let there: BTreeSet<usize> = shards.iter().map(|shard| shard.number).collect();
    let missing: Vec<String> =
        (1..=first.of).filter(|k| !there.contains(k)).map(|k| format!("{k}/{}", first.of)).collect();
    if !missing.is_empty() {
        return Err(UsageError::new(format!(
            "--merge: the results of --shard {} are missing",
            missing.join(", ")
        )));
    }
    let cases: usize = reports.iter().map(|report| report.cases.len()).sum();
    if cases != first.cases {
        let message =
            format!("--merge: {cases} cases of {}: a shard is incomplete or duplicated", first.cases);
        return Err(UsageError::new(message));
    }
    Ok(())
}
