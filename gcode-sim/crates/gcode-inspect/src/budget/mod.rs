//! The error budget: how far the holes of many parts would be off, on machines and set-ups that differ as an error file says.
//!
//! Every sample is one part: its set-up is drawn once, the machine's own errors anew for each hole. A hole is judged as
//! `verify` judges it. What is drawn depends on the seed, the sample, the hole and the source alone, so that the answer is
//! the same on any number of threads.
mod hole_plan;
mod shares;
mod statistics;
#[cfg(test)]
mod tests;

use std::num::NonZeroUsize;
use std::sync::atomic::{AtomicUsize, Ordering};

use hole_plan::HolePlan;
pub use shares::ErrorShare;
pub use statistics::Statistics;

use crate::machine::Machine;
use crate::machine::random::RandomStream;
use crate::machine::sources::ErrorSource;
use gcode_part::Hole;

/// More samples than this would need more memory than a computer in a shop has: 16 bytes each.
pub const MAX_SAMPLES: usize = 20_000_000;

/// What is asked for.
#[derive(Clone, Copy, Debug)]
pub struct BudgetRequest<'q> {
    /// The machine as the program believes it: without errors.
    pub machine: &'q Machine,
    pub holes: &'q [Hole],
    /// How far above the surface each hole's feed begins, mm.
    pub clearance: f64,
    pub sources: &'q [ErrorSource],
    /// 1 to [`MOST_SAMPLES`].
    pub samples: usize,
    pub seed: u64,
    pub threads: NonZeroUsize,
    /// Diameter of the tolerance zone, mm.
    pub tolerance: f64,
}

/// Position as ISO 1101 has it, diameters in mm.
#[derive(Clone, Debug, PartialEq)]
pub struct Budget {
    pub holes: Vec<HoleBudget>,
    /// The worst hole of each part.
    pub parts: Statistics,
    /// Over all holes, the largest share first.
    pub shares: Vec<ErrorShare>,
}

#[derive(Clone, Debug, PartialEq)]
pub struct HoleBudget {
    pub id: String,
    pub statistics: Statistics,
    /// Without any of the errors: what rounding to the increment leaves.
    pub nominal: f64,
    /// Of each source, in the order of the error file.
    pub shares: Vec<ErrorShare>,
}

/// Why there is no budget.
#[derive(Debug, PartialEq, Eq, thiserror::Error)]
pub enum BudgetError {
    #[error("hole '{id}': the machine cannot reach it along the hole axis")]
    OutOfReach { id: String },
    #[error("hole '{id}': the errors are so large that no position can be computed")]
    NoPosition { id: String },
}

/// Draws the samples and judges them; `progress` counts the holes that are done, for a bar.
pub fn budget(question: &BudgetRequest<'_>, progress: &AtomicUsize) -> Result<Budget, BudgetError> {
    let planned = question
        .holes
        .iter()
        .map(|hole| HolePlan::new(question.machine, hole, question.clearance))
        .collect::<Result<Vec<_>, _>>()?;
    let mut phis = vec![0.0; question.samples];
    let mut worst = vec![0.0; question.samples];
    let mut holes = Vec::with_capacity(planned.len());
    for (index, hole) in planned.iter().enumerate() {
        sample_hole(question, hole, index, &mut phis, &mut worst, progress);
        if phis.iter().any(|phi| !phi.is_finite()) {
            return Err(BudgetError::NoPosition { id: hole.id() });
        }
        let statistics = Statistics::of(&mut phis, question.tolerance);
        let shares = shares::hole_shares(question, hole);
        holes.push(HoleBudget {
            id: hole.id(),
            statistics,
            nominal: hole.position_deviation(question.machine),
            shares,
        });
    }
    let parts = Statistics::of(&mut worst, question.tolerance);
    let shares = shares::total_shares(&holes);
    Ok(Budget { holes, parts, shares })
}

/// The position of one hole in every sample, and with it the worst of each part.
fn sample_hole(
    question: &BudgetRequest<'_>,
    hole: &HolePlan<'_>,
    index: usize,
    phis: &mut [f64],
    worst: &mut [f64],
    progress: &AtomicUsize,
) {
    let length = question.samples.div_ceil(question.threads.get()).max(MIN_SAMPLES_PER_THREAD);
    let root = RandomStream::new(question.seed);
    let draw = |part: usize, phis: &mut [f64], worst: &mut [f64]| {
        let mut machine = question.machine.clone();
        for (offset, (phi, worst)) in phis.iter_mut().zip(worst).enumerate() {
            let of_part = root.branch((part * length + offset) as u64);
            machine.reset(question.machine);
            let of_hole = of_part.branch(HOLE_STREAM + index as u64);
            for source in question.sources {
                let draw = if source.quantity.is_per_part() { of_part } else { of_hole };
                source.draw_into(&mut machine, draw);
            }
            *phi = hole.position_deviation(&machine);
            *worst = phi.max(*worst);
            if offset % PROGRESS_STEP == 0 {
                progress.fetch_add(PROGRESS_STEP, Ordering::Relaxed);
            }
        }
    };
    std::thread::scope(|scope| {
        let mut parts = phis.chunks_mut(length).zip(worst.chunks_mut(length)).enumerate();
        let own = parts.next();
        for (part, (phis, worst)) in parts {
            let draw = &draw;
            scope.spawn(move || draw(part, phis, worst));
        }
        if let Some((part, (phis, worst))) = own {
            draw(part, phis, worst);
        }
    });
}

/// Starting a thread takes as long as drawing some hundred samples.
const MIN_SAMPLES_PER_THREAD: usize = 256;

/// Draws of single holes lie beyond those of sources.
const HOLE_STREAM: u64 = 1000;

/// So many samples are counted at a time.
const PROGRESS_STEP: usize = 4096;
