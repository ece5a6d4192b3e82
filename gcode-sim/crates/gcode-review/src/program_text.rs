//! Texts of two revisions' programs: their blocks, and where these are written differently.
use std::collections::BTreeMap;
use std::ops::Range;

use schemars::JsonSchema;
use serde::Serialize;

use super::align::common;
use super::record::{BlockLocation, Record, Revision};
use gcode_lang::source::SourceId;
use gcode_lang::syntax::parse;

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
    let mut depth = 0;
    let code = block.chars().filter(|c| {
        let is_comment = depth > 0 || *c == '(';
        depth += i32::from(*c == '(') - i32::from(*c == ')');
        !is_comment && !c.is_whitespace()
    });
    let code: String = code.collect();
    let number = code.strip_prefix('N').map(|rest| rest.trim_start_matches(|c: char| c.is_ascii_digit()));
    number.unwrap_or(&code).to_owned()
}

/// A block with words.
pub(super) struct TextBlock {
    pub location: BlockLocation,
    /// Without sequence number, comments and spaces.
    words: String,
    /// Number of steps before its first execution; `None` if it is not executed.
    pub reached: Option<usize>,
    /// Source and offset; `None` for a block known from a record alone.
    key: Option<(SourceId, u32)>,
}

impl TextBlock {
    pub(super) fn new(location: BlockLocation, reached: Option<usize>) -> Self {
        // The comment of an alarm or a message is its text.
        let has_message = ["#3000", "#3006"].iter().any(|variable| location.block.contains(variable));
        let words = if has_message { location.block.clone() } else { words(&location.block) };
        Self { location, words, reached, key: None }
    }
}

/// Programs by their names in the order in which they were read; the main program has none.
pub(super) type Programs = Vec<(String, Vec<TextBlock>)>;

/// Returns every block of every program; `None` for a record of a file.
pub(super) fn written(record: &Record) -> Option<Programs> {
    let sources = record.sources.as_ref()?;
    let mut programs = Programs::new();
    for (source, text) in sources.iter() {
        for program in parse(source, &text.bytes) {
            let name = program.name.label();
            let blocks = program.blocks.iter().map(|block| {
                let location = BlockLocation {
                    program: name.clone(),
                    line: sources.line_column(block.span).line,
                    block: sources.text(block.span).trim().to_owned(),
                    calls: Vec::new(),
                };
                let key = (source, block.span.start);
                TextBlock {
                    key: Some(key),
                    ..TextBlock::new(location, record.executed.get(&key).map(|(reached, _)| *reached))
                }
            });
            let blocks: Vec<TextBlock> = blocks.filter(|block| !block.words.is_empty()).collect();
            programs.push((if programs.is_empty() { String::new() } else { name }, blocks));
        }
    }
    Some(programs)
}

/// Returns the blocks that steps and their calls name.
pub(super) fn executed(record: &Record) -> Programs {
    let mut found: BTreeMap<(&str, u32), (&BlockLocation, usize)> = BTreeMap::new();
    let mut is_known = vec![false; record.blocks.len()];
    let mut main = record.program.as_deref();
    for (number, step) in record.steps.iter().enumerate() {
        if std::mem::replace(&mut is_known[step.block_number], true) {
            continue;
        }
        let location = &record.blocks[step.block_number];
        for block in location.calls.iter().rev().chain([location]) {
            main = main.or(Some(&block.program));
            found.entry((&block.program, block.line)).or_insert((block, number));
        }
    }
    let mut programs: BTreeMap<String, Vec<TextBlock>> = BTreeMap::new();
    for ((program, _), (block, reached)) in found {
        let location = BlockLocation { calls: Vec::new(), ..block.clone() };
        let name = if Some(program) == main { String::new() } else { program.to_owned() };
        programs.entry(name).or_default().push(TextBlock::new(location, Some(reached)));
    }
    programs.into_iter().collect()
}

/// Returns the ranges of blocks between equal ones.
fn between(pairs: Vec<(usize, usize)>, ends: (usize, usize)) -> impl Iterator<Item = [Range<usize>; 2]> {
    let mut from = (0, 0);
    pairs.into_iter().chain([ends]).map(move |(i, j)| {
        let (first_i, first_j) = std::mem::replace(&mut from, (i + 1, j + 1));
        [first_i..i, first_j..j]
    })
}

/// Returns the passages in which two texts differ: block by block if both have the same number of blocks there. A
/// deletion and an insertion of the same blocks are one gap.
pub(super) fn gaps(before: &[TextBlock], now: &[TextBlock]) -> Vec<[Range<usize>; 2]> {
    let pairs = common(before.len(), now.len(), |i, j| before[i].words == now[j].words);
    let mut gaps: Vec<[Range<usize>; 2]> = Vec::new();
    for [old, new] in between(pairs, (before.len(), now.len())) {
        if old.len() == new.len() {
            gaps.extend(old.zip(new).map(|(i, j)| [i..i + 1, j..j + 1]));
        } else {
            gaps.push([old, new]);
        }
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

/// An unexecuted changed block, old and new; only one of them if it is added or removed.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, JsonSchema)]
pub struct UnexecutedChange {
    /// The block of the old revision.
    pub old: Option<BlockLocation>,
    /// The block of the new revision.
    pub new: Option<BlockLocation>,
}

/// Returns the changed blocks of programs of both revisions that no run executed as a whole, in their order: their
/// effect is unknown.
pub fn unexecuted(old: &Revision, new: &Revision) -> Vec<UnexecutedChange> {
    let [was, is] = [old, new].map(|revision| {
        let programs = written(&revision.record).unwrap_or_default().into_iter();
        let programs = programs.map(|(name, blocks)| {
            let blocks = blocks.into_iter().map(|block| (words(&block.location.block), block));
            (name, blocks.filter(|(words, _)| !words.is_empty()).collect::<Vec<_>>())
        });
        programs.collect::<Vec<_>>()
    });
    let idle = |revision: &Revision, blocks: &[(String, TextBlock)]| {
        let is_done = |block: &TextBlock| {
            block
                .key
                .and_then(|key| revision.record.executed.get(&key))
                .is_some_and(|(_, is_whole)| *is_whole)
        };
        let blocks = blocks.iter().map(|(_, block)| block).filter(|block| !is_done(block));
        blocks.map(|block| block.location.clone()).collect::<Vec<_>>().into_iter()
    };
    let mut all = Vec::new();
    for (name, before) in &was {
        let Some((_, now)) = is.iter().find(|(other, _)| other == name) else { continue };
        if !name.is_empty() && (before.is_empty() || now.is_empty()) {
            continue;
        }
        let pairs = common(before.len(), now.len(), |i, j| before[i].0 == now[j].0);
        for [of_old, of_new] in between(pairs, (before.len(), now.len())) {
            let (mut lost, mut added) = (idle(old, &before[of_old]), idle(new, &now[of_new]));
            let changes = std::iter::from_fn(|| match (lost.next(), added.next()) {
                (None, None) => None,
                (old, new) => Some(UnexecutedChange { old, new }),
            });
            all.extend(changes);
        }
    }
    all
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
    fn each_rewritten_block_is_one_gap() {
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
