//! Pairing of DO and END.
use std::ops::Range;

use super::OpIndex;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum LoopRole {
    /// DO or WHILE.
    Begin,
    End,
    /// END beside words: its block raises an alarm, and the loop ends before it.
    MixedEnd,
}

#[derive(Debug, Default)]
pub(super) struct Loops {
    /// DO or WHILE and END of each loop with its number, sorted by the DO or WHILE.
    pairs: Vec<(OpIndex, OpIndex, u8)>,
    /// END with its DO or WHILE, sorted by the END.
    ends: Vec<(OpIndex, OpIndex)>,
}

impl Loops {
    /// Pairs the loop blocks, given in order. A block without a partner raises an alarm when execution
    /// reaches it.
    pub(super) fn pair(parts: &[(OpIndex, LoopRole, u8)]) -> Self {
        let mut open: Vec<(u8, OpIndex)> = Vec::new();
        let (mut pairs, mut ends) = (Vec::new(), Vec::new());
        for &(block, part, number) in parts {
            // A loop inside one of the same number makes the END of the outer loop ambiguous: the outer loop
            // and all loops open in it have no END.
            let outer = open.iter().position(|(n, _)| *n == number);
            match part {
                LoopRole::Begin => {
                    open.truncate(outer.unwrap_or(open.len()));
                    open.push((number, block));
                }
                LoopRole::End | LoopRole::MixedEnd => {
                    let Some(outer) = outer else { continue };
                    let begin = open[outer].1;
                    if part == LoopRole::End {
                        pairs.push((begin, block, number));
                        ends.push((block, begin));
                    } else {
                        pairs.push((begin, block - 1, number));
                    }
                    open.truncate(outer);
                }
            }
        }
        pairs.sort_unstable();
        ends.sort_unstable();
        Self { pairs, ends }
    }

    /// Returns the loops whose first and last blocks are kept, with new indices for them.
    pub(super) fn renumbered(&self, new_index: &[u32]) -> Self {
        let new = |block: OpIndex| new_index[block] as OpIndex;
        let is_kept = |block: OpIndex| new_index[block] != new_index[block + 1];
        let pairs = self.pairs.iter().filter(|(begin, end, _)| is_kept(*begin) && is_kept(*end));
        let ends = self.ends.iter().filter(|(end, begin)| is_kept(*begin) && is_kept(*end));
        Self {
            pairs: pairs.map(|(begin, end, number)| (new(*begin), new(*end), *number)).collect(),
            ends: ends.map(|(end, begin)| (new(*end), new(*begin))).collect(),
        }
    }

    /// Returns the loops of some consecutive blocks.
    pub(super) fn part(&self, blocks: Range<OpIndex>) -> Self {
        let first = blocks.start;
        let of = |list: &[(OpIndex, OpIndex)]| {
            let from = list.partition_point(|(block, _)| *block < first);
            let inside = list[from..].iter().take_while(|(block, _)| *block < blocks.end);
            inside.map(|(block, partner)| (block - first, partner.saturating_sub(first))).collect()
        };
        let from = self.pairs.partition_point(|(begin, ..)| *begin < first);
        let inside = self.pairs[from..].iter().take_while(|(begin, ..)| *begin < blocks.end);
        let pairs = inside.map(|(begin, end, number)| (begin - first, end - first, *number)).collect();
        Self { pairs, ends: of(&self.ends) }
    }

    /// Returns true if a loop begins before a block and does not end before it.
    pub(super) fn contain(&self, block: OpIndex) -> bool {
        self.pairs.iter().take_while(|(begin, ..)| *begin < block).any(|(_, end, _)| block <= *end)
    }

    pub(super) fn end_of(&self, begin: OpIndex) -> Option<OpIndex> {
        let index = self.pairs.binary_search_by_key(&begin, |(first, ..)| *first).ok()?;
        self.pairs.get(index).map(|(_, end, _)| *end)
    }

    pub(super) fn begin_of(&self, end: OpIndex) -> Option<OpIndex> {
        let index = self.ends.binary_search_by_key(&end, |(last, _)| *last).ok()?;
        self.ends.get(index).map(|(_, begin)| *begin)
    }

    /// Returns the number of a loop that contains `to` and is not among `open`.
    pub(super) fn loop_entered(&self, to: OpIndex, open: &[Option<(OpIndex, OpIndex)>]) -> Option<u8> {
        let entered = |(first, last, _): &&(OpIndex, OpIndex, u8)| {
            *first < to && to <= *last && !open.contains(&Some((*first, *last)))
        };
        self.pairs.iter().find(entered).map(|(.., number)| *number)
    }
}
