//! Runs an emitted package as the control would and verifies its effect against the job's geometry. Only a
//! package that passes is written.
mod alignment;
mod flutes;
mod holes;

use gcode_draw::Picture;
use gcode_inspect::verify::Verdict;
use gcode_inspect::verify::flutes::FluteVerdict;
use gcode_lang::diag::{Diagnostic, Severity};
use gcode_lang::program::Library;
use gcode_lang::source::Sources;
use gcode_part::NominalPart;
use gcode_part::job::Job;
use gcode_sim::report::diagnostic;
use schemars::JsonSchema;
use serde::Serialize;

use crate::package::{Package, Program, file_name};

/// Reasons why a package cannot be verified.
#[derive(Debug, thiserror::Error)]
pub enum CheckError {
    /// No part can have the job's geometry.
    #[error("{0}")]
    Impossible(String),
    /// The package contradicts itself.
    #[error("{0}")]
    Broken(String),
}

/// A package with the results of its run.
#[derive(Debug)]
pub struct CheckedPackage {
    /// Errors that forbid writing it, as text for a terminal; empty if it passes.
    pub refusals: Vec<String>,
    /// Warnings of the verdict, as text for a terminal.
    pub warnings: Vec<String>,
    /// Predicted running time without operator stops, seconds.
    pub seconds: f64,
    /// Report as printed by `verify`.
    pub report: String,
    /// Pictures, each with its file name without `.png`.
    pub pictures: Vec<(String, Picture)>,
    pub verdict: PackageVerdict,
}

/// The verdict, by the kind of part.
#[derive(Debug, Serialize, JsonSchema)]
#[serde(untagged)]
pub enum PackageVerdict {
    Holes(Verdict),
    Flutes(FluteVerdict),
    /// The part is only measured, so that nothing is verified.
    Measured,
}

impl PackageVerdict {
    /// Returns the verdict on holes, if it is one.
    pub fn into_holes(self) -> Option<Verdict> {
        match self {
            Self::Holes(verdict) => Some(verdict),
            Self::Flutes(_) | Self::Measured => None,
        }
    }

    /// Returns the verdict on flutes, if it is one.
    pub fn into_flutes(self) -> Option<FluteVerdict> {
        match self {
            Self::Flutes(verdict) => Some(verdict),
            Self::Holes(_) | Self::Measured => None,
        }
    }
}

/// Simulates the main programs on the machine of the package's own machine file.
pub fn check(job: &Job, package: &Package) -> Result<CheckedPackage, CheckError> {
    if let Job::Alignment(job) = job {
        return alignment::check(job, package);
    }
    if let Job::Burr(burr) = job
        && let Some(why) = crate::families::burr::refusal(burr)
    {
        return Err(CheckError::Impossible(why));
    }
    match NominalPart::from_job(job).map_err(|e| CheckError::Impossible(e.to_string()))? {
        NominalPart::Holes(reference) => holes::check(job, package, &reference),
        NominalPart::Flutes(wanted) => flutes::check(package, &wanted),
    }
}

pub(crate) fn broken_package(what: &str, error: &dyn std::fmt::Display) -> CheckError {
    CheckError::Broken(format!("{what}: {error}"))
}

fn warnings(found: &[Diagnostic], sources: &Sources) -> Vec<String> {
    let told = found.iter().filter(|finding| finding.severity == Severity::Warning);
    told.map(|finding| diagnostic::render(finding, sources)).collect()
}

fn main_program(package: &Package) -> Result<&Program, CheckError> {
    package.main().ok_or_else(|| CheckError::Broken("the main program was not emitted".to_owned()))
}

/// The package's programs as the control's program memory.
pub struct Programs<'p>(pub &'p Package);

impl Library for Programs<'_> {
    fn program(&mut self, number: u32) -> Option<(String, Vec<u8>)> {
        let program = self.0.program(number)?;
        Some((file_name(number), program.text.as_bytes().to_vec()))
    }
}
