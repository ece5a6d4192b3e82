//! What is known of a program when its file is loaded: where its blocks begin, its first sequence number, its loops.
use std::collections::BTreeMap;
use std::sync::OnceLock;

use super::blocks::{Blocks, Text};
use super::loops::{LoopRole, Loops};
use super::lower::Lowering;
use super::{OpIndex, OpKind, Program, Statement};
use crate::source::{Bytes, SourceId, Span};
use crate::syntax::ast::{self, ProgramName};
use crate::syntax::{Outlined, Parts, end_without_spaces, outline, sequence_number_at, written};

/// What grows while a program is outlined.
#[derive(Default)]
struct OutlineBuilder {
    blocks: u32,
    /// Where the last block ends, perhaps with spaces behind it.
    end: u32,
    first_number: Option<u32>,
    loops: Vec<(OpIndex, LoopRole, u8)>,
    apart: BTreeMap<u32, ast::Block>,
}

/// Outlines the programs of a file.
pub(super) fn programs(source: SourceId, bytes: &Bytes) -> Vec<Program> {
    let text = Text { source, bytes: bytes.clone(), length: written(bytes).len() };
    let programs = outline(source, bytes, |growing: &mut OutlineBuilder, block| growing.block(block, &text));
    programs.into_iter().map(|parts| finish(parts, text.clone())).collect()
}

impl OutlineBuilder {
    /// Notes a block.
    #[inline(always)]
    fn block(&mut self, block: Outlined, text: &Text) -> u32 {
        let span = block.span();
        if !matches!(block, Outlined::Words(_)) || self.first_number.is_none() {
            self.look_into(block, text);
        }
        self.blocks += 1;
        self.end = span.end;
        span.start
    }

    /// Notes what is in a block besides words.
    #[inline(never)]
    fn look_into(&mut self, block: Outlined, text: &Text) {
        let place = self.blocks;
        match block {
            Outlined::Words(span) => {
                self.number(sequence_number_at(text.source, text.written(), span.start));
            }
            Outlined::Read(block) => self.read(place, &block),
            Outlined::Apart(block) => {
                self.read(place, &block);
                self.apart.insert(place, *block);
            }
        }
    }

    /// Notes the sequence number of a block.
    fn number(&mut self, number: Option<u32>) {
        self.first_number = self.first_number.or(number.filter(|number| *number > 0));
    }

    /// Notes a block that had to be read.
    fn read(&mut self, place: u32, block: &ast::Block) {
        self.number(block.number.map(|number| number.node));
        if !block.items.iter().any(is_of_loop) {
            return;
        }
        let part = match Lowering::default().block(block, None).kind() {
            OpKind::Statement(Statement::While { number, .. } | Statement::Do { number, .. }) => {
                Some((LoopRole::Begin, *number))
            }
            OpKind::Statement(Statement::End { number, .. }) => Some((LoopRole::End, *number)),
            _ => None,
        };
        self.loops.extend(part.map(|(part, number)| (place as OpIndex, part, number)));
    }
}

/// WHILE, DO or END.
fn is_of_loop(item: &ast::Item) -> bool {
    use ast::Statement::{Do, End, While};
    matches!(item, ast::Item::Statement(found) if matches!(found.node, While { .. } | Do(_) | End(_)))
}

fn finish(Parts { name, span, context, blocks, closed }: Parts<OutlineBuilder, u32>, text: Text) -> Program {
    let OutlineBuilder { end, first_number, loops, apart, .. } = context;
    let end = end_without_spaces(text.written(), end);
    let number = match name {
        ProgramName::Number(number) => Some(number),
        ProgramName::Name(_) => None,
        ProgramName::Unnamed => first_number,
    };
    Program {
        name,
        number,
        first_number,
        span: Span { end: end.max(span.end), ..span },
        blocks: Blocks::new(text, blocks, apart),
        numbers: OnceLock::new(),
        loops: Loops::pair(&loops),
        closed,
    }
}
