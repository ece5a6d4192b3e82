//! `gcode-sim test`: runs a folder of programs and compares each with its accepted result.
mod case;
mod claims;
mod find;
mod main_program;
mod merge;
mod other_endings;
mod watch;

use std::path::PathBuf;
use std::sync::atomic::{AtomicUsize, Ordering};

use clap::Args;

use self::case::{Case, CaseResult, Terms};
pub(super) use self::find::reference_beside;
use super::conditions::DenyArguments;
use super::format::TestFormat;
use super::options::EqualityArguments;
use super::{ExitStatus, UsageError, output, progress};
use crate::report::junit;
use crate::report::test_report::{CaseAnswer, Shard, TestReport};
use gcode_review::Record;

#[derive(Debug, Args)]
pub(super) struct Arguments {
    /// Folders with cases, at any depth
    #[arg(value_name = "DIR", required_unless_present = "merge")]
    folders: Vec<PathBuf>,

    /// A folder that holds called programs, after each case's own folders (repeatable)
    #[arg(long = "lib", value_name = "DIR")]
    libraries: Vec<PathBuf>,

    /// Only cases with this text in their names (repeatable)
    #[arg(long, value_name = "NAME")]
    only: Vec<String>,

    /// Only the K-th of N parts of the cases
    #[arg(long, value_name = "K/N")]
    shard: Option<String>,

    /// Merge the JSON results of all shards instead of running or accepting anything
    #[arg(long, value_name = "RESULT.json", num_args = 1.., conflicts_with_all = ["folders", "libraries", "only", "shard", "accept"])]
    merge: Vec<PathBuf>,

    /// Accept the current results: write accepted.json for each case, except where a called program is not found
    #[arg(long)]
    accept: bool,

    /// Prove all claims of claims.toml, also those that claims.lock records as proved
    #[arg(long)]
    prove_all: bool,

    /// Re-run affected cases when a file is saved, until Ctrl-C; writes text, and accepts nothing
    #[arg(long, conflicts_with_all = ["accept", "format", "merge"])]
    watch: bool,

    #[command(flatten)]
    deny: DenyArguments,

    #[command(flatten)]
    equality: EqualityArguments,

    /// Output format
    #[arg(long, value_enum, default_value_t = TestFormat::Text)]
    format: TestFormat,
}

impl Arguments {
    fn terms(&self, tolerance: f64) -> Terms<'_> {
        Terms {
            libraries: &self.libraries,
            tolerance,
            denies_assumptions: self.deny.denies_assumptions(),
            proves_all: self.prove_all,
        }
    }
}

pub(super) fn run(arguments: &Arguments) -> Result<ExitStatus, UsageError> {
    let tolerance = arguments.equality.tolerance()?;
    if arguments.watch {
        return watch::run(arguments, tolerance);
    }
    let report = match arguments.merge.as_slice() {
        [] => run_cases(arguments, tolerance)?,
        files => merge::merged(files)?,
    };
    print(&report, arguments.format)?;
    if arguments.format != TestFormat::Text {
        // A build server keeps the document in a file; its log has to state the error.
        report.refused().for_each(|why| output::print_message(&format!("error: {why}\n")));
    }
    let is_refused = report.cases.iter().any(|case| case.answer == CaseAnswer::Refused);
    Ok(match report.cases.iter().all(|case| case.is_good()) {
        true => ExitStatus::Passed,
        false if is_refused => ExitStatus::Invalid,
        false => ExitStatus::Failed,
    })
}

fn print(report: &TestReport, format: TestFormat) -> Result<(), UsageError> {
    match format {
        TestFormat::Json => output::json(report),
        TestFormat::Text => output::print(&report.text()),
        TestFormat::Junit => {
            let document = junit::document(report);
            output::print(&document.map_err(|why| UsageError::new(format!("no JUnit XML: {why}")))?)
        }
        TestFormat::Sarif => output::sarif(report.findings(), None),
    }
}

