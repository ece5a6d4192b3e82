//! Where the blocks of a file begin, and single blocks from there: a long file is read as it is executed.
//!
//! Most lines of long files are one block of words. That much is seen without reading them; the others are read, so that
//! an outline has the same programs and blocks as the tree.
use super::ast::Block;
use super::file::{Parts, programs};
use super::numbers::Numbers;
use super::pieces::{Piece, Pieces, says_nothing};
use crate::source::{SourceId, Span};

/// A block as its outline has it.
#[derive(Debug)]
pub enum Outlined {
    /// Not looked at: neither DO nor END.
    Words(Span),
    Read(Box<Block>),
    /// Something else stands before it in its line: it can't be read from its own beginning on.
    Apart(Box<Block>),
}

impl Outlined {
    pub fn span(&self) -> Span {
        match self {
            Self::Words(span) => *span,
            Self::Read(block) | Self::Apart(block) => block.span,
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

/// The sequence number of that block.
pub fn sequence_number_at(source: SourceId, bytes: &[u8], start: u32) -> Option<u32> {
    match bytes.get(start as usize)? {
        b'N' => {
            // A comment may go on with the number, and only the whole block tells.
            if let Some(numbers) = Numbers::new(source, bytes, start)
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

/// The pieces of a file, most blocks unread.
struct Outlines<'a> {
    pieces: Pieces<'a>,
    /// Whether it is known that the program at hand is one: it has a name, or a block that says something.
    told: bool,
}

impl Iterator for Outlines<'_> {
    type Item = Piece<Outlined>;

    #[inline]
    fn next(&mut self) -> Option<Piece<Outlined>> {
        loop {
            let begins = self.pieces.begins_line();
            if let Some(piece) = self.pieces.piece() {
                return Some(self.read(piece, begins));
            }
            if self.told
                && let Some(span) = self.pieces.plain_line()
            {
                if span.start == span.end {
                    continue;
                }
                return Some(Piece::Block(Outlined::Words(span)));
            }
            self.pieces.next_line()?;
        }
    }
}

impl Outlines<'_> {
    /// A piece that had to be read; `begins` where it begins its line.
    fn read(&mut self, piece: Piece, begins: bool) -> Piece<Outlined> {
        match piece {
            Piece::Section => {
                self.told = false;
                Piece::Section
            }
            Piece::Program { name, span } => {
                self.told = true;
                Piece::Program { name, span }
            }
            Piece::Block(block) => {
                self.told |= !says_nothing(&block);
                let block = Box::new(block);
                Piece::Block(if begins { Outlined::Read(block) } else { Outlined::Apart(block) })
            }
        }
    }
}
