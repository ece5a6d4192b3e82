//! What is known of a program when its file is loaded: where its blocks begin, its sequence numbers, its loops.
use std::collections::BTreeMap;

use super::blocks::{Blocks, Entry};
use super::loops::{Loops, Part};
use super::lower::Lowering;
use super::{OpIndex, OpKind, Program, Statement};
use crate::source::{SourceId, Span};
use crate::syntax::ast::{self, ProgramName};
use crate::syntax::{Outlined, Parts, outline, written};

/// What grows while a program is outlined.
#[derive(Default)]
struct Growing {
    blocks: u32,
    /// Where the last block ends.
    end: u32,
    numbers: Vec<(u32, u32)>,
    first_number: Option<u32>,
    loops: Vec<(OpIndex, Part, u8)>,
    apart: BTreeMap<u32, ast::Block>,
}

/// Outlines the programs of a file.
pub(super) fn programs(source: SourceId, bytes: &[u8]) -> Vec<Program> {
    let length = written(bytes).len() as u32;
    let programs = outline(source, bytes, Growing::block);
    programs.into_iter().map(|parts| finish(parts, length)).collect()
}

impl Growing {
    /// Notes a block.
    fn block(&mut self, block: Outlined) -> Entry {
        let place = self.blocks;
        self.blocks += 1;
        self.end = block.span().end;
        if let Some(number) = block.number() {
            self.numbers.push((number, place));
            self.first_number = self.first_number.or(Some(number).filter(|number| *number > 0));
        }
        let entry = Entry::new(block.span().start, matches!(block, Outlined::Words { plain: true, .. }));
        if let Outlined::Read(block) | Outlined::Apart(block) = &block {
            let part = match Lowering::default().block(block, None).kind {
                OpKind::Statement(Statement::While { number, .. } | Statement::Do { number, .. }) => {
                    Some((Part::Begin, number))
                }
                OpKind::Statement(Statement::End { number, .. }) => Some((Part::End, number)),
                _ => None,
            };
            self.loops.extend(part.map(|(part, number)| (place as OpIndex, part, number)));
        }
        if let Outlined::Apart(block) = block {
            self.apart.insert(place, *block);
        }
        entry
    }
}

fn finish(Parts { name, span, context, blocks, closed }: Parts<Growing, Entry>, length: u32) -> Program {
    let Growing { end, mut numbers, first_number, loops, apart, .. } = context;
    let number = match name {
        ProgramName::Number(number) => Some(number),
        ProgramName::Name(_) => None,
        ProgramName::Unnamed => first_number,
    };
    numbers.sort_unstable();
    numbers.shrink_to_fit();
    Program {
        name,
        number,
        first_number,
        span: Span { end: end.max(span.end), ..span },
        blocks: Blocks::new(blocks, apart, length),
        numbers,
        loops: Loops::pair(&loops),
        closed,
    }
}
