//! Error of the helix angle from straight moves and rounding, and the chord error that keeps it within the
//! job's tolerance.
//!
//! A path that deviates by the chord error is inclined to the flute: by that error per gauge length, and by
//! more near the tip, where the flute narrows within that length. If this exceeds the tolerance, the moves
//! are made for a smaller chord error.
use gcode_lang::control::Increment;
use gcode_lang::units::Deg;
use gcode_part::job::Burr;

use super::law::Flute;
use super::nose::{Arc, arcs};
use super::path::{Point, points};

/// The place of a flute with the largest error of its helix angle.
#[derive(Clone, Copy, Debug)]
pub(super) struct WorstHelixError {
    pub(super) error: Deg,
    /// Polar angle from the tip.
    pub(super) polar: Deg,
}

/// Share of the tolerance that is used: a measurement may begin and end between the places computed here.
const USED_SHARE: f64 = 0.95;

/// Returns the chord error for the moves: the job's, or a smaller one that keeps the helix angle within its
/// tolerance.
///
/// # Errors
/// If no chord error suffices, returns the place and size of the smallest helix angle error achieved.
pub(super) fn chord_error(job: &Burr) -> Result<f64, WorstHelixError> {
    let allowed = Deg(USED_SHARE * job.tolerance.helix);
    let least = job.control.increment.size();
    let mut best: Option<WorstHelixError> = None;
    let mut error = job.chord_error;
    loop {
        let helix_error = worst_error(job, error);
        if helix_error.error <= allowed {
            return Ok(error);
        }
        let better = best.filter(|best| best.error <= helix_error.error).unwrap_or(helix_error);
        if error <= least {
            return Err(better);
        }
        best = Some(better);
        // A grid keeps the value legible in the program.
        error = ((0.95e5 * error).floor() / 1e5).max(least);
    }
}

/// Returns the reason why no moves keep the helix angle, and alternatives.
pub(super) fn refusal(job: &Burr) -> Option<String> {
    let helix_error = chord_error(job).err()?;
    let holds = |change: &dyn Fn(&mut Burr)| {
        let mut other = job.clone();
        change(&mut other);
        chord_error(&other).is_ok()
    };
    let mut would = Vec::new();
    let finer = Increment::ALL.iter().filter(|(_, other)| other.size() < job.control.increment.size());
    would.extend(
        finer
            .map(|(name, other)| (name, *other))
            .find(|(_, other)| holds(&|job| job.control.increment = *other))
            .map(|(name, _)| format!("control.increment = \"{name}\", if the control has it")),
    );
    let grown = |from: f64, most: f64| {
        std::iter::successors(Some(from * 1.5), |value| Some(value * 1.5)).take_while(move |v| *v <= most)
    };
    would.extend(
        grown(job.shape.tip_angle, 85.0)
            .map(f64::ceil)
            .find(|angle| holds(&|job| job.shape.tip_angle = *angle))
            .map(|angle| format!("tip_angle = {angle:?}")),
    );
    would.extend(
        grown(job.chord_error, 0.05)
            .map(|error| (error * 1e4).ceil() / 1e4)
            .find(|error| holds(&|job| job.chord_error = *error))
            .map(|error| format!("chord_error = {error:?}, because the angle is measured over 250 of them")),
    );
    would
        .push(format!("[tolerance] helix = {:?}", (helix_error.error.0 / USED_SHARE * 100.0).ceil() / 100.0));
    Some(format!(
        "the helix angle cannot be kept within {}°: measured over {} mm of a flute, the shortest moves and \
         rounding to {} mm cause {:.2}° of error at polar angle {:.1}°; alternatives: {}",
        job.tolerance.helix,
        job.gauge(),
        job.control.increment.size(),
        helix_error.error.0,
        helix_error.polar.0,
        would.join("; or ")
    ))
}

/// A contact point on the burr, and the path lengths to it.
#[derive(Clone, Copy, Debug, Default)]
struct ContactPoint {
    /// Direction of the surface normal, as an angle of C.
    c: Deg,
    radius: f64,
    /// Path along the meridian and around the axis.
    along: f64,
    around: f64,
    /// Path around the axis by the law.
    nominal: f64,
}

