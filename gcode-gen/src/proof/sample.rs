//! Single holes of a case, emitted and verified: the largest deviations that are found, and holes that break a tolerance.
use gcode_inspect::verify::Ending;
use gcode_part::job::{HoleSpec, Job, PinHoles};
use gcode_prove::radical_inverse;

use super::quantity_range::{Quantity, QuantityRange};
use crate::check::{PackageVerdict, check};
use crate::families::emit;
use crate::package::Package;

/// Verified hole.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct SampledHole {
    /// Values of the quantities, in the order of the ranges.
    pub(super) values: Vec<f64>,
    /// Position deviation; infinite for a hole that isn't there.
    pub(super) phi: f64,
}

/// Number of points that are spread over the ranges, besides the corners.
const SPREAD: u32 = 40;

/// Verifies holes at the corners of the ranges and between them; those that the macro refuses are left out. `macros` replace the
/// job's own.
pub(super) fn sampled(
    job: &PinHoles,
    hole: &HoleSpec,
    overs: &[QuantityRange],
    macros: &Package,
    is_over: &dyn Fn() -> bool,
) -> Vec<SampledHole> {
    let mut found = Vec::new();
    for point in points(overs) {
        if is_over() {
            break;
        }
        found.extend(verified(job, hole, overs, macros, point));
    }
    found
}

/// Returns the corners, then points after Halton with three decimals; an azimuth is halfway between two increments of a rotary,
/// where it is rounded most.
fn points(overs: &[QuantityRange]) -> Vec<Vec<f64>> {
    const PRIMES: [u32; 5] = [2, 3, 5, 7, 11];
    let within = |over: &QuantityRange, part: f64| {
        let value = over.low + (over.high - over.low) * part;
        ((value * 1000.0).round() / 1000.0).clamp(over.low, over.high)
    };
    let halfway = |over: &QuantityRange, value: f64| match over.quantity {
        Quantity::Azimuth => (value + 0.0005).clamp(over.low, over.high),
        _ => value,
    };
    let corner = |bits: u32| {
        let part = |place: usize| f64::from(bits >> place & 1);
        overs.iter().enumerate().map(|(place, over)| within(over, part(place))).collect()
    };
    let spread = |index: u32| {
        let part = |place: usize| radical_inverse(index, PRIMES[place % PRIMES.len()]);
        let value = |(place, over)| halfway(over, within(over, part(place)));
        overs.iter().enumerate().map(value).collect()
    };
    (0..1 << overs.len()).map(corner).chain((1..=SPREAD).map(spread)).collect()
}

/// Verifies one hole; `None` for one that no part has or that the macro refuses.
fn verified(
    job: &PinHoles,
    hole: &HoleSpec,
    overs: &[QuantityRange],
    macros: &Package,
    values: Vec<f64>,
) -> Option<SampledHole> {
    let (mut job, mut hole) = (job.clone(), hole.clone());
    for (over, value) in overs.iter().zip(&values) {
        over.quantity.set(&mut job, &mut hole, *value);
    }
    if hole.radius > job.surface.a {
        return None;
    }
    job.holes = vec![hole];
    let job = Job::PinHoles(job);
    let mut package = emit(&job);
    for program in &mut package.programs {
        if !package.mains.contains(&program.number)
            && let Some(tested) = macros.program(program.number)
        {
            program.text.clone_from(&tested.text);
        }
    }
    let checked = check(&job, &package).ok()?;
    let PackageVerdict::Holes(verdict) = &checked.verdict else { return None };
    match verdict.holes.first() {
        Some(hole) => Some(SampledHole { values, phi: hole.position_deviation }),
        // A run that an alarm has stopped has drilled nothing.
        None if verdict.outcome == Ending::End => Some(SampledHole { values, phi: f64::INFINITY }),
        None => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn corners_come_first_and_all_points_are_inside() {
        let overs = [
            QuantityRange { quantity: Quantity::Radius, low: 0.0, high: 1.0005 },
            QuantityRange { quantity: Quantity::Azimuth, low: -180.0, high: 180.0 },
        ];
        let points = points(&overs);
        assert_eq!(points.len(), 44);
        assert_eq!(points[..4], [[0.0, -180.0], [1.0005, -180.0], [0.0, 180.0], [1.0005, 180.0]]);
        // 0.50025 and −60, rounded, and half an increment on.
        assert_eq!(points[4], [0.5, -59.9995]);
        assert!(points.iter().all(|point| (0.0..=1.0005).contains(&point[0])));
    }
}
