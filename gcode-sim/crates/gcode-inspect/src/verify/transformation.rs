//! One mistake that moves all holes: the unit, a sign, exchanged axes, a wrong zero, a wrong angle, or G90 for G91.
//!
//! Each candidate maps the drilled axes back to where they were meant. The one that puts most nominal holes in their zones
//! explains the pattern if these are nearly all, and few were there before. Where most are in position, it may explain the
//! extra holes, as of a tool whose points count from another zero.
use nalgebra::{Point3, Unit, Vector3};

use super::displacement::rotation_error;
use super::{Comparison, Deviation, HolePair};
use crate::machine::{Machine, Setup};
use gcode_lang::motion::{AxisIndex, Backtrace, Position};
use gcode_lang::units::Deg;
use gcode_part::{Hole, exceeds};

/// Least share of the nominal holes that a mistake has to explain.
const MIN_AGREEING_SHARE: f64 = 0.8;

/// Least number of nominal holes.
const MIN_HOLES: usize = 3;

/// Largest number of pairs of nominal and drilled holes for which mistakes are looked for.
const MAX_PAIRS: usize = 1_000_000;

/// Number of nominal holes on which a candidate is tried first.
const SAMPLE: usize = 6;

/// Largest number of candidates for a shift or an angle.
const MAX_CANDIDATES: usize = 200;

/// Heights that differ by less are equal, mm.
const SAME_HEIGHT: f64 = 0.02;

/// Millimetres in an inch.
const INCH: f64 = 25.4;

/// Mistake that moves all holes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Mistake {
    /// Numbers in mm that count as inches.
    MillimetresAsInches,
    /// Numbers in inches that count as mm.
    InchesAsMillimetres,
    /// Coordinates of the wrong sign, of x, of y or of both.
    Negated([bool; 2]),
    /// x and y are exchanged.
    Exchanged,
    /// The pattern is turned by a right angle about the work zero, counterclockwise by this many degrees.
    Turned(f64),
    /// Actual minus nominal, mm.
    Shifted(Vector3<f64>),
    /// A rotary axis is off by this angle.
    Rotated(AxisIndex, Deg),
    /// Absolute points that count as increments: G91 for G90.
    AbsoluteAsIncrements,
    /// Increments that count as absolute points: G90 for G91.
    IncrementsAsAbsolute,
}

/// A mistake with what it explains.
#[derive(Clone, Debug)]
pub(super) struct Transformation {
    pub mistake: Mistake,
    /// Number of extra holes, if it is only these that it moves.
    pub extra: Option<usize>,
    /// Nominal holes in position without it, and the indices of the drilled ones; `None` for a feed beside the part.
    pub explained: Vec<(usize, Option<usize>)>,
    /// Block of the first hole that it moves.
    pub backtrace: Backtrace,
}

/// Axis of a drilled hole, or of a feed beside the part.
#[derive(Clone, Debug)]
struct Line {
    bottom: Point3<f64>,
    axis: Unit<Vector3<f64>>,
    /// Place among all lines.
    place: usize,
    index: Option<usize>,
    axis_position: Option<Position>,
}

