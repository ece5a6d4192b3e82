//! Quantities measured along the flutes over stretches of the gauge length: the helix angle, and the speed of the contact.
use nalgebra::Point3;

use crate::flutes::{GrindingPass, Sample, Trace, Window};
use gcode_lang::motion::Backtrace;
use gcode_lang::units::Deg;

/// Tolerance of the speed as a fraction: between programmed points the axes move evenly, and the contact speeds up by as
/// much in emitted programs.
pub(super) const SPEED_TOLERANCE: f64 = 0.25;

/// Range of a quantity along all flutes, and its worst stretch in each pass.
#[derive(Clone, Debug)]
pub(super) struct MeasuredRange {
    pub min: f64,
    pub max: f64,
    /// Empty if the nominal value is not specified.
    pub worst_by_pass: Vec<WorstStretch>,
}

/// The stretch of a pass with the largest error.
#[derive(Clone, Copy, Debug)]
pub(super) struct WorstStretch {
    /// Counted from 0.
    pub pass: usize,
    /// Polar angle and point on the burr in its middle.
    pub polar: Deg,
    pub point: Point3<f64>,
    pub actual: f64,
    pub nominal: f64,
    /// Degrees for the helix angle; for a speed the factor by which it is too fast or too slow, at least 1.
    pub error: f64,
    /// First and last sample, counted from 0.
    sample_range: [usize; 2],
}

impl MeasuredRange {
    /// Returns the helix angles, degrees; `None` without a flute.
    pub(super) fn of_helix(gauge: f64, passes: &[GrindingPass]) -> Option<Self> {
        let angles = |_: &Trace, window: &Window<'_>| (window.helix.0, Some(window.nominal_helix.0));
        Self::of(gauge, passes, angles, |actual, nominal| (actual - nominal).abs())
    }

    /// Returns the speeds of the contact, mm/min; `None` without a flute.
    pub(super) fn of_speed(gauge: f64, nominal: Option<f64>, passes: &[GrindingPass]) -> Option<Self> {
        let speed = |trace: &Trace, window: &Window<'_>| {
            let [first, last] = window.ends.map(|end| &trace.samples[end]);
            (60.0 * (last.path_length - first.path_length) / (last.seconds - first.seconds), nominal)
        };
        Self::of(gauge, passes, speed, speed_factor)
    }

    fn of(
        gauge: f64,
        passes: &[GrindingPass],
        measure: impl Fn(&Trace, &Window<'_>) -> (f64, Option<f64>),
        error: impl Fn(f64, f64) -> f64,
    ) -> Option<Self> {
        let mut range: Option<Self> = None;
        for (index, pass) in passes.iter().enumerate() {
            let mut worst: Option<WorstStretch> = None;
            for window in pass.trace.windows(gauge) {
                let (actual, nominal) = measure(&pass.trace, &window);
                let range = range.get_or_insert(Self { min: actual, max: actual, worst_by_pass: Vec::new() });
                (range.min, range.max) = (range.min.min(actual), range.max.max(actual));
                let Some(nominal) = nominal else { continue };
                let stretch = WorstStretch {
                    pass: index,
                    polar: window.middle.polar,
                    point: window.middle.point,
                    actual,
                    nominal,
                    error: error(actual, nominal),
                    sample_range: window.ends,
                };
                worst = Some(worst.map_or(stretch, |worst| worst.worse_of(stretch)));
            }
            if let Some((range, worst)) = range.as_mut().zip(worst) {
                range.worst_by_pass.push(worst);
            }
        }
        range
    }

    /// Returns the worst stretch of all passes.
    pub(super) fn worst(&self) -> Option<WorstStretch> {
        self.worst_by_pass.iter().copied().reduce(WorstStretch::worse_of)
    }
}

impl WorstStretch {
    /// Returns the other if its error is larger by more than rounding.
    fn worse_of(self, other: Self) -> Self {
        if self.error + 1e-6 < other.error { other } else { self }
    }

    pub(super) fn is_wrong_speed(&self) -> bool {
        SPEED_TOLERANCE * self.nominal < (self.actual - self.nominal).abs()
    }

    /// Returns the block that deviates most from the law there, or within a gauge length of it. One misplaced point makes
    /// two moves wrong, there and back: the first of them has the point.
    pub(super) fn helix_backtrace<'g>(&self, trace: &'g Trace, gauge: f64) -> Option<&'g Backtrace> {
        let [first, last] = self.sample_range.map(|end| trace.samples[end].along);
        let (low, high) = (first.min(last) - gauge, first.max(last) + gauge);
        let is_near = |pair: &&[Sample]| (low..=high).contains(&pair[1].along);
        let off = |sample: &Sample| sample.around - sample.nominal_around;
        let pairs = trace.samples.windows(2).filter(is_near);
        let blocks = trace.sum_by_block(pairs, |from, to| [off(to) - off(from), 0.0]);
        let most = blocks.iter().map(|(_, [off, _])| off.abs()).fold(0.0, f64::max);
        blocks.iter().find(|(_, [off, _])| 0.9 * most <= off.abs()).map(|(backtrace, _)| *backtrace)
    }

    /// Returns the block of the stretch that alone is most too fast or too slow.
    pub(super) fn speed_backtrace<'g>(&self, trace: &'g Trace) -> Option<&'g Backtrace> {
        let [first, last] = self.sample_range;
        let pairs = trace.samples[first..=last].windows(2);
        let blocks = trace
            .sum_by_block(pairs, |from, to| [to.path_length - from.path_length, to.seconds - from.seconds]);
        let factor = |[length, seconds]: [f64; 2]| speed_factor(60.0 * length / seconds, self.nominal);
        let slowest = blocks.into_iter().max_by(|a, b| factor(a.1).total_cmp(&factor(b.1)))?;
        Some(slowest.0)
    }
}

fn speed_factor(actual: f64, nominal: f64) -> f64 {
    (actual / nominal).max(nominal / actual)
}
