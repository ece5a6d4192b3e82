//! How fast the contact runs along the flutes: its own way over the time that the moves take.
use nalgebra::Point3;

use crate::flutes::{GrindingPass, Trace};
use gcode_lang::motion::Backtrace;
use gcode_part::Flutes;

/// The speed may be off by this part of the wanted one: between two programmed points the axes run evenly and the contact
/// doesn't, and by so much emitted moves let it swing.
pub(super) const ALLOWED: f64 = 0.25;

/// The speeds along all flutes, mm/min, each measured over a stretch of the gauge's length.
#[derive(Clone, Debug)]
pub struct SpeedRange {
    pub least: f64,
    pub most: f64,
    /// Where a speed is wanted: of each pass the one that is most times too fast or too slow.
    pub of_passes: Vec<WorstSpeed>,
}

#[derive(Clone, Copy, Debug)]
pub struct WorstSpeed {
    /// Counted from 0.
    pub pass: usize,
    /// On the burr, mm.
    pub at: Point3<f64>,
    pub found: f64,
    pub wanted: f64,
    /// The first and the last sample of the stretch, counted from 0.
    ends: [usize; 2],
}

impl WorstSpeed {
    pub fn is_wrong(&self) -> bool {
        ALLOWED * self.wanted < (self.found - self.wanted).abs()
    }

    /// How many times too fast or too slow, 1 or more.
    pub fn times(&self) -> f64 {
        (self.found / self.wanted).max(self.wanted / self.found)
    }

    /// The block of the stretch that is most times too fast or too slow, taken alone.
    pub fn place<'t>(&self, trace: &'t Trace) -> Option<&'t Backtrace> {
        let [first, last] = self.ends;
        let mut blocks: Vec<(&Backtrace, f64, f64)> = Vec::new();
        for pair in trace.samples[first..=last].windows(2) {
            let place = trace.place(&pair[1]);
            let (way, seconds) = (pair[1].way - pair[0].way, pair[1].seconds - pair[0].seconds);
            match blocks.last_mut().filter(|(last, ..)| std::ptr::eq(*last, place)) {
                Some((_, all, time)) => (*all, *time) = (*all + way, *time + seconds),
                None => blocks.push((place, way, seconds)),
            }
        }
        let alone = |way: f64, seconds: f64| Self { found: 60.0 * way / seconds, ..*self }.times();
        blocks.iter().max_by(|a, b| alone(a.1, a.2).total_cmp(&alone(b.1, b.2))).map(|(place, ..)| *place)
    }
}

impl SpeedRange {
    pub(super) fn of(wanted: &Flutes, passes: &[GrindingPass]) -> Option<Self> {
        let mut range: Option<Self> = None;
        for (pass, ground) in passes.iter().enumerate() {
            let mut worst: Option<WorstSpeed> = None;
            for window in ground.trace.windows(wanted.gauge) {
                let [first, last] = window.ends.map(|end| &ground.trace.samples[end]);
                let found = 60.0 * (last.way - first.way) / (last.seconds - first.seconds);
                let range = range.get_or_insert(Self { least: found, most: found, of_passes: Vec::new() });
                range.least = range.least.min(found);
                range.most = range.most.max(found);
                let Some(speed) = wanted.speed else { continue };
                let here = WorstSpeed { pass, at: window.middle.at, found, wanted: speed, ends: window.ends };
                if worst.is_none_or(|worst| worst.times() + 1e-6 < here.times()) {
                    worst = Some(here);
                }
            }
            if let Some((range, worst)) = range.as_mut().zip(worst) {
                range.of_passes.push(worst);
            }
        }
        range
    }
}
