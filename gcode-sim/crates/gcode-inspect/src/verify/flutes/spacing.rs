//! Flutes round the burr: passes that are one flute, evenness of the spacing, distance of neighbours.
use nalgebra::Point3;

use super::path_distance;
use crate::flutes::{GrindingPass, Sample, wrap_angle};
use gcode_lang::units::Deg;
use gcode_part::Flutes;

/// The passes by their position round the burr.
#[derive(Clone, Debug, Default)]
pub(super) struct FluteSpacing {
    /// Distinct flutes in the order of their angles: a pass of each, counted from 0, and its angle halfway along, 0° to
    /// 360°.
    pub flutes: Vec<(usize, Deg)>,
    /// Passes over a flute that is already ground, in the order of grinding.
    pub repeated: Vec<RepeatedPass>,
    /// The gap with the largest error anywhere along the flutes.
    pub worst_gap: Option<Gap>,
    /// The least distance between the paths of neighbours.
    pub nearest_approach: Option<NearestApproach>,
}

/// A pass over a flute that an earlier one has ground; both counted from 0.
#[derive(Clone, Copy, Debug)]
pub(super) struct RepeatedPass {
    pub pass: usize,
    pub first_pass: usize,
}

/// The closest points of two neighbours.
#[derive(Clone, Copy, Debug)]
pub(super) struct NearestApproach {
    /// Straight-line distance, mm.
    pub distance: f64,
    /// One of the two, counted from 0, and the point on it.
    pub pass: usize,
    pub point: Point3<f64>,
}

/// Gap from one flute to the next round the burr, at one position along them.
#[derive(Clone, Copy, Debug)]
pub(super) struct Gap {
    /// Index in [`FluteSpacing::flutes`].
    pub from_flute: usize,
    pub actual: Deg,
    /// Deviation from the nominal gap.
    pub error: Deg,
    /// Position along x, and the polar angle there.
    pub x: f64,
    pub polar: Deg,
    /// The flute that is farther off its position between all others; its sample there, and its first sample that is
    /// nearly as far off.
    pub pass: usize,
    pub sample: usize,
    pub first_sample: usize,
    /// Error of that flute's position; `None` of two flutes, of which either may be right.
    pub index_error: Option<Deg>,
}

/// Step from each flute to the one ground after it, if it is constant.
#[derive(Clone, Copy, Debug)]
pub(super) struct IndexStep {
    pub actual: Deg,
    /// The nearest step with which flutes are evenly spaced.
    pub nominal: Deg,
    /// The pass after the first step, counted from 0.
    pub pass: usize,
}

impl IndexStep {
    pub(super) fn error(&self) -> Deg {
        (self.actual - self.nominal).abs()
    }
}

/// Largest distance of passes over the same flute, in index tolerances.
pub(super) const SAME_FLUTE: f64 = 2.0;

/// Angles that differ by less are equal, degrees.
const ANGLE_EPSILON: f64 = 1e-6;

/// A flute's angle about the axis, degrees, by its position along the meridian, mm, ascending towards the tip.
struct FluteCurve(Vec<(f64, f64)>);

impl FluteSpacing {
    pub(super) fn of(nominal: &Flutes, passes: &[GrindingPass]) -> Self {
        let middle = middle_x(nominal);
        let angle = |pass: &GrindingPass| {
            let first = pass.trace.samples.first()?;
            let angle = pass.trace.angle_at(middle).unwrap_or(first.start_azimuth);
            Some(Deg(angle.0.rem_euclid(360.0)))
        };
        let mut all: Vec<(usize, Deg)> =
            passes.iter().enumerate().filter_map(|(index, pass)| Some((index, angle(pass)?))).collect();
        all.sort_by(|one, other| one.1.0.total_cmp(&other.1.0));
        let mut spacing = Self::default();
        let mut over: Vec<(usize, usize)> = Vec::new();
        for (pass, angle) in all {
            let same = |other: &(usize, Deg)| {
                let gap = (angle.0 - other.1.0).rem_euclid(360.0);
                gap.min(360.0 - gap) <= SAME_FLUTE * nominal.index_tolerance.0
            };
            if spacing.flutes.last().is_some_and(same) {
                over.push((pass, spacing.flutes.len() - 1));
            } else if spacing.flutes.first().is_some_and(same) {
                over.push((pass, 0));
            } else {
                spacing.flutes.push((pass, angle));
            }
        }
        spacing.repeated = repeated_passes(&spacing.flutes, &over);
        spacing.worst_gap = spacing.worst_gap_of(nominal, passes);
        spacing.nearest_approach = spacing.find_nearest(passes);
        spacing
    }

