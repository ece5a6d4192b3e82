//! Holes that are moved, tilted, deeper, lost or added, or made by another tool or at another time.
use std::collections::{BTreeMap, BTreeSet};

use nalgebra::{Point3, Vector3};

use super::align::Alignment;
use super::change::Effect;
use super::hole_groups::{
    ChangedHole, HoleDifference, HoleEffect, HoleGroup, consecutive_holes, groups, name_holes,
    without_negative_zero,
};
use super::hole_order::hole_order;
use super::kinds;
use super::pass_changes::pass_changes;
use super::passes::{Passes, other_tools};
use super::program_text::cause;
use super::record::Record;
use super::steps::{Step, StepKind, difference, near};
use gcode_inspect::holes::DrilledHole;
use gcode_inspect::verify::{Comparison, Tolerances};
use gcode_lang::motion::Position;
use gcode_lang::units::Deg;
use gcode_part::Hole;

/// A hole of one revision and its partner in the other, counted from 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Paired {
    /// Hole of the old revision; `None` if it is added.
    pub old: Option<usize>,
    /// Hole of the new revision; `None` if it is lost.
    pub new: Option<usize>,
    /// True if anything about it differs.
    pub changed: bool,
    /// Displacement of the entry, mm; 0 for a lost or added hole, like the following numbers.
    pub moved: f64,
    /// Angle between the axes.
    pub tilted: Deg,
    /// Displacement of the bottom along the axis, mm.
    pub deeper: f64,
}

impl Paired {
    /// Returns a hole without a partner.
    pub(super) fn alone(old: Option<usize>, new: Option<usize>) -> Self {
        Self { old, new, changed: true, moved: 0.0, tilted: Deg::ZERO, deeper: 0.0 }
    }
}

/// Returns the effects on holes, and all holes with their partners. With `by_motion` the partner of a hole is the
/// one that the same feed makes, at any position; else the nearest hole comes first.
pub(super) fn compare(alignment: &Alignment<'_>, by_motion: bool) -> (Vec<HoleEffect>, Vec<Paired>) {
    let Alignment { records: [old, new], tolerance, .. } = *alignment;
    let passes = [old, new].map(Passes::of);
    let [was, is] = [0, 1].map(|side| passes[side].firsts());
    let mut partner: Vec<Option<usize>> = vec![None; old.holes.len()];
    let mut extra: BTreeSet<usize> = is.iter().copied().collect();
    if !by_motion {
        let nominal: Vec<Hole> =
            was.iter().map(|hole| old.holes[*hole].hole(|_| (String::new(), 0))).collect();
        let actual: Vec<DrilledHole> = is.iter().map(|hole| new.holes[*hole].clone()).collect();
        let limits = Tolerances { position: 2.0 * tolerance, depth: tolerance, diameter: tolerance };
        let comparison = Comparison::new(&nominal, &actual, limits, None);
        for pair in &comparison.pairs {
            partner[was[pair.nominal]] = Some(is[pair.actual]);
        }
        extra = comparison.extra.iter().map(|hole| is[*hole]).collect();
    }
    pair_by_motion(&mut partner, extra, alignment, &passes);
    let comparer = HoleComparer { alignment: *alignment, passes };
    let mut effects = comparer.pairs(&partner);
    effects.extend(hole_order(alignment, &comparer.passes, &partner));
    effects.extend(comparer.lost_and_added(&partner));
    let pairs = comparer.all(partner);
    (effects, pairs)
}

/// Returns the angle between the axes.
fn tilt(old: &DrilledHole, new: &DrilledHole) -> Deg {
    Deg::atan2(old.axis.cross(&new.axis).norm(), old.axis.dot(&new.axis))
}

/// Pairs holes without a partner that the same feed makes.
fn pair_by_motion(
    partner: &mut [Option<usize>],
    mut extra: BTreeSet<usize>,
    alignment: &Alignment<'_>,
    passes: &[Passes; 2],
) {
    let [of_old, of_new] = [0, 1].map(|side| hole_of_step(&passes[side]));
    if of_old.is_empty() || of_new.is_empty() {
        return;
    }
    for (i, j) in alignment.pairs() {
        if let (Some(hole), Some(other)) = (of_old.get(&i), of_new.get(&j))
            && partner[*hole].is_none()
            && extra.remove(other)
        {
            partner[*hole] = Some(*other);
        }
    }
}

fn hole_of_step(passes: &Passes) -> BTreeMap<usize, usize> {
    let holes = passes.steps.iter().enumerate();
    holes.flat_map(|(hole, steps)| steps.iter().map(move |step| (*step, hole))).collect()
}

struct HoleComparer<'a> {
    alignment: Alignment<'a>,
    passes: [Passes; 2],
}

