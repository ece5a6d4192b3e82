//! `gcode-gen emit`: programs into a folder, after they have been run and held against the job.
use std::fmt::Write;
use std::path::{Path, PathBuf};

use gcode_sim::cli::{Refusal, Status, input, output};
use gcode_sim::job::Job;

use crate::check::{Checked, check};
use crate::families;

pub(super) fn run(path: &Path, out: &Path) -> Result<Status, Refusal> {
    let text = input::text(path)?;
    let job = Job::parse(&text).map_err(|error| Refusal::new(format!("{}, {error}", path.display())))?;
    let package = families::emit(&job);
    let checked = check(&job, &package).map_err(|error| Refusal::new(error.to_string()))?;
    if !checked.refusals.is_empty() {
        let reasons = checked.refusals.concat();
        let job = path.display();
        output::tell(&format!("{reasons}error: nothing is written, for the programs of {job} don't hold\n"));
        return Ok(Status::Fails);
    }
    make_folder(out)?;
    let files: Vec<(PathBuf, &str)> =
        package.files().into_iter().map(|(name, text)| (out.join(name), text)).collect();
    let bytes: Vec<_> = files.iter().map(|(path, text)| (path.as_path(), text.as_bytes())).collect();
    output::write_all(&bytes)?;
    let mut list = String::new();
    for (path, _) in &files {
        let _ = writeln!(list, "{}", path.display());
    }
    output::print(&list)?;
    output::tell(&summary(&checked));
    Ok(Status::Holds)
}

/// The folder, and those it stands in.
fn make_folder(out: &Path) -> Result<(), Refusal> {
    let told =
        |error: &dyn std::fmt::Display| Refusal::new(format!("{} can't be written: {error}", out.display()));
    if out.exists() && !out.is_dir() {
        return Err(told(&"it is a file, and the programs need a folder"));
    }
    std::fs::create_dir_all(out).map_err(|error| told(&error))
}

fn summary(checked: &Checked) -> String {
    let verdict = &checked.verdict;
    let minutes = checked.seconds / 60.0;
    let mut text = format!(
        "{} holes in Φ{} by simulation, {minutes:.0} min without the operator's stops\n",
        verdict.holes.len(),
        verdict.tolerance
    );
    if let (Some(worst), Some(from)) = (verdict.worst, &verdict.worst_from) {
        let _ = writeln!(text, "worst Φ{worst:.4}: {from}");
    }
    text
}
