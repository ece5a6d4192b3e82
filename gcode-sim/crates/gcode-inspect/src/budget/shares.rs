//! Share of each source in a hole's deviation: the classical sum of squares.
//!
//! The sensitivities come from the same kinematics as the samples.
use nalgebra::Vector3;

use super::hole_plan::HolePlan;
use super::{BudgetRequest, HoleBudget};
use crate::machine::Machine;
use crate::machine::{ErrorSource, Quantity};
use gcode_lang::units::Deg;

/// Share of one source.
#[derive(Clone, Debug, PartialEq)]
pub struct ErrorShare {
    /// Key that names the source in the error file.
    pub source: String,
    /// Displacement of the hole's axis, mm: the root of the mean square at the worse end.
    pub displacement: f64,
    /// Its square over the sum of all squares, 0 to 1.
    pub share: f64,
}

impl ErrorShare {
    /// `square`: square of the displacement; `sum`: sum of the squares of all sources.
    fn new(source: String, square: f64, sum: f64) -> Self {
        Self { source, displacement: square.sqrt(), share: if sum > 0.0 { square / sum } else { 0.0 } }
    }
}

/// Returns the shares at that end of the hole where all sources together displace its axis more.
pub(super) fn hole_shares(request: &BudgetRequest<'_>, hole: &HolePlan<'_>) -> Vec<ErrorShare> {
    let mean_squares = |source| mean_squares(request.machine, hole, source);
    let squares: Vec<[f64; 2]> = request.sources.iter().map(mean_squares).collect();
    let sums = [0, 1].map(|end| squares.iter().map(|ends| ends[end]).sum::<f64>());
    let end = usize::from(sums[1] > sums[0]);
    let sources = request.sources.iter().map(|source| source.quantity.name(request.machine));
    sources.zip(&squares).map(|(source, ends)| ErrorShare::new(source, ends[end], sums[end])).collect()
}

/// Returns the shares over all holes: the means of their squares, each at its own worse end; the largest
/// first.
pub(super) fn total_shares(holes: &[HoleBudget]) -> Vec<ErrorShare> {
    let Some(first) = holes.first() else { return Vec::new() };
    let square = |index: usize| -> f64 {
        let displacements = holes.iter().map(|hole| hole.shares[index].displacement);
        displacements.map(|displacement| displacement * displacement).sum::<f64>() / holes.len() as f64
    };
    let squares: Vec<f64> = (0..first.shares.len()).map(square).collect();
    let sum: f64 = squares.iter().sum();
    let shares = first.shares.iter().zip(&squares);
    let mut all: Vec<ErrorShare> =
        shares.map(|(share, square)| ErrorShare::new(share.source.clone(), *square, sum)).collect();
    all.sort_by(|a, b| b.share.total_cmp(&a.share));
    all
}

/// Returns the mean squares of the axis displacement at entry and bottom due to one source, by central
/// differences.
fn mean_squares(machine: &Machine, hole: &HolePlan<'_>, source: &ErrorSource) -> [f64; 2] {
    let size = source.distribution.mean_square().sqrt();
    let moved = |direction: Deg| -> [f64; 2] {
        let ends = |value: f64| -> [Vector3<f64>; 2] {
            let mut machine = machine.clone();
            machine.add_error(source.quantity, value, direction);
            hole.deviation(&machine).map_or([Vector3::zeros(); 2], |d| [d.entry.coords, d.bottom.coords])
        };
        let (plus, minus) = (ends(size), ends(-size));
        [0, 1].map(|end| ((plus[end] - minus[end]) / 2.0).norm_squared())
    };
    if source.quantity != Quantity::RunOut {
        return moved(Deg::ZERO);
    }
    // The direction is unknown: half the square along each of two directions.
    let (along, across) = (moved(Deg::ZERO), moved(Deg(90.0)));
    [0, 1].map(|end| (along[end] + across[end]) / 2.0)
}
