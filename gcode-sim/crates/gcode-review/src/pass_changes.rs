//! Passes of a hole that end elsewhere though the hole is finished as before, or otherwise than it: a pilot's, a spot drilling's.
use nalgebra::Point3;

use super::align::common;
use super::descriptions::coordinates;
use super::descriptions::deeper;
use super::passes::Passes;
use super::record::Record;
use super::steps::{Step, difference, dot, is_as_far_above, near};
use gcode_lang::motion::{Axes, MAX_AXES, Position};

/// Such a pass.
#[derive(Clone, Debug)]
pub(super) struct PassChange {
    /// Its feed, before and now, by their numbers in either run.
    pub steps: (usize, usize),
    /// How far the feed ends from where it ended, in machine coordinates; nothing where it stays and the hole doesn't.
    shift: Position,
    /// How much of that is along the feed, mm.
    pub deeper: f64,
    /// Nothing of it is aside.
    is_along: bool,
    /// The tool's tip ends where it ended: another length makes up for it.
    is_compensated: bool,
    /// Of how many passes which it is, counted from 1, and its tool now.
    number: (usize, usize),
    tool: Option<u32>,
}

/// Of a hole that is there before and now, and is `hole_deeper` mm deeper. Its bottom is where its deepest pass ends; all others are
/// held against what that one does. Of passes that are made once only, others tell.
pub(super) fn pass_changes(
    old: &Record,
    new: &Record,
    (hole, other): (usize, usize),
    passes: &(Passes, Passes),
    hole_deeper: f64,
    tolerance: f64,
) -> Vec<PassChange> {
    let (was, is) = (&passes.0.steps[hole], &passes.1.steps[other]);
    let pairs = paired((was, &passes.0.tools[hole]), (is, &passes.1.tools[other]));
    let pass = |(i, j): &(usize, usize)| PassPair { before: &old.steps[was[*i]], now: &new.steps[is[*j]] };
    let find = |step: Option<usize>| pairs.iter().find(|(i, _)| Some(was[*i]) == step).map(pass);
    let finish = find(old.feeds[hole].last().copied());
    let deepest = find(deepest(old, hole, tolerance)).or(pairs.last().map(pass));
    // A hole that is finished where it was isn't moved, wherever its deepest pass is now.
    let is_aside = deepest.is_some_and(|deepest| deepest.parts(&deepest.shift()).1 > tolerance);
    let lead = finish.filter(|finish| is_aside && finish.stays(tolerance)).or(deepest);
    let Some(lead) = lead else { return Vec::new() };
    let lead_shift = lead.shift();
    let (lead_along, lead_aside) = lead.parts(&lead_shift);
    let is_moved = lead_aside > tolerance;
    // A hole is moved as the pass that finishes it.
    let is_apart =
        |finish: PassPair<'_>| finish.parts(&difference(&finish.shift(), &lead_shift)).1 > tolerance;
    let is_lead_told = !is_moved || !finish.is_some_and(is_apart);
    let mut all = Vec::new();
    for (i, j) in &pairs {
        let pass = pass(&(*i, *j));
        let shift = pass.shift();
        let is_with_hole = || {
            near(&shift, &lead_shift, tolerance)
                || (is_moved || lead_along.abs() > tolerance)
                    && is_as_far_above((pass.before, lead.before), (pass.now, lead.now), hole_deeper)
        };
        let is_told = if std::ptr::eq(pass.before, lead.before) {
            is_lead_told
        } else {
            // A pass on the line of a hole that is deeper now needn't be.
            !is_moved && pass.stays(tolerance) || is_with_hole()
        };
        if is_told {
            continue;
        }
        let (along, aside) = pass.parts(&shift);
        let tips = tip(old, hole, was[*i]).zip(tip(new, other, is[*j]));
        all.push(PassChange {
            steps: (was[*i], is[*j]),
            shift,
            deeper: along,
            is_along: aside <= tolerance,
            is_compensated: tips.is_some_and(|(was, is)| (is - was).norm() <= tolerance),
            number: (*i + 1, was.len()),
            tool: passes.1.tools[other].get(*j).copied(),
        });
    }
    all
}

/// A pass before and now.
#[derive(Clone, Copy)]
struct PassPair<'a> {
    before: &'a Step,
    now: &'a Step,
}

impl PassPair<'_> {
    /// How far it ends from where it ended.
    fn shift(self) -> Position {
        difference(&self.now.to, &self.before.to)
    }

    fn stays(self, tolerance: f64) -> bool {
        near(&self.shift(), &Position::default(), tolerance)
    }

    /// How much of a way is along its feed, and how much aside.
    fn parts(self, way: &Position) -> (f64, f64) {
        parts(way, self.before)
    }
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
    let feed = &record.steps[finish];
    let depth = |step: &usize| parts(&difference(&record.steps[*step].to, &feed.to), feed).0;
    let bottom = found.bottom();
    let lowest = |height: f64| height.abs() <= tolerance;
    let others = found.earlier_passes.iter().zip(feeds).take(feeds.len() - 1);
    let deeper = others.filter(|(cut, _)| lowest((cut.bottom - bottom).dot(&found.axis)));
    deeper.map(|(_, step)| step).find(|step| depth(step) > tolerance).copied().or(Some(finish))
}

/// Where a pass of a hole ends on the part, as far as that is known.
fn tip(record: &Record, hole: usize, step: usize) -> Option<Point3<f64>> {
    let (others, feeds) = (&record.holes[hole].earlier_passes, &record.feeds[hole]);
    let place = feeds.iter().position(|feed| *feed == step)?;
    others.get(place).filter(|_| feeds.len() == others.len() + 1).map(|cut| cut.bottom)
}

/// How much of a way is along a feed, and how much aside.
fn parts(way: &Position, feed: &Step) -> (f64, f64) {
    let along = dot(way, &feed.way()) / feed.length().max(f64::MIN_POSITIVE);
    (along, (dot(way, way) - along * along).max(0.0).sqrt())
}

impl PassChange {
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
            return format!("{} is unchanged", self.name());
        }
        if self.is_along {
            let tip = if self.is_compensated {
                " as programmed; its tip position is unchanged because of another length offset"
            } else {
                ""
            };
            return format!("{} {:.4} mm {}{tip}", self.name(), self.deeper.abs(), deeper(self.deeper));
        }
        format!(
            "{} ends at a different point: {}",
            self.name(),
            coordinates(&self.shift, axes, tolerance, true)
        )
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
            return format!("{} is unchanged", self.name());
        }
        format!(
            "{} ends at a different point: up to {}",
            self.name(),
            coordinates(&most, axes, tolerance, false)
        )
    }
}
