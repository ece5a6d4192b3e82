//! The blocks that two revisions' programs have written differently, and the edit that an effect comes from.
use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;

use super::align::common;
use super::cause::words;
use super::change::Effect;
use super::hole_groups::HoleEffect;
use super::record::{BlockLocation, Record};
use gcode_lang::syntax::parse;

/// A block that is written differently, or adjacent blocks that are new, gone, moved or rewritten together.
#[derive(Clone, Debug)]
pub(super) struct Edit {
    /// The first block of it in the old and in the new revision, where there is one.
    pub blocks: [Option<BlockLocation>; 2],
    /// How many steps each run has made when it first executes the edit.
    reached: [Option<usize>; 2],
}

/// All edits that one of the runs has executed.
#[derive(Clone, Debug, Default)]
pub(super) struct Edits {
    all: Vec<Edit>,
    /// The edit of a block, by program and line, old and new.
    of_block: [BTreeMap<String, BTreeMap<u32, usize>>; 2],
    /// When each edit is first executed, and its number, old and new; in that order.
    by_step: [Vec<(usize, usize)>; 2],
}

impl Edits {
    /// Compares the programs' texts; of a record without a text those blocks that its steps and their calls name.
    pub(super) fn new(old: &Record, new: &Record) -> Self {
        let [was, is] = match (written(old), written(new)) {
            (Some(was), Some(is)) => [was, is],
            _ => [executed(old), executed(new)],
        };
        let mut edits = Self::default();
        for (name, before) in &was {
            // A program that one revision alone calls isn't edited: its call is.
            let Some(now) = is.get(name) else { continue };
            for [of_old, of_new] in gaps(before, now) {
                edits.add([&before[of_old], &now[of_new]]);
            }
        }
        for (side, by_step) in edits.by_step.iter_mut().enumerate() {
            let reached =
                edits.all.iter().enumerate().filter_map(|(edit, one)| Some((one.reached[side]?, edit)));
            by_step.extend(reached);
            by_step.sort_unstable();
        }
        edits
    }

    fn add(&mut self, sides: [&[TextBlock]; 2]) {
        let reached = sides.map(|blocks| blocks.iter().filter_map(|block| block.reached).min());
        if reached == [None, None] {
            return;
        }
        let first = |blocks: &[TextBlock]| {
            let executed = blocks.iter().find(|block| block.reached.is_some());
            executed.or(blocks.first()).map(|block| block.place.clone())
        };
        for (blocks, of_block) in sides.iter().zip(&mut self.of_block) {
            for BlockLocation { program, line, .. } in blocks.iter().map(|block| &block.place) {
                of_block.entry(program.clone()).or_default().insert(*line, self.all.len());
            }
        }
        self.all.push(Edit { blocks: sides.map(first), reached });
    }

    pub(super) fn len(&self) -> usize {
        self.all.len()
    }

    /// There is only one edit.
    pub(super) fn is_single(&self) -> bool {
        self.all.len() == 1
    }

    /// The edit that blocks belong to, or the outermost call that leads to them.
    pub(super) fn of(&self, blocks: [Option<&BlockLocation>; 2]) -> Option<usize> {
        let of = |side: usize| self.of_side(side, blocks[side]?);
        match (of(0), of(1)) {
            (Some(old), Some(new)) => Some(old.min(new)),
            (old, new) => old.or(new),
        }
    }

    fn of_side(&self, side: usize, block: &BlockLocation) -> Option<usize> {
        let find = |block: &BlockLocation| self.of_block[side].get(&block.program)?.get(&block.line).copied();
        block.calls.iter().rev().chain([block]).find_map(find)
    }

    /// The edit that an effect at these blocks and steps comes from: theirs, else the last one executed before the steps.
    pub(super) fn cause(
        &self,
        blocks: [Option<&BlockLocation>; 2],
        steps: [Option<usize>; 2],
    ) -> Option<usize> {
        let only = || self.is_single().then_some(0);
        self.of(blocks).or_else(only).or_else(|| self.last_before(steps))
    }

    fn last_before(&self, steps: [Option<usize>; 2]) -> Option<usize> {
        let last = |side: usize| {
            let (step, by_step) = (steps[side]?, &self.by_step[side]);
            let (reached, edit) =
                by_step[..by_step.partition_point(|(reached, _)| *reached <= step)].last()?;
            Some((step - reached, *edit))
        };
        [last(0), last(1)].into_iter().flatten().min().map(|(_, edit)| edit)
    }

