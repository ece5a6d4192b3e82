//! Passes of a hole that end elsewhere though the hole is finished as before, or otherwise than it: a pilot's, a spot drilling's.
use nalgebra::Point3;

use super::align::common;
use super::hole_groups::deeper;
use super::passes::Passes;
use super::record::Record;
use super::steps::{Step, difference, is_as_far_above, near};
use super::words::coordinates;
use crate::motion::{Axes, MAX_AXES, Position};

/// Such a pass.
#[derive(Clone, Debug)]
pub(super) struct Strayed {
    /// Its feed, before and now, by their numbers in either run.
    pub steps: (usize, usize),
    /// How far the feed ends from where it ended, in machine coordinates; nothing where it stays and the hole doesn't.
    shift: Position,
    /// How much of that is along the feed, mm.
    pub deeper: f64,
    /// Nothing of it is aside.
    is_along: bool,
    /// The tool's tip ends where it ended: another length makes up for it.
    is_made_up: bool,
    /// Of how many passes which it is, counted from 1, and its tool now.
    number: (usize, usize),
    tool: Option<u32>,
}

/// Of a hole that is there before and now, and is `hole_deeper` mm deeper. Its bottom is where its deepest pass ends; all others are
/// held against what that one does. Of passes that are made once only, others tell.
pub(super) fn strayed(
    old: &Record,
    new: &Record,
    (hole, other): (usize, usize),
    passes: &(Passes, Passes),
    hole_deeper: f64,
    tolerance: f64,
) -> Vec<Strayed> {
    let (was, is) = (&passes.0.steps[hole], &passes.1.steps[other]);
    let pairs = paired((was, &passes.0.tools[hole]), (is, &passes.1.tools[other]));
    let steps = |(i, j): &(usize, usize)| (&old.steps[was[*i]], &new.steps[is[*j]]);
    let find = |step: Option<usize>| pairs.iter().find(|(i, _)| Some(was[*i]) == step).map(steps);
    let finish = find(old.feeds[hole].last().copied());
    let stays = |(before, now): &(&Step, &Step)| near(&before.to, &now.to, tolerance);
    let aside = |(before, now): &(&Step, &Step)| parts(&difference(&now.to, &before.to), before).1;
    let deepest = find(deepest(old, hole, tolerance)).or(pairs.last().map(steps));
    // A hole that is finished where it was isn't moved, wherever its deepest pass is now.
    let is_aside = deepest.is_some_and(|deepest| aside(&deepest) > tolerance);
    let lead = finish.filter(|finish| is_aside && stays(finish)).or(deepest);
    let Some((lead, lead_now)) = lead else { return Vec::new() };
    let lead_shift = difference(&lead_now.to, &lead.to);
    let (lead_along, lead_aside) = parts(&lead_shift, lead);
    let is_moved = lead_aside > tolerance;
    // A hole is moved as the pass that finishes it.
    let apart = |(before, now): (&Step, &Step)| {
        let shift = difference(&now.to, &before.to);
        parts(&difference(&shift, &lead_shift), before).1 > tolerance
    };
    let is_told = !is_moved || !finish.is_some_and(apart);
    let mut all = Vec::new();
    for (i, j) in &pairs {
        let (before, now) = steps(&(*i, *j));
        let shift = difference(&now.to, &before.to);
        let stays = near(&shift, &Position::default(), tolerance);
        let is_with_hole = || {
            near(&shift, &lead_shift, tolerance)
                || (is_moved || lead_along.abs() > tolerance)
                    && is_as_far_above((before, lead), (now, lead_now), hole_deeper)
        };
        // A pass on the line of a hole that is deeper now needn't be.
        let is_lead = std::ptr::eq(before, lead);
        if is_lead && is_told || stays && !is_moved || !is_lead && is_with_hole() {
            continue;
        }
        let (along, aside) = parts(&shift, before);
        all.push(Strayed {
            steps: (was[*i], is[*j]),
            shift,
            deeper: along,
            is_along: aside <= tolerance,
            is_made_up: tip(old, hole, was[*i])
                .zip(tip(new, other, is[*j]))
                .is_some_and(|(was, is)| !stays && (is - was).norm() <= tolerance),
            number: (*i + 1, was.len()),
            tool: passes.1.tools[other].get(*j).copied(),
        });
    }
    all
}

