//! State of a local when a block is reached for the first time, on any path.
use std::collections::{BTreeMap, BTreeSet};

use gcode_lang::program::OpIndex;

use super::components::strongly_connected_components;
use super::context::ProgramUnit;
use super::vacancy::{Locals, States, UNSET, steps};
use super::variables;

/// States of a program with the components of its control flow.
///
/// A node outside all cycles is reached once, so that only cycles are traced again.
pub(super) struct FirstReach<'a> {
    unit: &'a ProgramUnit<'a>,
    states: &'a States,
    component: Vec<usize>,
    /// Nodes outside each component that lead into it.
    entries: BTreeMap<usize, Vec<OpIndex>>,
    /// Blocks with those of their locals that may be set when the block is reached for the first time.
    set_reads: BTreeSet<(OpIndex, u32)>,
}

impl<'a> FirstReach<'a> {
    pub(super) fn new(unit: &'a ProgramUnit<'a>, states: &'a States) -> Self {
        let circle = strongly_connected_components(&unit.flow);
        let mut entries: BTreeMap<usize, Vec<OpIndex>> = BTreeMap::new();
        for place in 0..unit.flow.block_count() {
            let left = unit.flow.successors(place).filter(|to| circle[*to] != circle[place]);
            for to in left {
                entries.entry(circle[to]).or_default().push(place);
            }
        }
        let mut first = Self { unit, states, component: circle, entries, set_reads: BTreeSet::new() };
        first.set_reads = first.find_set_reads();
        first
    }

    /// Returns the reads in cycles whose local may be set before.
    ///
    /// Each local is traced once around its cycle, with all blocks that read it as ends. A value set at one
    /// of them is set on a path that passes no earlier reader, which decides most reads.
    fn find_set_reads(&self) -> BTreeSet<(OpIndex, u32)> {
        let mut readers: BTreeMap<(usize, u32), BTreeSet<OpIndex>> = BTreeMap::new();
        for (block, written) in self.unit.blocks.iter().enumerate() {
            for number in variables::block_reads(written).iter().map(|read| read.number) {
                if (1..=33).contains(&number) && is_unclear(self.bits(block, number)) {
                    readers.entry((self.component[block], number)).or_default().insert(block);
                }
            }
        }
        let mut set = BTreeSet::new();
        for ((circle, local), blocks) in readers {
            let known = self.trace(circle, local, &blocks);
            let found =
                blocks.into_iter().filter(|block| known.get(block).is_some_and(|bits| *bits != UNSET));
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
        !self.set_reads.contains(&(block, local)) && traced().get(&block) == Some(&UNSET)
    }

    /// Traces a local once more around a component, with some blocks as ends, and returns its bits at each
    /// node.
    fn trace(&self, circle: usize, local: u32, ends: &BTreeSet<OpIndex>) -> BTreeMap<OpIndex, u8> {
        let mut component_state = ComponentState {
            components: &self.component,
            component: circle,
            known: BTreeMap::new(),
            pending: Vec::new(),
        };
        for start in self.unit.entry_blocks.iter().filter(|start| self.component[**start] == circle) {
            component_state.join(*start, self.bits(*start, local));
        }
        for entry in self.entries.get(&circle).into_iter().flatten() {
            let Some(state) = &self.states[*entry] else { continue };
            self.propagate(*entry, state, local, &mut component_state);
        }
        while let Some(at) = component_state.pending.pop() {
            if ends.contains(&at) {
                continue;
            }
            let Some(mut state) = self.states[at] else { continue };
            state.0[local as usize] = component_state.known[&at];
            self.propagate(at, &state, local, &mut component_state);
        }
        component_state.known
    }

    fn propagate(&self, from: OpIndex, state: &Locals, local: u32, around: &mut ComponentState<'_>) {
        for (to, after) in steps(self.unit, from, state) {
            around.join(to, after.bits_of(local));
        }
    }

    fn bits(&self, place: OpIndex, local: u32) -> u8 {
        self.states[place].map_or(0, |state| state.bits_of(local))
    }
}

/// Returns true if a local may be unset and may be set.
fn is_unclear(bits: u8) -> bool {
    bits & UNSET != 0 && bits != UNSET
}

/// Bits of a local at the nodes of one component.
struct ComponentState<'a> {
    components: &'a [usize],
    component: usize,
    known: BTreeMap<OpIndex, u8>,
    /// Nodes whose bits have grown.
    pending: Vec<OpIndex>,
}

impl ComponentState<'_> {
    fn join(&mut self, place: OpIndex, bits: u8) {
        if self.components.get(place) != Some(&self.component) {
            return;
        }
        let known = self.known.entry(place).or_default();
        if *known | bits != *known {
            *known |= bits;
            self.pending.push(place);
        }
    }
}
