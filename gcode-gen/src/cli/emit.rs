//! `gcode-gen emit`: programs into a folder, after they have been run and held against the job.
use std::path::{Path, PathBuf};

use anstream::adapter::strip_str;
use gcode_draw::{PictureError, Scene, Size};
use gcode_part::job::Job;
use gcode_sim::cli::format::TextFormat;
use gcode_sim::cli::{ExitStatus, UsageError, input, output, overwrite_guard};

use crate::check::{CheckError, CheckedPackage, check};
use crate::families;
use crate::package::{Package, file_name};
use crate::report::EmitReport;

/// A job, its programs, and the run in which they hold.
pub(super) struct VerifiedPackage {
    pub job: Job,
    pub package: Package,
    pub checked: CheckedPackage,
}

/// Why programs aren't written, as a terminal shows it, and the run in which they don't hold.
pub(super) struct EmitFailure {
    pub reason: String,
    pub checked: Option<CheckedPackage>,
}

impl EmitFailure {
    /// Without colours.
    pub(super) fn plain(&self) -> String {
        strip_str(self.reason.trim_end()).to_string()
    }
}

/// Reads a job, emits its programs and runs them; where they don't hold, why is told.
pub(super) fn emit_verified(path: &Path) -> Result<Result<VerifiedPackage, EmitFailure>, UsageError> {
    let text = input::text(path)?;
    let job = Job::parse(&text).map_err(|error| UsageError::new(format!("{}, {error}", path.display())))?;
    let package = families::emit(&job);
    let refused = |why: String, checked| {
        output::print_message(&why);
        Ok(Err(EmitFailure { reason: why, checked }))
    };
    match check(&job, &package) {
        Ok(checked) if checked.refusals.is_empty() => Ok(Ok(VerifiedPackage { job, package, checked })),
        Ok(checked) => {
            let (reasons, job) = (checked.refusals.concat(), path.display());
            let why =
                format!("{reasons}error: nothing is written: the programs of {job} fail verification\n");
            refused(why, Some(checked))
        }
        Err(CheckError::Impossible(why)) => {
            refused(format!("error: {why}\nerror: nothing is written for {}\n", path.display()), None)
        }
        Err(error) => Err(UsageError::new(error.to_string())),
    }
}

pub(super) fn run(path: &Path, out: &Path, format: TextFormat) -> Result<ExitStatus, UsageError> {
    let VerifiedPackage { job, package, checked } = match emit_verified(path)? {
        Ok(held) => held,
        Err(refused) => {
            if format == TextFormat::Json {
                output::json(&EmitReport::refused(refused.checked.as_ref(), refused.plain()))?;
            }
            return Ok(ExitStatus::Failed);
        }
    };
    checked.warnings.iter().for_each(|warning| output::print_message(warning));
    let pictures = pictures(&checked)?;
    make_folder(out)?;
    let mut files: Vec<(PathBuf, &[u8])> =
        package.files().into_iter().map(|(name, text)| (out.join(name), text.as_bytes())).collect();
    files.extend(pictures.iter().map(|(name, png)| (out.join(name), png.as_slice())));
    files.iter().try_for_each(|(file, _)| overwrite_guard::check_not_input(file, &[path]))?;
    let written: Vec<_> = files.iter().map(|(path, bytes)| (path.as_path(), *bytes)).collect();
    output::write_all(&written)?;
    let left_over = stale_files(&job, &package, out);
    let names = |path: &Path| path.display().to_string();
    let report = EmitReport::new(
        &checked,
        files.iter().map(|(path, _)| names(path)).collect(),
        left_over.iter().map(|path| names(path)).collect(),
    );
    match format {
        TextFormat::Text => output::print(&report.text())?,
        TextFormat::Json => output::json(&report)?,
    }
    for path in left_over {
        output::print_message(&format!(
            "warning: {} is from an earlier job and is not called by the programs just written: remove it, \
             unless another program in the folder calls it, so that it is not loaded with them\n",
            path.display()
        ));
    }
    Ok(ExitStatus::Passed)
}

/// Resident macros of the job's family that stand in the folder and aren't of this package.
fn stale_files(job: &Job, package: &Package, out: &Path) -> Vec<PathBuf> {
    let resident = (families::of(job).resident)();
    let others = resident.iter().filter(|(_, macros)| package.program(macros.number).is_none());
    others.map(|(_, macros)| out.join(file_name(macros.number))).filter(|path| path.exists()).collect()
}

/// What was drawn of it, as PNG by file name: `O8100.png`, and where there are more views `O8400-tip.png`.
pub(super) fn pictures(checked: &CheckedPackage) -> Result<Vec<(String, Vec<u8>)>, UsageError> {
    let refused = |error: PictureError| UsageError::new(error.to_string());
    let size = Size::new(1600, 1200).map_err(refused)?;
    let drawn = |(name, scene): &(String, Scene)| {
        Ok((format!("{name}.png"), gcode_draw::draw(scene, size).map_err(refused)?))
    };
    checked.pictures.iter().map(drawn).collect()
}

/// The folder, and those it stands in.
fn make_folder(out: &Path) -> Result<(), UsageError> {
    let told = |error: &dyn std::fmt::Display| {
        UsageError::new(format!("{} cannot be written: {error}", out.display()))
    };
    if out.exists() && !out.is_dir() {
        return Err(told(&"it is a file; the programs need a folder"));
    }
    std::fs::create_dir_all(out).map_err(|error| told(&error))
}
