//! The blocks of a program, lowered when they are asked for and kept for a while: a loop lowers its blocks once, and a
//! long file never has all of its blocks lowered at a time.
use std::collections::BTreeMap;

use super::loops::Loops;
use super::lower::{Lowering, lower_case};
use super::{Code, Instruction, Op, OpIndex, OpKind, Statement};
use crate::alarm::Alarm;
use crate::source::SourceId;
use crate::syntax::{ast, block_at, plain_block_at};

/// As many operations are kept. Loops are shorter; some megabytes at most.
const KEPT: usize = 8192;

/// Where a block begins, and where its operation is.
#[derive(Clone, Copy, Debug)]
pub(super) struct Entry {
    start: u32,
    /// The place of its operation, [`Entry::UNREAD`] where it isn't lowered; [`Entry::PLAIN`] as the highest bit.
    op: u32,
}

impl Entry {
    /// It is alone in its line and can be read as [`plain_block_at`] does.
    const PLAIN: u32 = 1 << 31;
    const UNREAD: u32 = !Self::PLAIN;

    pub(super) fn new(start: u32, plain: bool) -> Self {
        Self { start, op: Self::UNREAD | if plain { Self::PLAIN } else { 0 } }
    }

    fn is_plain(self) -> bool {
        self.op & Self::PLAIN != 0
    }

    /// The place of its operation; that of none where it isn't lowered.
    fn op(self) -> usize {
        (self.op & Self::UNREAD) as usize
    }

    fn set_op(&mut self, op: u32) {
        self.op = self.op & Self::PLAIN | op;
    }
}

/// All blocks of a program, and the operations of some.
#[derive(Debug)]
pub(super) struct Blocks {
    entries: Vec<Entry>,
    /// The trees of blocks that don't begin their line.
    apart: BTreeMap<u32, ast::Block>,
    /// How much of the text is written on.
    length: u32,
    /// Operations with the places of their blocks.
    ops: Vec<Op>,
    places: Vec<u32>,
    /// The tree of the block that was lowered last.
    tree: ast::Block,
    lowering: Lowering,
}

impl Blocks {
    pub(super) fn new(entries: Vec<Entry>, apart: BTreeMap<u32, ast::Block>, length: u32) -> Self {
        let (ops, places, tree) = (Vec::new(), Vec::new(), ast::Block::default());
        Self { entries, apart, length, ops, places, tree, lowering: Lowering::default() }
    }

    /// The tree of a block, read anew.
    pub(super) fn tree(&self, place: OpIndex, source: SourceId, bytes: &[u8]) -> Option<ast::Block> {
        let start = self.entries.get(place)?.start;
        if !self.apart.is_empty()
            && let Some(block) = self.apart.get(&(place as u32))
        {
            return Some(block.clone());
        }
        block_at(source, bytes.get(..self.length as usize)?, start)
    }

    #[inline]
    pub(super) fn is_ready(&self, place: OpIndex) -> bool {
        self.entries.get(place).is_some_and(|entry| entry.op() < self.ops.len())
    }

    #[inline]
    pub(super) fn op(&self, place: OpIndex) -> Option<&Op> {
        self.ops.get(self.entries.get(place)?.op())
    }

    /// All operations; to ask before all are lowered, in order, is a mistake of ours.
    pub(super) fn all(&self) -> &[Op] {
        debug_assert_eq!(self.ops.len(), self.entries.len(), "all blocks are lowered");
        if self.ops.len() == self.entries.len() { &self.ops } else { &[] }
    }

    #[inline]
    pub(super) fn code(&self, code: Code) -> &[Instruction] {
        &self.lowering.instructions[code.start as usize..code.end as usize]
    }

    pub(super) fn variable_name(&self, index: u32) -> &str {
        self.lowering.names.get(index as usize).map_or("", String::as_str)
    }

    /// Lowers a block that isn't. Where too many are, the others are forgotten.
    pub(super) fn ready(&mut self, place: OpIndex, source: SourceId, bytes: &[u8], loops: &Loops) {
        if self.ops.len() >= KEPT {
            self.forget();
        }
        self.lower(place, source, bytes, loops);
    }

    /// Lowers all blocks, in order.
    pub(super) fn lower_all(&mut self, source: SourceId, bytes: &[u8], loops: &Loops) {
        self.forget();
        for place in 0..self.entries.len() {
            self.lower(place, source, bytes, loops);
        }
    }

    fn forget(&mut self) {
        for place in self.places.drain(..) {
            self.entries[place as usize].set_op(Entry::UNREAD);
        }
        for op in self.ops.drain(..) {
            self.lowering.give_up(op);
        }
        self.lowering.forget();
    }

    fn lower(&mut self, place: OpIndex, source: SourceId, bytes: &[u8], loops: &Loops) {
        let Some(entry) = self.entries.get(place) else { return };
        let plain = entry.is_plain();
        if plain {
            plain_block_at(source, &bytes[..self.length as usize], entry.start, &mut self.tree);
        } else {
            let Some(tree) = self.tree(place, source, bytes) else { return };
            self.tree = tree;
        }
        let small = if plain { None } else { lower_case(&self.tree, bytes) };
        let mut op = self.lowering.block(&self.tree, small);
        join(&mut op, place, loops);
        self.entries[place].set_op(self.ops.len() as u32);
        self.places.push(place as u32);
        self.ops.push(op);
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