impl HoleComparer<'_> {
    /// Returns the effects on holes that both revisions have.
    fn pairs(&self, partner: &[Option<usize>]) -> Vec<HoleEffect> {
        let Alignment { records: [old, new], tolerance, .. } = self.alignment;
        let mut changed = Vec::new();
        for (hole, other) in partner.iter().enumerate() {
            let Some(other) = *other else { continue };
            let offset = HoleOffset::new(&old.holes[hole], &new.holes[other]);
            let difference_of = self.difference(hole, other, &offset);
            if difference_of.kind().is_none() {
                continue;
            }
            let Some(finish) = last(old, hole).zip(last(new, other)) else { continue };
            let shift = |(i, j): (usize, usize)| difference(&new.steps.at(j).to, &old.steps.at(i).to);
            let is_shifted = |feeds| !near(&shift(feeds), &Position::default(), tolerance);
            let (was, is) = (&self.passes[0].steps[hole], &self.passes[1].steps[other]);
            let is_one_by_one = difference_of.is_displaced() && was.len() == is.len();
            let passes = was.iter().copied().zip(is.iter().copied()).filter(|_| is_one_by_one);
            let changed_passes = difference_of.passes.iter().map(|pass| pass.steps);
            let other_pass_feeds: Vec<(usize, usize)> =
                changed_passes.chain(passes).filter(|feeds| is_shifted(*feeds)).collect();
            let feeds =
                if is_shifted(finish) { finish } else { other_pass_feeds.first().copied().unwrap_or(finish) };
            let cause = cause(&old.block(feeds.0), &new.block(feeds.1));
            changed.push(ChangedHole {
                hole,
                difference: difference_of,
                feeds,
                other_pass_feeds,
                shift: shift(feeds),
                cause,
            });
        }
        let effect = |group: HoleGroup| {
            let feeds = group.all[0].feeds;
            let is_by_tool = ["hole-tool", "hole-diameter"].contains(&group.kind().code);
            let tools = if is_by_tool { self.tool_changes(feeds) } else { [None, None] };
            let steps =
                group.all.iter().flat_map(|one| std::iter::once(&one.feeds).chain(&one.other_pass_feeds));
            let (was_made, is_made) = steps.copied().unzip();
            let blocks = self.alignment.blocks([Some(feeds.0), Some(feeds.1)]);
            let effect = Effect::new(group.kind(), group.message(self.alignment.axes(), tolerance), blocks);
            HoleEffect { effect, steps: [was_made, is_made], tools }
        };
        groups(changed, self.alignment.axes(), tolerance).into_iter().map(effect).collect()
    }

    /// Returns the blocks of the tool changes before two feeds.
    fn tool_changes(&self, (i, j): (usize, usize)) -> [Option<usize>; 2] {
        let last = |record: &Record, feed: usize| {
            let is_change = |step: &usize| matches!(record.steps.kind(*step), StepKind::Tool(_));
            (0..feed).rev().find(is_change).map(|step| record.steps.at(step).editable_at())
        };
        let [old, new] = self.alignment.records;
        [last(old, i), last(new, j)]
    }

    /// Returns every hole with its partner; those of the old revision first.
    fn all(&self, mut partner: Vec<Option<usize>>) -> Vec<Paired> {
        let [old, new] = self.alignment.records;
        for first in self.passes[0].firsts() {
            let Some(other) = partner[first] else { continue };
            let repeats = self.passes[0].repeats[first].iter().zip(&self.passes[1].repeats[other]);
            repeats.for_each(|(old, new)| partner[*old] = Some(*new));
        }
        let pair = |(hole, other): (usize, &Option<usize>)| {
            let Some(other) = *other else { return Paired::alone(Some(hole), None) };
            let offset = HoleOffset::new(&old.holes[hole], &new.holes[other]);
            Paired {
                old: Some(hole),
                new: Some(other),
                changed: self.difference(hole, other, &offset).kind().is_some(),
                moved: offset.entry.norm(),
                tilted: tilt(&old.holes[hole], &new.holes[other]),
                deeper: offset.deeper,
            }
        };
        let known: BTreeSet<usize> = partner.iter().flatten().copied().collect();
        let added = (0..new.holes.len()).filter(|hole| !known.contains(hole));
        let added = added.map(|hole| Paired::alone(None, Some(hole)));
        partner.iter().enumerate().map(pair).chain(added).collect()
    }

    /// Returns the differences of a hole and its partner.
    fn difference(&self, hole: usize, other: usize, offset: &HoleOffset) -> HoleDifference {
        let Alignment { records, tolerance, .. } = self.alignment;
        let (old, new) = (&records[0].holes[hole], &records[1].holes[other]);
        if records[0].unfinished.contains(&hole) || records[1].unfinished.contains(&other) {
            return HoleDifference::default();
        }
        let far = |mm: f64| mm.abs() > tolerance;
        let mut tool_differences = Vec::new();
        if let (Some(before), Some(now)) = (old.diameter, new.diameter)
            && far(before - now)
        {
            tool_differences.push((&kinds::HOLE_DIAMETER, format!("Φ{now} instead of Φ{before}")));
        }
        let made = other_tools(&self.passes[0].tools[hole], &self.passes[1].tools[other]);
        tool_differences.extend(made.map(|text| (&kinds::HOLE_TOOL, text)));
        HoleDifference {
            moved: far(offset.entry.norm()).then_some(offset.entry),
            tilted: far((offset.bottom - offset.entry).norm()).then(|| tilt(old, new).0),
            depth_change: far(offset.deeper).then_some(offset.deeper),
            tool_differences,
            passes: pass_changes(&self.alignment, &self.passes, [hole, other], offset.deeper),
        }
    }

    /// Returns one effect for each run of holes that one revision alone has.
    fn lost_and_added(&self, partner: &[Option<usize>]) -> Vec<HoleEffect> {
        let known: BTreeSet<usize> = partner.iter().flatten().copied().collect();
        let mut effects = Vec::new();
        for (side, record) in self.alignment.records.into_iter().enumerate() {
            let is_alone =
                |hole: &usize| if side == 0 { partner[*hole].is_none() } else { !known.contains(hole) };
            let firsts = self.passes[side].firsts();
            let alone: Vec<usize> = firsts.iter().copied().filter(is_alone).collect();
            for run in consecutive_holes(&alone, &firsts, |hole| {
                Some(record.steps.block_number(last(record, hole)?))
            }) {
                let hole = described(&record.holes[run[0]]);
                let feed = last(record, run[0]);
                let rapid = if side == 0 { self.rapid_to_bottom(run[0]) } else { None };
                let first = if run.len() == 1 { "" } else { "the first " };
                let (kind, message) = match (side, rapid, run.len()) {
                    (0, Some(_), _) => {
                        let lost = "a rapid instead of a feed goes to the bottom";
                        (&kinds::HOLE_LOST, format!("{}: {lost}, {first}{hole}", name_holes(&run)))
                    }
                    (0, None, _) => (&kinds::HOLE_LOST, format!("{}: lost, {first}{hole}", name_holes(&run))),
                    (_, _, 1) => (&kinds::HOLE_ADDED, format!("a hole added: {hole}")),
                    (_, _, n) => (&kinds::HOLE_ADDED, format!("{n} holes added: {first}{hole}")),
                };
                let blocks = self.alignment.blocks(if side == 0 { [feed, rapid] } else { [None, feed] });
                let mut steps = [Vec::new(), Vec::new()];
                steps[side] = self.passes[side].of_holes(&run);
                effects.push(HoleEffect {
                    effect: Effect::new(kind, message, blocks),
                    steps,
                    tools: [None, None],
                });
            }
        }
        effects
    }

    /// Returns the rapid of the new revision that ends at the bottom of an old hole.
    fn rapid_to_bottom(&self, hole: usize) -> Option<usize> {
        let [old, new] = self.alignment.records;
        let feed = old.steps.at(last(old, hole)?);
        let is_there = |step: Step<'_>| step.is_rapid() && near(&step.to, &feed.to, self.alignment.tolerance);
        new.steps.iter().position(is_there)
    }
}