impl Transformation {
    /// Finds the mistake that explains the holes; `None` if no single one does. `in_air` are feeds beside the part.
    pub(super) fn of(
        comparison: &Comparison<'_>,
        machine: &Machine,
        in_air: &[(Point3<f64>, Backtrace)],
    ) -> Option<Self> {
        let (count, lines) = (comparison.nominal.len(), lines(comparison, in_air)?);
        if comparison.pattern.is_some() || comparison.is_all_in_place() || MAX_PAIRS < count * lines.len() {
            return None;
        }
        let before = comparison.pairs.iter().filter(|pair| comparison.is_in_place(pair)).count();
        let is_open = 2 * before <= count;
        // Holes on the axis of a nominal one are no displaced ones.
        let is_displaced = |index: &&usize| comparison.nominal_on_line_of(**index).is_none();
        let extra = comparison.extra.iter().filter(is_displaced).copied();
        let subset: Vec<usize> = if is_open { (0..lines.len()).collect() } else { extra.collect() };
        let (before, count) = if is_open { (before, count) } else { (0, subset.len()) };
        // Beside a whole pattern extra holes are extra.
        let is_unfinished =
            |pair: &HolePair| exceeds(-pair.deviation.depth_error, comparison.tolerances.depth);
        let is_whole = comparison.missing.is_empty() && !comparison.pairs.iter().any(is_unfinished);
        if count < MIN_HOLES || subset.len() < MIN_HOLES || !is_open && is_whole {
            return None;
        }
        let search = Search { comparison, machine, lines: &lines };
        let on_their_axes = if is_open { search.matched(&lines) } else { Vec::new() };
        let is_enough =
            |matched: usize| MIN_AGREEING_SHARE * count as f64 <= matched as f64 && before + 2 <= matched;
        let raised = search.common_height(&on_their_axes).filter(|_| is_enough(on_their_axes.len()));
        let mut best = raised.map(|_| (Mistake::Shifted(Vector3::zeros()), on_their_axes));
        let mut consider = |(mistake, mut mapped): (Mistake, Vec<Line>)| {
            mapped.retain(|line| subset.binary_search(&line.place).is_ok());
            if is_open && !search.fits_sample(&mapped) {
                return;
            }
            let matched = search.matched(&mapped);
            let is_better = best.as_ref().is_none_or(|(_, known)| known.len() < matched.len());
            if is_better && is_enough(matched.len()) {
                best = Some((mistake, matched));
            }
        };
        let mut zeros = vec![Point3::origin()];
        zeros.extend(machine.offsets.iter().map(|offset| search.work_zero(&offset.values)));
        zeros.dedup_by(|a, b| (*a - *b).norm() < 1e-6);
        for zero in zeros {
            search.about(&zero).into_iter().for_each(&mut consider);
        }
        search.shifts().into_iter().for_each(&mut consider);
        search.rotations().into_iter().for_each(&mut consider);
        let (mut mistake, matched) = best?;
        let mut is_raised = false;
        if let (Mistake::Shifted(by), Some(height)) = (&mut mistake, search.common_height(&matched)) {
            *by += height;
            is_raised = true;
        }
        let is_moved =
            |(nominal, line): &&(usize, usize)| is_raised || !search.is_at(*nominal, &lines[*line]);
        let first = matched.iter().filter(is_moved).map(|(_, line)| *line).min()?;
        let backtrace = match lines[first].index {
            Some(index) => comparison.actual[index].backtrace.clone(),
            None => in_air[first - comparison.actual.len()].1.clone(),
        };
        let explained = matched.iter().map(|(nominal, line)| (*nominal, lines[*line].index)).collect();
        Some(Self { mistake, extra: (!is_open).then_some(count), explained, backtrace })
    }
}

/// Returns the axes of the drilled holes in their order, then those of feeds beside the part, which take the direction of the
/// nominal holes; `None` without nominal holes.
fn lines(comparison: &Comparison<'_>, in_air: &[(Point3<f64>, Backtrace)]) -> Option<Vec<Line>> {
    let out = Unit::try_new(Vector3::from(comparison.nominal.first()?.axis), 0.5)?;
    let drilled = comparison.actual.iter().enumerate().map(|(index, hole)| Line {
        bottom: hole.bottom(),
        axis: hole.axis,
        place: index,
        index: Some(index),
        axis_position: Some(hole.axis_position),
    });
    let count = comparison.actual.len();
    let beside = in_air.iter().enumerate().map(|(index, (end, _))| Line {
        bottom: *end,
        axis: out,
        place: count + index,
        index: None,
        axis_position: None,
    });
    Some(drilled.chain(beside).collect())
}

/// The holes for which a mistake is looked for.
struct Search<'a> {
    comparison: &'a Comparison<'a>,
    machine: &'a Machine,
    lines: &'a [Line],
}

