//! Share of each source in a hole's deviation: the classical sum of squares.
//!
//! The sensitivities come from the same kinematics as the samples.
use nalgebra::Vector3;

use super::hole_plan::HolePlan;
use super::{BudgetRequest, HoleBudget};
use crate::machine::Machine;
use crate::machine::sources::{ErrorSource, Quantity};
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

/// Returns the shares at that end of the hole where all sources together displace its axis more.
pub(super) fn hole_shares(question: &BudgetRequest<'_>, hole: &HolePlan<'_>) -> Vec<ErrorShare> {
    let squares: Vec<[f64; 2]> =
        question.sources.iter().map(|source| mean_squares(question.machine, hole, source)).collect();
    let sums = [0, 1].map(|end| squares.iter().map(|ends| ends[end]).sum::<f64>());
    let end = usize::from(sums[1] > sums[0]);
    let share = |(source, squares): (&ErrorSource, &[f64; 2])| ErrorShare {
        source: source.quantity.name(question.machine),
        displacement: squares[end].sqrt(),
        share: if sums[end] > 0.0 { squares[end] / sums[end] } else { 0.0 },
    };
    question.sources.iter().zip(&squares).map(share).collect()
}

/// Returns the shares over all holes: the sums of their squares, each at its own worse end; the largest
/// first.
pub(super) fn total_shares(holes: &[HoleBudget]) -> Vec<ErrorShare> {
    let Some(first) = holes.first() else { return Vec::new() };
    let square = |index: usize| -> f64 {
        let squares =
            holes.iter().map(|hole| hole.shares[index].displacement * hole.shares[index].displacement);
        squares.sum::<f64>() / holes.len() as f64
    };
    let squares: Vec<f64> = (0..first.shares.len()).map(square).collect();
    let sum: f64 = squares.iter().sum();
    let all = first.shares.iter().zip(&squares).map(|(share, square)| ErrorShare {
        source: share.source.clone(),
        displacement: square.sqrt(),
        share: if sum > 0.0 { square / sum } else { 0.0 },
    });
    let mut all: Vec<ErrorShare> = all.collect();
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