    /// The blocks of the only edit, where an effect names others.
    pub(super) fn blocks(&self, named: [Option<&BlockLocation>; 2]) -> Option<&[Option<BlockLocation>; 2]> {
        let [Edit { blocks, .. }] = &self.all[..] else { return None };
        let is_named = (0..2).all(|side| match (named[side], &blocks[side]) {
            (Some(block), Some(_)) => self.of_side(side, block).is_some(),
            (None, None) => true,
            _ => false,
        });
        (!is_named).then_some(blocks)
    }

    /// Edits of these lines alone.
    #[cfg(test)]
    pub(super) fn of_lines(lines: &[u32]) -> Self {
        let mut edits = Self::default();
        for line in lines {
            let place = |block: &str| BlockLocation {
                program: "O0001".to_owned(),
                line: *line,
                block: block.to_owned(),
                calls: Vec::new(),
            };
            let [old, new] = ["X1.", "X2."].map(|block| [TextBlock::new(place(block), Some(0))]);
            edits.add([&old, &new]);
        }
        edits
    }
}

/// The edits that effects come from, by the blocks and steps that they name.
pub(super) struct Causes<'a> {
    edits: &'a Edits,
    records: [&'a Record; 2],
    /// The first step of each block, old and new.
    first: [BTreeMap<&'a BlockLocation, usize>; 2],
}

impl<'a> Causes<'a> {
    pub(super) fn new(edits: &'a Edits, records: [&'a Record; 2]) -> Self {
        let first = records.map(|record| {
            let mut first = BTreeMap::new();
            for (number, step) in record.steps.iter().enumerate() {
                first.entry(&record.places[step.place]).or_insert(number);
            }
            first
        });
        Self { edits, records, first }
    }

    /// Of an effect that its own blocks tell of. How a run ends comes from all before it.
    pub(super) fn of(&self, effect: &Effect) -> Vec<usize> {
        let blocks = [effect.old.as_ref(), effect.new.as_ref()];
        let first = |side: usize| self.first[side].get(blocks[side]?).copied();
        let steps = match &*effect.code {
            "outcome" => self.records.map(|record| Some(record.steps.len())),
            _ => [first(0), first(1)],
        };
        self.edits.cause(blocks, steps).into_iter().collect()
    }

    /// Of an effect about holes: every edit of a feed or a tool that makes it so.
    pub(super) fn of_holes(&self, HoleEffect { effect, steps, tools }: &HoleEffect) -> Vec<usize> {
        let place =
            |side: usize, place: usize| self.edits.of_side(side, self.records[side].places.get(place)?);
        let tools = (0..2).filter_map(|side| place(side, tools[side]?));
        let feed = |side: usize| {
            let places = steps[side].iter().map(move |step| self.records[side].steps[*step].place);
            places.filter_map(move |one| place(side, one))
        };
        let edits: BTreeSet<usize> = tools.chain((0..2).flat_map(feed)).collect();
        if edits.is_empty() { self.of(effect) } else { edits.into_iter().collect() }
    }
}

/// A block of a program's text that says something.
struct TextBlock {
    place: BlockLocation,
    /// Without sequence number, comments and spaces.
    words: String,
    /// How many steps the run has made when it first executes the block.
    reached: Option<usize>,
}

impl TextBlock {
    fn new(place: BlockLocation, reached: Option<usize>) -> Self {
        // The comment of an alarm or a message is what it says.
        let has_message = ["#3000", "#3006"].iter().any(|variable| place.block.contains(variable));
        let words = if has_message { place.block.clone() } else { words(&place.block) };
        Self { place, words, reached }
    }
}

/// Blocks by the program's name; the main program has none.
type Programs = BTreeMap<String, Vec<TextBlock>>;

/// Every block of every program that was read; `None` for a record of a file.
fn written(record: &Record) -> Option<Programs> {
    let sources = record.sources.as_ref()?;
    let mut programs = Programs::new();
    for (source, text) in sources.iter() {
        for program in parse(source, &text.bytes) {
            let name = program.name.label();
            let blocks = program.blocks.iter().map(|block| {
                let place = BlockLocation {
                    program: name.clone(),
                    line: sources.line_column(block.span).line,
                    block: sources.text(block.span).trim().to_owned(),
                    calls: Vec::new(),
                };
                TextBlock::new(place, record.reached.get(&(source, block.span.start)).copied())
            });
            let blocks: Vec<TextBlock> = blocks.filter(|block| !block.words.is_empty()).collect();
            programs.insert(if programs.is_empty() { String::new() } else { name }, blocks);
        }
    }
    Some(programs)
}

