//! Blocks that were read before an edit: those on lines that the edit leaves as they are need not be read again.
use std::cell::Cell;

use super::ast::Block;
use super::token::is_space;
use crate::shares::{share_length, work_on};
use crate::source::Bytes;

/// Bits that a user of blocks keeps with each: what holds of a block wherever an edit moves it.
pub type BlockMarks = u8;

/// Blocks of one state of a text, in order.
#[derive(Debug, Default)]
pub struct ReadBlocks {
    text: Option<Bytes>,
    blocks: Vec<Block>,
    marks: Vec<BlockMarks>,
}

/// Blocks of a text that were read in an earlier state of it, by their offsets in this one.
#[derive(Debug, Default)]
pub struct KnownBlocks {
    starts: Vec<u32>,
    blocks: Vec<Option<Block>>,
    marks: Vec<BlockMarks>,
    /// Place behind the block that was found last: most are asked for in order.
    next: Cell<usize>,
}

impl ReadBlocks {
    /// Takes the blocks of a text, in order, each with its marks.
    pub fn new(text: Bytes, (blocks, marks): (Vec<Block>, Vec<BlockMarks>)) -> Self {
        Self { text: Some(text), blocks, marks }
    }

    /// Removes the marks of all blocks.
    pub fn clear_marks(&mut self) {
        self.marks.fill(0);
    }

    /// Returns the number of blocks.
    pub fn count(&self) -> usize {
        self.blocks.len()
    }

    /// Returns the blocks that a later state of the text has too, at their offsets there.
    ///
    /// Such a block fills its line, and the line is outside of what changed: reading it again gives the same block.
    pub fn moved_to(self, text: &[u8]) -> KnownBlocks {
        let Some(before) = self.text else { return KnownBlocks::default() };
        let (same_front, same_back) = common_ends(&before, text);
        // A line in front of the change ends before it, a line behind it begins after a line end that did not change.
        let front_end = before[..same_front].iter().rposition(is_line_end).unwrap_or(0);
        let back = &before[before.len() - same_back..];
        let back_start = before.len() - same_back + back.iter().position(is_line_end).unwrap_or(same_back);
        let delta = text.len() as i64 - before.len() as i64;
        let mut blocks = self.blocks;
        let first_behind = blocks.partition_point(|block| block.span.start as usize <= back_start);
        let is_known = |(index, block): (usize, &Block)| {
            let (start, end) = (block.span.start as usize, block.span.end as usize);
            (first_behind <= index || end <= front_end) && fills_its_line(&before, start, end)
        };
        let is_known: Vec<bool> = blocks.iter().enumerate().map(is_known).collect();
        if delta != 0 {
            let behind = &mut blocks[first_behind..];
            let share = share_length(behind.len());
            work_on(behind.chunks_mut(share), |share| share.iter_mut().for_each(|block| block.shift(delta)));
        }
        let mut known = KnownBlocks::default();
        let all = blocks.into_iter().zip(self.marks).zip(is_known);
        for ((block, marks), _) in all.filter(|(_, is_known)| *is_known) {
            known.starts.push(block.span.start);
            known.blocks.push(Some(block));
            known.marks.push(marks);
        }
        known
    }
}

impl KnownBlocks {
    /// Takes blocks of the same state of the text, in order, each with its marks.
    pub fn of((blocks, marks): (Vec<Block>, Vec<BlockMarks>)) -> Self {
        let starts = blocks.iter().map(|block| block.span.start).collect();
        Self { starts, blocks: blocks.into_iter().map(Some).collect(), marks, next: Cell::default() }
    }

    /// Returns the marks of the block that begins its line at an offset, also if it was taken; none of an unknown block.
    pub fn marks(&self, start: u32) -> BlockMarks {
        self.place(start).map_or(0, |place| self.marks[place])
    }

    /// Returns the block that begins its line at an offset.
    pub(crate) fn find(&self, start: u32) -> Option<&Block> {
        self.blocks[self.place(start)?].as_ref()
    }

    /// Takes the block that begins its line at an offset.
    pub(crate) fn take(&mut self, start: u32) -> Option<Block> {
        let place = self.place(start)?;
        self.blocks[place].take()
    }

    fn place(&self, start: u32) -> Option<usize> {
        let next = self.next.get();
        let is_next = self.starts.get(next) == Some(&start);
        let place = if is_next { next } else { self.starts.binary_search(&start).ok()? };
        self.next.set(place + 1);
        Some(place)
    }
}

