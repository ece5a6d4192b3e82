//! The flutes round the burr: which passes are one flute, how evenly they are spaced, how near neighbours come.
use nalgebra::Point3;

use super::path_distance;
use crate::flutes::{GrindingPass, Sample, wrap_angle};
use gcode_lang::units::Deg;
use gcode_part::Flutes;

/// The passes by their place round the burr.
#[derive(Clone, Debug, Default)]
pub struct FluteSpacing {
    /// The distinct flutes in the order of their angle: the first pass of each, counted from 0, and its angle halfway
    /// along, 0° to 360°.
    pub flutes: Vec<(usize, Deg)>,
    /// Passes that go over a flute that is there already, in the order in which they are ground.
    pub repeated: Vec<RepeatedPass>,
    /// The gap that is most off, of the wanted number of flutes, anywhere along them.
    pub worst_gap: Option<Gap>,
    /// The least distance between the paths of neighbours, in a straight line, mm.
    pub nearest_approach: Option<NearestApproach>,
}

/// A pass over a flute that an earlier one has ground; both counted from 0.
#[derive(Clone, Copy, Debug)]
pub struct RepeatedPass {
    pub pass: usize,
    pub first_pass: usize,
}

/// Where neighbours come nearest to each other.
#[derive(Clone, Copy, Debug)]
pub struct NearestApproach {
    /// In a straight line, mm.
    pub distance: f64,
    /// One of the two, counted from 0, and the place on it.
    pub pass: usize,
    pub point: Point3<f64>,
}

/// From one flute to the next one round the burr, at one place along them.
#[derive(Clone, Copy, Debug)]
pub struct Gap {
    /// Counted from 0, as in [`FluteSpacing::flutes`].
    pub from_flute: usize,
    pub actual: Deg,
    /// How far it is from the wanted one.
    pub error: Deg,
    /// Along x, where it is so, and the polar angle there.
    pub x: f64,
    pub polar: Deg,
    /// Of the two flutes the one that stands farther from its place between all others, which of its samples is there,
    /// and the first of them that is nearly as far off.
    pub pass: usize,
    pub sample: usize,
    pub first_sample: usize,
    /// How far that flute stands from its place; `None` of two flutes, for either may be right.
    pub index_error: Option<Deg>,
}

/// How far each flute is from the one that is ground before it, where that is always the same.
#[derive(Clone, Copy, Debug)]
pub(super) struct IndexStep {
    pub actual: Deg,
    /// The nearest one with which flutes would be evenly spaced.
    pub nominal: Deg,
    /// The pass after the first step, counted from 0.
    pub pass: usize,
}

impl IndexStep {
    pub(super) fn error(&self) -> Deg {
        (self.actual - self.nominal).abs()
    }
}

/// Passes nearer to each other than so many tolerances of a flute's place are rounds over the same flute.
pub(super) const SAME_FLUTE: f64 = 2.0;

/// Angles nearer to each other than this are equal, degrees.
const ANGLE_EPSILON: f64 = 1e-6;

/// A flute's angle about the axis by its place along the meridian.
struct FluteCurve {
    /// Growing towards the tip, mm.
    stations: Vec<f64>,
    angles: Vec<f64>,
}

impl FluteSpacing {
    pub(super) fn of(wanted: &Flutes, passes: &[GrindingPass]) -> Self {
        let middle = middle_x(wanted);
        let angle = |pass: &GrindingPass| {
            let first = pass.trace.samples.first()?;
            let found = pass.trace.angle_at(middle).unwrap_or(first.start_azimuth);
            Some(Deg(found.0.rem_euclid(360.0)))
        };
        let mut all: Vec<(usize, Deg)> =
            passes.iter().enumerate().filter_map(|(index, pass)| Some((index, angle(pass)?))).collect();
        all.sort_by(|one, other| one.1.0.total_cmp(&other.1.0));
        let mut round = Self::default();
        let mut over: Vec<(usize, usize)> = Vec::new();
        for (pass, angle) in all {
            let same = |other: &(usize, Deg)| {
                let gap = (angle.0 - other.1.0).rem_euclid(360.0);
                gap.min(360.0 - gap) <= SAME_FLUTE * wanted.index_tolerance.0
            };
            if round.flutes.last().is_some_and(same) {
                over.push((pass, round.flutes.len() - 1));
            } else if round.flutes.first().is_some_and(same) {
                over.push((pass, 0));
            } else {
                round.flutes.push((pass, angle));
            }
        }
        round.repeated = repeated_passes(&round.flutes, &over);
        round.worst_gap = round.worst_gap_of(wanted, passes);
        round.nearest_approach = round.find_nearest(passes);
        round
    }