/// Returns the worst place of a flute whose moves are made for a chord error.
fn worst_error(job: &Burr, error: f64) -> WorstHelixError {
    let places = contact_points(job, &points(job, error));
    let length = |one: &ContactPoint, other: &ContactPoint| {
        let (along, around) = (other.along - one.along, other.around - one.around);
        (along * along + around * around).sqrt()
    };
    let whole = places.first().zip(places.last()).map_or(0.0, |(first, last)| length(first, last));
    let gauge = job.gauge().min(whole * (1.0 - 1e-9));
    // A is rounded differently on every flute: at each end of a section by up to half an increment, in
    // opposite directions.
    let turn = Deg(job.control.increment.size()).to_rad();
    let mut worst = WorstHelixError { error: Deg(0.0), polar: Deg(90.0) };
    let mut end = 0;
    for (start, first) in places.iter().enumerate() {
        while end < places.len() && (end <= start || length(first, &places[end]) < gauge) {
            end += 1;
        }
        let Some(last) = places.get(end) else { break };
        let along = last.along - first.along;
        let actual = Deg::atan2(last.around - first.around, along);
        let nominal = Deg::atan2(last.nominal - first.nominal, along);
        let rounding = Deg::from_rad(turn * first.radius * nominal.cos() / length(first, last));
        let off = (actual - nominal).abs() + rounding;
        if worst.error < off {
            worst = WorstHelixError { error: off, polar: Deg(90.0) - places[(start + end) / 2].c };
        }
    }
    worst
}

/// Returns contact points along all moves, at most a fortieth of the gauge length apart, at least ten per
/// move.
fn contact_points(job: &Burr, points: &[Point]) -> Vec<ContactPoint> {
    let helix = Deg(job.helix);
    let begin = ContactPoint { radius: job.shape.radius, ..ContactPoint::default() };
    let mut places = vec![begin];
    let mut last = begin;
    for pair in points.windows(2) {
        let (from, to) = (&pair[0], &pair[1]);
        let turn = (to.a - from.a).to_rad();
        let count = (40.0 * to.path_length / job.gauge()).ceil().max(10.0);
        let arc = arcs(job).into_iter().find(|arc| from.c < to.c && to.c <= arc.to);
        for n in 1..=count as u32 {
            let part = f64::from(n) / count;
            last = match &arc {
                // On the cylinder X and A move in proportion.
                None => {
                    let along = to.path_length * helix.cos() / count;
                    let around = job.shape.radius * turn / count;
                    last.advanced_to(begin, along, around, helix.tan())
                }
                Some(arc) => {
                    let c = normal_direction(job, arc, from, to, part);
                    let middle = Deg((c.0 + last.c.0) / 2.0);
                    let slope = Flute { law: job.law, helix, arc: *arc }.slope(middle);
                    let here = ContactPoint { c, radius: arc.station(c).radius, ..last };
                    let around = arc.station(middle).radius * turn / count;
                    last.advanced_to(here, arc.radius * (c - last.c).to_rad(), around, slope)
                }
            };
            places.push(last);
        }
    }
    places
}

/// Returns the direction of the normal at the contact after a fraction of a move: C, corrected by the
/// deviation of X and Y.
fn normal_direction(job: &Burr, arc: &Arc, from: &Point, to: &Point, part: f64) -> Deg {
    let grid = |value: f64| job.control.increment.round(value);
    let mix = |one: f64, other: f64| one + (other - one) * part;
    let c = Deg(mix(from.c.0, to.c.0));
    // From the arc's centre to the wheel, which is `radius` below the end of the cylinder at X0 Y0 C0.
    let [offset_x, offset_y] = job.grinder.c_offset;
    let [centre_x, centre_y] = arc.carried(c);
    let x = offset_x - mix(grid(from.x), grid(to.x)) - centre_x;
    let y = offset_y - job.shape.radius - mix(grid(from.y), grid(to.y)) - centre_y;
    c + Deg::atan2(-x, -y)
}

impl ContactPoint {
    /// Returns the contact `here` with the path lengths extended to it.
    fn advanced_to(&self, here: Self, along: f64, around: f64, slope: f64) -> Self {
        Self {
            along: self.along + along,
            around: self.around + around,
            nominal: self.nominal + slope * along,
            ..here
        }
    }
}
