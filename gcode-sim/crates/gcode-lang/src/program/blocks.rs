//! Blocks of a program, lowered on demand and kept for a while.
//!
//! A loop lowers its blocks once, and a long file never has all of its blocks lowered at the same time.
use std::collections::BTreeMap;
use std::ops::Range;

use super::block_texts::{BlockTexts, ProgramText};
use super::loops::Loops;
use super::lowering::{Lowering, lower_case};
use super::numbers::NumberBlock;
use super::{Op, OpBody, OpIndex, OpKind, Statement};
use crate::alarm::Alarm;
use crate::shares::{share_length, work_on};
use crate::syntax::{KnownBlocks, ast, sequence_number_at};

/// Number of operations kept. Most loops are shorter; the operations take a few megabytes at most.
const KEPT_OPERATIONS: usize = 8192;

/// Blocks of a program, and the operations of some.
#[derive(Debug)]
pub(super) struct Blocks {
    texts: BlockTexts,
    /// Operations by slot.
    ///
    /// A block's slot is its index modulo the number of slots; blocks with the same slot replace one another,
    /// and the list of words is reused.
    ops: Vec<Op>,
    /// Bit mask from block index to slot; all ones if every block is kept.
    index_mask: usize,
    lowering: Lowering,
}

impl Blocks {
    pub(super) fn new(text: ProgramText, starts: Vec<u32>, apart: BTreeMap<u32, ast::Block>) -> Self {
        Self {
            texts: BlockTexts::new(text, starts, apart),
            ops: Vec::new(),
            index_mask: KEPT_OPERATIONS - 1,
            lowering: Lowering::default(),
        }
    }

    /// Returns the texts of the blocks.
    pub(super) fn texts(&self) -> &BlockTexts {
        &self.texts
    }

    /// Returns the tree of a block, read again from the text.
    pub(super) fn tree(&self, index: OpIndex) -> Option<ast::Block> {
        self.texts.tree(index)
    }

    /// Returns the sequence numbers with their blocks, sorted.
    pub(super) fn sequence_numbers(&self) -> Vec<(u32, u32)> {
        let mut numbers = Vec::new();
        for (index, start) in (0..).zip(self.texts.starts.iter()) {
            let number = match self.texts.separate_trees.get(&index) {
                Some(block) => block.number.map(|number| number.node),
                None => sequence_number_at(self.texts.text.source, self.texts.text.content(), *start),
            };
            numbers.extend(number.map(|number| (number, index)));
        }
        numbers.sort_unstable();
        numbers
    }

    /// Returns the number of blocks.
    pub(super) fn len(&self) -> usize {
        self.texts.starts.len()
    }

