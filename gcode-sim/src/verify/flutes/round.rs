//! The flutes round the burr: which passes are one flute, how evenly they are spaced, how near neighbours come.
use crate::flutes::Pass;
use crate::part::flutes::Flutes;
use crate::units::Deg;

/// The passes by their place round the burr.
#[derive(Clone, Debug, Default)]
pub struct Round {
    /// The distinct flutes in the order of their angle: the first pass of each, counted from 0, and its angle halfway
    /// along, 0° to 360°.
    pub flutes: Vec<(usize, Deg)>,
    /// Passes that go over a flute that is there already.
    pub again: usize,
    /// The gap that is most off, of the wanted number of flutes.
    pub worst_gap: Option<Gap>,
    /// The least distance between neighbours, across them, mm.
    pub nearest: Option<f64>,
}

/// From one flute to the next one round the burr.
#[derive(Clone, Copy, Debug)]
pub struct Gap {
    /// Counted from 0, as in [`Round::flutes`].
    pub from: usize,
    pub found: Deg,
    /// Along x, where it is so.
    pub x: f64,
}

/// At so many places along the flutes their spacing is measured.
const STATIONS: usize = 24;

impl Round {
    pub(super) fn of(wanted: &Flutes, passes: &[Pass]) -> Self {
        let end = wanted.profile.at_polar(wanted.tip_angle).x;
        let middle = (wanted.start + end) / 2.0;
        let pitch = 360.0 / f64::from(wanted.count);
        let angle = |pass: &Pass| {
            let first = pass.trace.samples.first()?;
            let found = pass.trace.angle_at(middle).unwrap_or(first.begun);
            Some(Deg(found.0.rem_euclid(360.0)))
        };
        let mut all: Vec<(usize, Deg)> =
            passes.iter().enumerate().filter_map(|(index, pass)| Some((index, angle(pass)?))).collect();
        all.sort_by(|one, other| one.1.0.total_cmp(&other.1.0));
        let mut round = Self::default();
        for (pass, angle) in all {
            let same = |other: &(usize, Deg)| {
                let gap = (angle.0 - other.1.0).rem_euclid(360.0);
                gap.min(360.0 - gap) < 0.25 * pitch
            };
            let last = round.flutes.last().is_some_and(same);
            if last || round.flutes.first().is_some_and(same) {
                round.again += 1;
            } else {
                round.flutes.push((pass, angle));
            }
        }
        for station in 0..STATIONS {
            let part = (station as f64 + 0.5) / STATIONS as f64;
            round.look_at(wanted, passes, wanted.start + (end - wanted.start) * part);
        }
        // The tip is where flutes come nearest.
        round.look_at(wanted, passes, end + 1e-4 * wanted.profile.radius());
        round
    }

    /// The gaps between neighbours at a place along the burr.
    fn look_at(&mut self, wanted: &Flutes, passes: &[Pass], x: f64) {
        let pitch = 360.0 / f64::from(wanted.count);
        for from in 0..self.flutes.len() {
            let to = (from + 1) % self.flutes.len();
            let (one, other) = (self.flutes[from].0, self.flutes[to].0);
            let angles = passes[one].trace.angle_at(x).zip(passes[other].trace.angle_at(x));
            let Some((one_angle, other_angle)) = angles else { continue };
            let turn = other_angle.0 - one_angle.0;
            // One flute alone is its own neighbour a whole turn further.
            let found = if from == to { 360.0 } else { turn.rem_euclid(360.0) };
            let gap = Gap { from, found: Deg(found), x };
            let off = |gap: &Gap| (gap.found.0 - pitch).abs();
            if self.worst_gap.is_none_or(|worst| off(&worst) < off(&gap)) {
                self.worst_gap = Some(gap);
            }
            let Some(sample) = passes[one].trace.samples.iter().find(|s| s.at.x <= x) else { continue };
            let radius = libm::hypot(sample.at.y, sample.at.z);
            let slope = wanted.slope(wanted.law, &sample.at);
            // Across the flutes, which cross the circle at their helix angle.
            let near = radius * Deg(found.min(360.0 - found)).to_rad() / (1.0 + slope * slope).sqrt();
            if from != to && self.nearest.is_none_or(|nearest| near < nearest) {
                self.nearest = Some(near);
            }
        }
    }
}
