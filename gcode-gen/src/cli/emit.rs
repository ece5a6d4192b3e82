//! `gcode-gen emit`: verifies the programs of a job and writes them into a folder.
#![expect(clippy::disallowed_methods, reason = "the command line writes files")]

use std::path::{Path, PathBuf};

use anstream::adapter::strip_str;
use gcode_draw::{FileFormat, Picture, Size};
use gcode_inspect::machine::Machine;
use gcode_part::job::Job;
use gcode_sim::cli::format::TextFormat;
use gcode_sim::cli::{ExitStatus, UsageError, input, output, overwrite_guard, progress};

use super::emitted_files::{self, EmittedFiles};
use crate::check::{CheckError, CheckedPackage, check};
use crate::families;
use crate::package::{MACHINE, Package, file_name};
use crate::report::EmitReport;

/// The programs of a job and their run.
pub(super) struct Emitted {
    pub(super) job: Job,
    pub(super) package: Package,
    /// The run and its verdict; `None` if nothing could be run.
    pub(super) checked: Option<CheckedPackage>,
    /// The reasons why nothing is written, without colours; `None` if the programs pass.
    pub(super) refused: Option<String>,
}

/// Reads a job, emits its programs and verifies them; the reasons of a failure are printed.
pub(super) fn emit_verified(path: &Path) -> Result<Emitted, UsageError> {
    let job = Job::parse(&input::text(path)?).map_err(|error| UsageError::in_toml(path, &error))?;
    let package = families::emit(&job);
    let failure = format!("the programs of {} fail verification", path.display());
    let (checked, refused) = verified(&job, &package, path, &failure)?;
    Ok(Emitted { job, package, checked, refused })
}

/// Verifies the programs; the reasons of a failure are printed and returned, without colours.
fn verified(
    job: &Job,
    package: &Package,
    path: &Path,
    failure: &str,
) -> Result<(Option<CheckedPackage>, Option<String>), UsageError> {
    let name = path.display();
    let checked = progress::of_work("simulating and verifying the programs", || check(job, package));
    let (checked, reasons) = match checked {
        Ok(checked) if checked.refusals.is_empty() => (Some(checked), None),
        Ok(checked) => {
            let reasons = checked.refusals.concat();
            (Some(checked), Some(format!("{reasons}error: nothing is written: {failure}\n")))
        }
        Err(CheckError::Impossible(why)) => {
            (None, Some(format!("error: {why}\nerror: nothing is written for {name}\n")))
        }
        Err(error) => return Err(UsageError::new(error.to_string())),
    };
    reasons.iter().for_each(|reasons| output::print_message(reasons));
    let refused = reasons.map(|reasons| strip_str(reasons.trim_end()).to_string());
    Ok((checked, refused))
}

pub(super) fn run(
    path: &Path,
    out: &Path,
    force: bool,
    format: TextFormat,
) -> Result<ExitStatus, UsageError> {
    let mut result = emit_verified(path)?;
    let emitted = EmittedFiles::of(out)?;
    // A machine file with the data of a person stays, if the programs pass on that machine as well.
    let machine = out.join(MACHINE);
    let kept = if force { None } else { emitted.edited_text(&machine, &result.package.machine)? };
    if let (Some(text), None) = (&kept, &result.refused) {
        Machine::parse(text).map_err(|error| UsageError::in_toml(&machine, &error))?;
        result.package.machine.clone_from(text);
        let failure = emitted_files::failure_with_machine(path, &machine);
        (result.checked, result.refused) = verified(&result.job, &result.package, path, &failure)?;
        if let (Some(checked), None) = (&result.checked, &result.refused)
            && checked.verdict.has_opposite_signs()
        {
            let reasons = format!("{}error: nothing is written: {failure}\n", checked.warnings.concat());
            output::print_message(&reasons);
            result.refused = Some(strip_str(reasons.trim_end()).to_string());
        }
    }
    let Emitted { job, package, checked, refused } = result;
    let (Some(checked), None) = (&checked, &refused) else {
        if format == TextFormat::Json {
            output::json(&EmitReport::new(checked.as_ref(), refused, Vec::new(), Vec::new()))?;
        }
        return Ok(ExitStatus::Failed);
    };
    checked.warnings.iter().for_each(|warning| output::print_message(warning));
    let pictures = pictures(checked)?;
    let texts = package.files();
    let texts = texts.iter().map(|(name, text)| (out.join(name), text.as_bytes()));
    let pictures = pictures.iter().map(|(name, png)| (out.join(name), png.as_slice()));
    let mut files: Vec<(PathBuf, &[u8])> = texts.chain(pictures).collect();
    files.iter().try_for_each(|(file, _)| overwrite_guard::check_not_input(file, &[path]))?;
    files.retain(|(file, _)| kept.is_none() || *file != machine);
    let edited = if force { Vec::new() } else { emitted.edited(&files)? };
    if !edited.is_empty() {
        let refusal = emitted_files::refusal(&edited);
        output::print_message(&refusal);
        if format == TextFormat::Json {
            let refused = Some(refusal.trim_end().to_owned());
            output::json(&EmitReport::new(Some(checked), refused, Vec::new(), Vec::new()))?;
        }
        return Ok(ExitStatus::Failed);
    }
    let (list, digests) = emitted.with(out, &files);
    files.extend(emitted_files::ignored_by_git(out));
    let mut all = files.clone();
    all.push((list, digests.as_bytes()));
    make_folder(out)?;
    output::write_all(&all)?;
    let left_over = stale_files(&job, &package, out);
    let name = |path: &PathBuf| path.display().to_string();
    let written = files.iter().map(|(path, _)| name(path)).collect();
    let left = left_over.iter().map(name).collect();
    let kept = kept.map(|_| name(&machine));
    let report = EmitReport::new(Some(checked), None, written, left).with_proofs(&package).with_kept(kept);
    output::report(&report, EmitReport::text, format)?;
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
    let macros = families::of(job).macros.iter().flat_map(|of_main| *of_main);
    let others = macros.filter(|one| package.program(one.number).is_none());
    others.map(|one| out.join(file_name(one.number))).filter(|path| path.exists()).collect()
}

/// Encodes the pictures as PNG by file name: `O8100.png`, and `O8400-tip.png` for a further view.
pub(super) fn pictures(checked: &CheckedPackage) -> Result<Vec<(String, Vec<u8>)>, UsageError> {
    let size = Size::new(1600, 1200)?;
    let drawn = |(name, picture): &(String, Picture)| {
        Ok((format!("{name}.png"), gcode_draw::draw(picture, size, FileFormat::Png)?))
    };
    checked.pictures.iter().map(drawn).collect()
}

/// Creates the folder and its parents.
fn make_folder(out: &Path) -> Result<(), UsageError> {
    if out.exists() && !out.is_dir() {
        return Err(UsageError::unwritable(out, "it is a file; the programs need a folder"));
    }
    std::fs::create_dir_all(out).map_err(|error| UsageError::unwritable(out, error))
}
