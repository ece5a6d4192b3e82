//! What a local is when a block is reached for the first time, whichever way that is.
use std::collections::BTreeMap;

use crate::program::OpIndex;

use super::circles::circles;
use super::subject::Unit;
use super::vacancy::{Locals, States, UNSET, steps};

/// The states of a program with the circles of its ways: what lies on no circle is reached once, so that only circles
/// are ever gone round again.
pub(super) struct First<'a> {
    unit: &'a Unit<'a>,
    states: &'a States,
    circle: Vec<usize>,
    /// For each circle the places outside that lead into it.
    entries: BTreeMap<usize, Vec<OpIndex>>,
}

impl<'a> First<'a> {
    pub(super) fn new(unit: &'a Unit<'a>, states: &'a States) -> Self {
        let circle = circles(&unit.flow);
        let mut entries: BTreeMap<usize, Vec<OpIndex>> = BTreeMap::new();
        for place in 0..unit.flow.places() {
            let left = unit.flow.after(place).filter(|to| circle[*to] != circle[place]);
            for to in left {
                entries.entry(circle[to]).or_default().push(place);
            }
        }
        Self { unit, states, circle, entries }
    }

    /// Whether a local is still unset when a block is reached for the first time: no way to the block that doesn't pass
    /// it sets the local.
    pub(super) fn is_unset(&self, block: OpIndex, local: u32) -> bool {
        let here = self.bits(block, local);
        here == UNSET || here & UNSET != 0 && self.is_unset_before(block, local)
    }

    /// Follows the local once more round the block's circle, with the block as an end.
    fn is_unset_before(&self, block: OpIndex, local: u32) -> bool {
        let circle = self.circle[block];
        let mut around =
            Around { circle: &self.circle, of: circle, known: BTreeMap::new(), open: Vec::new() };
        for start in self.unit.starts.iter().filter(|start| self.circle[**start] == circle) {
            around.join(*start, self.bits(*start, local));
        }
        for entry in self.entries.get(&circle).into_iter().flatten() {
            let Some(state) = &self.states[*entry] else { continue };
            self.lead(*entry, state, local, &mut around);
        }
        while let Some(at) = around.open.pop() {
            if at == block {
                if around.known[&at] != UNSET {
                    return false;
                }
                continue;
            }
            let Some(mut state) = self.states[at] else { continue };
            state.0[local as usize] = around.known[&at];
            self.lead(at, &state, local, &mut around);
        }
        around.known.get(&block) == Some(&UNSET)
    }

    fn lead(&self, from: OpIndex, state: &Locals, local: u32, around: &mut Around<'_>) {
        for (to, after) in steps(self.unit, from, state) {
            around.join(to, after.of(local));
        }
    }

    fn bits(&self, place: OpIndex, local: u32) -> u8 {
        self.states[place].map_or(0, |state| state.of(local))
    }
}

/// What the local may be at the places of one circle.
struct Around<'a> {
    circle: &'a [usize],
    of: usize,
    known: BTreeMap<OpIndex, u8>,
    /// Places where it has become known to be more.
    open: Vec<OpIndex>,
}

impl Around<'_> {
    fn join(&mut self, place: OpIndex, bits: u8) {
        if self.circle.get(place) != Some(&self.of) {
            return;
        }
        let known = self.known.entry(place).or_default();
        if *known | bits != *known {
            *known |= bits;
            self.open.push(place);
        }
    }
}
