//! Compares two revisions of a program by their effects: holes, motion, stops, and the final state of the control.
//!
//! In: two [`Record`]s. [`Revision::of`] runs a program and records its steps; [`Record::from_json`] reads an
//! accepted result. Out: a [`RevisionDiff`] with one [`Change`] for each edit, the hole pairs and the steps that
//! differ. Texts are compared only to find the cause of a difference: sequence numbers, spaces, comments, numbers
//! of locals and the spelling of values are no changes.
//!
//! ```
//! use gcode_inspect::machine::Machine;
//! use gcode_lang::program::NoLibrary;
//! use gcode_review::{Revision, changes};
//! use gcode_session::Request;
//!
//! let [old, new] = ["O1\nG81 X10. Z-5. R2. F50\nM30\n", "O1\nG81 X10.1 Z-5. R2. F50\nM30\n"].map(|text| {
//!     let request = Request::new("O1.nc", text.as_bytes(), Machine::default());
//!     Revision::of(&request, &mut NoLibrary, None).unwrap().record
//! });
//! let changes = changes(&old, &new, 0.0001);
//! assert_eq!(changes.len(), 1);
//! assert_eq!(changes[0].code, "hole-moved");
//! assert_eq!(changes[0].message, "hole 1: moved by +0.1000 +0.0000 +0.0000 mm");
//! ```
#![warn(missing_docs)]

mod align;
mod anchor;
mod arcs;
mod block_list;
mod block_location;
mod change;
mod common_sequence;
mod cut_settings;
mod descriptions;
mod differences;
mod edits;
mod effect_groups;
mod effects;
mod end_state;
mod entries;
mod first_command;
mod hole_groups;
mod hole_order;
mod holes;
mod initial_commands;
mod kind_numbers;
pub mod kinds;
mod leg;
mod legacy_records;
mod links;
mod modal_conditions;
mod other_blocks;
mod pass_changes;
mod passes;
mod path;
mod position_cells;
mod positions;
mod program_text;
mod record;
mod recorder;
mod redundant_commands;
mod reordered_cuts;
mod runs;
mod shifted_events;
mod step_list;
mod steps;
mod store;
mod tool_setup;
mod unexecuted;
mod uniform_shift;

pub use block_location::BlockLocation;
pub use change::{Change, Effect, UnexecutedChange};
pub use holes::Paired;
pub use leg::{Leg, UnplacedEnd};
pub use record::{Record, Revision, Totals, alarm_code};
pub use store::{AcceptedFile, StoreError};
pub use unexecuted::unexecuted;

use self::align::Alignment;
use self::edits::Edits;
use self::effects::Effects;
use self::entries::entries;
use self::links::{Links, StepPair};

/// Returns the changes: outcome and holes first, then motion, then the final state.
///
/// Deviations up to `tolerance`, in mm and for rotary axes in degrees, are no changes.
pub fn changes(old: &Record, new: &Record, tolerance: f64) -> Vec<Change> {
    RevisionDiff::new(old, new, tolerance).changes
}

/// Comparison of two revisions: the changes, and the pairs of holes and steps.
#[derive(Clone, Debug)]
pub struct RevisionDiff {
    /// The result of [`changes`].
    pub changes: Vec<Change>,
    /// All holes of both revisions.
    pub holes: Vec<Paired>,
    /// Numbers of the steps that differ, old and new, those behind the stop of the other revision included.
    pub steps: [Vec<usize>; 2],
    /// Those of them that have no counterpart in the other revision.
    pub unpaired_steps: [Vec<usize>; 2],
}

