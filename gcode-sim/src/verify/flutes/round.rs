//! The flutes round the burr: which passes are one flute, how evenly they are spaced, how near neighbours come.
use nalgebra::Point3;

use super::near;
use crate::flutes::{Pass, Sample};
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
    /// The gap that is most off, of the wanted number of flutes, anywhere along them.
    pub worst_gap: Option<Gap>,
    /// The least distance between the paths of neighbours, in a straight line, mm.
    pub nearest: Option<Near>,
}

/// Where neighbours come nearest to each other.
#[derive(Clone, Copy, Debug)]
pub struct Near {
    /// In a straight line, mm.
    pub apart: f64,
    /// One of the two, counted from 0, and the place on it.
    pub pass: usize,
    pub at: Point3<f64>,
}

/// From one flute to the next one round the burr, at one place along them.
#[derive(Clone, Copy, Debug)]
pub struct Gap {
    /// Counted from 0, as in [`Round::flutes`].
    pub from: usize,
    pub found: Deg,
    /// How far it is from the wanted one.
    pub off: Deg,
    /// Along x, where it is so, and the polar angle there.
    pub x: f64,
    pub polar: Deg,
    /// Of the two flutes the one that stands farther from the middle between its neighbours, and which of its samples.
    pub pass: usize,
    pub sample: usize,
    /// How far it stands from there.
    astray: f64,
}

/// Passes nearer to each other than so many tolerances of a flute's place are rounds over the same flute.
pub(super) const SAME: f64 = 2.0;

/// Angles nearer to each other than this are equal, degrees.
const EQUAL: f64 = 1e-6;

/// A flute's angle about the axis by its place along the meridian.
struct Course {
    /// Growing towards the tip, mm.
    places: Vec<f64>,
    angles: Vec<f64>,
}

impl Round {
    pub(super) fn of(wanted: &Flutes, passes: &[Pass]) -> Self {
        let middle = middle(wanted);
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
                gap.min(360.0 - gap) <= SAME * wanted.index_tolerance.0
            };
            let last = round.flutes.last().is_some_and(same);
            if last || round.flutes.first().is_some_and(same) {
                round.again += 1;
            } else {
                round.flutes.push((pass, angle));
            }
        }
        round.worst_gap = round.gaps(wanted, passes);
        round.nearest = round.nearest(passes);
        round
    }

    /// The gaps on both sides of every flute at every one of its samples: the worst.
    fn gaps(&self, wanted: &Flutes, passes: &[Pass]) -> Option<Gap> {
        let pitch = 360.0 / f64::from(wanted.count);
        let courses: Vec<Course> =
            self.flutes.iter().map(|(pass, _)| Course::of(wanted, &passes[*pass])).collect();
        let count = courses.len();
        let mut worst: Option<Gap> = None;
        for (flute, (pass, _)) in self.flutes.iter().enumerate() {
            let (before, after) = ((flute + count - 1) % count, (flute + 1) % count);
            for (index, sample) in passes[*pass].trace.samples.iter().enumerate() {
                let (at, angle) = (place(wanted, sample), (sample.begun + sample.turned).0);
                // One flute alone is its own neighbour a whole turn further.
                let turn = |angle: f64| if count == 1 { 360.0 } else { angle.rem_euclid(360.0) };
                let behind = courses[before].angle(at).map(|other| turn(angle - other));
                let ahead = courses[after].angle(at).map(|other| turn(other - angle));
                let astray = behind.zip(ahead).map_or(0.0, |(behind, ahead)| (behind - ahead).abs() / 2.0);
                for (from, found) in [(flute, ahead), (before, behind)] {
                    let Some(found) = found else { continue };
                    let gap = Gap {
                        from,
                        found: Deg(found),
                        off: Deg((found - pitch).abs()),
                        x: sample.at.x,
                        polar: sample.polar,
                        pass: *pass,
                        sample: index,
                        astray,
                    };
                    if worst.is_none_or(|worst| gap.is_worse(&worst)) {
                        worst = Some(gap);
                    }
                }
            }
        }
        worst
    }

    /// Where flutes would have to be so that none is missing, halfway along the burr: so many to a gap as it is wider
    /// than an even one.
    pub(super) fn absent(&self, wanted: &Flutes) -> Vec<Point3<f64>> {
        let pitch = 360.0 / f64::from(wanted.count);
        let outside = Point3::new(middle(wanted), -wanted.profile.radius(), 0.0);
        let foot = wanted.profile.foot(&outside);
        let (x, radius) = (foot.x, -foot.y);
        let next = self.flutes.iter().skip(1).map(|(_, angle)| angle.0);
        let ends = next.chain(self.flutes.first().map(|(_, angle)| angle.0 + 360.0));
        let gaps = self.flutes.iter().map(|(_, angle)| angle.0).zip(ends);
        let places = gaps.flat_map(|(from, to)| {
            let pieces = ((to - from) / pitch).round().max(1.0);
            (1..pieces as u32).map(move |n| Deg(from + (to - from) * f64::from(n) / pieces))
        });
        places.map(|angle| Point3::new(x, radius * angle.cos(), -radius * angle.sin())).collect()
    }

    fn nearest(&self, passes: &[Pass]) -> Option<Near> {
        let paths: Vec<Vec<Point3<f64>>> = self
            .flutes
            .iter()
            .map(|(pass, _)| passes[*pass].trace.samples.iter().map(|sample| sample.at).collect())
            .collect();
        let pairs = (0..paths.len()).map(|from| (from, (from + 1) % paths.len()));
        pairs
            .filter(|(from, to)| from != to)
            .filter_map(|(from, to)| {
                let (apart, piece) = near::distance(&paths[from], &paths[to])?;
                Some(Near { apart, pass: self.flutes[from].0, at: paths[from][piece] })
            })
            .reduce(|best, near| if near.apart < best.apart { near } else { best })
    }
}

