//! Values that wait for their operators.
use std::cell::Cell;

use super::variables::Value;
use gcode_lang::program::STACK;

/// The values that wait for their operators, in as many places as [`gcode_lang::program`] lets an expression need. They
/// are part of the control, so that an evaluation has none to clear. Going round in them saves the question at every
/// step whether there is a place, and what an alarm has left behind.
#[derive(Clone, Debug)]
pub(super) struct OperandStack {
    pub(super) values: [Cell<Value>; STACK],
    depth: Cell<usize>,
}

impl Default for OperandStack {
    fn default() -> Self {
        Self { values: [const { Cell::new(Value::Vacant) }; STACK], depth: Cell::new(0) }
    }
}

impl OperandStack {
    pub(super) fn push(&self, value: Value) {
        let used = self.depth.get();
        self.values[used % STACK].set(value);
        self.depth.set(used.wrapping_add(1));
    }

    #[inline]
    pub(super) fn pop(&self) -> Value {
        let used = self.depth.get().wrapping_sub(1);
        self.depth.set(used);
        self.values[used % STACK].get()
    }
}
