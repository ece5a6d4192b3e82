//! Two revisions of a program held against each other by what they do: holes, motion, stops, and what they leave behind.
//!
//! Nothing of the text is compared: sequence numbers, spaces, comments, names of locals and the way a number is written
//! make no difference unless the control does something else because of them.
mod align;
mod anchor;
mod arcs;
mod cause;
mod change;
mod condition_changes;
mod cut_settings;
mod descriptions;
mod differences;
mod edits;
mod effects;
mod end_state;
mod entries;
mod first_command;
mod hole_groups;
mod hole_order;
mod holes;
mod initial_commands;
mod legacy_records;
mod modal_conditions;
mod pass_changes;
mod passes;
mod path;
mod record;
mod recorder;
mod redundant_commands;
mod reordered_cuts;
mod shifted_events;
mod steps;
mod store;
mod tool_setup;
mod unexecuted;
mod uniform_shift;

pub use change::{CODES, Change, Effect};
pub use holes::Paired;
pub use path::Leg;
pub use record::{BlockLocation, Record, Revision, Totals, alarm_code};
pub use recorder::MOST_STEPS;
pub use store::AcceptedFile;
pub use store::StoreError;
pub use unexecuted::{UnexecutedChange, unexecuted};

use self::align::StepPair;
use self::edits::{Causes, Edits};
use self::effects::Effects;
use self::entries::{CausedEffect, entries};

/// Everything that is different: how the runs ended and the holes first, then the motion that no changed hole explains, then the rest.
///
/// `tolerance` is in mm, and in degrees for axes that turn: what differs by less is the same.
pub fn changes(old: &Record, new: &Record, tolerance: f64) -> Vec<Change> {
    RevisionDiff::new(old, new, tolerance).changes
}

/// Two revisions held against each other: what is different, and which hole and which step is which.
#[derive(Clone, Debug)]
pub struct RevisionDiff {
    /// As [`changes`] has them.
    pub changes: Vec<Change>,
    /// All holes of both.
    pub holes: Vec<Paired>,
    /// The steps that the other one doesn't do in the same way, old and new.
    pub steps: [Vec<usize>; 2],
    /// Those of them that the other one doesn't do at that point at all.
    pub unpaired_steps: [Vec<usize>; 2],
}

impl RevisionDiff {
    /// `tolerance` as for [`changes`].
    pub fn new(old: &Record, new: &Record, tolerance: f64) -> Self {
        let outcome = end_state::outcome(old, new);
        let mut links = align::align_until_stop(&old.steps, &new.steps, (stops(old), stops(new)), tolerance);
        let [old_steps, new_steps] = truncate_at_stop(old, new, &mut links);
        let (old, new) = (&*old.up_to(old_steps), &*new.up_to(new_steps));
        let whole = uniform_shift::pair_shifted_program(&links, old, new, tolerance);
        let is_whole = whole.is_some();
        links = whole.unwrap_or(links);
        let runs = reordered_cuts::displaced(&mut links, old, new, tolerance);
        let holes = holes::compare(old, new, &links, is_whole, tolerance);
        let is_to_the_end = outcome.is_none() || [old, new].iter().all(|record| record.outcome() == "end");
        let edits = Edits::new(old, new);
        let causes = Causes::new(&edits, [old, new]);
        let caused = |effect: Effect| (causes.of(&effect), effect);
        let mut effects: Vec<CausedEffect> = outcome.into_iter().map(caused).collect();
        effects.extend(end_state::program(old, new).map(|effect| (Vec::new(), effect)));
        effects.extend(initial_commands::compare(old, new, &links).into_iter().map(caused));
        effects.extend(holes.effects.into_iter().map(|hole| (causes.of_holes(&hole), hole.effect)));
        effects.extend(condition_changes::condition_changes((old, new), &links, &edits));
        let cuts = reordered_cuts::ReorderedCuts::new(&runs, &links, (old, new), tolerance);
        let (differences, relied) = differences::differences((old, new), &links, &cuts, tolerance);
        let mut counted = Effects::new([old, new], &edits, tolerance);
        differences.iter().for_each(|difference| counted.add(difference));
        effects.extend(counted.finish());
        effects.extend(cuts.effects(&links).into_iter().chain(relied).map(caused));
        if is_to_the_end {
            effects.extend(end_state::compare(old, new, tolerance).into_iter().map(caused));
        } else if [old, new].iter().any(|record| record.outcome() == "limit") {
            // Which iteration of a program without an end is compared with the other's end is unknown.
            effects.truncate(1);
        }
        let mut changes = entries(effects, &edits);
        changes.iter_mut().for_each(|change| anchor::set_anchor(change, old, new, &links));
        let different = links.iter().filter(|link| !matches!(link, StepPair::Same(..)));
        let (was, is): (Vec<_>, Vec<_>) = different.map(|link| link.sides()).unzip();
        let steps = [was.into_iter().flatten().collect(), is.into_iter().flatten().collect()];
        let mut alone = [Vec::new(), Vec::new()];
        for link in &links {
            match link {
                StepPair::Lost(i) => alone[0].push(*i),
                StepPair::Added(j) => alone[1].push(*j),
                StepPair::Same(..) | StepPair::Changed(..) => {}
            }
        }
        Self { changes, holes: holes.pairs, steps, unpaired_steps: alone }
    }
}

fn stops(record: &Record) -> bool {
    record.outcome() != "end"
}

/// How many steps of each count where one of them stops: what the other does behind that isn't compared.
fn truncate_at_stop(old: &Record, new: &Record, links: &mut Vec<StepPair>) -> [usize; 2] {
    let is_endless = |record: &Record| record.outcome() == "limit";
    let is_lost_behind = stops(new) || is_endless(old);
    let is_added_behind = stops(old) || is_endless(new);
    let mut steps = [old.steps.len(), new.steps.len()];
    while let Some(link) = links.last() {
        match link {
            StepPair::Lost(i) if is_lost_behind => steps[0] = *i,
            StepPair::Added(j) if is_added_behind => steps[1] = *j,
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