/// Halfway along the flutes, by x.
fn middle(wanted: &Flutes) -> f64 {
    (wanted.start + wanted.profile.at_polar(wanted.tip_angle).x) / 2.0
}

impl Gap {
    fn is_worse(&self, than: &Self) -> bool {
        let more = self.off.0 - than.off.0;
        EQUAL < more || (-EQUAL <= more && than.astray + EQUAL < self.astray)
    }
}

/// The way along the meridian from the end of the cylinder, towards the tip: on the nose by the direction of the normal,
/// which a depth that is off doesn't change.
fn place(wanted: &Flutes, sample: &Sample) -> f64 {
    if 0.0 < sample.at.x {
        -sample.at.x
    } else {
        wanted.profile.radius() * (Deg(90.0) - sample.polar).to_rad()
    }
}

impl Course {
    /// Stretches that go back are left out.
    fn of(wanted: &Flutes, pass: &Pass) -> Self {
        let mut all: Vec<(f64, f64)> = pass
            .trace
            .samples
            .iter()
            .map(|sample| (place(wanted, sample), (sample.begun + sample.turned).0))
            .collect();
        if all.first().zip(all.last()).is_some_and(|(first, last)| last.0 < first.0) {
            all.reverse();
        }
        let mut course = Self { places: Vec::new(), angles: Vec::new() };
        for (place, angle) in all {
            if course.places.last().is_none_or(|last| *last < place) {
                course.places.push(place);
                course.angles.push(angle);
            }
        }
        course
    }

    /// `None` where the flute doesn't come.
    fn angle(&self, place: f64) -> Option<f64> {
        let (first, last) = (*self.places.first()?, *self.places.last()?);
        let slack = 1e-6;
        if place < first - slack || last + slack < place {
            return None;
        }
        let after = self.places.partition_point(|one| *one < place).min(self.places.len() - 1);
        let before = after.saturating_sub(1);
        let way = self.places[after] - self.places[before];
        let part = if way == 0.0 { 0.0 } else { ((place - self.places[before]) / way).clamp(0.0, 1.0) };
        Some(self.angles[before] + (self.angles[after] - self.angles[before]) * part)
    }
}
