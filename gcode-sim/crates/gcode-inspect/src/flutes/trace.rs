//! Path of the contact on the burr: distance from the tooth bottom, path along and around the burr, direction.
use nalgebra::Point3;

use gcode_lang::motion::Backtrace;
use gcode_lang::units::Deg;
use gcode_part::Flutes;
use gcode_part::job::FluteLaw;

/// One point of the path; lengths in mm.
#[derive(Clone, Copy, Debug)]
pub struct Sample {
    /// Point in the part's frame.
    pub point: Point3<f64>,
    /// Distance from the tooth bottom; negative inside.
    pub deviation: f64,
    /// Polar angle of the surface normal, from the tip.
    pub polar: Deg,
    /// Path along the meridian since the start of the pass, towards the tip.
    pub along: f64,
    /// Path around the axis; positive is right-handed with the path along.
    pub(crate) around: f64,
    /// Path around by the nominal law, for the actual path along.
    pub(crate) nominal_around: f64,
    /// The same by the other law.
    other_law_around: f64,
    /// Rotation about the axis since the start of the pass, in the sense of `around`.
    pub(crate) turned_angle: Deg,
    /// Angle about the axis at the start of the pass, in the same sense.
    pub(crate) start_azimuth: Deg,
    /// Length of the path since the start of the pass.
    pub(crate) path_length: f64,
    /// Time since the start of the pass.
    pub(crate) seconds: f64,
    /// Index of the move in [`Trace::backtraces`].
    move_index: usize,
}

impl Sample {
    /// Returns the angle about the axis, continuous along the pass.
    pub(crate) fn angle(&self) -> Deg {
        self.start_azimuth + self.turned_angle
    }
}

/// The path of one pass.
#[derive(Clone, Debug, Default)]
pub struct Trace {
    /// Points in order.
    pub samples: Vec<Sample>,
    /// Block of each move.
    backtraces: Vec<Backtrace>,
    /// Time of all moves so far.
    seconds: f64,
}

/// Direction of the path over a stretch of the gauge length.
#[derive(Clone, Copy, Debug)]
pub struct Window<'t> {
    /// Sample in its middle.
    pub middle: &'t Sample,
    /// First and last sample, counted from 0.
    pub(crate) ends: [usize; 2],
    /// Helix angle.
    pub helix: Deg,
    /// Helix angle by the nominal law.
    pub nominal_helix: Deg,
    /// Helix angle by the other law.
    pub other_law_helix: Deg,
}

/// Returns the other of the two laws.
pub(crate) fn other_law(law: FluteLaw) -> FluteLaw {
    match law {
        FluteLaw::ConstantHelix => FluteLaw::Published,
        FluteLaw::Published => FluteLaw::ConstantHelix,
    }
}

/// Returns the angle about the axis in the sense of `around`.
fn azimuth(p: &Point3<f64>) -> Deg {
    Deg::atan2(-p.z, p.y)
}

impl Trace {
    /// Appends `path`, which begins at the last sample and whose points have equal time steps. Along and around are
    /// measured on the surface below the path: its height does not change its direction.
    pub(super) fn append(
        &mut self,
        flutes: &Flutes,
        path: &[Point3<f64>],
        seconds: f64,
        backtrace: Backtrace,
    ) {
        let profile = &flutes.profile;
        let index = self.backtraces.len();
        self.backtraces.push(backtrace);
        let begun = self.seconds;
        self.seconds += seconds;
        let steps = path.len().saturating_sub(1).max(1) as f64;
        let other = other_law(flutes.law);
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

    /// Returns the programmed points: the start of the pass, and the end of each of its moves.
    pub(crate) fn programmed_points(&self) -> impl Iterator<Item = &Sample> {
        let ends = self.samples.windows(2).filter(|pair| pair[0].move_index != pair[1].move_index);
        let first = self.samples.first().filter(|_| 1 < self.samples.len());
        first.into_iter().chain(ends.map(|pair| &pair[0])).chain(self.samples.last())
    }

    /// Returns the block that moved to a sample.
    pub(crate) fn backtrace(&self, sample: &Sample) -> &Backtrace {
        &self.backtraces[sample.move_index]
    }

    /// Sums two values over the steps of each block, for pairs of consecutive samples.
    pub(crate) fn sum_by_block<'t>(
        &'t self,
        pairs: impl Iterator<Item = &'t [Sample]>,
        values: impl Fn(&Sample, &Sample) -> [f64; 2],
    ) -> Vec<(&'t Backtrace, [f64; 2])> {
        let mut blocks: Vec<(&Backtrace, [f64; 2])> = Vec::new();
        for pair in pairs {
            let backtrace = self.backtrace(&pair[1]);
            let [first, second] = values(&pair[0], &pair[1]);
            match blocks.last_mut().filter(|(last, _)| std::ptr::eq(*last, backtrace)) {
                Some((_, [sum, other])) => (*sum, *other) = (*sum + first, *other + second),
                None => blocks.push((backtrace, [first, second])),
            }
        }
        blocks
    }

    /// Returns the direction of the path over every stretch of the gauge length, or over a whole path that is shorter.
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
            // A flute is the same in both directions of grinding.
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

    /// Returns the angle about the axis at which the path crosses `x`; `None` if it does not.
    pub fn angle_at(&self, x: f64) -> Option<Deg> {
        let crossing = |pair: &[Sample]| (pair[0].point.x - x) * (pair[1].point.x - x) <= 0.0;
        let pair = self.samples.windows(2).find(|pair| crossing(pair))?;
        let (before, after) = (&pair[0], &pair[1]);
        let way = before.point.x - after.point.x;
        let part = if way == 0.0 { 0.0 } else { (before.point.x - x) / way };
        Some(before.angle() + (after.turned_angle - before.turned_angle) * part)
    }
}

/// Returns the equivalent angle between −180 and 180.
pub(crate) fn wrap_angle(angle: f64) -> f64 {
    (angle + 180.0).rem_euclid(360.0) - 180.0
}