fn run_cases(arguments: &Arguments, tolerance: f64) -> Result<TestReport, UsageError> {
    let (shard, cases) = cases(arguments)?;
    let mut tried = all(&cases, arguments.terms(tolerance));
    let accepted = if arguments.accept { accept(&cases, &mut tried)? } else { Vec::new() };
    Ok(TestReport::new(shard, tolerance, tried.into_iter().map(|tried| tried.report).collect(), accepted))
}

/// Returns the selected cases, and the shard that they form.
fn cases(arguments: &Arguments) -> Result<(Option<Shard>, Vec<Case>), UsageError> {
    let mut cases = find::cases(&arguments.folders)?;
    if cases.is_empty() {
        return Err(UsageError::new("no cases: a case is a folder with a program (.nc)"));
    }
    if !arguments.only.is_empty() {
        cases.retain(|case| arguments.only.iter().any(|part| case.name.contains(part.as_str())));
        if cases.is_empty() {
            return Err(UsageError::new(format!(
                "no case has '{}' in its name",
                arguments.only.join("' or '")
            )));
        }
    }
    let Some(text) = &arguments.shard else { return Ok((None, cases)) };
    let (number, of) = shard(text)?;
    let shard = Shard { number, of, cases: cases.len() };
    Ok((Some(shard), cases.into_iter().skip(number - 1).step_by(of).collect()))
}

/// Parses `2/4`: the second of four shards.
fn shard(text: &str) -> Result<(usize, usize), UsageError> {
    let parts =
        text.split_once('/').and_then(|(k, n)| Some((k.trim().parse().ok()?, n.trim().parse().ok()?)));
    parts
        .filter(|(number, of)| (1..=*of).contains(number))
        .ok_or_else(|| UsageError::new(format!("--shard {text}: write K/N; the second of four parts is 2/4")))
}

/// Runs the cases on all cores, each of which takes the next case until none is left; the results are in the order
/// of the cases.
fn all(cases: &[Case], terms: Terms<'_>) -> Vec<CaseResult> {
    let (next, counted) = (AtomicUsize::new(0), AtomicUsize::new(0));
    let work = || {
        let mut done = Vec::new();
        loop {
            let index = next.fetch_add(1, Ordering::Relaxed);
            let Some(case) = cases.get(index) else { return done };
            done.push((index, case.run(terms)));
            counted.fetch_add(1, Ordering::Relaxed);
        }
    };
    let workers = std::thread::available_parallelism().map_or(1, usize::from).min(cases.len());
    let run = || {
        std::thread::scope(|scope| {
            let workers: Vec<_> = (0..workers).map(|_| scope.spawn(work)).collect();
            let joined = workers.into_iter().map(|worker| worker.join());
            joined.flat_map(|done| done.unwrap_or_else(|panic| std::panic::resume_unwind(panic))).collect()
        })
    };
    let mut results: Vec<(usize, CaseResult)> = progress::of_cases(cases.len(), &counted, run);
    results.sort_by_key(|(index, _)| *index);
    results.into_iter().map(|(_, result)| result).collect()
}

/// Writes the results as the accepted ones, all files or none.
fn accept(cases: &[Case], tried: &mut [CaseResult]) -> Result<Vec<String>, UsageError> {
    let mut files = Vec::new();
    let mut names = Vec::new();
    for (case, CaseResult { report, record, lock }) in cases.iter().zip(tried.iter_mut()) {
        files.extend(lock.take());
        let is_other = report.answer != CaseAnswer::Same;
        let is_taken = |record: &&Record| is_other && !record.lacks_program();
        let Some(record) = record.as_ref().filter(is_taken) else { continue };
        let text = record.to_json().map_err(|error| UsageError::new(error.to_string()))?;
        files.push((case.accepted(), text));
        names.push(report.name.clone());
        report.answer = CaseAnswer::Same;
        report.changes.clear();
        report.not_compared.clear();
    }
    output::write_all(&files)?;
    Ok(names)
}
