//! How fast the contact runs along the flutes: its own way over the time that the moves take.
use nalgebra::Point3;

use crate::flutes::{GrindingPass, Trace};
use gcode_lang::motion::Backtrace;
use gcode_part::Flutes;

/// The speed may be off by this part of the wanted one: between two programmed points the axes run evenly and the contact
/// doesn't, and by so much emitted moves let it swing.
pub(super) const SPEED_TOLERANCE: f64 = 0.25;

/// The speeds along all flutes, mm/min, each measured over a stretch of the gauge's length.
#[derive(Clone, Debug)]
pub struct SpeedRange {
    pub min: f64,
    pub max: f64,
    /// Where a speed is wanted: of each pass the one that is most times too fast or too slow.
    pub worst_by_pass: Vec<WorstSpeed>,
}

#[derive(Clone, Copy, Debug)]
pub struct WorstSpeed {
    /// Counted from 0.
    pub pass: usize,
    /// On the burr, mm.
    pub point: Point3<f64>,
    pub actual: f64,
    pub nominal: f64,
    /// The first and the last sample of the stretch, counted from 0.
    sample_range: [usize; 2],
}

impl WorstSpeed {
    pub fn is_wrong(&self) -> bool {
        SPEED_TOLERANCE * self.nominal < (self.actual - self.nominal).abs()
    }

    /// How many times too fast or too slow, 1 or more.
    pub fn factor(&self) -> f64 {
        (self.actual / self.nominal).max(self.nominal / self.actual)
    }

    /// The block of the stretch that is most times too fast or too slow, taken alone.
    pub fn backtrace<'t>(&self, trace: &'t Trace) -> Option<&'t Backtrace> {
        let [first, last] = self.sample_range;
        let mut blocks: Vec<(&Backtrace, f64, f64)> = Vec::new();
        for pair in trace.samples[first..=last].windows(2) {
            let place = trace.backtrace(&pair[1]);
            let (way, seconds) =
                (pair[1].path_length - pair[0].path_length, pair[1].seconds - pair[0].seconds);
            match blocks.last_mut().filter(|(last, ..)| std::ptr::eq(*last, place)) {
                Some((_, all, time)) => (*all, *time) = (*all + way, *time + seconds),
                None => blocks.push((place, way, seconds)),
            }
        }
        let factor_of = |way: f64, seconds: f64| Self { actual: 60.0 * way / seconds, ..*self }.factor();
        blocks
            .iter()
            .max_by(|a, b| factor_of(a.1, a.2).total_cmp(&factor_of(b.1, b.2)))
            .map(|(place, ..)| *place)
    }
}

impl SpeedRange {
    pub(super) fn of(wanted: &Flutes, passes: &[GrindingPass]) -> Option<Self> {
        let mut range: Option<Self> = None;
        for (pass, ground) in passes.iter().enumerate() {
            let mut worst: Option<WorstSpeed> = None;
            for window in ground.trace.windows(wanted.gauge) {
                let [first, last] = window.ends.map(|end| &ground.trace.samples[end]);
                let found = 60.0 * (last.path_length - first.path_length) / (last.seconds - first.seconds);
                let range = range.get_or_insert(Self { min: found, max: found, worst_by_pass: Vec::new() });
                range.min = range.min.min(found);
                range.max = range.max.max(found);
                let Some(speed) = wanted.speed else { continue };
                let candidate = WorstSpeed {
                    pass,
                    point: window.middle.point,
                    actual: found,
                    nominal: speed,
                    sample_range: window.ends,
                };
                if worst.is_none_or(|worst| worst.factor() + 1e-6 < candidate.factor()) {
                    worst = Some(candidate);
                }
            }
            if let Some((range, worst)) = range.as_mut().zip(worst) {
                range.worst_by_pass.push(worst);
            }
        }
        range
    }
}
