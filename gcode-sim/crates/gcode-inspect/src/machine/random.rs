//! Random numbers as a function of a seed and their purpose: neither the order of the draws nor the number of
//! threads changes any of them.
use gcode_lang::units::Deg;

/// A node in a tree of random numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RandomStream(u64);

/// 2⁶⁴ over the golden ratio, odd: its multiples are evenly distributed.
const STEP: u64 = 0x9e37_79b9_7f4a_7c15;

impl RandomStream {
    /// Returns the root of a seed.
    pub fn new(seed: u64) -> Self {
        Self(mix(seed))
    }

    /// Returns the child node `index`, different for every index.
    pub fn branch(self, index: u64) -> Self {
        Self(mix(self.0.wrapping_add(index.wrapping_add(1).wrapping_mul(STEP))))
    }

    /// Returns a number between 0 and 1, both excluded.
    pub fn uniform(self) -> f64 {
        ((mix(self.0.wrapping_add(STEP)) >> 11) as f64 + 0.5) / (1u64 << 53) as f64
    }

    /// Returns an angle, uniform between 0 and a full revolution.
    pub fn angle(self) -> Deg {
        Deg(360.0 * self.uniform())
    }

    /// Returns the distance from the origin of a point of the standard normal distribution of the plane
    /// (Rayleigh).
    pub fn radius(self) -> f64 {
        (-2.0 * libm::log(self.uniform())).sqrt()
    }

    /// Returns a standard normal number: the x of such a point (Box and Muller).
    pub fn normal(self) -> f64 {
        self.branch(0).radius() * self.branch(1).angle().cos()
    }
}

/// Returns the finaliser of SplitMix64 (Steele, Lea, Flood: *Fast Splittable Pseudorandom Number
/// Generators*).
///
/// Every bit of the result depends on every bit of the argument.
fn mix(mut z: u64) -> u64 {
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Mean, variance, skewness and kurtosis of the standard normal distribution are 0, 1, 0, 3; those of 10⁶
    /// draws are within four standard errors √(1, 2, 6, 24)/1000.
    #[test]
    fn a_million_normal_draws_have_the_moments_of_the_distribution() {
        let root = RandomStream::new(1);
        let mut sums = [0.0; 4];
        for index in 0..1_000_000 {
            let value = root.branch(index).normal();
            let mut power = 1.0;
            for sum in &mut sums {
                power *= value;
                *sum += power / 1e6;
            }
        }
        for (sum, (mean, error)) in sums.iter().zip([(0.0, 1.0), (1.0, 2.0), (0.0, 15.0), (3.0, 96.0f64)]) {
            assert!((sum - mean).abs() < 4e-3 * error.sqrt(), "{sums:?}");
        }
    }

    /// 10⁶ draws in 1000 boxes: χ² has mean 999 and standard deviation √1998.
    #[test]
    fn draws_fill_the_unit_interval_evenly_along_each_branch() {
        for branch in 0..3 {
            let mut boxes = vec![0u32; 1000];
            for index in 0..1_000_000 {
                let draw = match branch {
                    0 => RandomStream::new(7).branch(index),
                    1 => RandomStream::new(index).branch(3),
                    _ => RandomStream::new(7).branch(index / 1000).branch(index % 1000),
                };
                boxes[(draw.uniform() * 1000.0) as usize] += 1;
            }
            let deviations = boxes.iter().map(|n| f64::from(*n) - 1000.0);
            let chi = deviations.map(|deviation| deviation * deviation / 1000.0).sum::<f64>();
            assert!((chi - 999.0).abs() < 4.0 * 1998f64.sqrt(), "branch {branch}: {chi}");
        }
    }

    /// Neighbouring nodes are independent: the correlation of 10⁶ pairs is 0 within four of 1/1000.
    #[test]
    fn neighbours_are_independent() {
        let value = |sample: u64, source: u64| RandomStream::new(5).branch(sample).branch(source).normal();
        let (mut along, mut across) = (0.0, 0.0);
        for index in 0..1_000_000 {
            along += value(index, 0) * value(index + 1, 0) / 1e6;
            across += value(index, 0) * value(index, 1) / 1e6;
        }
        assert!(along.abs() < 4e-3 && across.abs() < 4e-3, "{along} {across}");
    }
}
