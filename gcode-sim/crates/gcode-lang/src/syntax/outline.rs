//! Where the blocks of a file begin, and single blocks from there: a long file is read as it is executed.
//!
//! Most lines of long files are one block of words. That much is seen without reading them; the others are read, so that
//! an outline has the same programs and blocks as the tree.
use super::ast::Block;
use super::file::{ProgramParts, Programs};
use super::file_items::{FileItem, FileItems, is_unreadable_block};
use super::numbers::NumberWords;
use crate::source::{SourceId, Span};

/// A block as its outline has it.
#[derive(Debug)]
pub enum BlockOutline {
    /// Not looked at: neither DO nor END. Spaces behind it belong to its place.
    Words(Span),
    Tree(Box<Block>),
    /// Something else stands before it in its line: it can't be read from its own beginning on.
    WithinLine(Box<Block>),
}

impl BlockOutline {
    pub fn span(&self) -> Span {
        match self {
            Self::Words(span) => *span,
            Self::Tree(block) | Self::WithinLine(block) => block.span,
        }
    }
}

/// The programs of a file as [`super::parse`] finds them; each block becomes at once what `each` makes of it, so that
/// neither the trees of a long file are ever held nor its lines.
pub fn outline<C: Default, B>(
    source: SourceId,
    bytes: &[u8],
    mut convert: impl FnMut(&mut C, BlockOutline) -> B,
) -> Vec<ProgramParts<C, B>> {
    let mut programs = Programs::default();
    let mut pieces = FileItems::new(source, bytes);
    // Whether it is known that the program at hand is one: it has a name, or a block that says something.
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

/// The block at the beginning of a line, from where an outline has it, of a text as [`super::written`].
pub fn block_at(source: SourceId, bytes: &[u8], start: u32) -> Option<Block> {
    FileItems::starting_at(source, bytes, start).find_map(|piece| match piece {
        FileItem::Block(block) => Some(block),
        _ => None,
    })
}

/// The sequence number of that block.
pub fn sequence_number_at(source: SourceId, bytes: &[u8], start: u32) -> Option<u32> {
    match bytes.get(start as usize)? {
        b'N' => {
            // A comment may go on with the number, and only the whole block tells.
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
