//! The blocks of a program, lowered when they are asked for and kept for a while: a loop lowers its blocks once, and a
//! long file never has all of its blocks lowered at a time.
use std::collections::BTreeMap;

use super::loops::Loops;
use super::lowering::{Lowering, lower_case};
use super::{Op, OpBody, OpIndex, OpKind, Statement};
use crate::alarm::Alarm;
use crate::source::{Bytes, SourceId};
use crate::syntax::{ast, block_at, sequence_number_at};

/// As many operations are kept. Loops are shorter; some megabytes at most.
const KEPT_OPERATIONS: usize = 8192;

/// The text that a program stands in.
#[derive(Clone, Debug)]
pub(super) struct ProgramText {
    pub(super) source: SourceId,
    pub(super) bytes: Bytes,
    /// How much of it is written on.
    pub(super) length: usize,
}

impl ProgramText {
    pub(super) fn content(&self) -> &[u8] {
        &self.bytes[..self.length]
    }
}

/// All blocks of a program, and the operations of some.
#[derive(Debug)]
pub(super) struct Blocks {
    text: ProgramText,
    /// Where each block begins.
    starts: Vec<u32>,
    /// The trees of blocks that don't begin their line.
    separate_trees: BTreeMap<u32, ast::Block>,
    /// Operations. A block has one place for its own, which it shares with those a multiple of [`KEPT`] away: the list of
    /// words of the one that was there is filled again.
    ops: Vec<Op>,
    /// A block's place for its operation is its own within these bits: all of them where every block is kept.
    index_mask: usize,
    lowering: Lowering,
}

impl Blocks {
    pub(super) fn new(text: ProgramText, starts: Vec<u32>, apart: BTreeMap<u32, ast::Block>) -> Self {
        Self {
            text,
            starts,
            separate_trees: apart,
            ops: Vec::new(),
            index_mask: KEPT_OPERATIONS - 1,
            lowering: Lowering::default(),
        }
    }

    /// The tree of a block, read anew.
    pub(super) fn tree(&self, index: OpIndex) -> Option<ast::Block> {
        let start = *self.starts.get(index)?;
        match self.separate_trees.get(&(index as u32)) {
            Some(block) => Some(block.clone()),
            None => block_at(self.text.source, self.text.content(), start),
        }
    }

    /// The sequence numbers with their blocks, by number, then by place.
    pub(super) fn sequence_numbers(&self) -> Vec<(u32, u32)> {
        let mut numbers = Vec::new();
        for (index, start) in (0..).zip(&self.starts) {
            let number = match self.separate_trees.get(&index) {
                Some(block) => block.number.map(|number| number.node),
                None => sequence_number_at(self.text.source, self.text.content(), *start),
            };
            numbers.extend(number.map(|number| (number, index)));
        }
        numbers.sort_unstable();
        numbers
    }

    /// The operation of a block, if it is lowered.
    #[inline(always)]
    pub(super) fn op(&self, index: OpIndex) -> Option<&Op> {
        self.ops.get(index & self.index_mask).filter(|op| op.ordinal as usize == index + 1)
    }

    /// All operations; to ask before all are lowered, in order, is a mistake of ours.
    pub(super) fn lowered_ops(&self) -> &[Op] {
        debug_assert_eq!(self.index_mask, usize::MAX, "all blocks are lowered");
        if self.index_mask == usize::MAX { &self.ops } else { &[] }
    }

    /// Lowers a block in the place of another; `None` behind the last block.
    #[inline(never)]
    pub(super) fn lower(&mut self, place: OpIndex, loops: &Loops) -> Option<()> {
        let start = *self.starts.get(place)?;
        let at = place & self.index_mask;
        if at >= self.ops.len() {
            self.ops.resize_with(at + 1, Op::default);
        }
        let apart = self.separate_trees.contains_key(&(place as u32));
        if apart || !self.ops[at].refill(self.text.source, self.text.content(), start) {
            let op = self.lower_tree(place, loops)?;
            self.ops[at] = op;
        }
        self.ops[at].ordinal = place as u32 + 1;
        Some(())
    }

    /// Lowers all blocks, in order.
    pub(super) fn lower_all(&mut self, loops: &Loops) {
        self.ops.clear();
        self.index_mask = usize::MAX;
        for index in 0..self.starts.len() {
            self.lower(index, loops);
        }
    }

    /// Lowers a block that is more than numbers.
    #[inline(never)]
    fn lower_tree(&mut self, index: OpIndex, loops: &Loops) -> Option<Op> {
        let tree = self.tree(index)?;
        let small = lower_case(&tree, &self.text.bytes);
        let mut op = self.lowering.lower_block(&tree, small);
        link_loop(&mut op, index, loops);
        Some(op)
    }
}

/// Writes into a WHILE, DO or END where its partner stands. What has none becomes the alarm that a control raises when
/// it gets there.
fn link_loop(op: &mut Op, place: OpIndex, loops: &Loops) {
    let kind = match &mut op.body {
        OpBody::Plain(kind) => kind,
        OpBody::Guarded(asked) => &mut asked.kind,
    };
    let OpKind::Statement(statement) = kind else { return };
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
    *kind = OpKind::Alarm(alarm.located_at(op.span));
}

#[cfg(test)]
mod tests {
    use super::super::{Assign, Memory, OperandSource, Operation};
    use super::*;

    /// Every third block is an assignment with code of its own.
    fn line(place: usize) -> String {
        if place.is_multiple_of(3) { format!("#1={place}+#2") } else { format!("N{place} X{place}.") }
    }

    #[test]
    fn a_block_is_itself_whatever_was_asked_for_before() {
        const LINES: usize = 3 * KEPT_OPERATIONS + 5;
        let text: Vec<String> = (0..LINES).map(line).collect();
        let mut memory = Memory::default();
        memory.load("O1.nc", format!("O1\n{}", text.join("\n")).into_bytes());
        let id = memory.ids().next().unwrap();
        let near = (0..2 * KEPT_OPERATIONS).map(|step| step * KEPT_OPERATIONS % (LINES - 3));
        for place in (0..LINES).chain((0..2 * LINES).map(|step| step * 7919 % LINES)).chain(near) {
            let op = memory.lower_block(id, place).unwrap();
            let span = op.span;
            if let OpKind::AssignFree(Assign { code, .. }) = op.kind() {
                let wanted = Operation::Add([OperandSource::Number(place as f64), OperandSource::Free(2)]);
                assert_eq!(code[0].operation, wanted);
            } else {
                assert_eq!(op.number, Some(place as u32));
            }
            assert_eq!(memory.sources().text(span), line(place));
            assert_eq!(memory.get(id).op(place).map(|op| op.span), Some(span));
        }
        assert!(memory.lower_block(id, LINES).is_none());
        assert_eq!(memory.lower_program(id).ops().len(), LINES);
        assert_eq!(
            memory.lower_block(id, 2 * KEPT_OPERATIONS).unwrap().number,
            Some(2 * KEPT_OPERATIONS as u32)
        );
    }

    #[test]
    fn a_block_that_another_took_the_place_of_is_not_there() {
        let mut memory = Memory::default();
        memory.load("O1.nc", format!("O1\n{}", "X1.\n".repeat(KEPT_OPERATIONS + 1)).into_bytes());
        let id = memory.ids().next().unwrap();
        assert!(memory.lower_block(id, 0).is_some() && memory.get(id).op(0).is_some());
        assert!(memory.lower_block(id, KEPT_OPERATIONS).is_some() && memory.get(id).op(0).is_none());
    }
}
