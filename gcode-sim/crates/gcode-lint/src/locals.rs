//! Possible states of the locals, as sets of possibilities.

/// Possible values of a local, as bits.
pub(crate) const UNSET: u8 = 1;
pub(crate) const VACANT: u8 = 2;
pub(crate) const NUMBER: u8 = 4;
pub(crate) const ANY_VALUE: u8 = VACANT | NUMBER;

/// States of the locals #1 to #33; element 0 is unused.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Locals(pub [u8; 34]);

impl Locals {
    pub(crate) const UNSET: Self = Self([UNSET; 34]);
    pub(crate) const ANYTHING: Self = Self([ANY_VALUE; 34]);

    pub(super) fn bits_of(&self, number: u32) -> u8 {
        match number {
            // [#_EMPTY] is #3100.
            0 | 3100 => VACANT,
            1..=33 => self.0[number as usize],
            _ => ANY_VALUE,
        }
    }

    pub(super) fn join(&mut self, other: Self) {
        self.0.iter_mut().zip(other.0).for_each(|(mine, others)| *mine |= others);
    }

    pub(super) fn add_bits(&mut self, bits: u8) {
        self.0.iter_mut().for_each(|local| *local |= bits);
    }
}

/// State at each node of the control flow graph; `None` if the node is unreachable.
pub(crate) type States = Vec<Option<Locals>>;
