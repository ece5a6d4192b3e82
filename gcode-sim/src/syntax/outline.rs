//! Where the blocks of a file begin, and single blocks from there: a long file is read as it is executed.
//!
//! Most lines of long files are one block of words. That much is seen without reading them; the others are read, so that
//! an outline has the same programs and blocks as the tree.
use super::ast::Block;
use super::block::sequence_number;
use super::file::{Parts, programs};
use super::pieces::{Piece, Pieces, read_plain, says_nothing};
use super::token::Line;
use crate::source::{SourceId, Span};

/// A block as its outline has it.
#[derive(Debug)]
pub enum Outlined {
    /// Not looked at but for its sequence number: neither DO nor END.
    Words {
        span: Span,
        number: Option<u32>,
        /// [`plain_block_at`] reads it.
        plain: bool,
    },
    Read(Box<Block>),
    /// Something else stands before it in its line: it can't be read from its own beginning on.
    Apart(Box<Block>),
}

impl Outlined {
    pub fn span(&self) -> Span {
        match self {
            Self::Words { span, .. } => *span,
            Self::Read(block) | Self::Apart(block) => block.span,
        }
    }

    pub fn number(&self) -> Option<u32> {
        match self {
            Self::Words { number, .. } => *number,
            Self::Read(block) | Self::Apart(block) => block.number.as_ref().map(|number| number.node),
        }
    }
}

/// The programs of a file as [`super::parse`] finds them; each block becomes at once what `each` makes of it.
pub fn outline<C: Default, B>(
    source: SourceId,
    bytes: &[u8],
    each: impl FnMut(&mut C, Outlined) -> B,
) -> Vec<Parts<C, B>> {
    let silent = |block: &Outlined| matches!(block, Outlined::Read(block) | Outlined::Apart(block) if says_nothing(block));
    programs(Outlines { pieces: Pieces::new(source, bytes), told: false }, silent, Outlined::span, each)
}

/// The block at the beginning of a line, from where an outline has it, of a text as [`super::written`].
pub fn block_at(source: SourceId, bytes: &[u8], start: u32) -> Option<Block> {
    Pieces::from(source, bytes, start).find_map(|piece| match piece {
        Piece::Block(block) => Some(block),
        _ => None,
    })
}

/// Reads a plain block from where an outline has it into one that may have been used for another.
pub fn plain_block_at(source: SourceId, bytes: &[u8], start: u32, block: &mut Block) {
    read_plain(source, bytes, start, block);
}

/// The pieces of a file, most blocks unread.
struct Outlines<'a> {
    pieces: Pieces<'a>,
    /// Whether it is known that the program at hand is one: it has a name, or a block that says something.
    told: bool,
}

impl Iterator for Outlines<'_> {
    type Item = Piece<Outlined>;

    fn next(&mut self) -> Option<Piece<Outlined>> {
        loop {
            if self.told
                && let Some((span, text, plain)) = self.pieces.plain_line()
            {
                if text.is_empty() {
                    continue;
                }
                let line = Line { source: span.source, end: span.end };
                let number = match text {
                    [b'N' | b'n', ..] => sequence_number(line, text).ok().map(|(_, number)| number.node),
                    _ => None,
                };
                return Some(Piece::Block(Outlined::Words { span, number, plain }));
            }
            let begins = self.pieces.begins_line();
            match self.pieces.piece() {
                None => self.pieces.next_line()?,
                Some(Piece::Section) => {
                    self.told = false;
                    return Some(Piece::Section);
                }
                Some(Piece::Program { name, span }) => {
                    self.told = true;
                    return Some(Piece::Program { name, span });
                }
                Some(Piece::Block(block)) => {
                    self.told |= !says_nothing(&block);
                    let block = Box::new(block);
                    let read = if begins { Outlined::Read(block) } else { Outlined::Apart(block) };
                    return Some(Piece::Block(read));
                }
            }
        }
    }
}
