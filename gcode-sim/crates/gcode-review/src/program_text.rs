//! Texts of two revisions' programs: their blocks, and where these are written differently.
use std::borrow::Cow;
use std::collections::BTreeMap;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::ops::Range;

use super::block_list::{BlockList, ExecutedBlocks};
use super::block_location::BlockLocation;
use super::common_sequence::{EqualRun, common_lines};
use super::record::Record;

/// Blocks of both revisions that cause a difference.
pub(super) type Cause = (BlockLocation, BlockLocation);

/// Returns the outermost call that is written differently, else the blocks themselves.
pub(super) fn cause(old: &BlockLocation, new: &BlockLocation) -> Cause {
    let calls = old.calls.iter().rev().zip(new.calls.iter().rev());
    let mut calls = calls.take_while(|(was, is)| was.program == is.program);
    let call = calls.find(|(was, is)| words(&was.block) != words(&is.block));
    let (old, new) = call.unwrap_or((old, new));
    (old.clone(), new.clone())
}

/// Returns a block without sequence number, comments and spaces.
pub(super) fn words(block: &str) -> String {
    let mut code = String::new();
    read_words(block, &mut code);
    code
}

/// Puts a block without sequence number, comments and spaces into `code`.
pub(super) fn read_words(block: &str, code: &mut String) {
    code.clear();
    if block.contains(['(', ')']) {
        let mut depth = 0;
        let is_code = |c: &char| {
            let is_comment = depth > 0 || *c == '(';
            depth += i32::from(*c == '(') - i32::from(*c == ')');
            !is_comment && !c.is_whitespace()
        };
        code.extend(block.chars().filter(is_code));
    } else {
        block.split_whitespace().for_each(|piece| code.push_str(piece));
    }
    if let Some(rest) = code.strip_prefix('N') {
        let rest = rest.trim_start_matches(|c: char| c.is_ascii_digit()).len();
        code.drain(..code.len() - rest);
    }
}

/// Puts what a block says to the control into `code`: its words, or with the text of an alarm or a message.
fn read_words_and_text(block: &str, code: &mut String) {
    let has_message = block.contains('#') && ["#3000", "#3006"].iter().any(|one| block.contains(one));
    match has_message {
        true => {
            code.clear();
            code.push_str(block);
        }
        false => read_words(block, code),
    }
}

/// Blocks of one program of a record.
pub(super) struct ProgramSide<'a> {
    /// Name of the program, see [`ExecutedBlocks::unique_name`]; empty for the first one.
    pub name: String,
    blocks: SideBlocks<'a>,
}

enum SideBlocks<'a> {
    /// All blocks of a program of the memory, by its number.
    Text(&'a ExecutedBlocks, usize),
    /// Blocks of a file.
    Named(Vec<NamedBlock>),
}

/// A block with the number of steps before its first execution, and whether it was ever executed as a whole; `None` if it
/// was not executed.
pub(super) type NamedBlock = (BlockLocation, Option<(usize, bool)>);

impl<'a> ProgramSide<'a> {
    pub(super) fn named(name: String, blocks: Vec<NamedBlock>) -> Self {
        Self { name, blocks: SideBlocks::Named(blocks) }
    }

    pub(super) fn count(&self) -> usize {
        match &self.blocks {
            SideBlocks::Text(blocks, program) => blocks.programs[*program].texts.count(),
            SideBlocks::Named(all) => all.len(),
        }
    }

    /// Returns the text up to the next block; `None` if a record does not have it.
    fn up_to_next(&self, index: usize) -> Option<&'a [u8]> {
        match self.blocks {
            SideBlocks::Text(blocks, program) => Some(blocks.programs[program].texts.up_to_next(index)),
            SideBlocks::Named(_) => None,
        }
    }

    pub(super) fn text(&self, index: usize) -> Cow<'_, str> {
        match &self.blocks {
            SideBlocks::Text(blocks, program) => {
                match blocks.sources.text_in(blocks.programs[*program].texts.span(index)) {
                    Cow::Borrowed(text) => Cow::Borrowed(text.trim()),
                    Cow::Owned(text) => Cow::Owned(text.trim().to_owned()),
                }
            }
            SideBlocks::Named(all) => Cow::Borrowed(&all[index].0.block),
        }
    }

    /// Returns program and line of a block.
    pub(super) fn place(&self, index: usize) -> (&str, u32) {
        match &self.blocks {
            SideBlocks::Text(blocks, program) => {
                let program = &blocks.programs[*program];
                let (source, start) = (program.texts.source(), program.texts.start(index));
                (&program.label, blocks.sources.get(source).line_column(start).line)
            }
            SideBlocks::Named(all) => (&all[index].0.program, all[index].0.line),
        }
    }

    /// Returns a block without the calls that led to it.
    pub(super) fn location(&self, index: usize) -> BlockLocation {
        let (program, line) = self.place(index);
        let (program, block) = (program.to_owned(), self.text(index).into_owned());
        BlockLocation { program, line, block, calls: Vec::new() }
    }

    /// Returns the number of steps before the first execution of a block, and whether it was ever executed as a whole;
    /// `None` if it is not executed.
    pub(super) fn reached(&self, index: usize) -> Option<(usize, bool)> {
        match &self.blocks {
            SideBlocks::Text(blocks, program) => blocks.reached(*program, index),
            SideBlocks::Named(all) => all[index].1,
        }
    }
}

