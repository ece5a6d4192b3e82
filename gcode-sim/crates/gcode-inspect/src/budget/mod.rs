//! Error budget: position deviations of the holes of many parts, on machines and set-ups with the errors of
//! an error file.
//!
//! Every sample is one part: its set-up is drawn once, the machine's own errors anew for each hole. Holes are
//! judged as in `verify`. A draw depends only on the seed, the sample, the hole and the source, so that the
//! result is the same for any number of threads.
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

use crate::machine::ErrorSource;
use crate::machine::Machine;
use crate::machine::RandomStream;
use gcode_part::Hole;

/// Limit of the number of samples, 16 bytes of memory each.
pub const MAX_SAMPLES: usize = 20_000_000;

/// Input of a budget.
#[derive(Clone, Copy, Debug)]
pub struct BudgetRequest<'q> {
    /// The machine without errors.
    pub machine: &'q Machine,
    /// Nominal holes.
    pub holes: &'q [Hole],
    /// Height above the surface at which each hole's feed begins, mm.
    pub clearance: f64,
    /// Errors of machine and set-up.
    pub sources: &'q [ErrorSource],
    /// Number of samples, 1 to [`MAX_SAMPLES`].
    pub samples: usize,
    /// Seed of the random errors.
    pub seed: u64,
    /// Number of threads.
    pub threads: NonZeroUsize,
    /// Diameter of the tolerance zone, mm.
    pub tolerance: f64,
}

/// Result of a budget: positions in the sense of ISO 1101, diameters in mm.
#[derive(Clone, Debug, PartialEq)]
pub struct Budget {
    /// Holes in the order of the request.
    pub holes: Vec<HoleBudget>,
    /// Statistics of the worst hole of each part.
    pub parts: Statistics,
    /// Shares over all holes, the largest first.
    pub shares: Vec<ErrorShare>,
}

/// Result for one hole.
#[derive(Clone, Debug, PartialEq)]
pub struct HoleBudget {
    /// Id of the hole.
    pub id: String,
    /// Position over all samples.
    pub statistics: Statistics,
    /// Position without errors: the effect of rounding to the increment.
    pub nominal: f64,
    /// Share of each source, in the order of the error file.
    pub shares: Vec<ErrorShare>,
}

/// Reason for which a budget is impossible.
#[derive(Debug, PartialEq, Eq, thiserror::Error)]
pub enum BudgetError {
    /// The machine cannot reach the hole along its axis.
    #[error("hole '{id}': the machine cannot reach it along the hole axis")]
    OutOfReach {
        /// Id of the hole.
        id: String,
    },
    /// The errors are too large for a position to be defined.
    #[error("hole '{id}': the errors are so large that no position can be computed")]
    NoPosition {
        /// Id of the hole.
        id: String,
    },
}

/// Draws the samples and judges them. `progress` counts completed samples, for a progress bar.
///
/// # Errors
/// A hole out of reach, and errors too large for a position.
pub fn budget(request: &BudgetRequest<'_>, progress: &AtomicUsize) -> Result<Budget, BudgetError> {
    let planned = request
        .holes
        .iter()
        .map(|hole| HolePlan::new(request.machine, hole, request.clearance))
        .collect::<Result<Vec<_>, _>>()?;
    let mut phis = vec![0.0; request.samples];
    let mut worst = vec![0.0; request.samples];
    let mut holes = Vec::with_capacity(planned.len());
    for (index, hole) in planned.iter().enumerate() {
        sample_hole(request, hole, index, &mut phis, &mut worst, progress);
        if phis.iter().any(|phi| !phi.is_finite()) {
            return Err(BudgetError::NoPosition { id: hole.id() });
        }
        holes.push(HoleBudget {
            id: hole.id(),
            statistics: Statistics::of(&mut phis, request.tolerance),
            nominal: hole.position_deviation(request.machine),
            shares: shares::hole_shares(request, hole),
        });
    }
    let parts = Statistics::of(&mut worst, request.tolerance);
    Ok(Budget { parts, shares: shares::total_shares(&holes), holes })
}

/// Computes the position of one hole in every sample, and updates the worst position of each part.
fn sample_hole(
    request: &BudgetRequest<'_>,
    hole: &HolePlan<'_>,
    index: usize,
    phis: &mut [f64],
    worst: &mut [f64],
    progress: &AtomicUsize,
) {
    let length = request.samples.div_ceil(request.threads.get()).max(MIN_SAMPLES_PER_THREAD);
    let root = RandomStream::new(request.seed);
    let draw = |part: usize, phis: &mut [f64], worst: &mut [f64]| {
        let mut machine = request.machine.clone();
        for (offset, (phi, worst)) in phis.iter_mut().zip(worst).enumerate() {
            let of_part = root.branch((part * length + offset) as u64);
            machine.reset(request.machine);
            let of_hole = of_part.branch(HOLE_STREAM + index as u64);
            for source in request.sources {
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

/// Samples per thread below which starting the thread takes longer than drawing them.
const MIN_SAMPLES_PER_THREAD: usize = 256;

/// Stream of single holes, beyond the streams of the sources.
const HOLE_STREAM: u64 = 1000;

/// Samples counted at a time.
const PROGRESS_STEP: usize = 4096;
