//! Round numbers along an axis.

/// Ticks at steps of 1, 2 or 5 times a power of ten.
pub(super) struct Ticks {
    first: i64,
    last: i64,
    /// Mantissa of the step; the step is `of` · 10^`power`.
    of: f64,
    power: i32,
}

impl Ticks {
    /// Covers `low` to `high` in at most `most` steps.
    pub(super) fn over(low: f64, high: f64, most: f64) -> Self {
        let rough = (high - low) / most;
        let power = libm::floor(libm::log10(rough)) as i32;
        let of = [1.0, 2.0, 5.0, 10.0].into_iter().find(|of| rough <= of * libm::pow(10.0, f64::from(power)));
        let of = of.unwrap_or(10.0);
        let step = of * libm::pow(10.0, f64::from(power));
        let rounding = 1e-9;
        Self {
            first: (low / step - rounding).ceil() as i64,
            last: (high / step + rounding).floor() as i64,
            of,
            power,
        }
    }

    fn step(&self) -> f64 {
        self.of * libm::pow(10.0, f64::from(self.power))
    }

    pub(super) fn all(&self) -> impl Iterator<Item = f64> + '_ {
        (self.first..=self.last).map(|n| n as f64 * self.step())
    }

    /// Formats a tick with the decimals that distinguish it from the next one.
    pub(super) fn name(&self, at: f64) -> String {
        let power = if self.of < 10.0 { self.power } else { self.power + 1 };
        let decimals = usize::try_from(-power).unwrap_or(0);
        let name = format!("{at:.decimals$}");
        if name.bytes().all(|b| matches!(b, b'-' | b'0' | b'.')) {
            "0".to_owned()
        } else {
            name.replace('-', "−")
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 0 to 83 in at most ten steps: tens. −0.012 to 0.03: 0.005.
    #[test]
    fn the_numbers_are_round() {
        let names = |low, high| {
            let ticks = Ticks::over(low, high, 10.0);
            ticks.all().map(|at| ticks.name(at)).collect::<Vec<_>>().join(" ")
        };
        assert_eq!(names(0.0, 83.0), "0 10 20 30 40 50 60 70 80");
        assert_eq!(names(-0.012, 0.03), "−0.010 −0.005 0 0.005 0.010 0.015 0.020 0.025 0.030");
        assert_eq!(names(0.0, 100.0), "0 10 20 30 40 50 60 70 80 90 100");
        assert_eq!(names(-0.9, 0.85), "−0.8 −0.6 −0.4 −0.2 0 0.2 0.4 0.6 0.8");
        assert_eq!(names(19.66, 20.34), "19.7 19.8 19.9 20.0 20.1 20.2 20.3");
    }
}
