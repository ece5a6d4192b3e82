//! Edits: blocks that two revisions write differently, and the edit that causes an effect.
use std::collections::{BTreeMap, BTreeSet};

use super::change::Effect;
use super::hole_groups::HoleEffect;
use super::program_text::{TextBlock, executed, gaps, written};
use super::record::{BlockLocation, Record};

/// A block that is written differently, or consecutive blocks that are added, removed, moved or rewritten together.
#[derive(Clone, Debug)]
pub(super) struct Edit {
    /// Its first executed block, old and new; `None` if it has none.
    pub blocks: [Option<BlockLocation>; 2],
    /// Number of steps of each run before its first execution.
    reached: [Option<usize>; 2],
}

/// All edits that one of the runs executes.
#[derive(Clone, Debug, Default)]
pub(super) struct Edits {
    all: Vec<Edit>,
    /// Edits by program and line, old and new.
    of_block: [BTreeMap<String, BTreeMap<u32, usize>>; 2],
    /// Number of steps before each edit, and the edit, in that order; old and new.
    by_step: [Vec<(usize, usize)>; 2],
}

impl Edits {
    /// Compares the programs' texts; of a record without texts the blocks that steps and their calls name.
    pub(super) fn new(old: &Record, new: &Record) -> Self {
        let programs = match (written(old), written(new)) {
            (Some(was), Some(is)) => [was, is],
            _ => [executed(old), executed(new)],
        };
        let [was, is] = programs.map(|all| all.into_iter().collect::<BTreeMap<_, _>>());
        let mut edits = Self::default();
        for (name, before) in &was {
            // The edit of a program that one revision alone calls is its call.
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
            executed.or(blocks.first()).map(|block| block.location.clone())
        };
        for (blocks, of_block) in sides.iter().zip(&mut self.of_block) {
            for BlockLocation { program, line, .. } in blocks.iter().map(|block| &block.location) {
                of_block.entry(program.clone()).or_default().insert(*line, self.all.len());
            }
        }
        self.all.push(Edit { blocks: sides.map(first), reached });
    }

    pub(super) fn len(&self) -> usize {
        self.all.len()
    }

    /// Returns true if there is one edit only.
    pub(super) fn is_single(&self) -> bool {
        self.all.len() == 1
    }

    /// Returns the edit of the outermost call of blocks, or of the blocks themselves.
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

    /// Returns the edit that causes an effect at these blocks and steps: theirs, else the last one before the
    /// steps.
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

    /// Returns the blocks of the only edit if an effect names others.
    pub(super) fn blocks(&self, named: [Option<&BlockLocation>; 2]) -> Option<&[Option<BlockLocation>; 2]> {
        let [Edit { blocks, .. }] = &self.all[..] else { return None };
        let is_named = (0..2).all(|side| match (named[side], &blocks[side]) {
            (Some(block), Some(_)) => self.of_side(side, block).is_some(),
            (None, None) => true,
            _ => false,
        });
        (!is_named).then_some(blocks)
    }

    /// Returns edits of single lines.
    #[cfg(test)]
    pub(super) fn of_lines(lines: &[u32]) -> Self {
        let mut edits = Self::default();
        for line in lines {
            let location = |block: &str| BlockLocation {
                program: "O0001".to_owned(),
                line: *line,
                block: block.to_owned(),
                calls: Vec::new(),
            };
            let [old, new] = ["X1.", "X2."].map(|block| [TextBlock::new(location(block), Some(0))]);
            edits.add([&old, &new]);
        }
        edits
    }
}

/// Finds the edits that cause effects, by the blocks and steps of these.
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
                first.entry(&record.blocks[step.block_number]).or_insert(number);
            }
            first
        });
        Self { edits, records, first }
    }

    /// Returns the edit of an effect by its blocks; the outcome of a run depends on all steps, its name on none.
    pub(super) fn of(&self, effect: &Effect) -> Vec<usize> {
        let blocks = [effect.old.as_ref(), effect.new.as_ref()];
        let first = |side: usize| self.first[side].get(blocks[side]?).copied();
        let steps = match &*effect.code {
            "program" => return Vec::new(),
            "outcome" => self.records.map(|record| Some(record.steps.len())),
            _ => [first(0), first(1)],
        };
        self.edits.cause(blocks, steps).into_iter().collect()
    }

    /// Returns the edits of an effect on holes: those of its feeds and tools.
    pub(super) fn of_holes(&self, HoleEffect { effect, steps, tools }: &HoleEffect) -> Vec<usize> {
        let edit =
            |side: usize, number: usize| self.edits.of_side(side, self.records[side].blocks.get(number)?);
        let tools = (0..2).filter_map(|side| edit(side, tools[side]?));
        let feed = |side: usize| {
            let numbers = steps[side].iter().map(move |step| self.records[side].steps[*step].block_number);
            numbers.filter_map(move |number| edit(side, number))
        };
        let edits: BTreeSet<usize> = tools.chain((0..2).flat_map(feed)).collect();
        if edits.is_empty() { self.of(effect) } else { edits.into_iter().collect() }
    }
}
