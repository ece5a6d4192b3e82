//! Which holes are moved, tilted, deeper, made by another tool or at another time, lost or added.
use std::collections::{BTreeMap, BTreeSet};

use nalgebra::{Point3, Vector3};

use super::align::StepPair;
use super::cause::cause;
use super::change::Effect;
use super::hole_groups::{ChangedHole, HoleDifference, HoleEffect, HoleGroup, groups, named, plain, runs};
use super::hole_order::hole_order;
use super::pass_changes::pass_changes;
use super::passes::{Passes, in_words, more_or_fewer};
use super::record::{BlockLocation, Record};
use super::steps::{Step, StepKind, difference, near};
use gcode_inspect::holes::DrilledHole;
use gcode_inspect::verify::{Comparison, Tolerances};
use gcode_lang::motion::Position;
use gcode_lang::source::Span;
use gcode_lang::units::Deg;
use gcode_part::Hole;

/// The changes of holes, which is which, and what of the motion they explain.
pub(super) struct HoleChanges {
    pub effects: Vec<HoleEffect>,
    pub pairs: Vec<Paired>,
}

/// A hole of one revision and what has become of it in the other; both are counted from 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Paired {
    pub old: Option<usize>,
    pub new: Option<usize>,
    /// Something about it is different.
    pub changed: bool,
    /// How far it is moved where it begins, mm; 0 for one that is there once only, as are the others.
    pub moved: f64,
    /// Between the axes.
    pub tilted: Deg,
    /// mm.
    pub deeper: f64,
}

/// With `by_motion` a hole is the one that the same feed makes, wherever it is; else the nearest comes first.
pub(super) fn compare(
    old: &Record,
    new: &Record,
    links: &[StepPair],
    by_motion: bool,
    tolerance: f64,
) -> HoleChanges {
    let passes = (Passes::of(old), Passes::of(new));
    let (was, is) = (passes.0.firsts(), passes.1.firsts());
    let mut partner: Vec<Option<usize>> = vec![None; old.holes.len()];
    let mut extra: BTreeSet<usize> = is.iter().copied().collect();
    if !by_motion {
        let wanted: Vec<Hole> = was.iter().map(|hole| old.holes[*hole].hole(nowhere)).collect();
        let found: Vec<DrilledHole> = is.iter().map(|hole| new.holes[*hole].clone()).collect();
        let limits = Tolerances { position: 2.0 * tolerance, depth: tolerance, diameter: tolerance };
        let comparison = Comparison::new(&wanted, &found, limits, None);
        for pair in &comparison.pairs {
            partner[was[pair.nominal]] = Some(is[pair.actual]);
        }
        extra = comparison.extra.iter().map(|hole| is[*hole]).collect();
    }
    pair_by_motion(&mut partner, extra, links, &passes);
    let comparer = HoleComparer { old, new, tolerance, passes };
    let mut effects = comparer.pairs(&partner);
    effects.extend(hole_order((old, new), links, &comparer.passes, &partner));
    effects.extend(comparer.lost_and_added(&partner));
    HoleChanges { effects, pairs: comparer.all(&partner) }
}

/// The angle between their axes.
fn tilt(old: &DrilledHole, new: &DrilledHole) -> Deg {
    Deg::atan2(old.axis.cross(&new.axis).norm(), old.axis.dot(&new.axis))
}

fn nowhere(_: Span) -> (String, u32) {
    (String::new(), 0)
}

