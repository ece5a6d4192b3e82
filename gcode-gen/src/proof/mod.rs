//! Proofs of a job's resident macro for all values of its quantities at once, against the part's geometry.
//!
//! The macro is followed as `gcode-sim prove` follows it; the hole that it drills is compared with the implicit surface and its
//! gradient, of which the macro's formulas know nothing. Single holes are verified besides: they show how close the bounds are,
//! and refute what is wrong.
mod arguments;
mod boxes;
mod case;
pub(crate) mod controls;
mod hole_path;
mod position;
mod quantity_range;
mod rapids;
pub mod report;
mod sample;
mod statements;
#[cfg(test)]
mod tests;

use std::num::NonZeroUsize;
use std::time::Duration;

use gcode_part::job::{AxisDirection, HoleSpec, Job, PinHoles, Tool};

use self::case::Case;
use self::quantity_range::{Quantity, QuantityRange};
use self::report::{CaseReport, JobProof};
use crate::package::Package;

/// What is to be proved of a job's macro.
pub struct ProofRequest<'a> {
    /// The job.
    pub job: &'a Job,
    /// Its programs, whose macros are proved.
    pub package: &'a Package,
    /// Ranges of quantities, `hole.radius=0..1100`.
    pub over: &'a [String],
    /// Tolerances of the position, mm; that of the job if there is none.
    pub tolerances: &'a [f64],
    /// Number of threads.
    pub threads: NonZeroUsize,
    /// Time since the start.
    pub clock: &'a (dyn Fn() -> Duration + Sync),
    /// Largest time.
    pub limit: Duration,
}

/// Proves the claims of a job's macro for all values of the ranges.
///
/// # Errors
/// The reason why the request can't be used.
pub fn prove_job(request: &ProofRequest<'_>) -> Result<JobProof, String> {
    let Job::PinHoles(job) = request.job else {
        return arguments::prove_arguments(request);
    };
    let overs = QuantityRange::parse_all(request.over)?;
    if overs.is_empty() {
        return Err("nothing is left open: give --over, 'hole.radius=0..1100'".to_owned());
    }
    let mut tolerances = request.tolerances.to_vec();
    if tolerances.is_empty() {
        tolerances.push(job.tolerance.position);
    }
    let kinds = kinds(job, &overs);
    let count = kinds.len() as u32;
    let reports = kinds.into_iter().enumerate().map(|(index, (hole, tool))| {
        let limit = request.limit * (index as u32 + 1) / count;
        let case = Case { request, job, hole, tool, overs: &overs, tolerances: &tolerances, limit };
        case.prove()
    });
    let reports: Vec<CaseReport> = reports.collect::<Result<_, _>>()?;
    let over = overs.iter().map(|over| (over.quantity.key().to_owned(), [over.low, over.high])).collect();
    Ok(JobProof::new(over, reports, Vec::new(), (request.clock)().as_secs_f64()))
}

/// Returns a hole and a tool for each call that differs in more than the quantities left open.
fn kinds<'j>(job: &'j PinHoles, overs: &[QuantityRange]) -> Vec<(&'j HoleSpec, &'j Tool)> {
    let fixed = |quantity: &Quantity| overs.iter().all(|over| over.quantity != *quantity);
    let key = |hole: &HoleSpec, tool: &Tool| {
        let values = Quantity::ALL.into_iter().filter(fixed).map(|quantity| quantity.of(job, hole).to_bits());
        (matches!(hole.axis, AxisDirection::Axial), tool.number, values.collect::<Vec<_>>())
    };
    let mut kinds: Vec<(&HoleSpec, &Tool)> = Vec::new();
    for hole in &job.holes {
        for tool in job.tools.iter().filter(|tool| hole.tools.contains(&tool.number)) {
            if !kinds.iter().any(|(other, with)| key(other, with) == key(hole, tool)) {
                kinds.push((hole, tool));
            }
        }
    }
    kinds
}
