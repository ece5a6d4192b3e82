//! Outline of a file: the places of its blocks, and single blocks read from there during execution.
//!
//! Most lines of a long file are one block of words, which is recognised without reading them. The other
//! lines are read, so an outline has the same programs and blocks as the tree.
use super::ast::Block;
use super::file::{ProgramParts, Programs};
use super::file_items::{FileItem, FileItems, is_unreadable_block};
use super::numbers::NumberWords;
use crate::source::{SourceId, Span};

#[derive(Debug)]
pub(crate) enum BlockOutline {
    /// Block that is not read; it is neither DO nor END. The span includes trailing spaces.
    Words(Span),
    /// Block that begins its line.
    Tree(Box<Block>),
    /// Block after another item of its line; it cannot be read again from its own start.
    WithinLine(Box<Block>),
}

impl BlockOutline {
    pub(crate) fn span(&self) -> Span {
        match self {
            Self::Words(span) => *span,
            Self::Tree(block) | Self::WithinLine(block) => block.span,
        }
    }
}

/// Returns the programs of a file as [`super::parse`] finds them, each block converted by `convert`.
///
/// Neither the trees nor the lines of a long file are kept.
pub(crate) fn outline<C: Default, B>(
    source: SourceId,
    bytes: &[u8],
    mut convert: impl FnMut(&mut C, BlockOutline) -> B,
) -> Vec<ProgramParts<C, B>> {
    let mut programs = Programs::default();
    let mut pieces = FileItems::new(source, bytes);
    // True once the current program has a name or a readable block.
    let mut is_program_known = false;
    loop {
        let begins_line = pieces.begins_line();
        match pieces.next_item() {
            Some(FileItem::Section) => {
                is_program_known = false;
                programs.close();
            }
            Some(FileItem::Program { name, span }) => {
                is_program_known = true;
                programs.begin(name, span);
            }
            Some(FileItem::Block(block)) => {
                let silent = is_unreadable_block(&block);
                is_program_known |= !silent;
                let ProgramParts { context, blocks, .. } = programs.program_for_block(block.span, silent);
                let block = Box::new(block);
                let outlined =
                    if begins_line { BlockOutline::Tree(block) } else { BlockOutline::WithinLine(block) };
                blocks.push(convert(context, outlined));
            }
            None => {
                if is_program_known {
                    let ProgramParts { context, blocks, .. } =
                        programs.program_for_block(Span::default(), false);
                    pieces.plain_lines(|span| blocks.push(convert(context, BlockOutline::Words(span))));
                }
                if pieces.next_line().is_none() {
                    return programs.finish();
                }
            }
        }
    }
}

/// Reads the block at the line start `start`, taken from an outline, of a text without its trailer.
pub(crate) fn block_at(source: SourceId, bytes: &[u8], start: u32) -> Option<Block> {
    FileItems::starting_at(source, bytes, start as usize).find_map(|piece| match piece {
        FileItem::Block(block) => Some(block),
        _ => None,
    })
}

/// Returns the sequence number of the block at `start`, `None` without one.
pub(crate) fn sequence_number_at(source: SourceId, bytes: &[u8], start: u32) -> Option<u32> {
    match bytes.get(start as usize)? {
        b'N' => {
            // A comment may interrupt the number; only the complete block settles it.
            if let Some(numbers) = NumberWords::new(source, bytes, start)
                && (numbers.is_at_end() || numbers.is_at_letter())
            {
                return numbers.sequence_number;
            }
        }
        b'#' | b'A'..=b'Z' => return None,
        _ => {}
    }
    block_at(source, bytes, start)?.number.map(|number| number.node)
}
