//! Facts about a program known once its file is loaded: the spans of its blocks, first sequence number and loops.
use std::collections::BTreeMap;
use std::sync::OnceLock;

use super::block_texts::ProgramText;
use super::blocks::Blocks;
use super::loops::{LoopRole, Loops};
use super::lowering::Lowering;
use super::{OpIndex, OpKind, Program, Statement};
use crate::source::{Bytes, SourceId, Span};
use crate::syntax::ast;
use crate::syntax::{
    BlockOutline, KnownBlocks, ProgramParts, end_without_spaces, outline, sequence_number_at, without_trailer,
};

#[derive(Default)]
struct OutlineBuilder {
    blocks: u32,
    /// End of the last block, with or without trailing spaces.
    end: u32,
    first_number: Option<u32>,
    loops: Vec<(OpIndex, LoopRole, u8)>,
    separate_trees: BTreeMap<u32, ast::Block>,
}

/// Returns the programs of a file, with their blocks located but not lowered. Known blocks are not read again.
pub(super) fn programs(source: SourceId, bytes: &Bytes, known: &KnownBlocks) -> Vec<Program> {
    let text = ProgramText { source, bytes: bytes.clone(), length: without_trailer(bytes).len() };
    let programs =
        outline(source, bytes, known, |growing: &mut OutlineBuilder, block| growing.block(block, &text));
    programs.into_iter().map(|parts| finish(parts, text.clone())).collect()
}

impl OutlineBuilder {
    #[inline(always)]
    fn block(&mut self, block: BlockOutline<'_>, text: &ProgramText) -> u32 {
        let span = block.span();
        if !matches!(block, BlockOutline::Words(_)) || self.first_number.is_none() {
            self.record_block(block, text);
        }
        self.blocks += 1;
        self.end = span.end;
        span.start
    }

    /// Records the loops, the sequence number and the separate tree of a block.
    #[inline(never)]
    fn record_block(&mut self, block: BlockOutline<'_>, text: &ProgramText) {
        let index = self.blocks;
        match block {
            BlockOutline::Words(span) => {
                self.record_number(sequence_number_at(text.source, text.content(), span.start));
            }
            BlockOutline::Tree(block) => self.record_tree(index, block),
            BlockOutline::WithinLine(block) => {
                self.record_tree(index, &block);
                self.separate_trees.insert(index, *block);
            }
        }
    }

    fn record_number(&mut self, number: Option<u32>) {
        self.first_number = self.first_number.or(number.filter(|number| *number > 0));
    }

    /// Records a block that had to be read.
    fn record_tree(&mut self, index: u32, block: &ast::Block) {
        self.record_number(block.number.map(|number| number.node));
        if !block.items.iter().any(is_loop_item) {
            return;
        }
        let part = match Lowering::default().lower_block(block, None).kind() {
            OpKind::Statement(Statement::While { number, .. } | Statement::Do { number, .. }) => {
                Some((LoopRole::Begin, *number))
            }
            OpKind::Statement(Statement::End { number, .. }) => Some((LoopRole::End, *number)),
            OpKind::Alarm(_) => mixed_end(block).map(|number| (LoopRole::MixedEnd, number)),
            _ => None,
        };
        self.loops.extend(part.map(|(part, number)| (index as OpIndex, part, number)));
    }
}

/// Returns true for WHILE, DO and END.
fn is_loop_item(item: &ast::Item) -> bool {
    use ast::Statement::{Do, End, While};
    matches!(item, ast::Item::Statement(found) if matches!(found.node, While { .. } | Do(_) | End(_)))
}

/// Returns the number of an END beside words.
fn mixed_end(block: &ast::Block) -> Option<u8> {
    let has_words = block.items.iter().any(|item| matches!(item, ast::Item::Word(_)));
    block.items.iter().filter(|_| has_words).find_map(|item| match item {
        ast::Item::Statement(found) => match &found.node {
            ast::Statement::End(number) => u8::try_from(number.node).ok(),
            _ => None,
        },
        _ => None,
    })
}

fn finish(
    ProgramParts { name, folder, span, context, blocks, is_closed: closed }: ProgramParts<
        OutlineBuilder,
        u32,
    >,
    text: ProgramText,
) -> Program {
    let OutlineBuilder { end, first_number, loops, separate_trees: apart, .. } = context;
    let end = end_without_spaces(text.content(), end);
    Program {
        label: name.label(),
        name,
        folder,
        first_number,
        span: Span { end: end.max(span.end), ..span },
        blocks: Blocks::new(text, blocks, apart),
        numbers: OnceLock::new(),
        loops: Loops::pair(&loops),
        is_closed: closed,
    }
}
