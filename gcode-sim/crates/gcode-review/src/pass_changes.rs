//! Passes of a hole that end at another point while the hole does not move with them: pilots, spot drilling.
use nalgebra::Point3;

use super::align::Alignment;
use super::common_sequence::common;
use super::descriptions::{coordinates, deeper};
use super::passes::Passes;
use super::record::Record;
use super::steps::{Step, difference, dot, is_as_far_above, near};
use gcode_lang::motion::{Axes, Position};

/// A pass that changed, unlike its hole.
#[derive(Clone, Debug)]
pub(super) struct PassChange {
    /// Its feeds by their numbers in the old and the new run.
    pub steps: (usize, usize),
    /// Displacement of its end point in machine coordinates; 0 for a pass that stays while the hole moves.
    shift: Position,
    /// Part of the displacement along the feed, mm.
    depth_change: f64,
    /// The whole displacement is along the feed.
    is_along: bool,
    /// The tool tip ends at the same point because of another length offset.
    is_compensated: bool,
    /// Number of the pass, from 1, and number of passes.
    pub number: (usize, usize),
    /// Its tool in the new revision.
    tool: Option<u32>,
}

/// Returns the changed passes of a hole that both revisions have and that is `hole_deeper` mm deeper. Each pass is
/// compared with the deepest one, which makes the bottom; passes of one revision alone are differences of its
/// tools.
pub(super) fn pass_changes(
    alignment: &Alignment<'_>,
    passes: &[Passes; 2],
    [hole, other]: [usize; 2],
    hole_deeper: f64,
) -> Vec<PassChange> {
    let Alignment { records: [old, new], tolerance, .. } = *alignment;
    let (was, is) = (&passes[0].steps[hole], &passes[1].steps[other]);
    let pairs = paired((was, &passes[0].tools[hole]), (is, &passes[1].tools[other]));
    let pass = |(i, j): &(usize, usize)| PassPair {
        before: old.steps.at(was[*i]),
        now: new.steps.at(is[*j]),
        number: *i,
    };
    let find = |step: Option<usize>| pairs.iter().find(|(i, _)| Some(was[*i]) == step).map(pass);
    let finish = find(old.feeds[hole].last().copied());
    let deepest = find(deepest(old, hole, tolerance)).or(pairs.last().map(pass));
    // The pass that finishes the hole decides whether it moved, even if the deepest pass did.
    let is_aside = deepest.is_some_and(|deepest| deepest.parts(&deepest.shift()).1 > tolerance);
    let lead = finish.filter(|finish| is_aside && finish.stays(tolerance)).or(deepest);
    let Some(lead) = lead else { return Vec::new() };
    let lead_shift = lead.shift();
    let (lead_along, lead_aside) = lead.parts(&lead_shift);
    let is_moved = lead_aside > tolerance;
    let is_apart =
        |finish: PassPair<'_>| finish.parts(&difference(&finish.shift(), &lead_shift)).1 > tolerance;
    let is_lead_explained = !is_moved || !finish.is_some_and(is_apart);
    let mut all = Vec::new();
    for (i, j) in &pairs {
        let pass = pass(&(*i, *j));
        let shift = pass.shift();
        let is_with_hole = || {
            near(&shift, &lead_shift, tolerance)
                || (is_moved || lead_along.abs() > tolerance)
                    && is_as_far_above((&pass.before, &lead.before), (&pass.now, &lead.now), hole_deeper)
        };
        let is_explained = if pass.number == lead.number {
            is_lead_explained
        } else {
            // A pass of a hole that only gets deeper may stay.
            !is_moved && pass.stays(tolerance) || is_with_hole()
        };
        if is_explained {
            continue;
        }
        let (along, aside) = pass.parts(&shift);
        let tips = tip(old, hole, was[*i]).zip(tip(new, other, is[*j]));
        all.push(PassChange {
            steps: (was[*i], is[*j]),
            shift,
            depth_change: along,
            is_along: aside <= tolerance,
            is_compensated: tips.is_some_and(|(was, is)| (is - was).norm() <= tolerance),
            number: (*i + 1, was.len()),
            tool: passes[1].tools[other].get(*j).copied(),
        });
    }
    all
}

