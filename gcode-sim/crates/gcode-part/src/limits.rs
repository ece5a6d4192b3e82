//! Comparison of deviations with their limits: a value exactly at its limit passes.

/// Noise of the arithmetic, mm or degrees: a difference of two coordinates has an error of some 1e-13.
pub const NOISE: f64 = 1e-9;

/// Returns true if a value is above its limit by more than the noise of the arithmetic.
pub fn exceeds(value: f64, limit: f64) -> bool {
    value > limit + NOISE
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_value_at_its_limit_passes_whatever_its_last_digits() {
        // 10.05 − 10 is 0.050000000000000711.
        assert!(!exceeds(2.0 * (10.05 - 10.0), 0.1));
        assert!(!exceeds(1.1 - 1.0, 0.1));
        assert!(exceeds(2.0 * (10.050_001 - 10.0), 0.1));
    }
}
