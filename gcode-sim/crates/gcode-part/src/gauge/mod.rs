//! Gauge blocks: the sets, the stack nearest to a height, and the angle that it sets on a sine table, H = L·sin φ.
mod sets;
mod stack;

pub use sets::{GaugeSet, Thickness};
pub use stack::Stack;

use gcode_lang::units::{Deg, Mm};

/// Setting of a sine table with blocks of one set.
#[derive(Clone, Debug, PartialEq)]
pub struct SineSetting {
    /// Nominal height, L·sin φ.
    pub height: Mm,
    /// Nearest stack of the set.
    pub stack: Stack,
    /// Angle set by the stack minus the nominal angle, seconds of arc.
    pub remainder: f64,
}

/// Returns the height under one roller that inclines a table with rollers `length` apart by `angle`.
pub fn height(length: Mm, angle: Deg) -> Mm {
    length * angle.sin()
}

/// Returns the nearest stack for an angle of 0° to 45° on a table of at least 10 mm, the ranges of job files.
pub fn sine_setting(length: Mm, angle: Deg, set: &GaugeSet) -> SineSetting {
    let height = height(length, angle);
    let stack = set.nearest_stack(height);
    let left = (Deg::asin(stack.thickness().mm() / length.0).0 - angle.0) * 3600.0;
    SineSetting { height, stack, remainder: left }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn metric_87() -> GaugeSet {
        GaugeSet::ALL.into_iter().find(|set| set.name == "metric-87").unwrap()
    }

    /// 200·sin 30° is 100, one block. 200·sin 38.5° = 124.502 93: stacked 124.503, 0.07 microns more; a
    /// micron at 38.5° is 206 265/(200 000·cos 38.5°) = 1.317 seconds, so 0.09 of them remain. sin 0.01° =
    /// 0.000 174 53: 0.0349 mm, for which no block exists, so that the whole 36 seconds remain.
    #[test]
    fn angles_worked_out_by_hand() {
        let at = |angle: f64| sine_setting(Mm(200.0), Deg(angle), &metric_87());
        let upright = at(30.0);
        assert_eq!(upright.stack.thickness().to_string(), "100");
        assert!(upright.remainder.abs() < 1e-9);
        let odd = at(38.5);
        assert_eq!(odd.stack.thickness().to_string(), "124.503");
        assert!((odd.height.0 - 124.502_93).abs() < 5e-6, "{}", odd.height);
        assert!((odd.remainder - 0.09).abs() < 0.01, "{}", odd.remainder);
        let flat = at(0.01);
        assert!(flat.stack.blocks.is_empty() && (flat.remainder + 36.0).abs() < 1e-9);
        assert_eq!(at(0.0).remainder, 0.0);
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]

        /// The sine of the angle that is set is the stack over the length; with rollers 200 mm apart half a
        /// micron is at most 0.73 seconds, towards 45°.
        #[test]
        fn the_set_angle_is_the_nominal_one_and_the_remainder(angle in 1.0..45.0) {
            let found = sine_setting(Mm(200.0), Deg(angle), &metric_87());
            let made = Deg(angle + found.remainder / 3600.0);
            let stack: f64 = found.stack.blocks.iter().map(|block| block.mm()).sum();
            prop_assert!((made.sin() * 200.0 - stack).abs() < 1e-9);
            prop_assert!(found.remainder.abs() < 0.73, "{}", found.remainder);
        }
    }
}
