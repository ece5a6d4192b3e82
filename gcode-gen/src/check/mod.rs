//! Runs an emitted package as the control would and verifies its effect against the job's geometry. Only a
//! package that passes is written.
mod alignment;

use gcode_draw::Picture;
use gcode_inspect::findings::AXIS_SIGNS;
use gcode_inspect::machine::Machine;
use gcode_inspect::verify::flutes::FluteVerdict;
use gcode_inspect::verify::{Answer, Verdict};
use gcode_lang::diag::{Diagnostic, Severity};
use gcode_lang::program::Library;
use gcode_lang::source::Bytes;
use gcode_part::job::Job;
use gcode_part::{Flutes, NominalPart, Reference, exceeds, overlaps};
use gcode_session::{Criteria, Request, Run, judge_flutes, judge_holes};
use gcode_sim::report::verdict_table::{Layout, table};
use gcode_sim::report::{diagnostic, flute_table, flute_view, top};
use schemars::JsonSchema;
use serde::Serialize;

use crate::package::{Package, file_name, stem};

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
    /// The verdict.
    pub verdict: PackageVerdict,
}

/// The verdict, by the kind of part.
#[derive(Debug, Serialize, JsonSchema)]
#[serde(untagged)]
pub enum PackageVerdict {
    /// The part has holes.
    Holes(Verdict),
    /// The part has flutes.
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

