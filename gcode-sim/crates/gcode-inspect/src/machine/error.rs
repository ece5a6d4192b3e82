//! Errors of a machine and a set-up: their distribution and their variation along an axis.
use super::random::RandomStream;
use gcode_lang::units::Deg;

/// Distribution of an error; lengths in mm, angles in degrees.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Distribution {
    /// A constant: known and not corrected.
    Fixed(f64),
    /// Gaussian about 0 with this standard deviation.
    Normal(f64),
    /// Uniform between minus and plus this value.
    Uniform(f64),
}

impl Distribution {
    /// Draws one value.
    pub fn sample(self, draw: RandomStream) -> f64 {
        match self {
            Self::Fixed(value) => value,
            Self::Normal(deviation) => deviation * draw.normal(),
            Self::Uniform(most) => most * (2.0 * draw.uniform() - 1.0),
        }
    }

    /// Returns the mean of the squared value.
    pub(crate) fn mean_square(self) -> f64 {
        match self {
            Self::Fixed(value) | Self::Normal(value) => value * value,
            Self::Uniform(most) => most * most / 3.0,
        }
    }
}

/// An error as a function of the axis position: a level and a cosine wave. The default is no error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PeriodicError {
    /// Mean value, mm or degrees.
    pub level: f64,
    /// Amplitude of the wave, mm or degrees.
    pub amplitude: f64,
    /// Phase at position 0.
    pub phase: Deg,
    /// Wavelength along the axis, mm or degrees.
    pub period: f64,
}

impl Default for PeriodicError {
    fn default() -> Self {
        Self { level: 0.0, amplitude: 0.0, phase: Deg::ZERO, period: 360.0 }
    }
}

impl PeriodicError {
    /// Returns an error that is the same at every position.
    pub fn constant(level: f64) -> Self {
        Self { level, ..Self::default() }
    }

    /// Draws one machine's error such that at every position it has the distribution `spread`.
    ///
    /// Normal: the coordinates of a normally distributed point of the plane, rotated by the position, stay
    /// normal. Uniform: every coordinate of a uniformly distributed point on a sphere is uniform
    /// (Archimedes).
    pub fn sample(spread: Distribution, length: f64, draw: RandomStream) -> Self {
        let (level, swing) = match spread {
            Distribution::Fixed(value) => (value, 0.0),
            Distribution::Normal(deviation) => (0.0, deviation * draw.branch(0).radius()),
            Distribution::Uniform(most) => {
                let height = 2.0 * draw.branch(0).uniform() - 1.0;
                (0.0, most * (1.0 - height * height).sqrt())
            }
        };
        Self { level, amplitude: swing, phase: draw.branch(1).angle(), period: length }
    }

    /// Returns the error at a position of the axis.
    pub(crate) fn value_at(&self, position: f64) -> f64 {
        if self.amplitude == 0.0 {
            return self.level;
        }
        self.level + self.amplitude * (Deg(360.0 * position / self.period) - self.phase).cos()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Over 200 000 machines the error at one position has the quartiles of its distribution: ±0.6745 σ, ±
    /// half the range.
    #[test]
    fn at_every_position_an_error_has_the_distribution_of_the_file() {
        for position in [0.0, 123.456, -900.0] {
            for (spread, quartile) in
                [(Distribution::Normal(0.01), 0.006_745), (Distribution::Uniform(0.01), 0.005)]
            {
                let errors = (0..200_000)
                    .map(|n| PeriodicError::sample(spread, 500.0, RandomStream::new(n)).value_at(position));
                let mut errors: Vec<f64> = errors.collect();
                errors.sort_by(f64::total_cmp);
                for (part, expected) in [(50_000, -quartile), (100_000, 0.0), (150_000, quartile)] {
                    assert!(
                        (errors[part] - expected).abs() < 2e-4,
                        "{spread:?} at {position}: {}",
                        errors[part]
                    );
                }
                assert!(spread != Distribution::Uniform(0.01) || errors[199_999] <= 0.01);
            }
        }
    }

    #[test]
    fn a_wave_repeats_after_its_length_and_a_fixed_error_is_the_same_everywhere() {
        let wave = PeriodicError::sample(Distribution::Normal(0.02), 500.0, RandomStream::new(3));
        assert!((wave.value_at(17.0) - wave.value_at(517.0)).abs() < 1e-12);
        assert!(
            (wave.value_at(17.0) + wave.value_at(267.0)).abs() < 1e-12,
            "half a wave on it is the opposite"
        );
        let fixed = PeriodicError::sample(Distribution::Fixed(-0.02), 500.0, RandomStream::new(3));
        assert_eq!((fixed.value_at(0.0), fixed.value_at(123.0)), (-0.02, -0.02));
    }
}
