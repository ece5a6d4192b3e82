//! Which holes are moved, tilted, deeper, made by another tool or at another time, lost or added.
use std::collections::{BTreeMap, BTreeSet};

use nalgebra::{Point3, Vector3};

use super::align::StepPair;
use super::cause::cause;
use super::change::Change;
use super::hole_groups::{ChangedHole, HoleDifference, HoleGroup, groups, named, plain, runs};
use super::hole_order::order;
use super::pass_changes::pass_changes;
use super::passes::{Passes, in_words, more_or_fewer};
use super::record::{BlockLocation, Record};
use super::steps::{Step, difference, near};
use gcode_inspect::holes::DrilledHole;
use gcode_inspect::verify::{Comparison, Tolerances};
use gcode_lang::motion::Position;
use gcode_lang::source::Span;
use gcode_lang::units::Deg;
use gcode_part::Hole;

/// The changes of holes, which is which, and what of the motion they explain.
pub(super) struct HoleChanges {
    pub changes: Vec<Change>,
    pub pairs: Vec<Paired>,
    pub moved: ExplainedSteps,
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

/// Steps that are different because a hole is: its feeds, by their numbers in either run.
#[derive(Default)]
pub(super) struct ExplainedSteps {
    /// Of holes that are somewhere else now, each with how much deeper its hole is, mm.
    pub shifted: (BTreeMap<usize, f64>, BTreeMap<usize, f64>),
    /// Of holes that are lost, added, or made at another time.
    pub elsewhen: (BTreeSet<usize>, BTreeSet<usize>),
    /// Tool numbers, before and now, that an entry about holes names.
    pub tools: BTreeSet<(u32, u32)>,
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
    let mut told = HoleComparer { old, new, tolerance, passes, moved: ExplainedSteps::default() };
    let mut changes = told.pairs(&partner);
    changes.extend(told.order(&partner, links));
    changes.extend(told.lost_and_added(&partner));
    HoleChanges { changes, pairs: told.all(&partner), moved: told.moved }
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
    moved: ExplainedSteps,
}

impl HoleComparer<'_> {
    /// Holes that are there before and now, those that changed alike or for one reason in one entry.
    fn pairs(&mut self, partner: &[Option<usize>]) -> Vec<Change> {
        let mut changed = Vec::new();
        for (hole, other) in partner.iter().enumerate() {
            let Some(other) = *other else { continue };
            let apart = HoleOffset::new(&self.old.holes[hole], &self.new.holes[other]);
            let aspects = self.aspects(hole, other, &apart);
            if aspects.code().is_none() {
                continue;
            }
            if aspects.is_elsewhere() {
                let with = |step: &usize| (*step, apart.deeper);
                self.moved.shifted.0.extend(self.passes.0.steps[hole].iter().map(with));
                self.moved.shifted.1.extend(self.passes.1.steps[other].iter().map(with));
            }
            for pass in &aspects.strayed {
                self.moved.shifted.0.insert(pass.steps.0, pass.deeper);
                self.moved.shifted.1.insert(pass.steps.1, pass.deeper);
            }
            let Some(feeds) = last(self.old, hole).zip(last(self.new, other)) else { continue };
            let way = |(i, j): (usize, usize)| difference(&self.new.steps[j].to, &self.old.steps[i].to);
            let is_elsewhere = |feeds| !near(&way(feeds), &Position::default(), self.tolerance);
            let (was, is) = (&self.passes.0.steps[hole], &self.passes.1.steps[other]);
            let is_one_by_one = aspects.is_elsewhere() && was.len() == is.len();
            let passes = was.iter().copied().zip(is.iter().copied()).filter(|_| is_one_by_one);
            let strayed = aspects.strayed.first().map(|pass| pass.steps);
            let others = strayed.into_iter().chain(passes).filter(|feeds| is_elsewhere(*feeds));
            let feeds =
                std::iter::once(feeds).chain(others).find(|feeds| is_elsewhere(*feeds)).unwrap_or(feeds);
            let [was, is] = self.blocks(feeds);
            changed.push(ChangedHole { hole, aspects, feeds, shift: way(feeds), cause: cause(was, is) });
        }
        let change = |group: HoleGroup| {
            let message = group.message(&self.old.axes, self.tolerance);
            let [was, is] = self.blocks(group.all[0].feeds);
            Change::new(group.code(), message).with_old(Some(was)).with_new(Some(is))
        };
        groups(changed, &self.old.axes, self.tolerance).into_iter().map(change).collect()
    }

    /// The blocks of two steps, before and now.
    fn blocks(&self, (i, j): (usize, usize)) -> [&BlockLocation; 2] {
        [&self.old.places[self.old.steps[i].place], &self.new.places[self.new.steps[j].place]]
    }

    /// Every hole with its partner; those that are there before first.
    fn all(&mut self, partner: &[Option<usize>]) -> Vec<Paired> {
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
    fn aspects(&mut self, hole: usize, other: usize, apart: &HoleOffset) -> HoleDifference {
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
                self.moved.tools.extend(swapped);
            }
            Some((text, swapped)) => {
                self.moved.tools.extend(swapped);
                self.moved.elsewhen.0.extend(&self.passes.0.steps[hole]);
                self.moved.elsewhen.1.extend(&self.passes.1.steps[other]);
                others.push(("hole-tool", text));
            }
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

    /// Holes, or passes of them, made in another order.
    fn order(&mut self, partner: &[Option<usize>], links: &[StepPair]) -> Vec<Change> {
        let order = order((self.old, self.new), links, &self.passes, partner);
        let (was, is): (Vec<usize>, Vec<usize>) = order.steps.into_iter().unzip();
        self.moved.elsewhen.0.extend(was);
        self.moved.elsewhen.1.extend(is);
        order.changes
    }

    fn lost_and_added(&mut self, partner: &[Option<usize>]) -> Vec<Change> {
        let mut changes = Vec::new();
        let (firsts, of_new) = (self.passes.0.firsts(), self.passes.1.firsts());
        let gone: Vec<usize> = firsts.iter().copied().filter(|hole| partner[*hole].is_none()).collect();
        self.moved.elsewhen.0.extend(gone.iter().flat_map(|hole| &self.passes.0.steps[*hole]));
        for run in runs(&gone, &firsts, |hole| Some(last_step(self.old, hole)?.place)) {
            let first = if run.len() == 1 { "" } else { "the first " };
            let rapid = self.rapid_to_bottom(run[0]);
            let lost = if rapid.is_some() { "a rapid instead of a feed goes to the bottom" } else { "lost" };
            let message = format!("{}: {lost}, {first}{}", named(&run), described(&self.old.holes[run[0]]));
            let change = Change::new("hole-lost", message).with_old(place(self.old, run[0]));
            changes.push(change.with_new(rapid.and_then(|step| self.new.places.get(step.place))));
        }
        let known: BTreeSet<usize> = partner.iter().flatten().copied().collect();
        let more: Vec<usize> = of_new.iter().copied().filter(|hole| !known.contains(hole)).collect();
        self.moved.elsewhen.1.extend(more.iter().flat_map(|hole| &self.passes.1.steps[*hole]));
        for run in runs(&more, &of_new, |hole| Some(last_step(self.new, hole)?.place)) {
            let first = described(&self.new.holes[run[0]]);
            let message = match run.len() {
                1 => format!("a hole added: {first}"),
                n => format!("{n} holes added: the first {first}"),
            };
            changes.push(Change::new("hole-added", message).with_new(place(self.new, run[0])));
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