    /// Returns the worst gap at any sample of any flute.
    fn worst_gap_of(&self, nominal: &Flutes, passes: &[GrindingPass]) -> Option<Gap> {
        let pitch = 360.0 / f64::from(nominal.count);
        let curves: Vec<FluteCurve> =
            self.flutes.iter().map(|(pass, _)| FluteCurve::of(nominal, &passes[*pass])).collect();
        let count = curves.len();
        // A single flute is its own neighbour after a revolution.
        let gap = |here: f64, there: f64| if count == 1 { 360.0 } else { (there - here).rem_euclid(360.0) };
        let mut worst: Option<(Gap, f64)> = None;
        for (flute, (pass, _)) in self.flutes.iter().enumerate() {
            let (before, after) = ((flute + count - 1) % count, (flute + 1) % count);
            for (index, sample) in passes[*pass].trace.samples.iter().enumerate() {
                let (at, angle) = (station(nominal, sample), sample.angle().0);
                let behind = curves[before].angle_at(at).map(|other| (before, gap(other, angle)));
                let ahead = curves[after].angle_at(at).map(|other| (flute, gap(angle, other)));
                for (from_flute, actual) in [ahead, behind].into_iter().flatten() {
                    let error = Deg((actual - pitch).abs());
                    if worst.is_none_or(|(worst, _)| worst.error.0 + ANGLE_EPSILON < error.0) {
                        let gap = Gap {
                            from_flute,
                            actual: Deg(actual),
                            error,
                            x: sample.point.x,
                            polar: sample.polar,
                            pass: *pass,
                            sample: index,
                            first_sample: index,
                            index_error: None,
                        };
                        worst = Some((gap, at));
                    }
                }
            }
        }
        let (mut worst, at) = worst?;
        // The finding is at the block of the misplaced flute.
        let (from, after) = (worst.from_flute, (worst.from_flute + 1) % count);
        let (flute, astray) = misplaced_flute(&curves, pitch, at, [from, after], &self.flutes);
        worst.index_error = astray.map(Deg);
        let (other, ahead) = if flute == from { (after, true) } else { (from, false) };
        let samples = &passes[self.flutes[flute].0].trace.samples;
        let off = |sample: &Sample| {
            let angle = sample.angle().0;
            let there = curves[other].angle_at(station(nominal, sample))?;
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

    /// Returns the step from each flute to the one ground after it; `None` if it varies, or with fewer than three flutes.
    pub(super) fn index_step(&self, nominal: &Flutes) -> Option<IndexStep> {
        let mut ground = self.flutes.clone();
        ground.sort_by_key(|(pass, _)| *pass);
        let steps = ground.windows(2).map(|pair| wrap_angle(pair[1].1.0 - pair[0].1.0));
        let min = steps.clone().fold(f64::INFINITY, f64::min);
        let max = steps.clone().fold(f64::NEG_INFINITY, f64::max);
        let pitch = 360.0 / f64::from(nominal.count);
        let mean = steps.sum::<f64>() / ground.len().saturating_sub(1) as f64;
        let step = IndexStep {
            actual: Deg(mean),
            nominal: Deg((mean / pitch).round() * pitch),
            pass: ground.get(1)?.0,
        };
        (3 <= ground.len() && max - min <= step.error().0 / 2.0).then_some(step)
    }

    /// Returns the positions of missing flutes halfway along the burr: evenly spaced in the gaps that are too wide.
    pub(super) fn missing_points(&self, nominal: &Flutes) -> Vec<Point3<f64>> {
        let pitch = 360.0 / f64::from(nominal.count);
        let outside = Point3::new(middle_x(nominal), -nominal.profile.radius(), 0.0);
        let foot = nominal.profile.foot(&outside);
        let (x, radius) = (foot.x, -foot.y);
        let next = self.flutes.iter().skip(1).map(|(_, angle)| angle.0);
        let ends = next.chain(self.flutes.first().map(|(_, angle)| angle.0 + 360.0));
        let gaps = self.flutes.iter().map(|(_, angle)| angle.0).zip(ends);
        let angles = gaps.flat_map(|(from, to)| {
            let pieces = ((to - from) / pitch).round().max(1.0);
            (1..pieces as u32).map(move |n| Deg(from + (to - from) * f64::from(n) / pieces))
        });
        angles.map(|angle| Point3::new(x, radius * angle.cos(), -radius * angle.sin())).collect()
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

/// Returns all passes of each flute but the first. `over`: passes, each with the index of its flute.
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

/// Returns the x halfway along the flutes.
fn middle_x(nominal: &Flutes) -> f64 {
    (nominal.start + nominal.profile.point_at_polar(nominal.tip_angle).x) / 2.0
}

/// Returns which of two flutes is farther off its position, and its error. Positions are relative to the median of all
/// flutes; of two flutes in all either may be right, and the one ground later is returned without an error.
fn misplaced_flute(
    curves: &[FluteCurve],
    pitch: f64,
    at: f64,
    pair: [usize; 2],
    flutes: &[(usize, Deg)],
) -> (usize, Option<f64>) {
    let later = if flutes[pair[0]].0 < flutes[pair[1]].0 { pair[1] } else { pair[0] };
    let angles = curves.iter().enumerate();
    let all: Vec<(usize, f64)> =
        angles.filter_map(|(n, curve)| Some((n, curve.angle_at(at)? - pitch * n as f64))).collect();
    let Some((_, zero)) = all.first().copied() else { return (later, None) };
    let mut sorted: Vec<f64> = all.iter().map(|(_, phase)| wrap_angle(phase - zero)).collect();
    sorted.sort_by(f64::total_cmp);
    let middle = sorted[(sorted.len() - 1) / 2];
    let off = |flute: usize| {
        let phase = all.iter().find(|(n, _)| *n == flute).map(|(_, phase)| wrap_angle(phase - zero - middle));
        phase.map_or(0.0, f64::abs)
    };
    let [one, other] = pair.map(off);
    if curves.len() < 3 || (one - other).abs() <= ANGLE_EPSILON {
        return (later, None);
    }
    if other < one { (pair[0], Some(one)) } else { (pair[1], Some(other)) }
}

/// Returns the path along the meridian from the end of the cylinder towards the tip. On the nose it follows from the
/// direction of the normal, which an error of the depth does not change.
fn station(nominal: &Flutes, sample: &Sample) -> f64 {
    if 0.0 < sample.point.x {
        -sample.point.x
    } else {
        nominal.profile.radius() * (Deg(90.0) - sample.polar).to_rad()
    }
}

impl FluteCurve {
    fn of(nominal: &Flutes, pass: &GrindingPass) -> Self {
        let point = |sample: &Sample| (station(nominal, sample), sample.angle().0);
        let mut points: Vec<(f64, f64)> = pass.trace.samples.iter().map(point).collect();
        if points.first().zip(points.last()).is_some_and(|(first, last)| last.0 < first.0) {
            points.reverse();
        }
        // Stretches that go back are left out.
        points.dedup_by(|one, last| one.0 <= last.0);
        Self(points)
    }

    /// Returns the angle at a station; `None` beyond the ends of the flute.
    fn angle_at(&self, station: f64) -> Option<f64> {
        let slack = 1e-6;
        let (first, last) = (self.0.first()?.0, self.0.last()?.0);
        if station < first - slack || last + slack < station {
            return None;
        }
        let after = self.0.partition_point(|one| one.0 < station).min(self.0.len() - 1);
        let ((start, angle), (end, next)) = (self.0[after.saturating_sub(1)], self.0[after]);
        let part = if end == start { 0.0 } else { ((station - start) / (end - start)).clamp(0.0, 1.0) };
        Some(angle + (next - angle) * part)
    }
}
