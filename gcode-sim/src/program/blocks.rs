//! The blocks of a program, lowered when they are asked for and kept for a while: a loop lowers its blocks once, and a
//! long file never has all of its blocks lowered at a time.
use std::collections::BTreeMap;
use std::sync::Arc;

use super::loops::Loops;
use super::lower::{Lowering, lower_case};
use super::{AxisPlace, Code, Instruction, Op, OpIndex, OpKind, Operand, Statement};
use crate::alarm::Alarm;
use crate::source::SourceId;
use crate::syntax::{ast, block_at, sequence_number_at};

/// As many operations are kept. Loops are shorter; some megabytes at most.
const KEPT: usize = 8192;

/// The text that a program stands in.
#[derive(Clone, Debug)]
pub(super) struct Text {
    pub(super) source: SourceId,
    pub(super) bytes: Arc<[u8]>,
    /// How much of it is written on.
    pub(super) length: usize,
}

impl Text {
    pub(super) fn written(&self) -> &[u8] {
        &self.bytes[..self.length]
    }
}

/// Where a block begins, and where its operation is.
#[derive(Clone, Copy, Debug)]
pub(super) struct Entry {
    start: u32,
    /// The place of its operation, [`Entry::UNREAD`] where it isn't lowered.
    op: u32,
}

impl Entry {
    /// No operation has this place.
    const UNREAD: u32 = u32::MAX;

    pub(super) fn new(start: u32) -> Self {
        Self { start, op: Self::UNREAD }
    }
}

/// All blocks of a program, and the operations of some.
#[derive(Debug)]
pub(super) struct Blocks {
    text: Text,
    entries: Vec<Entry>,
    /// The trees of blocks that don't begin their line.
    apart: BTreeMap<u32, ast::Block>,
    /// The places of the blocks that are lowered, and their operations. Behind those stand others that are forgotten: their
    /// lists of words are filled again.
    places: Vec<u32>,
    ops: Vec<Op>,
    lowering: Lowering,
}

impl Blocks {
    pub(super) fn new(text: Text, entries: Vec<Entry>, apart: BTreeMap<u32, ast::Block>) -> Self {
        let (ops, places, lowering) = (Vec::new(), Vec::new(), Lowering::default());
        Self { text, entries, apart, ops, places, lowering }
    }

    /// The tree of a block, read anew.
    pub(super) fn tree(&self, place: OpIndex) -> Option<ast::Block> {
        let start = self.entries.get(place)?.start;
        match self.apart.get(&(place as u32)) {
            Some(block) => Some(block.clone()),
            None => block_at(self.text.source, self.text.written(), start),
        }
    }

    /// The sequence numbers with their blocks, by number, then by place.
    pub(super) fn sequence_numbers(&self) -> Vec<(u32, u32)> {
        let mut numbers = Vec::new();
        for (place, entry) in (0..).zip(&self.entries) {
            let number = match self.apart.get(&place) {
                Some(block) => block.number.map(|number| number.node),
                None => sequence_number_at(self.text.source, self.text.written(), entry.start),
            };
            numbers.extend(number.map(|number| (number, place)));
        }
        numbers.sort_unstable();
        numbers
    }

    /// The operation of a block, if it is lowered.
    pub(super) fn op(&self, place: OpIndex) -> Option<&Op> {
        self.op_at(self.entries.get(place)?.op)
    }

    /// An operation by the place that [`Blocks::ready`] tells.
    #[inline]
    pub(super) fn op_at(&self, place: u32) -> Option<&Op> {
        self.ops.get(place as usize)
    }

    /// All operations; to ask before all are lowered, in order, is a mistake of ours.
    pub(super) fn all(&self) -> &[Op] {
        debug_assert_eq!(self.places.len(), self.entries.len(), "all blocks are lowered");
        if self.places.len() == self.entries.len() { &self.ops[..self.places.len()] } else { &[] }
    }

    #[inline(always)]
    pub(super) fn code(&self, code: Code) -> &[Instruction] {
        &self.lowering.instructions[..code.end as usize][code.start as usize..]
    }

    pub(super) fn axis(&self, axis: AxisPlace) -> Operand {
        self.lowering.axes[axis.0 as usize]
    }

    pub(super) fn variable_name(&self, index: u32) -> &str {
        self.lowering.names.get(index as usize).map_or("", String::as_str)
    }

    /// The place of a block's operation, which is lowered where it isn't; `None` behind the last block. Where too many are,
    /// the others are forgotten.
    #[inline]
    pub(super) fn ready(&mut self, place: OpIndex, loops: &Loops) -> Option<u32> {
        let op = self.entries.get(place)?.op;
        if (op as usize) < self.ops.len() { Some(op) } else { self.make_ready(place, loops) }
    }

    #[inline(never)]
    fn make_ready(&mut self, place: OpIndex, loops: &Loops) -> Option<u32> {
        if self.places.len() >= KEPT {
            self.forget();
        }
        self.lower(place, loops)
    }

    /// Lowers all blocks, in order.
    pub(super) fn lower_all(&mut self, loops: &Loops) {
        self.forget();
        for place in 0..self.entries.len() {
            self.lower(place, loops);
        }
    }

    fn forget(&mut self) {
        for place in self.places.drain(..) {
            self.entries[place as usize].op = Entry::UNREAD;
        }
        self.lowering.forget();
    }

    fn lower(&mut self, place: OpIndex, loops: &Loops) -> Option<u32> {
        let entry = *self.entries.get(place)?;
        let at = self.places.len();
        if at == self.ops.len() {
            self.ops.push(Op::default());
        }
        let apart = self.apart.contains_key(&(place as u32));
        if apart || !self.ops[at].refill(self.text.source, self.text.written(), entry.start) {
            let tree = self.tree(place)?;
            let small = lower_case(&tree, &self.text.bytes);
            let mut op = self.lowering.block(&tree, small);
            join(&mut op, place, loops);
            self.ops[at] = op;
        }
        self.entries[place].op = at as u32;
        self.places.push(place as u32);
        Some(at as u32)
    }
}

/// Writes into a WHILE, DO or END where its partner stands. What has none becomes the alarm that a control raises when
/// it gets there.
fn join(op: &mut Op, place: OpIndex, loops: &Loops) {
    let OpKind::Statement(statement) = &mut op.kind else { return };
    let alarm = match statement {
        Statement::While { number, end, .. } | Statement::Do { number, end } => match loops.end_of(place) {
            Some(found) => {
                *end = found;
                return;
            }
            None => Alarm::MissingEnd { number: *number },
        },
        Statement::End { number, start } => match loops.begin_of(place) {
            Some(found) => {
                *start = found;
                return;
            }
            None => Alarm::MissingDo { number: *number },
        },
        _ => return,
    };
    op.kind = OpKind::Alarm(alarm.at(op.span));
}