/// A hole too far from its old place to be known by it is the same hole if the same feed makes it.
fn pair_by_motion(
    partner: &mut [Option<usize>],
    mut extra: BTreeSet<usize>,
    links: &[StepPair],
    (old, new): &(Passes, Passes),
) {
    let (of_old, of_new) = (hole_of_step(old), hole_of_step(new));
    for link in links {
        let (StepPair::Changed(i, j) | StepPair::Same(i, j)) = link else { continue };
        if let (Some(hole), Some(other)) = (of_old.get(i), of_new.get(j))
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
    old: &'a Record,
    new: &'a Record,
    tolerance: f64,
    passes: (Passes, Passes),
}

impl HoleComparer<'_> {
    /// Holes that are there before and now, those that changed alike or for one reason in one entry.
    fn pairs(&self, partner: &[Option<usize>]) -> Vec<HoleEffect> {
        let mut changed = Vec::new();
        for (hole, other) in partner.iter().enumerate() {
            let Some(other) = *other else { continue };
            let apart = HoleOffset::new(&self.old.holes[hole], &self.new.holes[other]);
            let aspects = self.aspects(hole, other, &apart);
            if aspects.code().is_none() {
                continue;
            }
            let Some(feeds) = last(self.old, hole).zip(last(self.new, other)) else { continue };
            let way = |(i, j): (usize, usize)| difference(&self.new.steps[j].to, &self.old.steps[i].to);
            let is_elsewhere = |feeds| !near(&way(feeds), &Position::default(), self.tolerance);
            let (was, is) = (&self.passes.0.steps[hole], &self.passes.1.steps[other]);
            let is_one_by_one = aspects.is_elsewhere() && was.len() == is.len();
            let passes = was.iter().copied().zip(is.iter().copied()).filter(|_| is_one_by_one);
            let strayed = aspects.strayed.iter().map(|pass| pass.steps);
            let others: Vec<(usize, usize)> =
                strayed.chain(passes).filter(|feeds| is_elsewhere(*feeds)).collect();
            let feeds = if is_elsewhere(feeds) { feeds } else { others.first().copied().unwrap_or(feeds) };
            let [was, is] = self.blocks(feeds);
            let cause = cause(was, is);
            changed.push(ChangedHole { hole, aspects, feeds, others, shift: way(feeds), cause });
        }
        let effect = |group: HoleGroup| {
            let feeds = group.all[0].feeds;
            let message = group.message(&self.old.axes, self.tolerance);
            let [was, is] = self.blocks(feeds);
            let is_by_tool = matches!(group.code(), "hole-tool" | "hole-diameter");
            let tools = if is_by_tool { self.tool_changes(feeds) } else { [None, None] };
            let feeds = group.all.iter().flat_map(|one| std::iter::once(&one.feeds).chain(&one.others));
            let (was_made, is_made) = feeds.copied().unzip();
            let effect = Effect::new(group.code(), message).with_old(Some(was)).with_new(Some(is));
            HoleEffect { effect, steps: [was_made, is_made], tools }
        };
        groups(changed, &self.old.axes, self.tolerance).into_iter().map(effect).collect()
    }

    /// The blocks that have put in the tools of two feeds.
    fn tool_changes(&self, (i, j): (usize, usize)) -> [Option<usize>; 2] {
        let last = |record: &Record, feed: usize| {
            let mut steps = record.steps[..feed].iter().rev();
            steps.find(|step| matches!(step.kind, StepKind::Tool(_))).map(Step::editable_at)
        };
        [last(self.old, i), last(self.new, j)]
    }

    /// The blocks of two steps, before and now.
    fn blocks(&self, (i, j): (usize, usize)) -> [&BlockLocation; 2] {
        [&self.old.places[self.old.steps[i].place], &self.new.places[self.new.steps[j].place]]
    }

    /// Every hole with its partner; those that are there before first.
    fn all(&self, partner: &[Option<usize>]) -> Vec<Paired> {
        let alone =
            Paired { old: None, new: None, changed: true, moved: 0.0, tilted: Deg::ZERO, deeper: 0.0 };
        let (old, new) = (self.old, self.new);
        let mut partner = partner.to_vec();
        for first in self.passes.0.firsts() {
            let Some(other) = partner[first] else { continue };
            let again = self.passes.0.again[first].iter().zip(&self.passes.1.again[other]);
            again.for_each(|(old, new)| partner[*old] = Some(*new));
        }
        let known: BTreeSet<usize> = partner.iter().flatten().copied().collect();
        let mut pairs = Vec::with_capacity(partner.len());
        for (hole, other) in partner.iter().enumerate() {
            let Some(other) = *other else {
                pairs.push(Paired { old: Some(hole), ..alone });
                continue;
            };
            let (was, is) = (&old.holes[hole], &new.holes[other]);
            let apart = HoleOffset::new(was, is);
            pairs.push(Paired {
                old: Some(hole),
                new: Some(other),
                changed: self.aspects(hole, other, &apart).code().is_some(),
                moved: apart.entry.norm(),
                tilted: tilt(was, is),
                deeper: apart.deeper,
            });
        }
        let added = (0..new.holes.len()).filter(|hole| !known.contains(hole));
        pairs.extend(added.map(|hole| Paired { new: Some(hole), ..alone }));
        pairs
    }

    /// All that is different about one hole.
    fn aspects(&self, hole: usize, other: usize, apart: &HoleOffset) -> HoleDifference {
        let (old, new) = (&self.old.holes[hole], &self.new.holes[other]);
        if self.old.unfinished.contains(&hole) || self.new.unfinished.contains(&other) {
            return HoleDifference::default();
        }
        let far = |mm: f64| mm.abs() > self.tolerance;
        let mut others = Vec::new();
        if let (Some(before), Some(now)) = (old.diameter, new.diameter)
            && (before - now).abs() > self.tolerance
        {
            others.push(("hole-diameter", format!("Φ{now} instead of Φ{before}")));
        }
        let (was, is) = (&self.passes.0.tools[hole], &self.passes.1.tools[other]);
        match more_or_fewer(was, is) {
            None if was.is_empty() || is.is_empty() => {}
            None => {
                let swapped = was.iter().zip(is).filter(|(before, now)| before != now);
                let swapped: BTreeSet<(u32, u32)> = swapped.map(|(before, now)| (*before, *now)).collect();
                let text = match swapped.iter().collect::<Vec<_>>()[..] {
                    [] => None,
                    // The same for holes that other tools make as well.
                    [(before, now)] => Some(format!("made by T{now} instead of T{before}")),
                    _ => Some(format!("made by {} instead of {}", in_words(is), in_words(was))),
                };
                others.extend(text.map(|text| ("hole-tool", text)));
            }
            Some(text) => others.push(("hole-tool", text)),
        }
        HoleDifference {
            moved: far(apart.entry.norm()).then_some(apart.entry),
            tilted: far((apart.bottom - apart.entry).norm()).then(|| tilt(old, new).0),
            deeper: far(apart.deeper).then_some(apart.deeper),
            others,
            strayed: pass_changes(
                self.old,
                self.new,
                (hole, other),
                &self.passes,
                apart.deeper,
                self.tolerance,
            ),
        }
    }

    fn lost_and_added(&self, partner: &[Option<usize>]) -> Vec<HoleEffect> {
        let mut changes = Vec::new();
        let (firsts, of_new) = (self.passes.0.firsts(), self.passes.1.firsts());
        let gone: Vec<usize> = firsts.iter().copied().filter(|hole| partner[*hole].is_none()).collect();
        for run in runs(&gone, &firsts, |hole| Some(last_step(self.old, hole)?.place)) {
            let first = if run.len() == 1 { "" } else { "the first " };
            let rapid = self.rapid_to_bottom(run[0]);
            let lost = if rapid.is_some() { "a rapid instead of a feed goes to the bottom" } else { "lost" };
            let message = format!("{}: {lost}, {first}{}", named(&run), described(&self.old.holes[run[0]]));
            let change = Effect::new("hole-lost", message).with_old(place(self.old, run[0]));
            let effect = change.with_new(rapid.and_then(|step| self.new.places.get(step.place)));
            changes.push(HoleEffect {
                effect,
                steps: [self.passes.0.of_holes(&run), Vec::new()],
                tools: [None, None],
            });
        }
        let known: BTreeSet<usize> = partner.iter().flatten().copied().collect();
        let more: Vec<usize> = of_new.iter().copied().filter(|hole| !known.contains(hole)).collect();
        for run in runs(&more, &of_new, |hole| Some(last_step(self.new, hole)?.place)) {
            let first = described(&self.new.holes[run[0]]);
            let message = match run.len() {
                1 => format!("a hole added: {first}"),
                n => format!("{n} holes added: the first {first}"),
            };
            let effect = Effect::new("hole-added", message).with_new(place(self.new, run[0]));
            changes.push(HoleEffect {
                effect,
                steps: [Vec::new(), self.passes.1.of_holes(&run)],
                tools: [None, None],
            });
        }
        changes
    }

    /// The rapid of the new revision that ends where a hole's feed has ended.
    fn rapid_to_bottom(&self, hole: usize) -> Option<&Step> {
        let feed = last_step(self.old, hole)?;
        let is_there = |step: &&Step| step.is_rapid() && near(&step.to, &feed.to, self.tolerance);
        self.new.steps.iter().find(is_there)
    }
}

