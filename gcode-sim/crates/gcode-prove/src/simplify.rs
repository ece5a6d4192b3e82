//! Counterexamples in round numbers: the shortest values at which a claim still fails.
use std::time::Duration;

use gcode_lang::program::Library;

use crate::tree::Question;
use crate::watch::Watch;
use crate::witness::Witness;

/// Time for one counterexample: runs that never end take long.
const LIMIT: Duration = Duration::from_millis(400);

/// Returns a point with shorter numbers at which the control shows that the claim fails too.
pub(crate) fn simplified<L: Library>(
    witness: &mut Witness<L>,
    question: &Question,
    claim: usize,
    mut point: Vec<f64>,
    watch: &Watch,
) -> Vec<f64> {
    let end = watch.elapsed() + LIMIT;
    // Each pass can let another variable become rounder.
    for _ in 0..3 {
        let before = point.clone();
        for (input, range) in question.ranges.iter().enumerate() {
            for value in rounder(point[input], range.low, range.high) {
                if watch.elapsed() > end {
                    return point;
                }
                let mut next = point.clone();
                next[input] = value;
                watch.count_run();
                if witness.run(&next, watch).failed >> claim & 1 == 1 {
                    point = next;
                    break;
                }
            }
        }
        if before == point {
            break;
        }
    }
    point
}

/// Returns numbers of a range that are shorter than one of it, the shortest first.
fn rounder(value: f64, low: f64, high: f64) -> Vec<f64> {
    // Nothing is rounder than 0.
    let digits = |value: f64| value.abs().to_string().len() + usize::from(value < 0.0);
    let length = |value: f64| if value == 0.0 { 0 } else { digits(value) };
    let mut candidates = vec![0.0, low, high];
    for exponent in -20..4 {
        for digits in ["1", "2", "5", "25"] {
            let number: Option<f64> = format!("{digits}e{exponent}").parse().ok();
            candidates.extend(number.into_iter().flat_map(|number| [number, -number]));
        }
    }
    for step in [100.0, 10.0] {
        candidates.extend([(value / step).floor() * step, (value / step).ceil() * step]);
    }
    for decimals in 0..17 {
        // The text of a number is its shortest decimal form.
        let rounded: Option<f64> = format!("{value:.decimals$}").parse().ok();
        candidates.extend(rounded);
        let step: Option<f64> = format!("1e-{decimals}").parse().ok();
        for neighbour in step.into_iter().flat_map(|step| [value - step, value + step]) {
            candidates.extend(format!("{neighbour:.decimals$}").parse::<f64>().ok());
        }
    }
    candidates.retain(|candidate| (low..=high).contains(candidate) && length(*candidate) < length(value));
    candidates.sort_by(|a, b| {
        (length(*a), (a - value).abs())
            .partial_cmp(&(length(*b), (b - value).abs()))
            .unwrap_or(std::cmp::Ordering::Equal)
    });
    candidates.dedup();
    candidates.iter().map(|value| value + 0.0).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_shortest_numbers_of_the_range_come_first() {
        let candidates = rounder(3.741_592_653, 2.5, 9.0);
        assert_eq!(candidates[0], 4.0, "the nearest of those with one digit");
        assert!(candidates.contains(&3.74));
        assert!(candidates.iter().all(|value| (2.5..=9.0).contains(value)));
        assert!(rounder(0.0, -1.0, 1.0).is_empty());
        assert_eq!(rounder(9.0, 0.0, 20.0), [0.0]);
    }
}