/// Returns every program with its blocks, in the order in which they were read; `None` for a record of a file. The first
/// one has no name.
pub(super) fn written(record: &Record) -> Option<Vec<ProgramSide<'_>>> {
    let BlockList::Executed(blocks) = &record.blocks else { return None };
    let side = |number: usize| {
        let name = if number == 0 { String::new() } else { blocks.unique_name(number) };
        ProgramSide { name, blocks: SideBlocks::Text(blocks, number) }
    };
    Some((0..blocks.programs.len()).map(side).collect())
}

/// The passage between the first and the last difference of two programs: blocks with words, by their indices, old and
/// new.
pub(super) struct ChangedPassage<'a> {
    sides: [&'a ProgramSide<'a>; 2],
    read_words: fn(&str, &mut String),
    blocks: [Vec<u32>; 2],
    /// Hashes of the words of these blocks.
    hashes: [Vec<u64>; 2],
}

impl<'a> ChangedPassage<'a> {
    pub(super) fn new(sides: [&'a ProgramSide<'a>; 2], read_words: fn(&str, &mut String)) -> Self {
        let mut passage = Self { sides, read_words, blocks: Default::default(), hashes: Default::default() };
        let mut from = [0, 0];
        let mut to = sides.map(ProgramSide::count);
        while from[0] < to[0] && from[1] < to[1] {
            match passage.passed(from) {
                Some([i, j]) => from = [from[0] + i, from[1] + j],
                None => break,
            }
        }
        while from[0] < to[0] && from[1] < to[1] {
            match passage.passed([to[0] - 1, to[1] - 1]) {
                Some([i, j]) => to = [to[0] - i, to[1] - j],
                None => break,
            }
        }
        let mut words = String::new();
        for side in 0..2 {
            for index in from[side]..to[side] {
                passage.read(side, index, &mut words);
                if !words.is_empty() {
                    let mut hasher = DefaultHasher::new();
                    words.hash(&mut hasher);
                    passage.blocks[side].push(index as u32);
                    passage.hashes[side].push(hasher.finish());
                }
            }
        }
        passage
    }

    fn read(&self, side: usize, index: usize, words: &mut String) {
        (self.read_words)(&self.sides[side].text(index), words);
    }

    fn words_of(&self, side: usize, index: usize) -> String {
        let mut words = String::new();
        self.read(side, index, &mut words);
        words
    }

    /// Returns how many of two blocks are passed: both if they are equal, one that has no words; `None` if they differ.
    fn passed(&self, [i, j]: [usize; 2]) -> Option<[usize; 2]> {
        if let (Some(old), Some(new)) = (self.sides[0].up_to_next(i), self.sides[1].up_to_next(j))
            && old == new
        {
            return Some([1, 1]);
        }
        let (old, new) = (self.words_of(0, i), self.words_of(1, j));
        match (old.is_empty(), new.is_empty()) {
            (true, _) => Some([1, 0]),
            (_, true) => Some([0, 1]),
            _ => (old == new).then_some([1, 1]),
        }
    }

    fn words(&self, side: usize, index: usize) -> String {
        self.words_of(side, self.blocks[side][index] as usize)
    }

    /// Returns the ranges of blocks between equal ones.
    pub(super) fn differences(&self) -> Vec<[Range<usize>; 2]> {
        let [old, new] = &self.hashes;
        let runs = common_lines([old, new], |i, j| self.words(0, i) == self.words(1, j));
        let ends = [self.blocks[0].len(), self.blocks[1].len()];
        let mut from = [0, 0];
        let end = EqualRun { old: ends[0], new: ends[1], length: 0 };
        let ranges = runs.into_iter().chain([end]).map(|EqualRun { old, new, length }| {
            let [first_old, first_new] = std::mem::replace(&mut from, [old + length, new + length]);
            [first_old..old, first_new..new]
        });
        ranges.filter(|[old, new]| !(old.is_empty() && new.is_empty())).collect()
    }