    /// Calls `each` with every block in order, read if it consists of numbers, and one comment at most.
    pub(super) fn visit_numbers(&self, mut each: impl FnMut(OpIndex, Option<NumberBlock<'_>>)) {
        let mut list = Vec::new();
        let text = &self.texts.text;
        for (index, start) in self.texts.starts.iter().enumerate() {
            let is_separate = self.texts.separate_trees.contains_key(&(index as u32));
            let block = match is_separate {
                true => None,
                false => NumberBlock::read(&mut list, text.source, text.content(), *start),
            };
            each(index, block);
        }
    }

    /// Returns the blocks whose new index is not that of the next one.
    pub(super) fn renumbered(&self, new_index: &[u32]) -> Self {
        let is_kept = |index: usize| new_index[index] != new_index[index + 1];
        let kept = self.texts.starts.iter().enumerate().filter(|(index, _)| is_kept(*index));
        let trees =
            self.texts.separate_trees.iter().map(|(index, tree)| (new_index[*index as usize], tree.clone()));
        Self::new(self.texts.text.clone(), kept.map(|(_, start)| *start).collect(), trees.collect())
    }

    /// Returns some consecutive blocks.
    pub(super) fn part(&self, blocks: Range<OpIndex>) -> Self {
        let is_in = |index: u32| blocks.contains(&(index as OpIndex));
        let trees = self.texts.separate_trees.iter().filter(|(index, _)| is_in(**index));
        let trees = trees.map(|(index, tree)| (index - blocks.start as u32, tree.clone())).collect();
        Self::new(self.texts.text.clone(), self.texts.starts[blocks.clone()].to_vec(), trees)
    }

    /// Returns the operation of a block if it is lowered.
    #[inline(always)]
    pub(super) fn op(&self, index: OpIndex) -> Option<&Op> {
        self.ops.get(index & self.index_mask).filter(|op| op.ordinal as usize == index + 1)
    }

    /// Takes the operation of a lowered block, which is then no longer lowered.
    pub(super) fn take(&mut self, index: OpIndex) -> Option<OpKind> {
        let slot = self.ops.get_mut(index & self.index_mask)?;
        Some(match std::mem::take(slot).body {
            OpBody::Plain(kind) => kind,
            OpBody::Guarded(guarded) => guarded.kind,
        })
    }

    /// Returns all operations.
    ///
    /// Requires a preceding [`Blocks::lower_all`]; the slice is empty otherwise.
    pub(super) fn lowered_ops(&self) -> &[Op] {
        debug_assert_eq!(self.index_mask, usize::MAX, "all blocks are lowered");
        if self.index_mask == usize::MAX { &self.ops } else { &[] }
    }

    /// Lowers a block into its slot; `None` after the last block.
    #[inline(never)]
    pub(super) fn lower(&mut self, index: OpIndex, loops: &Loops) -> Option<()> {
        let start = *self.texts.starts.get(index)?;
        let at = index & self.index_mask;
        if at >= self.ops.len() {
            self.ops.resize_with(at + 1, Op::default);
        }
        let apart = self.texts.separate_trees.contains_key(&(index as u32));
        if apart || !self.ops[at].refill(self.texts.text.source, self.texts.text.content(), start) {
            let op = self.lower_tree(index, loops)?;
            self.ops[at] = op;
        }
        self.ops[at].ordinal = index as u32 + 1;
        Some(())
    }

    pub(super) fn lower_all(&mut self, loops: &Loops) {
        self.ops.clear();
        self.index_mask = usize::MAX;
        for index in 0..self.texts.starts.len() {
            self.lower(index, loops);
        }
    }

    /// Lowers all blocks and returns their trees. A block that is not known is read once.
    ///
    /// Blocks are lowered one apart from another, so that several threads share a long program.
    pub(super) fn lower_with_trees(&mut self, loops: &Loops, known: &mut KnownBlocks) -> Vec<ast::Block> {
        self.index_mask = usize::MAX;
        self.ops.clear();
        self.ops.resize_with(self.len(), Op::default);
        let texts = &self.texts;
        let take = |index: OpIndex| {
            let is_separate = texts.separate_trees.contains_key(&(index as u32));
            if is_separate { None } else { known.take(texts.start(index)) }
        };
        let mut trees: Vec<Option<ast::Block>> = (0..texts.count()).map(take).collect();
        let share = share_length(trees.len());
        let shares = trees.chunks_mut(share).zip(self.ops.chunks_mut(share));
        work_on((0..).step_by(share).zip(shares), |(first, (trees, ops))| {
            let mut lowering = Lowering::default();
            for (index, (tree, op)) in (first..).zip(trees.iter_mut().zip(ops)) {
                if tree.is_none() {
                    *tree = texts.tree(index);
                }
                let Some(tree) = tree else { break };
                lower_into(op, (index, tree), (texts, loops), &mut lowering);
            }
        });
        trees.into_iter().map(Option::unwrap_or_default).collect()
    }

    /// Lowers a block that has more than numbers.
    #[inline(never)]
    fn lower_tree(&mut self, index: OpIndex, loops: &Loops) -> Option<Op> {
        let tree = self.tree(index)?;
        let small = lower_case(&tree, &self.texts.text.bytes);
        let mut op = self.lowering.lower_block(&tree, small);
        link_loop(&mut op, index, loops);
        Some(op)
    }
}

/// Lowers a block into its slot.
fn lower_into(
    op: &mut Op,
    (index, tree): (OpIndex, &ast::Block),
    (texts, loops): (&BlockTexts, &Loops),
    lowering: &mut Lowering,
) {
    let is_separate = texts.separate_trees.contains_key(&(index as u32));
    if is_separate || !op.refill(texts.text.source, texts.text.content(), texts.start(index)) {
        let small = lower_case(tree, &texts.text.bytes);
        *op = lowering.lower_block(tree, small);
        link_loop(op, index, loops);
    }
    op.ordinal = index as u32 + 1;
}

/// Links a WHILE, DO or END with its partner.
///
/// Without a partner the operation becomes the alarm that a control raises when it reaches it.
fn link_loop(op: &mut Op, index: OpIndex, loops: &Loops) {
    let kind = match &mut op.body {
        OpBody::Plain(kind) => kind,
        OpBody::Guarded(asked) => &mut asked.kind,
    };
    let OpKind::Statement(statement) = kind else { return };
    let (partner, found, alarm) = match statement {
        Statement::While { number, end, .. } | Statement::Do { number, end } => {
            (end, loops.end_of(index), Alarm::MissingEnd { number: *number })
        }
        Statement::End { number, start } => {
            (start, loops.begin_of(index), Alarm::MissingDo { number: *number })
        }
        _ => return,
    };
    match found {
        Some(found) => *partner = found,
        None => *kind = OpKind::Alarm(alarm.located_at(op.span)),
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Assign, Memory, OperandSource, Operation};
    use super::*;

    /// Returns the text of a block; every third one is an assignment with its own code.
    fn line(index: usize) -> String {
        if index.is_multiple_of(3) { format!("#1={index}+#2") } else { format!("N{index} X{index}.") }
    }

    #[test]
    fn a_block_is_lowered_correctly_in_any_order() {
        const LINES: usize = 3 * KEPT_OPERATIONS + 5;
        let text: Vec<String> = (0..LINES).map(line).collect();
        let mut memory = Memory::default();
        memory.load("O1.nc", format!("O1\n{}", text.join("\n")).into_bytes());
        let id = memory.ids().next().unwrap();
        let near = (0..2 * KEPT_OPERATIONS).map(|step| step * KEPT_OPERATIONS % (LINES - 3));
        for index in (0..LINES).chain((0..2 * LINES).map(|step| step * 7919 % LINES)).chain(near) {
            let op = memory.lower_block(id, index).unwrap();
            let span = op.span;
            if let OpKind::AssignDirect(Assign { code, .. }) = op.kind() {
                let expected = Operation::Add([OperandSource::Number(index as f64), OperandSource::Free(2)]);
                assert_eq!(code[0].operation, expected);
            } else {
                assert_eq!(op.number, Some(index as u32));
            }
            assert_eq!(memory.sources().text(span), line(index));
            assert_eq!(memory.get(id).op(index).map(|op| op.span), Some(span));
        }
        assert!(memory.lower_block(id, LINES).is_none());
        assert_eq!(memory.lower_program(id).ops().len(), LINES);
        assert_eq!(
            memory.lower_block(id, 2 * KEPT_OPERATIONS).unwrap().number,
            Some(2 * KEPT_OPERATIONS as u32)
        );
    }

    #[test]
    fn a_replaced_block_is_not_lowered() {
        let mut memory = Memory::default();
        memory.load("O1.nc", format!("O1\n{}", "X1.\n".repeat(KEPT_OPERATIONS + 1)).into_bytes());
        let id = memory.ids().next().unwrap();
        assert!(memory.lower_block(id, 0).is_some() && memory.get(id).op(0).is_some());
        assert!(memory.lower_block(id, KEPT_OPERATIONS).is_some() && memory.get(id).op(0).is_none());
    }
}
