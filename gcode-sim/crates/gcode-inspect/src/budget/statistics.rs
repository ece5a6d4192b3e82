//! Statistics of many positions: mean and percentiles, exact, from the samples themselves.
use gcode_part::exceeds;

/// Statistics of one hole over all samples; diameters in mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Statistics {
    /// Mean.
    pub mean: f64,
    /// Median: half of the samples are no larger.
    pub p50: f64,
    /// 95th percentile.
    pub p95: f64,
    /// 99.7th percentile: three standard deviations of a Gaussian.
    pub p997: f64,
    /// Largest sample.
    pub max: f64,
    /// Share of the samples within the tolerance, 0 to 1.
    pub share_in_tolerance: f64,
}

impl Statistics {
    /// Returns the statistics of at least one sample; reorders the samples.
    ///
    /// A percentile is a sample: the smallest one that this percentage of all samples does not exceed
    /// (nearest rank).
    pub(super) fn of(samples: &mut [f64], tolerance: f64) -> Self {
        // The sum runs in the order of the samples, so that the number of threads changes no bit.
        let mean = samples.iter().sum::<f64>() / samples.len() as f64;
        let within =
            samples.iter().filter(|phi| !exceeds(**phi, tolerance)).count() as f64 / samples.len() as f64;
        let max = samples.iter().copied().fold(0.0, f64::max);
        let mut at = |thousandths: usize| {
            let rank = (samples.len() * thousandths).div_ceil(1000).max(1);
            *samples.select_nth_unstable_by(rank - 1, f64::total_cmp).1
        };
        Self { mean, p50: at(500), p95: at(950), p997: at(997), max, share_in_tolerance: within }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn percentiles_of_1000_numbers_are_those_with_that_rank() {
        let mut numbers: Vec<f64> = (1..=1000).rev().map(f64::from).collect();
        let found = Statistics::of(&mut numbers, 250.0);
        let expected = Statistics {
            mean: 500.5,
            p50: 500.0,
            p95: 950.0,
            p997: 997.0,
            max: 1000.0,
            share_in_tolerance: 0.25,
        };
        assert_eq!(found, expected);
    }

    #[test]
    fn one_sample_is_all_percentiles() {
        let found = Statistics::of(&mut [0.3], 0.3);
        assert_eq!([found.mean, found.p50, found.p95, found.p997, found.max], [0.3; 5]);
        assert_eq!(found.share_in_tolerance, 1.0);
    }

    /// Half of 7 numbers is 3.5, so four must not be larger; 95 % and more are all 7.
    #[test]
    fn ranks_are_rounded_up() {
        let found = Statistics::of(&mut [7.0, 1.0, 6.0, 2.0, 5.0, 3.0, 4.0], 0.5);
        assert_eq!((found.p50, found.p95, found.p997, found.share_in_tolerance), (4.0, 7.0, 7.0, 0.0));
    }
}