    /// Returns the ranges in which the programs differ. A deletion and an insertion of the same blocks are one gap.
    /// True marks blocks that are moved.
    fn gaps(&self) -> Vec<([Range<usize>; 2], bool)> {
        let mut gaps: Vec<_> = self.differences().into_iter().map(|gap| (gap, false)).collect();
        let text = |side: usize, blocks: &Range<usize>| {
            blocks.clone().map(|index| self.words(side, index)).collect::<Vec<_>>().join("\n")
        };
        let new = gaps.iter().map(|(gap, _)| gap).filter(|gap| gap[0].is_empty());
        let mut moved: BTreeMap<String, Range<usize>> =
            new.map(|gap| (text(1, &gap[1]), gap[1].clone())).collect();
        let mut taken = Vec::new();
        for (gap, is_moved) in gaps.iter_mut().filter(|(gap, _)| gap[1].is_empty()) {
            if let Some(range) = moved.remove(&text(0, &gap[0])) {
                taken.push(range.clone());
                (gap[1], *is_moved) = (range, true);
            }
        }
        gaps.retain(|(gap, _)| !(gap[0].is_empty() && taken.contains(&gap[1])));
        gaps
    }

    pub(super) fn indices(&self, side: usize, range: &Range<usize>) -> &[u32] {
        &self.blocks[side][range.clone()]
    }
}

/// Passes on the passages in which two programs differ, as the indices of their blocks, old and new: block by block if
/// both have the same number of blocks there.
pub(super) fn for_each_gap<'a>(sides: [&'a ProgramSide<'a>; 2], mut each: impl FnMut([&[u32]; 2])) {
    let passage = ChangedPassage::new(sides, read_words_and_text);
    for (gap, is_moved) in passage.gaps() {
        let [old, new] = [0, 1].map(|side| passage.indices(side, &gap[side]));
        if old.len() == new.len() && !is_moved {
            old.chunks(1).zip(new.chunks(1)).for_each(|(old, new)| each([old, new]));
        } else {
            each([old, new]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn side(text: &str) -> ProgramSide<'static> {
        let block = |(line, block): (usize, &str)| BlockLocation {
            program: "O0001".to_owned(),
            line: line as u32,
            block: block.to_owned(),
            calls: Vec::new(),
        };
        let blocks = text.lines().enumerate().map(|line| (block(line), Some((line.0, true))));
        ProgramSide::named(String::new(), blocks.collect())
    }

    /// Returns the first and the last block of each gap, old and new; none of an empty side.
    fn found(old: &str, new: &str) -> Vec<[Option<(u32, u32)>; 2]> {
        let mut all = Vec::new();
        for_each_gap([&side(old), &side(new)], |gap| {
            all.push(gap.map(|blocks| Some((*blocks.first()?, *blocks.last()?))));
        });
        all
    }

    #[test]
    fn each_rewritten_block_is_one_gap() {
        assert_eq!(
            found("G0\nX1.\nY1.\nM30", "N5 G0\nX2.\nY2. (HERE)\nM30"),
            [[Some((1, 1)); 2], [Some((2, 2)); 2]]
        );
        assert_eq!(found("G0\nX1.\nM30", "G0\nX1. Y1.\nX2.\nM30"), [[Some((1, 1)), Some((1, 2))]]);
        assert_eq!(found("G0\nM30", "G0\nM0\nM30"), [[None, Some((1, 1))]]);
    }

    #[test]
    fn a_block_that_moves_is_one_gap() {
        assert_eq!(found("M0\nX1.\nX2.\nM30", "X1.\nX2.\nM0\nM30"), [[Some((0, 0)), Some((2, 2))]]);
    }

    #[test]
    fn the_text_of_a_message_is_no_comment() {
        assert_eq!(found("#3006=1(A)", "#3006=1(B)").len(), 1);
        assert_eq!(found("G0 (A)", "G0 (B)").len(), 0);
    }

    fn at(line: u32, block: &str, calls: &[(u32, &str)]) -> BlockLocation {
        let calls = calls.iter().map(|(line, block)| at(*line, block, &[])).collect();
        BlockLocation { program: "O1".to_owned(), line, block: block.to_owned(), calls }
    }

    #[test]
    fn a_call_with_other_arguments_is_the_cause_of_its_differences() {
        let old = at(9, "G1 X#1", &[(5, "G65 P2 A1."), (3, "N10 G65 P1 A1. (FIRST)")]);
        let new = at(9, "G1 X#1", &[(5, "G65 P2 A1."), (4, "N20 G65P1 A1.01")]);
        assert_eq!(cause(&old, &new), (old.calls[1].clone(), new.calls[1].clone()));
        // Another sequence number and another comment: the same call.
        let same = at(9, "G1 X#2", &[(5, "G65 P2 A1."), (4, "N20 G65P1 A1.")]);
        assert_eq!(cause(&old, &same), (old.clone(), same.clone()));
    }
}
