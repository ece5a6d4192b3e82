//! `gcode-gen emit`: verifies the programs of a job and writes them into a folder.
use std::path::{Path, PathBuf};

use anstream::adapter::strip_str;
use gcode_draw::{Picture, PictureError, Size};
use gcode_part::job::Job;
use gcode_sim::cli::format::TextFormat;
use gcode_sim::cli::{ExitStatus, UsageError, input, output, overwrite_guard};

use crate::check::{CheckError, CheckedPackage, check};
use crate::families;
use crate::package::{Package, file_name};
use crate::report::EmitReport;

/// A job with its programs and the run in which they pass.
pub(super) struct VerifiedPackage {
    pub job: Job,
    pub package: Package,
    pub checked: CheckedPackage,
}

/// Reasons why programs are not written, as terminal text, and the run in which they fail.
pub(super) struct EmitFailure {
    pub reason: String,
    pub checked: Option<CheckedPackage>,
}

impl EmitFailure {
    /// Returns the reasons without colours.
    pub(super) fn plain(&self) -> String {
        strip_str(self.reason.trim_end()).to_string()
    }
}

/// Reads a job, emits its programs and verifies them; the reasons of a failure are printed.
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

/// Returns files of the family's resident macros in the folder that are not part of this package.
fn stale_files(job: &Job, package: &Package, out: &Path) -> Vec<PathBuf> {
    let resident = (families::of(job).resident)();
    let others = resident.iter().filter(|(_, macros)| package.program(macros.number).is_none());
    others.map(|(_, macros)| out.join(file_name(macros.number))).filter(|path| path.exists()).collect()
}

/// Encodes the pictures as PNG by file name: `O8100.png`, and `O8400-tip.png` for a further view.
pub(super) fn pictures(checked: &CheckedPackage) -> Result<Vec<(String, Vec<u8>)>, UsageError> {
    let refused = |error: PictureError| UsageError::new(error.to_string());
    let size = Size::new(1600, 1200).map_err(refused)?;
    let drawn = |(name, picture): &(String, Picture)| {
        Ok((format!("{name}.png"), gcode_draw::draw(picture, size).map_err(refused)?))
    };
    checked.pictures.iter().map(drawn).collect()
}

/// Creates the folder and its parents.
fn make_folder(out: &Path) -> Result<(), UsageError> {
    let told = |error: &dyn std::fmt::Display| {
        UsageError::new(format!("{} cannot be written: {error}", out.display()))
    };
    if out.exists() && !out.is_dir() {
        return Err(told(&"it is a file; the programs need a folder"));
    }
    std::fs::create_dir_all(out).map_err(|error| told(&error))
}
