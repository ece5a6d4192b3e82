//! State of a local when a block is reached for the first time, on any path.
use std::collections::{BTreeMap, BTreeSet};

use gcode_lang::program::OpIndex;

use super::context::ProgramUnit;
use super::vacancy::{Locals, States, UNSET, steps};

/// States of a program with the components of its control flow.
///
/// A node outside all cycles is reached once, so that only cycles are traced again.
pub(super) struct FirstReach<'a> {
    unit: &'a ProgramUnit<'a>,
    states: &'a States,
    component: &'a [usize],
    /// Nodes outside each component that lead into it.
    entries: BTreeMap<usize, Vec<OpIndex>>,
    /// Blocks with those of their locals that may be set when the block is reached for the first time.
    set_reads: BTreeSet<(OpIndex, u32)>,
}

impl<'a> FirstReach<'a> {
    pub(super) fn new(unit: &'a ProgramUnit<'a>, states: &'a States) -> Self {
        let mut first =
            Self { unit, states, component: &[], entries: BTreeMap::new(), set_reads: BTreeSet::new() };
        // Mostly the states decide all reads.
        if !has_unclear_read(unit, states) {
            return first;
        }
        let component = unit.components();
        let mut entries: BTreeMap<usize, Vec<OpIndex>> = BTreeMap::new();
        for place in 0..unit.flow.block_count() {
            let left = unit.flow.successors(place).filter(|to| component[*to] != component[place]);
            for to in left {
                entries.entry(component[to]).or_default().push(place);
            }
        }
        (first.component, first.entries) = (component, entries);
        first.set_reads = first.find_set_reads();
        first
    }

    /// Returns the reads in cycles whose local may be set before.
    ///
    /// Each local is traced once around its cycle, with all blocks that read it as ends. A value set at one
    /// of them is set on a path that passes no earlier reader, which decides most reads.
    fn find_set_reads(&self) -> BTreeSet<(OpIndex, u32)> {
        let mut readers: BTreeMap<(usize, u32), BTreeSet<OpIndex>> = BTreeMap::new();
        for block in 0..self.unit.blocks.len() {
            for number in self.unit.reads(block).iter().map(|read| read.number) {
                if (1..=33).contains(&number) && is_unclear(self.bits(block, number)) {
                    readers.entry((self.component[block], number)).or_default().insert(block);
                }
            }
        }
        let mut set = BTreeSet::new();
        for ((component, local), blocks) in readers {
            let known = self.trace(component, local, &blocks);
            let found = blocks.into_iter().filter(|block| known[*block].is_some_and(|bits| bits != UNSET));
            set.extend(found.map(|block| (block, local)));
        }
        set
    }

    /// Returns true if a local is unset when a block is reached for the first time: no path to it sets the
    /// local.
    pub(super) fn is_unset(&self, block: OpIndex, local: u32) -> bool {
        let bits = self.bits(block, local);
        if !is_unclear(bits) {
            return bits == UNSET;
        }
        let traced = || self.trace(self.component[block], local, &BTreeSet::from([block]));
        !self.set_reads.contains(&(block, local)) && traced()[block] == Some(UNSET)
    }

    /// Traces a local once more around a component, with some blocks as ends, and returns its bits at each
    /// node.
    fn trace(&self, component: usize, local: u32, ends: &BTreeSet<OpIndex>) -> Vec<Option<u8>> {
        let next_bits = |from: OpIndex, state: &Locals| {
            let mut to = Vec::new();
            steps(self.unit, from, state, &mut to);
            to.into_iter().map(|(to, after)| (to, after.bits_of(local)))
        };
        let entries = self.entries.get(&component).into_iter().flatten();
        let entries = entries.filter_map(|entry| Some((*entry, self.states[*entry].as_ref()?)));
        let far: &[_] = self.unit.piece.as_ref().map_or(&[], |piece| &piece.entries);
        let of_far = far.iter().filter_map(|entry| Some((entry.block, entry.locals?.bits_of(local))));
        let own = self.unit.entry_blocks.iter().take(self.unit.entry_blocks.len() - far.len());
        let starts = own.map(|start| (*start, self.bits(*start, local))).chain(of_far);
        let starts = starts.chain(entries.flat_map(|(entry, state)| next_bits(entry, state)));
        let next = |place: OpIndex, bits: &u8, open: &mut Vec<_>| {
            let is_inside = self.component[place] == component && !ends.contains(&place);
            let Some(mut state) = self.states[place].filter(|_| is_inside) else { return };
            state.0[local as usize] = *bits;
            open.extend(next_bits(place, &state));
        };
        self.unit.flow.propagate(starts, |known, other| *known |= other, next)
    }

    fn bits(&self, place: OpIndex, local: u32) -> u8 {
        bits(self.states, place, local)
    }
}

/// Returns true if a block reads a local that is unset on some paths to it only: the cycles about it decide.
pub(super) fn has_unclear_read(unit: &ProgramUnit<'_>, states: &States) -> bool {
    (0..unit.blocks.len()).any(|block| {
        let reads = unit.reads(block).iter().map(|read| read.number);
        reads.filter(|number| (1..=33).contains(number)).any(|local| is_unclear(bits(states, block, local)))
    })
}

fn bits(states: &States, place: OpIndex, local: u32) -> u8 {
    states[place].map_or(0, |state| state.bits_of(local))
}

fn is_unclear(bits: u8) -> bool {
    bits & UNSET != 0 && bits != UNSET
}