    /// Returns true if the machine gives an axis the other sign than the job: a symmetric part passes on both.
    pub fn has_opposite_signs(&self) -> bool {
        let findings = match self {
            Self::Holes(verdict) => &verdict.findings,
            Self::Flutes(verdict) => &verdict.findings,
            Self::Measured => return false,
        };
        findings.iter().any(|finding| finding.kind == &AXIS_SIGNS)
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
///
/// # Errors
/// [`CheckError`] if no part can have the job's geometry, or the package contradicts itself.
pub fn check(job: &Job, package: &Package) -> Result<CheckedPackage, CheckError> {
    if let Job::Alignment(job) = job {
        return alignment::check(job, package);
    }
    if let Job::Burr(burr) = job
        && let Some(why) = crate::families::burr::refusal(burr)
    {
        return Err(CheckError::Impossible(why));
    }
    let nominal = NominalPart::from_job(job).map_err(|e| CheckError::Impossible(e.to_string()))?;
    let machine = Machine::parse(&package.machine).map_err(|e| broken_package("machine.toml", &e))?;
    let main = package.main();
    let main = main.ok_or_else(|| CheckError::Broken("the main program was not emitted".to_owned()))?;
    let request = Request::new(file_name(main.number), main.text.as_bytes(), machine);
    match nominal {
        NominalPart::Holes(reference) => check_holes(job, package, request, &stem(main.number), &reference),
        NominalPart::Flutes(flutes) => check_flutes(package, &request, &stem(main.number), &flutes),
    }
}

fn check_holes(
    job: &Job,
    package: &Package,
    request: Request,
    stem: &str,
    reference: &Reference,
) -> Result<CheckedPackage, CheckError> {
    let judged = judge_holes(&request, &mut Programs(package), Criteria::of(reference), &mut (), &mut ());
    let (simulation, verdict) = judged.map_err(|e| broken_package("the main program", &e))?;
    let top = top::of_verdict(&request.name, &simulation, reference, &verdict, &request.machine);
    let mut also = Vec::new();
    // A pattern checks for overlaps before it computes any holes.
    if reference.pattern.is_none() {
        let cut = overlaps(&reference.holes);
        also.extend(cut.iter().map(|overlap| format!("error: {}\n", overlap.sentence(&reference.holes))));
    }
    also.extend(rounding_messages(&verdict, job.control().increment.size()));
    let (refusals, mut warnings) = messages(&verdict.diagnostics, &simulation.run, also, verdict.verdict);
    warnings.extend(pivot_warning(job));
    Ok(CheckedPackage {
        refusals,
        warnings,
        seconds: simulation.run.control.seconds().0,
        report: table(&verdict, Layout::default()),
        pictures: vec![(stem.to_owned(), gcode_draw::main_view(&top))],
        verdict: PackageVerdict::Holes(verdict),
    })
}

/// Returns the warning on a head whose pivot is at the gauge line of tools with lengths: the simulation has the same pivot, so
/// no hole shows a wrong one.
fn pivot_warning(job: &Job) -> Option<String> {
    let Job::PinHoles(job) = job else { return None };
    let tool = job.tools.iter().find(|tool| tool.length != 0.0).filter(|_| job.machine.head.pivot == 0.0)?;
    Some(format!(
        "warning: key 'machine.head.pivot' is 0 and tool {} has a length of {} mm: no real head has its pivot at the gauge \
         line; give the distance from the pivot to it, or length 0 to every tool whose tip is set by hand\n",
        tool.number, tool.length
    ))
}

fn check_flutes(
    package: &Package,
    request: &Request,
    stem: &str,
    nominal: &Flutes,
) -> Result<CheckedPackage, CheckError> {
    let (grinding, verdict) = judge_flutes(request, &mut Programs(package), nominal)
        .map_err(|e| broken_package("the main program", &e))?;
    let view = flute_view::of(&request.name, &grinding, &verdict);
    let (refusals, warnings) = messages(&verdict.diagnostics, &grinding.run, Vec::new(), verdict.verdict);
    Ok(CheckedPackage {
        refusals,
        warnings,
        seconds: grinding.run.control.seconds().0,
        report: flute_table::table(&verdict),
        pictures: vec![
            (stem.to_owned(), gcode_draw::side_view(&view)),
            (format!("{stem}-tip"), gcode_draw::tip_view(&view)),
            (format!("{stem}-helix"), gcode_draw::helix_graph(&view)),
        ],
        verdict: PackageVerdict::Flutes(verdict),
    })
}

/// Returns the refusals, every error with its block and then `also`, and the warnings.
fn messages(
    findings: &[Diagnostic],
    run: &Run,
    also: Vec<String>,
    answer: Answer,
) -> (Vec<String>, Vec<String>) {
    let rendered = |is_chosen: &dyn Fn(Severity) -> bool| {
        let chosen = findings.iter().filter(|finding| is_chosen(finding.severity));
        chosen.map(|finding| diagnostic::render(finding, run.control.memory().sources())).collect::<Vec<_>>()
    };
    let mut refusals = rendered(&|severity| Severity::Error <= severity);
    refusals.extend(also);
    if refusals.is_empty() && answer == Answer::Fail {
        refusals.push("the programs fail the job's reference\n".to_owned());
    }
    (refusals, rendered(&|severity| severity == Severity::Warning))
}

/// Returns the share of rounding in position errors that are too large because of it.
fn rounding_messages(verdict: &Verdict, increment: f64) -> impl Iterator<Item = String> {
    let tolerance = verdict.tolerance;
    let failed = verdict.holes.iter().filter(move |hole| exceeds(hole.position_deviation, tolerance));
    let by_rounding = failed
        .filter(move |hole| hole.rounding > tolerance - (hole.position_deviation - hole.rounding).max(0.0));
    by_rounding.map(move |hole| {
        format!(
            "hole {}: rounding to the least increment of {increment} mm and degrees alone can cause Φ{:.4} \
             here, tolerance Φ{tolerance}; use a finer increment or a wider tolerance\n",
            hole.id, hole.rounding
        )
    })
}

pub(crate) fn broken_package(what: &str, error: &dyn std::fmt::Display) -> CheckError {
    CheckError::Broken(format!("{what}: {error}"))
}

/// The package's programs as the control's program memory.
pub struct Programs<'p>(pub &'p Package);

impl Library for Programs<'_> {
    fn program(&mut self, number: u32) -> Option<(String, Bytes)> {
        let program = self.0.program(number)?;
        Some((file_name(number), program.text.as_bytes().into()))
    }
}
