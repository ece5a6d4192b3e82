//! Two revisions of a program held against each other by what they do: holes, motion, stops, and what they leave behind.
//!
//! Nothing of the text is compared: sequence numbers, spaces, comments, names of locals and the way a number is written
//! make no difference unless the control does something else because of them.
mod align;
mod arcs;
mod as_a_whole;
mod begin;
mod cause;
mod change;
mod conditions;
mod displaced;
mod elsewhen;
mod groups;
mod hole_groups;
mod holes;
mod idle;
mod in_force;
mod left;
mod made_with;
mod motion;
mod near;
mod older;
mod one_cause;
mod order;
mod passes;
mod path;
mod record;
mod recorder;
mod repeated;
mod returns;
mod set_up;
mod steps;
mod store;
mod strayed;
mod together;
mod words;

pub use change::{CODES, Change};
pub use holes::Paired;
pub use idle::{Unexecuted, unexecuted};
pub use path::Leg;
pub use record::{Record, Revision, Totals, Where};
pub use recorder::MOST_STEPS;
pub(crate) use store::File as AcceptedFile;
pub use store::StoreError;

use std::collections::BTreeSet;

use self::align::Link;
use crate::exec::mode_name;

/// Everything that is different: how the runs ended and the holes first, then the motion that no changed hole explains, then the rest.
///
/// `tolerance` is in mm, and in degrees for axes that turn: what differs by less is the same.
pub fn changes(old: &Record, new: &Record, tolerance: f64) -> Vec<Change> {
    Compared::new(old, new, tolerance).changes
}

/// Two revisions held against each other: what is different, and which hole and which step is which.
#[derive(Clone, Debug)]
pub struct Compared {
    /// As [`changes`] has them.
    pub changes: Vec<Change>,
    /// All holes of both.
    pub holes: Vec<Paired>,
    /// The steps that the other one doesn't do in the same way, old and new.
    pub steps: [Vec<usize>; 2],
    /// Those of them that the other one doesn't do at that point at all.
    pub alone: [Vec<usize>; 2],
}

impl Compared {
    /// `tolerance` as for [`changes`].
    pub fn new(old: &Record, new: &Record, tolerance: f64) -> Self {
        let outcome = left::outcome(old, new);
        let mut links = align::up_to_the_end(&old.steps, &new.steps, (stops(old), stops(new)), tolerance);
        let [old_steps, new_steps] = up_to_the_stop(old, new, &mut links);
        let (old, new) = (&*old.up_to(old_steps), &*new.up_to(new_steps));
        let whole = as_a_whole::as_a_whole(&links, old, new, tolerance);
        let is_whole = whole.is_some();
        links = whole.unwrap_or(links);
        let runs = displaced::displaced(&mut links, old, new, tolerance);
        let holes = holes::compare(old, new, &links, is_whole, tolerance);
        let is_by_other = outcome.is_some();
        let is_to_the_end = !is_by_other || [old, new].iter().all(|record| record.outcome() == "end");
        let mut changes: Vec<Change> = outcome.into_iter().collect();
        changes.extend(left::program(old, new));
        changes.extend(begin::compare(old, new, &links));
        changes.extend(holes.changes);
        let is_all_same = links.iter().all(|link| matches!(link, Link::Same(..)));
        let edit = if is_all_same { None } else { one_cause::edit(old, new) };
        let displaced = displaced::Displaced::new(&runs, &links, (old, new), tolerance);
        let explained = (&holes.moved, &displaced);
        let (motion, modes) = motion::compare((old, new), &links, explained, tolerance, edit.is_some());
        changes.extend(motion);
        // Where all moves go where they went, they may be made otherwise.
        if !changes.is_empty()
            && let Some(edit) = edit.or_else(|| one_cause::edit(old, new))
        {
            changes = one_cause::joined(changes, &edit);
        }
        if !is_to_the_end && [old, new].iter().any(|record| record.outcome() == "limit") {
            // Which round of a program without an end the other one is held against, nobody knows.
            changes.truncate(1);
        }
        if is_to_the_end {
            let mut told: BTreeSet<String> = modes.into_iter().map(mode_name).collect();
            told.extend(left::switches_outputs(old, new, &links).then(|| left::OUTPUTS.to_owned()));
            told.extend(is_by_other.then(|| left::PARTS.to_owned()));
            changes.extend(left::compare(old, new, &told, tolerance));
        }
        changes.iter_mut().for_each(|change| near::note(change, old, new, &links));
        let different = links.iter().filter(|link| !matches!(link, Link::Same(..)));
        let (was, is): (Vec<_>, Vec<_>) = different.map(|link| link.sides()).unzip();
        let steps = [was.into_iter().flatten().collect(), is.into_iter().flatten().collect()];
        let mut alone = [Vec::new(), Vec::new()];
        for link in &links {
            match link {
                Link::Lost(i) => alone[0].push(*i),
                Link::Added(j) => alone[1].push(*j),
                Link::Same(..) | Link::Changed(..) => {}
            }
        }
        Self { changes, holes: holes.pairs, steps, alone }
    }
}

fn stops(record: &Record) -> bool {
    record.outcome() != "end"
}

/// How many steps of each count where one of them stops: what the other does behind that isn't compared.
fn up_to_the_stop(old: &Record, new: &Record, links: &mut Vec<Link>) -> [usize; 2] {
    let is_endless = |record: &Record| record.outcome() == "limit";
    let is_lost_behind = stops(new) || is_endless(old);
    let is_added_behind = stops(old) || is_endless(new);
    let mut steps = [old.steps.len(), new.steps.len()];
    while let Some(link) = links.last() {
        match link {
            Link::Lost(i) if is_lost_behind => steps[0] = *i,
            Link::Added(j) if is_added_behind => steps[1] = *j,
            _ => break,
        }
        links.pop();
    }
    steps
}

/// Pairs of equal lines of two texts, by their places from 0: the longest common sequence, or, of texts that differ in
/// too much for that, what is common at their beginnings and ends.
pub fn common_lines(old: &[String], new: &[String]) -> Vec<(usize, usize)> {
    align::common(old.len(), new.len(), |i, j| old[i] == new[j])
}
