//! The contact's path on the burr: how far off the surface, how far along and around it, and its direction.
use nalgebra::Point3;

use gcode_lang::motion::Backtrace;
use gcode_lang::units::Deg;
use gcode_part::Flutes;
use gcode_part::job::FluteLaw;

/// One point of the path; lengths in mm.
#[derive(Clone, Copy, Debug)]
pub struct Sample {
    pub point: Point3<f64>,
    /// From the tooth bottom; below 0 inside.
    pub deviation: f64,
    /// Polar angle of the surface's normal, from the tip.
    pub polar: Deg,
    /// The way from the pass's beginning along the meridian, towards the tip.
    pub along: f64,
    /// The way around the axis; above 0 right-handed with the way along.
    pub around: f64,
    /// The way around that the wanted law makes of the way along.
    pub nominal_around: f64,
    /// The same by the other law.
    pub other_law_around: f64,
    /// The angle it has turned about the axis since the pass's beginning, in the sense of `around`.
    pub turned_angle: Deg,
    /// The angle about the axis where the pass begins, in the same sense.
    pub start_azimuth: Deg,
    /// The contact's own way since the pass's beginning, and the time it took, s.
    pub path_length: f64,
    pub seconds: f64,
    /// Which of [`Trace::places`] moved here.
    move_index: usize,
}

/// The path of one pass.
#[derive(Clone, Debug, Default)]
pub struct Trace {
    pub samples: Vec<Sample>,
    backtraces: Vec<Backtrace>,
    /// That all moves so far took.
    seconds: f64,
}

/// The path's direction over a stretch of gauge length.
#[derive(Clone, Copy, Debug)]
pub struct Window<'t> {
    pub middle: &'t Sample,
    /// Its first and its last sample, counted from 0.
    pub ends: [usize; 2],
    pub helix: Deg,
    pub nominal_helix: Deg,
    /// What the other law would have.
    pub other_law_helix: Deg,
}

/// The angle about the axis in the sense of `around`.
fn azimuth(p: &Point3<f64>) -> Deg {
    Deg::atan2(-p.z, p.y)
}

impl Trace {
    /// Goes on along `path`, whose first point is where the trace has come to and whose points are equally far in time.
    /// Ways along and around are those of the surface's points below the path: how far the path is off says nothing of its
    /// direction.
    pub(super) fn append(&mut self, flutes: &Flutes, path: &[Point3<f64>], seconds: f64, place: Backtrace) {
        let profile = &flutes.profile;
        let index = self.backtraces.len();
        self.backtraces.push(place);
        let begun = self.seconds;
        self.seconds += seconds;
        let steps = path.len().saturating_sub(1).max(1) as f64;
        let other = match flutes.law {
            FluteLaw::ConstantHelix => FluteLaw::Published,
            FluteLaw::Published => FluteLaw::ConstantHelix,
        };
        let foot = |at: &Point3<f64>| profile.foot(at);
        let mut previous_foot = self.samples.last().map(|last| foot(&last.point));
        for (step, at) in path.iter().enumerate() {
            let mut sample = Sample {
                point: *at,
                deviation: profile.distance(at),
                polar: profile.polar(at),
                along: 0.0,
                around: 0.0,
                nominal_around: 0.0,
                other_law_around: 0.0,
                turned_angle: Deg::ZERO,
                start_azimuth: azimuth(at),
                path_length: 0.0,
                seconds: begun + seconds * step as f64 / steps,
                move_index: index,
            };
            let current_foot = foot(at);
            if let Some((last, before)) = self.samples.last().zip(previous_foot) {
                if *at == last.point {
                    continue;
                }
                let by = current_foot - before;
                let middle = nalgebra::center(&current_foot, &before);
                let (meridian, around) = profile.directions(&middle);
                let along = by.dot(&meridian);
                sample.along = last.along + along;
                sample.around = last.around + by.dot(&around);
                sample.nominal_around = last.nominal_around + flutes.slope(flutes.law, &middle) * along;
                sample.other_law_around = last.other_law_around + flutes.slope(other, &middle) * along;
                sample.turned_angle =
                    last.turned_angle + Deg(wrap_angle(azimuth(at).0 - azimuth(&last.point).0));
                sample.start_azimuth = last.start_azimuth;
                sample.path_length = last.path_length + (at - last.point).norm();
            }
            self.samples.push(sample);
            previous_foot = Some(current_foot);
        }
    }

    /// The programmed points: where the pass begins, and where each of its moves ends.
    pub fn programmed_points(&self) -> impl Iterator<Item = &Sample> {
        let ends = self.samples.windows(2).filter(|pair| pair[0].move_index != pair[1].move_index);
        let first = self.samples.first().filter(|_| 1 < self.samples.len());
        first.into_iter().chain(ends.map(|pair| &pair[0])).chain(self.samples.last())
    }

    /// The block that moved to a sample.
    pub fn backtrace(&self, sample: &Sample) -> &Backtrace {
        &self.backtraces[sample.move_index]
    }

    /// The direction of the path, over every stretch of the gauge's length, or over all of it if it is shorter.
    pub fn windows(&self, gauge: f64) -> impl Iterator<Item = Window<'_>> {
        let length =
            |one: &Sample, other: &Sample| libm::hypot(other.along - one.along, other.around - one.around);
        let samples = &self.samples;
        let whole = samples.first().zip(samples.last()).map_or(0.0, |(first, last)| length(first, last));
        let gauge = gauge.min(whole * (1.0 - 1e-9));
        let mut end = 0;
        samples.iter().enumerate().map_while(move |(start, first)| {
            while length(first, samples.get(end)?) < gauge || end <= start {
                end += 1;
            }
            let last = &samples[end];
            // The same flute, whichever way it is ground.
            let along = last.along - first.along;
            let sense = if along < 0.0 { -1.0 } else { 1.0 };
            let angle = |way: f64| Deg::atan2(way * sense, along.abs());
            Some(Window {
                middle: &samples[(start + end) / 2],
                ends: [start, end],
                helix: angle(last.around - first.around),
                nominal_helix: angle(last.nominal_around - first.nominal_around),
                other_law_helix: angle(last.other_law_around - first.other_law_around),
            })
        })
    }

    /// The angle about the axis where the path crosses `x`; `None` where it doesn't.
    pub fn angle_at(&self, x: f64) -> Option<Deg> {
        let crossing = |pair: &[Sample]| (pair[0].point.x - x) * (pair[1].point.x - x) <= 0.0;
        let pair = self.samples.windows(2).find(|pair| crossing(pair))?;
        let (before, after) = (&pair[0], &pair[1]);
        let way = before.point.x - after.point.x;
        let part = if way == 0.0 { 0.0 } else { (before.point.x - x) / way };
        Some(before.start_azimuth + before.turned_angle + (after.turned_angle - before.turned_angle) * part)
    }
}

/// The same turn by the shorter way, −180° to 180°.
pub fn wrap_angle(angle: f64) -> f64 {
    (angle + 180.0).rem_euclid(360.0) - 180.0
}