impl RevisionDiff {
    /// Compares two records with the tolerance of [`changes`].
    pub fn new(old: &Record, new: &Record, tolerance: f64) -> Self {
        let stop = (stops(old), stops(new));
        let mut links = align::align_until_stop(&old.steps, &new.steps, stop, tolerance);
        let whole_records = [old, new];
        let [old_steps, new_steps] = truncate_at_stop(old, new, &mut links);
        let (old, new) = (&*old.up_to(old_steps), &*new.up_to(new_steps));
        let records = [old, new];
        let whole = uniform_shift::pair_shifted_program(&links, old, new, tolerance);
        let is_whole = whole.is_some();
        links = whole.unwrap_or(links);
        let runs = reordered_cuts::reordered_runs(&mut links, old, new, tolerance);
        let alignment = Alignment { records, links: &links, tolerance };
        let (holes, mut pairs) = holes::compare(&alignment, is_whole);
        let unreached = |side: usize| records[side].holes.len()..whole_records[side].holes.len();
        pairs.extend(unreached(0).map(|hole| Paired::alone(Some(hole), None)));
        pairs.extend(unreached(1).map(|hole| Paired::alone(None, Some(hole))));
        let cuts = reordered_cuts::ReorderedCuts::new(&runs, alignment);
        let edits = Edits::new(old, new);
        let mut effects = Effects::new(alignment, &edits);
        differences::differences(&alignment, holes, &cuts, |difference| effects.add(difference));
        let mut changes = entries(effects.finish(), &edits);
        anchor::set_anchors(&mut changes, &alignment);
        let sides = |side: usize| move |(_, link): (usize, StepPair)| link.sides()[side];
        let unreached = |side: usize| [old_steps, new_steps][side]..whole_records[side].steps.len();
        let differences = |side: usize| links.differences().filter_map(sides(side)).chain(unreached(side));
        let unpaired = |side: usize| links.unpaired().filter_map(sides(side)).chain(unreached(side));
        Self {
            changes,
            holes: pairs,
            steps: [0, 1].map(|side| differences(side).collect()),
            unpaired_steps: [0, 1].map(|side| unpaired(side).collect()),
        }
    }
}

fn stops(record: &Record) -> bool {
    record.outcome() != "end"
}

/// Removes the links after the point where one run stops, and returns the number of compared steps of each.
fn truncate_at_stop(old: &Record, new: &Record, links: &mut Links) -> [usize; 2] {
    let is_endless = |record: &Record| record.outcome() == "limit";
    let is_lost_behind = stops(new) || is_endless(old);
    let is_added_behind = stops(old) || is_endless(new);
    let mut steps = [old.steps.len(), new.steps.len()];
    while let Some(link) = links.last() {
        match link {
            StepPair::Lost(i) if is_lost_behind => steps[0] = i,
            StepPair::Added(j) if is_added_behind => steps[1] = j,
            _ => break,
        }
        links.pop();
    }
    steps
}

/// Returns pairs of equal lines of two texts, counted from 0: a longest common sequence, or a long one of texts
/// that differ too much.
pub fn common_lines(old: &[String], new: &[String]) -> Vec<(usize, usize)> {
    common_sequence::common(old.len(), new.len(), |i, j| old[i] == new[j])
}

#[cfg(test)]
mod tests {
    use super::*;
    use gcode_inspect::machine::Machine;
    use gcode_lang::program::NoLibrary;
    use gcode_session::Request;

    /// Three holes, of which the old program makes two before its alarm: the third is added, and so is every move behind the stop. The
    /// other way round it is lost.
    #[test]
    fn what_a_stopped_run_does_not_reach_is_no_unchanged_hole_and_no_unchanged_move() {
        let program = |alarm: &str| {
            format!(
                "O1\nS1000 M03\nG90 G00 X0 Y0 Z5.\nG81 X10. Z-5. R2. F100.\nX20.\n{alarm}X30.\nG80\nG01 X50.\nM30\n"
            )
        };
        let [stops, ends] = ["#3000=1(STOP)\n", ""].map(|alarm| {
            let request = Request::new("O1.nc", program(alarm).into_bytes(), Machine::default());
            Revision::of(&request, &mut NoLibrary, None).unwrap()
        });
        for (old, new, ending) in [(&stops, &ends, 1), (&ends, &stops, 0)] {
            let compared = RevisionDiff::new(&old.record, &new.record, 1e-4);
            let holes: Vec<_> = compared.holes.iter().map(|pair| [pair.old, pair.new]).collect();
            let alone = if ending == 1 { [None, Some(2)] } else { [Some(2), None] };
            assert_eq!(holes, [[Some(0), Some(0)], [Some(1), Some(1)], alone]);
            let (all, reached) = ([old, new].map(|side| side.record.steps.len()), stops.record.steps.len());
            for steps in [&compared.steps, &compared.unpaired_steps] {
                assert!(
                    (reached..all[ending]).all(|step| steps[ending].contains(&step)),
                    "{steps:?} {all:?}"
                );
                assert!(!steps[ending].contains(&0) && steps[1 - ending].len() < 2, "{steps:?}");
            }
        }
    }
}