    /// The gap behind every flute at every one of its samples: the worst.
    fn worst_gap_of(&self, wanted: &Flutes, passes: &[GrindingPass]) -> Option<Gap> {
        let pitch = 360.0 / f64::from(wanted.count);
        let courses: Vec<FluteCurve> =
            self.flutes.iter().map(|(pass, _)| FluteCurve::of(wanted, &passes[*pass])).collect();
        let count = courses.len();
        // One flute alone is its own neighbour a whole turn further.
        let gap = |here: f64, there: f64| if count == 1 { 360.0 } else { (there - here).rem_euclid(360.0) };
        let mut worst: Option<(Gap, f64)> = None;
        for (flute, (pass, _)) in self.flutes.iter().enumerate() {
            let (before, after) = ((flute + count - 1) % count, (flute + 1) % count);
            for (index, sample) in passes[*pass].trace.samples.iter().enumerate() {
                let (at, angle) = (station(wanted, sample), (sample.start_azimuth + sample.turned_angle).0);
                let behind = courses[before].angle_at(at).map(|other| (before, gap(other, angle)));
                let ahead = courses[after].angle_at(at).map(|other| (flute, gap(angle, other)));
                for (from, found) in [ahead, behind].into_iter().flatten() {
                    let off = Deg((found - pitch).abs());
                    if worst.is_none_or(|(worst, _)| worst.error.0 + ANGLE_EPSILON < off.0) {
                        let (x, polar) = (sample.point.x, sample.polar);
                        let (pass, sample, first) = (*pass, index, index);
                        let found = Deg(found);
                        let gap = Gap {
                            from_flute: from,
                            actual: found,
                            error: off,
                            x,
                            polar,
                            pass,
                            sample,
                            first_sample: first,
                            index_error: None,
                        };
                        worst = Some((gap, at));
                    }
                }
            }
        }
        let (mut worst, at) = worst?;
        // Which of both stands wrong decides whose block is named.
        let (from, after) = (worst.from_flute, (worst.from_flute + 1) % count);
        let (flute, astray) = misplaced_flute(&courses, pitch, at, [from, after], &self.flutes);
        worst.index_error = astray.map(Deg);
        let (other, ahead) = if flute == from { (after, true) } else { (from, false) };
        let samples = &passes[self.flutes[flute].0].trace.samples;
        let off = |sample: &Sample| {
            let angle = (sample.start_azimuth + sample.turned_angle).0;
            let there = courses[other].angle_at(station(wanted, sample))?;
            Some((if ahead { gap(angle, there) } else { gap(there, angle) } - pitch).abs())
        };
        let far = |part: f64| {
            samples.iter().position(|sample| off(sample).is_some_and(|off| part * worst.error.0 <= off))
        };
        if let Some(first) = far(0.9) {
            let sample = far(0.999).unwrap_or(first);
            (worst.pass, worst.sample, worst.first_sample) = (self.flutes[flute].0, sample, first);
        }
        Some(worst)
    }

    /// The step from each flute to the one ground after it, of three and more; `None` where it isn't the same.
    pub(super) fn index_step(&self, wanted: &Flutes) -> Option<IndexStep> {
        let mut ground = self.flutes.clone();
        ground.sort_by_key(|(pass, _)| *pass);
        let steps = ground.windows(2).map(|pair| wrap_angle(pair[1].1.0 - pair[0].1.0));
        let (least, most) = steps.clone().fold((f64::INFINITY, f64::NEG_INFINITY), |(least, most), step| {
            (step.min(least), step.max(most))
        });
        let pitch = 360.0 / f64::from(wanted.count);
        let mean = steps.sum::<f64>() / ground.len().saturating_sub(1) as f64;
        let step = IndexStep {
            actual: Deg(mean),
            nominal: Deg((mean / pitch).round() * pitch),
            pass: ground.get(1)?.0,
        };
        (3 <= ground.len() && most - least <= step.error().0 / 2.0).then_some(step)
    }

