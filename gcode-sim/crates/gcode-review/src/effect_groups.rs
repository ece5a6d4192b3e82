//! Groups of equal differences of steps: what they have in common, and the numbers that they collect.
use std::collections::BTreeSet;

use super::kinds;
use super::modal_conditions::ModalAspect;
use super::step_list::StepList;
use gcode_lang::diag::FindingKind;
use gcode_lang::motion::{MAX_AXES, Position};

/// Differences with one sentence, or those that one edit makes of moves.
pub(super) struct EffectGroup {
    pub kind: &'static FindingKind,
    /// The difference without its count.
    pub text: String,
    /// Names of the steps that differ, and the number of each.
    pub counts: Vec<(&'static str, usize)>,
    /// Others have other numbers than the first.
    pub varies: bool,
    pub numbers: Numbers,
    /// Numbers of its edits, and whether its blocks are part of them.
    pub causes: EditSet,
    pub is_direct: bool,
    /// Numbers of the first blocks in the records.
    pub block_numbers: [Option<usize>; 2],
}

/// Edits in the order in which they are added, each once.
#[derive(Clone, Default)]
pub(super) struct EditSet {
    pub all: Vec<u32>,
    /// The same edits, once they are not in their order.
    sorted: Option<BTreeSet<u32>>,
}

impl EditSet {
    pub(super) fn insert(&mut self, edit: u32) {
        let is_new = match &mut self.sorted {
            Some(sorted) => sorted.insert(edit),
            None if self.all.last().is_none_or(|last| *last < edit) => true,
            None if self.all.binary_search(&edit).is_ok() => false,
            None => {
                self.sorted = Some(self.all.iter().copied().chain([edit]).collect());
                true
            }
        };
        if is_new {
            self.all.push(edit);
        }
    }
}

impl FromIterator<usize> for EditSet {
    fn from_iter<T: IntoIterator<Item = usize>>(edits: T) -> Self {
        let mut all = Self::default();
        edits.into_iter().for_each(|edit| all.insert(edit as u32));
        all
    }
}

/// Numbers that a group collects.
#[derive(PartialEq)]
pub(super) enum Numbers {
    None,
    /// Largest deviation of each axis, and whether all machine positions are unchanged.
    Shift {
        most: Position,
        is_compensated: bool,
    },
    /// Ratios of new to old feeds.
    Factor {
        smallest: f64,
        largest: f64,
    },
    /// Spindle speeds of the old and the new run, rpm.
    Speeds {
        old: f64,
        new: f64,
    },
    /// Moves under another condition by their numbers in the old run, and the first in the new run.
    Moves {
        aspect: ModalAspect,
        old: Vec<usize>,
        first_new: usize,
    },
}

impl EffectGroup {
    /// Joins a difference that has the text and the numbers of one in the group, and other edits.
    pub(super) fn join_same(&mut self, causes: EditSet, is_direct: bool) {
        self.add_causes(causes, is_direct);
        self.counts[0].1 += 1;
    }

    fn add_causes(&mut self, causes: EditSet, is_direct: bool) {
        match (self.is_direct, is_direct) {
            (true, true) => causes.all.into_iter().for_each(|edit| self.causes.insert(edit)),
            (false, true) => (self.causes, self.is_direct) = (causes, true),
            (_, false) => {}
        }
    }

    pub(super) fn join(&mut self, other: Self) {
        self.varies |= self.text != other.text;
        self.join_numbers(other.numbers, other.causes, other.is_direct);
        other.counts.into_iter().for_each(|(name, times)| self.count(name, times));
    }

    /// Adds numbers and edits of another difference.
    pub(super) fn join_numbers(&mut self, numbers: Numbers, causes: EditSet, is_direct: bool) {
        self.add_causes(causes, is_direct);
        match (&mut self.numbers, numbers) {
            (
                Numbers::Shift { most, is_compensated },
                Numbers::Shift { most: others, is_compensated: is_other },
            ) => {
                (0..MAX_AXES).for_each(|axis| most[axis] = most[axis].max(others[axis]));
                *is_compensated &= is_other;
            }
            (
                Numbers::Factor { smallest, largest },
                Numbers::Factor { smallest: other_smallest, largest: other_largest },
            ) => (*smallest, *largest) = (smallest.min(other_smallest), largest.max(other_largest)),
            (Numbers::Moves { old, .. }, Numbers::Moves { old: others, .. }) => old.extend(others),
            _ => {}
        }
    }

    /// Counts steps of a name.
    pub(super) fn count(&mut self, name: &'static str, times: usize) {
        match self.counts.iter_mut().find(|(known, _)| *known == name) {
            Some((_, count)) => *count += times,
            None => self.counts.push((name, times)),
        }
    }
}

/// Returns a kind of change and the numbers of blocks, old and new, in little memory.
pub(super) fn block_key(kind: &FindingKind, blocks: [Option<usize>; 2]) -> (u8, u32, u32) {
    let number = kinds::ALL.iter().position(|other| other.code == kind.code).unwrap_or(kinds::ALL.len());
    let [old, new] = blocks.map(|block| block.map_or(0, |block| block as u32 + 1));
    (number as u8, old, new)
}

/// Blocks that make several steps, or set a word of several.
pub(super) struct RepeatedBlocks(Vec<bool>);

impl RepeatedBlocks {
    pub(super) fn of(steps: &StepList, blocks: usize) -> Self {
        let mut last = vec![u32::MAX; blocks];
        let mut repeated = vec![false; blocks];
        for step in 0..steps.len() {
            for block in [steps.block_number(step), steps.editable_at(step)] {
                let before = std::mem::replace(&mut last[block], step as u32);
                repeated[block] |= before != u32::MAX && before != step as u32;
            }
        }
        Self(repeated)
    }

    pub(super) fn contains(&self, block: usize) -> bool {
        self.0[block]
    }
}
