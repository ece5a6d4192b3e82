//! Items of some lines of a file. No line depends on another, so an editor reads again only what has changed.
use super::ast::{Block, Folder, ProgramName};
use super::file_items::{FileItem, FileItems, byte_order_marks};
use crate::source::{SourceId, Span};

/// Item of a line.
#[derive(Debug)]
pub enum LineItem {
    /// `%`.
    Section {
        /// Offset of the sign or of the spaces before it.
        start: u32,
    },
    /// O word or name of a program.
    Program {
        /// O number or name.
        name: ProgramName,
        /// Span of the O word.
        span: Span,
        /// Folder of the last folder line among the lines read.
        folder: Option<Folder>,
    },
    /// Line that is exactly one block without comments, not read: neither DO nor END nor GOTO.
    Words(Span),
    /// Block that is read.
    Block(Box<Block>),
}

/// Passes the items of the lines from the line start `start` to the end of `bytes` to `each`.
///
/// A leader is not recognised: its lines are unreadable blocks.
pub fn line_items(source: SourceId, bytes: &[u8], start: u32, mut each: impl FnMut(LineItem)) {
    let mut items = FileItems::starting_at(source, bytes, start as usize);
    loop {
        let start = items.position();
        match items.next_item() {
            Some(FileItem::Section) => each(LineItem::Section { start }),
            Some(FileItem::Program { name, span }) => {
                each(LineItem::Program { name, span, folder: items.folder() });
            }
            Some(FileItem::Block(block)) => each(LineItem::Block(Box::new(block))),
            None => {
                items.plain_lines(|span| each(LineItem::Words(span)));
                if items.next_line().is_none() {
                    return;
                }
            }
        }
    }
}

/// Returns the offset of the first line, after byte order marks.
pub fn first_line(bytes: &[u8]) -> u32 {
    byte_order_marks(bytes) as u32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_read_from_any_line_start() {
        let text = b"O1(A)\nG0 X1.\nGOTO 5\n%\nX2.\n";
        let kinds = |start: u32| {
            let mut kinds = String::new();
            line_items(SourceId(0), text, start, |item| {
                kinds.push(match item {
                    LineItem::Section { .. } => '%',
                    LineItem::Program { .. } => 'O',
                    LineItem::Words(_) => 'W',
                    LineItem::Block(block) if block.is_unreadable() => 'C',
                    LineItem::Block(_) => 'B',
                });
            });
            kinds
        };
        assert_eq!(kinds(0), "OCWB%W");
        assert_eq!(kinds(6), "WB%W");
        assert_eq!(first_line(b"\xef\xbb\xbfO1"), 3);
    }
}