/// A pass in the old and in the new revision.
#[derive(Clone, Copy)]
struct PassPair<'a> {
    before: Step<'a>,
    now: Step<'a>,
    /// Number of the pass in the old revision, from 0.
    number: usize,
}

impl PassPair<'_> {
    /// Returns the displacement of its end point.
    fn shift(self) -> Position {
        difference(&self.now.to, &self.before.to)
    }

    fn stays(self, tolerance: f64) -> bool {
        near(&self.shift(), &Position::default(), tolerance)
    }

    /// Splits a displacement into its parts along and across the feed.
    fn parts(self, displacement: &Position) -> (f64, f64) {
        parts(displacement, &self.before)
    }
}

/// Pairs passes in their order, or by their tools if their numbers differ.
fn paired((was, tools): (&[usize], &[u32]), (is, tools_now): (&[usize], &[u32])) -> Vec<(usize, usize)> {
    if was.len() == is.len() {
        return (0..was.len()).map(|pass| (pass, pass)).collect();
    }
    common(tools.len(), tools_now.len(), |i, j| tools[i] == tools_now[j])
}

/// Returns the feed that makes the bottom of a hole: the finishing one, or an earlier one that goes deeper.
fn deepest(record: &Record, hole: usize, tolerance: f64) -> Option<usize> {
    let (found, feeds) = (&record.holes[hole], &record.feeds[hole]);
    let finish = *feeds.last()?;
    let feed = record.steps.at(finish);
    let depth = |step: &usize| parts(&difference(&record.steps.at(*step).to, &feed.to), &feed).0;
    let bottom = found.bottom();
    let lowest = |height: f64| height.abs() <= tolerance;
    let others = found.earlier_passes.iter().zip(feeds).take(feeds.len() - 1);
    let deeper = others.filter(|(cut, _)| lowest((cut.cut.bottom - bottom).dot(&found.axis)));
    deeper.map(|(_, step)| step).find(|step| depth(step) > tolerance).copied().or(Some(finish))
}

/// Returns the end point of a pass on the part; `None` if it is unknown.
fn tip(record: &Record, hole: usize, step: usize) -> Option<Point3<f64>> {
    let (others, feeds) = (&record.holes[hole].earlier_passes, &record.feeds[hole]);
    let index = feeds.iter().position(|feed| *feed == step)?;
    others.get(index).filter(|_| feeds.len() == others.len() + 1).map(|cut| cut.cut.bottom)
}

/// Splits a displacement into its parts along and across a feed.
fn parts(displacement: &Position, feed: &Step<'_>) -> (f64, f64) {
    let along = dot(displacement, &feed.displacement()) / feed.length().max(f64::MIN_POSITIVE);
    (along, (dot(displacement, displacement) - along * along).max(0.0).sqrt())
}

/// Formats a pass that changed in one or more holes, with the numbers of the first if all of them are equal, else
/// with the largest.
pub(super) fn describe_pass(all: &[&PassChange], is_alike: bool, axes: &Axes, tolerance: f64) -> String {
    let PassChange { number: (number, passes), tool, shift, depth_change: depth, .. } = all[0];
    let by = tool.map(|tool| format!(", by T{tool}")).unwrap_or_default();
    let name = format!("pass {number} of {passes}{by},");
    let largest = |axis: usize| all.iter().map(|pass| pass.shift[axis].abs()).fold(0.0, f64::max);
    let most = if is_alike { *shift } else { Position(std::array::from_fn(largest)) };
    if near(&most, &Position::default(), tolerance) {
        format!("{name} is unchanged")
    } else if is_alike && all[0].is_along {
        let tip = if all[0].is_compensated {
            " as programmed; its tip position is unchanged because of another length offset"
        } else {
            ""
        };
        format!("{name} {:.4} mm {}{tip}", depth.abs(), deeper(*depth))
    } else {
        let up_to = if is_alike { "" } else { "up to " };
        format!("{name} ends at a different point: {up_to}{}", coordinates(&most, axes, tolerance, is_alike))
    }
}
