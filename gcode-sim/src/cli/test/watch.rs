//! `gcode-sim test --watch`: re-runs the cases affected by a saved file, until Ctrl-C.
#![expect(clippy::disallowed_methods, reason = "the command line watches files")]

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::time::{Duration, SystemTime};

use super::{Arguments, all, case, cases};
use crate::cli::{ExitStatus, UsageError, output, project};
use crate::report::test_report::TestReport;

/// Interval between two checks of the files.
const PAUSE: Duration = Duration::from_millis(250);

/// Time of the last write and length of each file.
type Stamps = BTreeMap<PathBuf, (Option<SystemTime>, u64)>;

/// Prints the results of all cases, then of those affected by each saved file. Returns only if printing
/// fails.
pub(super) fn run(arguments: &Arguments, tolerance: f64) -> Result<ExitStatus, UsageError> {
    let folders = || arguments.folders.iter().chain(&arguments.libraries);
    let mut stamps = stamps(folders());
    let mut changed: Option<Vec<PathBuf>> = None;
    // A misspelt folder is reported at once.
    cases(arguments)?;
    loop {
        match round(arguments, tolerance, changed.as_deref()) {
            Ok(text) => output::print(&text)?,
            // A folder may be absent while it is replaced.
            Err(refusal) => output::print_message(&format!("error: {refusal}\n")),
        }
        let now = next(&stamps, || self::stamps(folders()));
        changed = Some(differing(&stamps, &now));
        stamps = now;
    }
}

/// Runs the cases whose folders contain the changed files, or all cases if a changed file is elsewhere.
fn round(arguments: &Arguments, tolerance: f64, changed: Option<&[PathBuf]>) -> Result<String, UsageError> {
    let (shard, mut cases) = cases(arguments)?;
    let mut text = String::new();
    if let Some(changed) = changed {
        let of = |case: &case::Case| changed.iter().any(|path| path.starts_with(&case.folder));
        let is_of_case = |path: &PathBuf| cases.iter().any(|case| path.starts_with(&case.folder));
        let all_of_cases = changed.iter().all(is_of_case);
        let names: Vec<String> = changed.iter().take(3).map(|path| path.display().to_string()).collect();
        let more = if changed.len() > 3 { format!(" and {} more", changed.len() - 3) } else { String::new() };
        text.push_str(&format!("\nsaved: {}{more}\n", names.join(", ")));
        if all_of_cases {
            cases.retain(of);
        }
    }
    let tried = all(&cases, arguments.terms(tolerance));
    let report =
        TestReport::new(shard, tolerance, tried.into_iter().map(|tried| tried.report).collect(), Vec::new());
    text.push_str(&report.text());
    Ok(text)
}

/// Waits until the stamps differ from `old` and are stable for one interval: an editor may write in several
/// steps.
fn next(old: &Stamps, look: impl Fn() -> Stamps) -> Stamps {
    let mut last = look();
    loop {
        std::thread::sleep(PAUSE);
        let now = look();
        if now == last && now != *old {
            return now;
        }
        last = now;
    }
}

fn differing(old: &Stamps, new: &Stamps) -> Vec<PathBuf> {
    let gone = old.keys().filter(|path| !new.contains_key(*path));
    let written = new.iter().filter(|(path, stamp)| old.get(*path) != Some(stamp)).map(|(path, _)| path);
    gone.chain(written).cloned().collect()
}

/// Returns the stamps of all files in the folders and below them, and of the projects' files above them.
fn stamps<'a>(folders: impl Iterator<Item = &'a PathBuf>) -> Stamps {
    let mut found = Stamps::new();
    let mut left: Vec<PathBuf> = folders.cloned().collect();
    for path in left.iter().filter_map(|folder| project::file_for(folder)) {
        if let Ok(about) = std::fs::metadata(&path) {
            found.insert(path, (about.modified().ok(), about.len()));
        }
    }
    let mut seen = BTreeSet::new();
    while let Some(folder) = left.pop() {
        // A link may lead back to a parent folder.
        if folder.canonicalize().is_ok_and(|path| !seen.insert(path)) {
            continue;
        }
        let entries = std::fs::read_dir(Path::new(&folder)).into_iter().flatten().flatten();
        for entry in entries {
            let path = entry.path();
            match std::fs::metadata(&path) {
                Ok(about) if about.is_dir() => left.push(path),
                Ok(about) => _ = found.insert(path, (about.modified().ok(), about.len())),
                // The file was deleted between the two calls.
                Err(_) => {}
            }
        }
    }
    found
}