/// The step that finishes a hole, by its number.
fn last(record: &Record, hole: usize) -> Option<usize> {
    record.feeds[hole].last().copied()
}

fn last_step(record: &Record, hole: usize) -> Option<&Step> {
    record.steps.get(last(record, hole)?)
}

/// The block that finishes a hole.
fn place(record: &Record, hole: usize) -> Option<&BlockLocation> {
    record.places.get(last_step(record, hole)?.place)
}

/// How far the new hole is from the old one where the old one begins and ends.
struct HoleOffset {
    entry: Vector3<f64>,
    bottom: Vector3<f64>,
    deeper: f64,
}

impl HoleOffset {
    fn new(old: &DrilledHole, new: &DrilledHole) -> Self {
        let (bottom, deepest) = (old.bottom(), new.bottom());
        let slope = new.axis.dot(&old.axis);
        // Where the new axis crosses the plane through `p`, square to the old axis; axes that are square to one
        // another never do, and the entries are compared as they are.
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

fn described(found: &DrilledHole) -> String {
    let [x, y, z] = [found.entry.x, found.entry.y, found.entry.z].map(plain);
    let diameter = found.diameter.map(|d| format!("Φ{d} ")).unwrap_or_default();
    format!("{diameter}at {x:.3} {y:.3} {z:.3}, fed {:.3} mm", found.depth)
}