impl Search<'_> {
    /// Returns true if a line lies in the zone of a nominal hole.
    fn is_at(&self, nominal: usize, line: &Line) -> bool {
        let deviation = Deviation::new(&self.comparison.nominal[nominal], &line.bottom, &line.axis);
        deviation.is_some_and(|one| !exceeds(one.zone_diameter(), self.comparison.tolerances.position))
    }

    /// Returns true if most of a few nominal holes are in position.
    fn fits_sample(&self, mapped: &[Line]) -> bool {
        let count = self.comparison.nominal.len();
        let size = SAMPLE.min(count);
        let sample = (0..size).map(|step| step * count / size);
        let found = sample.filter(|nominal| mapped.iter().any(|line| self.is_at(*nominal, line))).count();
        size < 2 * found
    }

    /// Returns the nominal holes in position, each with the place of a line of its own.
    fn matched(&self, mapped: &[Line]) -> Vec<(usize, usize)> {
        let mut is_taken = vec![false; mapped.len()];
        let find = |nominal: usize| {
            let line =
                (0..mapped.len()).find(|line| !is_taken[*line] && self.is_at(nominal, &mapped[*line]))?;
            is_taken[line] = true;
            Some((nominal, mapped[line].place))
        };
        (0..self.comparison.nominal.len()).filter_map(find).collect()
    }

    /// Returns how far above the bottoms of nominal holes their lines end, if all end equally far above the entries.
    fn common_height(&self, matched: &[(usize, usize)]) -> Option<Vector3<f64>> {
        let height = |(nominal, line): &(usize, usize)| {
            let hole = &self.comparison.nominal[*nominal];
            let out = Vector3::from(hole.axis);
            let height = (self.lines[*line].bottom - Point3::from(hole.entry)).dot(&out) + hole.depth;
            (hole.depth < height).then_some(out * height)
        };
        let (first, others) = matched.split_first()?;
        let first = height(first)?;
        let is_same =
            |one: &(usize, usize)| height(one).is_some_and(|height| (height - first).norm() < SAME_HEIGHT);
        others.iter().all(is_same).then_some(first)
    }

    /// Returns the point of the part at the work zero of an offset.
    fn work_zero(&self, values: &[(AxisIndex, f64)]) -> Point3<f64> {
        let mut at = Position::default();
        values.iter().for_each(|(axis, value)| at[*axis] = *value);
        let frame = self.machine.part_frame(&at);
        self.machine.tool_pose(&at, &Setup::default()).relative_to(&frame).tip
    }

    /// Returns the drilled lines as they would be without each mistake that has a work zero.
    fn about(&self, zero: &Point3<f64>) -> Vec<(Mistake, Vec<Line>)> {
        let map = |by: &dyn Fn(Vector3<f64>) -> Vector3<f64>, turns_axis: bool| -> Vec<Line> {
            let of_line = |line: &Line| {
                let turned = Unit::try_new(by(line.axis.into_inner()), 1e-9).filter(|_| turns_axis);
                let axis = turned.unwrap_or(line.axis);
                Line { bottom: zero + by(line.bottom - zero), axis, ..line.clone() }
            };
            self.lines.iter().map(of_line).collect()
        };
        let sign = |is_negated: bool| if is_negated { -1.0 } else { 1.0 };
        let negated = |[x, y]: [bool; 2]| {
            let by = move |v: Vector3<f64>| Vector3::new(sign(x) * v.x, sign(y) * v.y, v.z);
            (Mistake::Negated([x, y]), map(&by, true))
        };
        let quarter = |degrees: f64| {
            let by =
                move |v: Vector3<f64>| Vector3::new(v.y, -v.x, 0.0) * degrees.signum() + Vector3::z() * v.z;
            (Mistake::Turned(degrees), map(&by, true))
        };
        vec![
            (Mistake::MillimetresAsInches, map(&|v| v / INCH, false)),
            (Mistake::InchesAsMillimetres, map(&|v| v * INCH, false)),
            negated([true, false]),
            negated([false, true]),
            negated([true, true]),
            (Mistake::Exchanged, map(&|v| Vector3::new(v.y, v.x, v.z), true)),
            quarter(90.0),
            quarter(-90.0),
            (Mistake::AbsoluteAsIncrements, self.chain(|last, p| zero + (p - last), zero)),
            (Mistake::IncrementsAsAbsolute, self.sums(zero)),
        ]
    }

    /// Returns the lines each at a point that follows from it and the line before; those in position stay.
    fn chain(
        &self,
        point: impl Fn(&Point3<f64>, &Point3<f64>) -> Point3<f64>,
        zero: &Point3<f64>,
    ) -> Vec<Line> {
        let mut last = *zero;
        let mut is_made = vec![false; self.comparison.nominal.len()];
        let follow = |line: &Line| {
            let here = line.bottom;
            let bottom = if self.makes_nominal(line, &mut is_made) { here } else { point(&last, &here) };
            last = here;
            Line { bottom, ..line.clone() }
        };
        self.lines.iter().map(follow).collect()
    }

    /// Returns the lines each as far from the one before as it is from the work zero; those in position stay.
    fn sums(&self, zero: &Point3<f64>) -> Vec<Line> {
        let mut last = *zero;
        let mut is_made = vec![false; self.comparison.nominal.len()];
        let follow = |line: &Line| {
            last = match self.makes_nominal(line, &mut is_made) {
                true => line.bottom,
                false => last + (line.bottom - zero),
            };
            Line { bottom: last, ..line.clone() }
        };
        self.lines.iter().map(follow).collect()
    }

    /// Returns true if a line is the first in the zone of a nominal hole.
    fn makes_nominal(&self, line: &Line, is_made: &mut [bool]) -> bool {
        let made = (0..is_made.len()).find(|nominal| !is_made[*nominal] && self.is_at(*nominal, line));
        made.is_some_and(|nominal| !std::mem::replace(&mut is_made[nominal], true))
    }

    /// Returns the lines less each shift that puts one of them on the first nominal hole.
    fn shifts(&self) -> Vec<(Mistake, Vec<Line>)> {
        let first = &self.comparison.nominal[0];
        let is_parallel = |hole: &Hole| hole.axis == first.axis;
        if !self.comparison.nominal.iter().all(is_parallel) {
            return Vec::new();
        }
        let of_line = |line: &Line| {
            let entry = Deviation::new(first, &line.bottom, &line.axis)?.entry;
            let by =
                (entry - Point3::from(first.entry)).map(|part| if part.abs() < 1e-6 { 0.0 } else { part });
            let mapped = self.lines.iter().map(|line| Line { bottom: line.bottom - by, ..line.clone() });
            Some((Mistake::Shifted(by), mapped.collect()))
        };
        self.lines.iter().take(MAX_CANDIDATES).filter_map(of_line).collect()
    }

    /// Returns the lines turned back by each angle of a rotary axis that puts one of them on the first nominal hole.
    fn rotations(&self) -> Vec<(Mistake, Vec<Line>)> {
        let first = &self.comparison.nominal[0];
        let mut all = Vec::new();
        for axis in self.machine.table.rotary_axes() {
            for drilled in self.comparison.actual.iter().take(MAX_CANDIDATES) {
                let Some((_, by)) = rotation_error(first, drilled, self.machine, axis) else { continue };
                let turn = |line: &Line| {
                    let at = line.axis_position?;
                    let mut meant = at;
                    meant[axis] -= by.0;
                    let back = self.machine.part_frame(&meant).inverse() * self.machine.part_frame(&at);
                    Some(Line { bottom: back * line.bottom, axis: back.rotation * line.axis, ..line.clone() })
                };
                let mapped = self.lines.iter().map(|line| turn(line).unwrap_or_else(|| line.clone()));
                all.push((Mistake::Rotated(axis, by), mapped.collect()));
            }
        }
        all
    }
}