/// The blocks that steps and their calls name.
fn executed(record: &Record) -> Programs {
    let mut found: BTreeMap<(&str, u32), (&BlockLocation, usize)> = BTreeMap::new();
    let mut is_known = vec![false; record.places.len()];
    let mut main = record.program.as_deref();
    for (number, step) in record.steps.iter().enumerate() {
        if std::mem::replace(&mut is_known[step.place], true) {
            continue;
        }
        let place = &record.places[step.place];
        for block in place.calls.iter().rev().chain([place]) {
            main = main.or(Some(&block.program));
            found.entry((&block.program, block.line)).or_insert((block, number));
        }
    }
    let mut programs = Programs::new();
    for ((program, _), (block, reached)) in found {
        let place = BlockLocation { calls: Vec::new(), ..block.clone() };
        let name = if Some(program) == main { String::new() } else { program.to_owned() };
        programs.entry(name).or_default().push(TextBlock::new(place, Some(reached)));
    }
    programs
}

/// Where two texts are different: block by block where as many stand on either side. Blocks that are gone in one place and
/// new in another are one gap.
fn gaps(before: &[TextBlock], now: &[TextBlock]) -> Vec<[Range<usize>; 2]> {
    let pairs = common(before.len(), now.len(), |i, j| before[i].words == now[j].words);
    let mut gaps: Vec<[Range<usize>; 2]> = Vec::new();
    let (mut i, mut j) = (0, 0);
    for (to_i, to_j) in pairs.into_iter().chain([(before.len(), now.len())]) {
        match (to_i - i, to_j - j) {
            (0, 0) => {}
            (n, m) if n == m => gaps.extend((0..n).map(|k| [i + k..i + k + 1, j + k..j + k + 1])),
            _ => gaps.push([i..to_i, j..to_j]),
        }
        (i, j) = (to_i + 1, to_j + 1);
    }
    let text =
        |blocks: &[TextBlock]| blocks.iter().map(|block| block.words.as_str()).collect::<Vec<_>>().join("\n");
    let new = gaps.iter().filter(|gap| gap[0].is_empty());
    let mut moved: BTreeMap<String, Range<usize>> =
        new.map(|gap| (text(&now[gap[1].clone()]), gap[1].clone())).collect();
    let mut taken = Vec::new();
    for gap in gaps.iter_mut().filter(|gap| gap[1].is_empty()) {
        if let Some(range) = moved.remove(&text(&before[gap[0].clone()])) {
            taken.push(range.clone());
            gap[1] = range;
        }
    }
    gaps.retain(|gap| !(gap[0].is_empty() && taken.contains(&gap[1])));
    gaps
}

#[cfg(test)]
mod tests {
    use super::*;

    fn blocks(text: &str) -> Vec<TextBlock> {
        let block = |(line, block): (usize, &str)| BlockLocation {
            program: "O0001".to_owned(),
            line: line as u32,
            block: block.to_owned(),
            calls: Vec::new(),
        };
        text.lines().enumerate().map(|line| TextBlock::new(block(line), Some(line.0))).collect()
    }

    fn found(old: &str, new: &str) -> Vec<[Range<usize>; 2]> {
        gaps(&blocks(old), &blocks(new))
    }

    #[test]
    fn blocks_written_anew_are_one_gap_each() {
        assert_eq!(found("G0\nX1.\nY1.\nM30", "N5 G0\nX2.\nY2. (HERE)\nM30"), [[1..2, 1..2], [2..3, 2..3]]);
        assert_eq!(found("G0\nX1.\nM30", "G0\nX1. Y1.\nX2.\nM30"), [[1..2, 1..3]]);
        assert_eq!(found("G0\nM30", "G0\nM0\nM30"), [[1..1, 1..2]]);
    }

    #[test]
    fn a_block_that_moves_is_one_gap() {
        assert_eq!(found("M0\nX1.\nX2.\nM30", "X1.\nX2.\nM0\nM30"), [[0..1, 2..3]]);
    }

    #[test]
    fn the_text_of_a_message_is_no_comment() {
        assert_eq!(found("#3006=1(A)", "#3006=1(B)").len(), 1);
        assert_eq!(found("G0 (A)", "G0 (B)").len(), 0);
    }
}