/// Which pass is which, by their places: in their order, or, where there are more or fewer, those of the same tools.
fn paired((was, tools): (&[usize], &[u32]), (is, tools_now): (&[usize], &[u32])) -> Vec<(usize, usize)> {
    if was.len() == is.len() {
        return (0..was.len()).map(|pass| (pass, pass)).collect();
    }
    common(tools.len(), tools_now.len(), |i, j| tools[i] == tools_now[j])
}

/// The feed that makes a hole's bottom: the one that finishes it, or one before that goes deeper.
fn deepest(record: &Record, hole: usize, tolerance: f64) -> Option<usize> {
    let (found, feeds) = (&record.holes[hole], &record.feeds[hole]);
    let finish = *feeds.last()?;
    let depth = |step: &usize| {
        parts(&difference(&record.steps[*step].to, &record.steps[finish].to), &record.steps[finish]).0
    };
    let bottom = found.bottom();
    let lowest = |height: f64| height.abs() <= tolerance;
    let others = found.others.iter().zip(feeds).take(feeds.len() - 1);
    let deeper = others.filter(|(cut, _)| lowest((cut.bottom - bottom).dot(&found.axis)));
    deeper.map(|(_, step)| step).find(|step| depth(step) > tolerance).copied().or(Some(finish))
}

/// Where a pass of a hole ends on the part, as far as that is known.
fn tip(record: &Record, hole: usize, step: usize) -> Option<Point3<f64>> {
    let (others, feeds) = (&record.holes[hole].others, &record.feeds[hole]);
    let place = feeds.iter().position(|feed| *feed == step)?;
    others.get(place).filter(|_| feeds.len() == others.len() + 1).map(|cut| cut.bottom)
}

/// How much of a way is along a feed, and how much aside.
fn parts(way: &Position, feed: &Step) -> (f64, f64) {
    let dot = |a: &Position, b: &Position| (0..MAX_AXES).map(|axis| a[axis] * b[axis]).sum::<f64>();
    let along = dot(way, &feed.way()) / feed.length().max(f64::MIN_POSITIVE);
    (along, (dot(way, way) - along * along).max(0.0).sqrt())
}

impl Strayed {
    /// Which of how many.
    pub(super) fn pass(&self) -> (usize, usize) {
        self.number
    }

    fn name(&self) -> String {
        let (number, all) = self.number;
        let by = self.tool.map(|tool| format!(", by T{tool}")).unwrap_or_default();
        format!("pass {number} of {all}{by},")
    }

    pub(super) fn text(&self, axes: &Axes, tolerance: f64) -> String {
        if self.stays(tolerance) {
            return format!("{} stays where it was", self.name());
        }
        if self.is_along {
            let tip =
                if self.is_made_up { " as programmed, its tip where it was by another length" } else { "" };
            return format!("{} {:.4} mm {}{tip}", self.name(), self.deeper.abs(), deeper(self.deeper));
        }
        format!("{} ends elsewhere, by {}", self.name(), coordinates(&self.shift, axes, tolerance, true))
    }

    fn stays(&self, tolerance: f64) -> bool {
        near(&self.shift, &Position::default(), tolerance)
    }

    /// The same pass of several holes.
    pub(super) fn up_to<'a>(
        &self,
        alike: impl Iterator<Item = &'a Self>,
        axes: &Axes,
        tolerance: f64,
    ) -> String {
        let mut most = Position::default();
        for pass in alike {
            for axis in 0..MAX_AXES {
                most[axis] = most[axis].max(pass.shift[axis].abs());
            }
        }
        if near(&most, &Position::default(), tolerance) {
            return format!("{} stays where it was", self.name());
        }
        format!("{} ends elsewhere, by up to {}", self.name(), coordinates(&most, axes, tolerance, false))
    }
}