/// Returns the number of the step that finishes a hole.
fn last(record: &Record, hole: usize) -> Option<usize> {
    record.feeds[hole].last().copied()
}

/// Displacement of a hole at the entry and at the bottom of the old one, mm.
struct HoleOffset {
    entry: Vector3<f64>,
    bottom: Vector3<f64>,
    deeper: f64,
}

impl HoleOffset {
    fn new(old: &DrilledHole, new: &DrilledHole) -> Self {
        let (bottom, deepest) = (old.bottom(), new.bottom());
        let slope = new.axis.dot(&old.axis);
        // The new axis crosses the plane through `p` perpendicular to the old axis; if the axes are perpendicular,
        // the points themselves are compared.
        let off = |p: &Point3<f64>, otherwise: &Point3<f64>| {
            if slope.abs() < 1e-9 {
                return otherwise - p;
            }
            deepest + new.axis.into_inner() * ((p - deepest).dot(&old.axis) / slope) - p
        };
        Self {
            entry: off(&old.entry, &new.entry),
            bottom: off(&bottom, &deepest),
            deeper: (bottom - deepest).dot(&old.axis),
        }
    }
}

/// Formats a hole with its diameter, entry and depth.
fn described(found: &DrilledHole) -> String {
    let [x, y, z] = [found.entry.x, found.entry.y, found.entry.z].map(without_negative_zero);
    let diameter = found.diameter.map(|d| format!("Φ{d} ")).unwrap_or_default();
    format!("{diameter}at {x:.3} {y:.3} {z:.3}, fed {:.3} mm", found.depth)
}