/// Returns the lengths of the equal beginning and of the equal rest of two texts.
fn common_ends(one: &[u8], other: &[u8]) -> (usize, usize) {
    let front = equal_length(one.iter(), other.iter());
    (front, equal_length(one[front..].iter().rev(), other[front..].iter().rev()))
}

fn equal_length<'a>(one: impl Iterator<Item = &'a u8>, other: impl Iterator<Item = &'a u8>) -> usize {
    one.zip(other).take_while(|(one, other)| one == other).count()
}

fn is_line_end(byte: &u8) -> bool {
    matches!(byte, b'\n' | b'\r')
}

fn fills_its_line(text: &[u8], start: usize, end: usize) -> bool {
    let before = text[..start].iter().rev().take_while(|byte| !is_line_end(byte)).all(|byte| is_space(*byte));
    before && text[end..].iter().take_while(|byte| !is_line_end(byte)).all(|byte| is_space(*byte))
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::super::{block_at, parse, without_trailer};
    use super::*;
    use crate::source::SourceId;

    fn blocks(text: &[u8]) -> Vec<Block> {
        parse(SourceId(0), text).into_iter().flat_map(|program| program.blocks).collect()
    }

    /// Returns the blocks of a text, each marked with its number of items.
    fn read(text: &[u8]) -> ReadBlocks {
        let blocks = blocks(text);
        let marks = blocks.iter().map(|block| block.items.len() as BlockMarks).collect();
        ReadBlocks::new(Bytes::from(text), (blocks, marks))
    }

    #[test]
    fn blocks_beside_the_edited_line_are_kept() {
        let before = b"O1\nG0 X1. (A)\n#1=SIN[#2]\nG1 X2.\n/2IF[#1 GT 3]THEN #2=1\nM30\n";
        let after = b"O1\nG0 X1. (A)\n#1=SIN[#2]\nG1 X2. Y5. F100.\n/2IF[#1 GT 3]THEN #2=1\nM30\n";
        let known = read(before).moved_to(after);
        let blocks = blocks(after);
        let found: Vec<_> = blocks.iter().map(|block| known.find(block.span.start)).collect();
        assert_eq!(found[2], None, "the edited block");
        for at in [0, 1, 3, 4] {
            assert_eq!(found[at], Some(&blocks[at]));
        }
        let marks: Vec<_> = blocks.iter().map(|block| known.marks(block.span.start)).collect();
        assert_eq!(marks, [2, 1, 0, 1, 1], "the words and statements of each known block");
    }

    #[test]
    fn a_line_of_several_items_is_read_again() {
        let text = b"O1 G0 X1.\nM99 O2\nM98 P1\nM99\n";
        let known = read(text).moved_to(text);
        let found = |start| known.find(start).is_some();
        assert!(!found(3) && !found(10), "behind O1, before O2");
        assert!(found(17) && found(24));
    }

    proptest! {
        /// Lines of all kinds and any edit: a known block is the one that the line has now.
        #[test]
        fn a_known_block_is_the_block_of_the_new_text(
            lines in proptest::collection::vec(
                "N?[0-9]{0,2} ?(G0|X1\\.|#1=\\[2\\+#3\\]|IF\\[#1EQ#0\\]GOTO ?5|WHILE\\[#1LT2\\]DO1|END1|\\(A\\(B\\)|;C|O2|%|/|DPRNT\\[A#1\\[44\\]\\]|X1\\.\\.|\u{1a}|&F=//A)",
                1..8,
            ),
            end in proptest::sample::select(vec!["\n", "\r\n", "\r", "\n\r\r"]),
            cut in (any::<prop::sample::Index>(), any::<prop::sample::Index>()),
            new in proptest::sample::select(vec!["", "X", "\n", "\r", "(", ")", "O3\n", "%\n", "#2=1\n", " ", "\u{1a}"]),
        ) {
            let before = format!("O1{end}{}", lines.join(end)).into_bytes();
            let (one, other) = (cut.0.index(before.len() + 1), cut.1.index(before.len() + 1));
            let (from, to) = (one.min(other), one.max(other));
            let after = [&before[..from], new.as_bytes(), &before[to..]].concat();
            let known = read(&before).moved_to(&after);
            for start in known.starts.clone() {
                let content = without_trailer(&after);
                prop_assert!((start as usize) < content.len());
                let read = block_at(SourceId(0), content, start);
                prop_assert_eq!(known.find(start), read.as_ref(), "{:?}", String::from_utf8_lossy(&after));
                let items = read.map_or(0, |block| block.items.len());
                prop_assert_eq!(usize::from(known.marks(start)), items, "{:?}", String::from_utf8_lossy(&after));
            }
        }
    }
}
