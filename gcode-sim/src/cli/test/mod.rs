//! `gcode-sim test`: a shop's own programs, each held against what was accepted of it.
mod case;

use std::path::PathBuf;
use std::sync::atomic::{AtomicUsize, Ordering};

use clap::Args;

use self::case::{ACCEPTED, Case, Tested, Tried};
use super::args::TextFormat;
use super::{Refusal, Status, options, output};
use crate::report::tested::{CaseReport, TestReport};

#[derive(Debug, Args)]
pub(super) struct TestArguments {
    /// Folders with cases, at any depth
    #[arg(value_name = "DIR", required = true)]
    folders: Vec<PathBuf>,

    /// A folder that holds called programs, after each case's own folders (repeatable)
    #[arg(long = "lib", value_name = "DIR")]
    libraries: Vec<PathBuf>,

    /// Only cases with this in their names (repeatable)
    #[arg(long, value_name = "NAME")]
    only: Vec<String>,

    /// Only the K-th of N parts of the cases
    #[arg(long, value_name = "K/N")]
    shard: Option<String>,

    /// Accept what came of the cases: write their accepted.json
    #[arg(long)]
    accept: bool,

    /// What differs by no more than this is the same, mm or degrees
    #[arg(long, value_name = "MM", default_value_t = 0.0001, allow_negative_numbers = true)]
    tolerance: f64,

    /// How the result is written
    #[arg(long, value_enum, default_value_t = TextFormat::Text)]
    format: TextFormat,
}

pub(super) fn run(arguments: &TestArguments) -> Result<Status, Refusal> {
    let tolerance = options::tolerance("--tolerance", Some(arguments.tolerance))?.unwrap_or_default();
    let mut cases = Vec::new();
    for folder in &arguments.folders {
        let mut found = case::find(folder)?;
        if arguments.folders.len() > 1 {
            found.iter_mut().for_each(|case| case.name = format!("{}/{}", folder.display(), case.name));
        }
        cases.extend(found);
    }
    if cases.is_empty() {
        return Err(Refusal::new("no cases: a case is a folder with a program (.nc)"));
    }
    if !arguments.only.is_empty() {
        cases.retain(|case| arguments.only.iter().any(|part| case.name.contains(part.as_str())));
        if cases.is_empty() {
            return Err(Refusal::new(format!("no case has a name with '{}'", arguments.only.join("' or '"))));
        }
    }
    if let Some(text) = &arguments.shard {
        let (number, of) = shard(text)?;
        cases = cases.into_iter().skip(number - 1).step_by(of).collect();
    }
    let mut tried = all(&cases, arguments, tolerance);
    let accepted = if arguments.accept { accept(&cases, &mut tried)? } else { Vec::new() };
    let report = TestReport::new(tried.iter().map(reported), accepted);
    match arguments.format {
        TextFormat::Json => output::json(&report)?,
        TextFormat::Text => output::print(&report.text())?,
    }
    let refused = tried.iter().any(|tried| matches!(tried.answer, Tested::Refused(_)));
    Ok(match tried.iter().all(Tried::is_good) {
        true => Status::Holds,
        false if refused => Status::Refused,
        false => Status::Fails,
    })
}

/// `2/4`: the second of four parts.
fn shard(text: &str) -> Result<(usize, usize), Refusal> {
    let parts =
        text.split_once('/').and_then(|(k, n)| Some((k.trim().parse().ok()?, n.trim().parse().ok()?)));
    parts
        .filter(|(number, of)| (1..=*of).contains(number))
        .ok_or_else(|| Refusal::new(format!("--shard {text}: write K/N, the second of four parts is 2/4")))
}

/// Runs the cases on all cores; the answers are in the order of the cases.
fn all(cases: &[Case], arguments: &TestArguments, tolerance: f64) -> Vec<Tried> {
    let next = AtomicUsize::new(0);
    let work = || {
        let mut done = Vec::new();
        loop {
            let index = next.fetch_add(1, Ordering::Relaxed);
            let Some(case) = cases.get(index) else { return done };
            done.push((index, case.run(&arguments.libraries, tolerance)));
        }
    };
    let workers = std::thread::available_parallelism().map_or(1, usize::from).min(cases.len());
    let mut tried: Vec<(usize, Tried)> = std::thread::scope(|scope| {
        let workers: Vec<_> = (0..workers).map(|_| scope.spawn(work)).collect();
        let join = |worker: std::thread::ScopedJoinHandle<'_, Vec<(usize, Tried)>>| match worker.join() {
            Ok(done) => done,
            Err(panic) => std::panic::resume_unwind(panic),
        };
        workers.into_iter().flat_map(join).collect()
    });
    tried.sort_by_key(|(index, _)| *index);
    tried.into_iter().map(|(_, tried)| tried).collect()
}

/// Writes what came of the cases as what is accepted of them, all files or none.
fn accept(cases: &[Case], tried: &mut [Tried]) -> Result<Vec<String>, Refusal> {
    let mut files = Vec::new();
    let mut names = Vec::new();
    for (case, tried) in cases.iter().zip(tried.iter_mut()) {
        let Some(record) = tried.record.as_ref().filter(|_| !matches!(tried.answer, Tested::Same)) else {
            continue;
        };
        let text = record.to_json().map_err(|error| Refusal::new(error.to_string()))?;
        files.push((case.folder.join(ACCEPTED), text.into_bytes()));
        names.push(tried.name.clone());
        tried.answer = Tested::Same;
    }
    let files: Vec<_> = files.iter().map(|(path, bytes)| (path.as_path(), bytes.as_slice())).collect();
    output::write_all(&files)?;
    Ok(names)
}

fn reported(tried: &Tried) -> CaseReport {
    let (answer, changes, error) = match &tried.answer {
        Tested::Same => ("same", Vec::new(), None),
        Tested::Changed(changes) => ("changed", changes.clone(), None),
        Tested::New => ("new", Vec::new(), None),
        Tested::Refused(why) => ("refused", Vec::new(), Some(why.clone())),
    };
    CaseReport {
        name: tried.name.clone(),
        answer,
        changes,
        against: tried.against.clone(),
        error,
        totals: tried.record.as_ref().map(|record| record.totals.clone()),
        ending: tried.record.as_ref().map(|record| record.words().to_owned()),
    }
}