    /// Where flutes would have to be so that none is missing, halfway along the burr: so many to a gap as it is wider
    /// than an even one.
    pub(super) fn missing_points(&self, wanted: &Flutes) -> Vec<Point3<f64>> {
        let pitch = 360.0 / f64::from(wanted.count);
        let outside = Point3::new(middle_x(wanted), -wanted.profile.radius(), 0.0);
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

    fn find_nearest(&self, passes: &[GrindingPass]) -> Option<NearestApproach> {
        let paths: Vec<Vec<Point3<f64>>> = self
            .flutes
            .iter()
            .map(|(pass, _)| passes[*pass].trace.samples.iter().map(|sample| sample.point).collect())
            .collect();
        let pairs = (0..paths.len()).map(|from| (from, (from + 1) % paths.len()));
        pairs
            .filter(|(from, to)| from != to)
            .filter_map(|(from, to)| {
                let (apart, piece) = path_distance::distance(&paths[from], &paths[to])?;
                Some(NearestApproach {
                    distance: apart,
                    pass: self.flutes[from].0,
                    point: paths[from][piece],
                })
            })
            .reduce(|best, near| if near.distance < best.distance { near } else { best })
    }
}

/// Of each flute all passes but the one that grinds it first. `over`: passes, and over which of the flutes they go.
fn repeated_passes(flutes: &[(usize, Deg)], over: &[(usize, usize)]) -> Vec<RepeatedPass> {
    let mut all = Vec::new();
    for (flute, (known, _)) in flutes.iter().enumerate() {
        let others = over.iter().filter(|(_, of)| *of == flute).map(|(pass, _)| *pass);
        let mut passes: Vec<usize> = others.chain([*known]).collect();
        passes.sort_unstable();
        all.extend(passes[1..].iter().map(|pass| RepeatedPass { pass: *pass, first_pass: passes[0] }));
    }
    all.sort_unstable_by_key(|again| again.pass);
    all
}

/// Halfway along the flutes, by x.
fn middle_x(wanted: &Flutes) -> f64 {
    (wanted.start + wanted.profile.point_at_polar(wanted.tip_angle).x) / 2.0
}

/// Which of two flutes stands farther from its place between all others, and how far; places are those with which most
/// agree. Of two flutes in all either may be right: the one ground later is named.
fn misplaced_flute(
    courses: &[FluteCurve],
    pitch: f64,
    at: f64,
    pair: [usize; 2],
    flutes: &[(usize, Deg)],
) -> (usize, Option<f64>) {
    let later = if flutes[pair[0]].0 < flutes[pair[1]].0 { pair[1] } else { pair[0] };
    let angles = courses.iter().enumerate();
    let all: Vec<(usize, f64)> =
        angles.filter_map(|(n, course)| Some((n, course.angle_at(at)? - pitch * n as f64))).collect();
    let Some((_, zero)) = all.first().copied() else { return (later, None) };
    let mut sorted: Vec<f64> = all.iter().map(|(_, phase)| wrap_angle(phase - zero)).collect();
    sorted.sort_by(f64::total_cmp);
    let middle = sorted[(sorted.len() - 1) / 2];
    let off = |flute: usize| {
        let phase = all.iter().find(|(n, _)| *n == flute).map(|(_, phase)| wrap_angle(phase - zero - middle));
        phase.map_or(0.0, f64::abs)
    };
    let [one, other] = pair.map(off);
    if courses.len() < 3 || (one - other).abs() <= ANGLE_EPSILON {
        return (later, None);
    }
    if other < one { (pair[0], Some(one)) } else { (pair[1], Some(other)) }
}

/// The way along the meridian from the end of the cylinder, towards the tip: on the nose by the direction of the normal,
/// which a depth that is off doesn't change.
fn station(wanted: &Flutes, sample: &Sample) -> f64 {
    if 0.0 < sample.point.x {
        -sample.point.x
    } else {
        wanted.profile.radius() * (Deg(90.0) - sample.polar).to_rad()
    }
}

impl FluteCurve {
    /// Stretches that go back are left out.
    fn of(wanted: &Flutes, pass: &GrindingPass) -> Self {
        let mut all: Vec<(f64, f64)> = pass
            .trace
            .samples
            .iter()
            .map(|sample| (station(wanted, sample), (sample.start_azimuth + sample.turned_angle).0))
            .collect();
        if all.first().zip(all.last()).is_some_and(|(first, last)| last.0 < first.0) {
            all.reverse();
        }
        let mut course = Self { stations: Vec::new(), angles: Vec::new() };
        for (place, angle) in all {
            if course.stations.last().is_none_or(|last| *last < place) {
                course.stations.push(place);
                course.angles.push(angle);
            }
        }
        course
    }

    /// `None` where the flute doesn't come.
    fn angle_at(&self, place: f64) -> Option<f64> {
        let (first, last) = (*self.stations.first()?, *self.stations.last()?);
        let slack = 1e-6;
        if place < first - slack || last + slack < place {
            return None;
        }
        let after = self.stations.partition_point(|one| *one < place).min(self.stations.len() - 1);
        let before = after.saturating_sub(1);
        let way = self.stations[after] - self.stations[before];
        let part = if way == 0.0 { 0.0 } else { ((place - self.stations[before]) / way).clamp(0.0, 1.0) };
        Some(self.angles[before] + (self.angles[after] - self.angles[before]) * part)
    }
}
