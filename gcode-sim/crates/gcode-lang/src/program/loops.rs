//! Pairs DO and END.
use super::OpIndex;

/// What a block is to a loop.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum LoopRole {
    /// DO, or WHILE.
    Begin,
    End,
}

/// The loops of a program.
#[derive(Debug, Default)]
pub(super) struct Loops {
    /// DO, or WHILE, and END of each loop with its number, in the order of their beginnings.
    pairs: Vec<(OpIndex, OpIndex, u8)>,
    /// END and DO, in the order of their ends.
    ends: Vec<(OpIndex, OpIndex)>,
}

impl Loops {
    /// Pairs the blocks, given in their order. What has no partner alarms when a run gets there.
    pub(super) fn pair(parts: &[(OpIndex, LoopRole, u8)]) -> Self {
        let mut open: Vec<(u8, OpIndex)> = Vec::new();
        let mut pairs = Vec::new();
        for &(block, part, number) in parts {
            // Inside a loop of the same number nobody can tell the outer one's END from the inner one's: the outer
            // one and all that are open in it have none.
            let outer = open.iter().position(|(n, _)| *n == number);
            match part {
                LoopRole::Begin => {
                    open.truncate(outer.unwrap_or(open.len()));
                    open.push((number, block));
                }
                LoopRole::End => {
                    let Some(outer) = outer else { continue };
                    pairs.push((open[outer].1, block, number));
                    open.truncate(outer);
                }
            }
        }
        pairs.sort_unstable();
        let mut ends: Vec<_> = pairs.iter().map(|(begin, end, _)| (*end, *begin)).collect();
        ends.sort_unstable();
        Self { pairs, ends }
    }

    /// Where the END of a DO or WHILE stands.
    pub(super) fn end_of(&self, begin: OpIndex) -> Option<OpIndex> {
        let place = self.pairs.binary_search_by_key(&begin, |(first, ..)| *first).ok()?;
        self.pairs.get(place).map(|(_, end, _)| *end)
    }

    /// Where the DO or WHILE of an END stands.
    pub(super) fn begin_of(&self, end: OpIndex) -> Option<OpIndex> {
        let place = self.ends.binary_search_by_key(&end, |(last, _)| *last).ok()?;
        self.ends.get(place).map(|(_, begin)| *begin)
    }

    /// The number of a loop that `to` lies in and that isn't among those open.
    pub(super) fn loop_entered(&self, to: OpIndex, open: &[Option<(OpIndex, OpIndex)>]) -> Option<u8> {
        let entered = |(first, last, _): &&(OpIndex, OpIndex, u8)| {
            *first < to && to <= *last && !open.contains(&Some((*first, *last)))
        };
        self.pairs.iter().find(entered).map(|(.., number)| *number)
    }
}
