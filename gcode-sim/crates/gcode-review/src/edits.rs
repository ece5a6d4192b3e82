//! Edits: blocks that two revisions write differently, and the edit that causes an effect.
use std::cell::OnceCell;
use std::collections::{BTreeMap, BTreeSet};

use super::block_location::BlockLocation;
use super::change::Effect;
use super::hole_groups::HoleEffect;
use super::other_blocks::sides;
use super::program_text::{ProgramSide, for_each_gap};
use super::record::Record;

/// A block that is written differently, or consecutive blocks that are added, removed, moved or rewritten together.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Edit {
    /// Number of its program among those of both revisions.
    program: u32,
    /// Its first executed block, old and new; [`NONE`] if it has none.
    first: [u32; 2],
    /// Number of steps of each run before its first execution; [`NONE`] without one.
    reached: [u32; 2],
}

/// No block, no number of steps.
const NONE: u32 = u32::MAX;

impl Edit {
    /// Returns the edit of the same kind that many blocks later.
    fn later(self, count: u32) -> Self {
        let later = |all: [u32; 2]| all.map(|one| if one == NONE { NONE } else { one.saturating_add(count) });
        Self { first: later(self.first), reached: later(self.reached), ..self }
    }
}

/// Edits by their numbers; consecutive blocks that make one step each need little memory.
#[derive(Default)]
struct EditList {
    runs: Vec<EditRun>,
    count: u32,
}

/// Edits of consecutive blocks.
struct EditRun {
    /// Number of edits before it.
    start: u32,
    first: Edit,
}

impl EditList {
    fn push(&mut self, edit: Edit) {
        let is_next = |run: &EditRun| run.first.later(self.count - run.start) == edit;
        if !self.runs.last().is_some_and(is_next) {
            self.runs.push(EditRun { start: self.count, first: edit });
        }
        self.count += 1;
    }

    fn len(&self) -> usize {
        self.count as usize
    }

    /// Returns an edit by its number.
    ///
    /// # Panics
    /// If the list has no edit with this number.
    fn get(&self, number: u32) -> Edit {
        let run = &self.runs[self.runs.partition_point(|run| run.start <= number) - 1];
        run.first.later(number - run.start)
    }

    /// Iterates over the edits in their order.
    fn iter(&self) -> impl Iterator<Item = Edit> {
        let ends = self.runs.iter().skip(1).map(|run| run.start).chain([self.count]);
        let edits = |(run, end): (&EditRun, u32)| {
            let (start, first) = (run.start, run.first);
            (start..end).map(move |number| first.later(number - start))
        };
        self.runs.iter().zip(ends).flat_map(edits)
    }

    /// Returns the number of the first edit of which a function is false; it is true of all edits before that.
    fn partition_point(&self, is_before: impl Fn(Edit) -> bool) -> usize {
        let (mut low, mut high) = (0, self.count);
        while low < high {
            let middle = u32::midpoint(low, high);
            match is_before(self.get(middle)) {
                true => low = middle + 1,
                false => high = middle,
            }
        }
        low as usize
    }
}

/// Consecutive lines of one edit, or each of the next one.
#[derive(Clone, Copy, Debug)]
struct LineRun {
    first: u32,
    count: u32,
    edit: u32,
    is_counting: bool,
}

/// All edits that one of the runs executes.
#[derive(Default)]
pub(super) struct Edits<'a> {
    programs: Vec<[ProgramSide<'a>; 2]>,
    all: EditList,
    /// Edits by program and line, old and new.
    of_line: [BTreeMap<String, Vec<LineRun>>; 2],
    /// Edits that a run executes, by the number of steps before them, old and new; `None` if all are in that order.
    by_step: [Option<Vec<u32>>; 2],
}

impl<'a> Edits<'a> {
    /// Compares the programs' texts, or what a file has of them.
    pub(super) fn new(old: &'a Record, new: &'a Record) -> Self {
        let by_name = |all: Vec<ProgramSide<'a>>| all.into_iter().map(|side| (side.name.clone(), side));
        let [was, mut is] = sides(old, new).map(|all| by_name(all).collect::<BTreeMap<_, _>>());
        // The edit of a program that one revision alone calls is its call.
        let shared = was.into_iter().filter_map(|(name, before)| Some([before, is.remove(&name)?]));
        Self::of_programs(shared.collect())
    }

    fn of_programs(programs: Vec<[ProgramSide<'a>; 2]>) -> Self {
        let mut edits = Self::default();
        for (number, [before, now]) in programs.iter().enumerate() {
            for_each_gap([before, now], |gap| edits.add(number as u32, [before, now], gap));
        }
        edits.programs = programs;
        for runs in edits.of_line.iter_mut().flat_map(BTreeMap::values_mut) {
            runs.sort_by_key(|run| run.first);
        }
        for side in 0..2 {
            let reached = || edits.all.iter().map(|edit| edit.reached[side]);
            if !reached().is_sorted() || reached().any(|steps| steps == NONE) {
                let numbered = (0..).zip(reached()).filter(|(_, steps)| *steps != NONE);
                let mut by_step: Vec<u32> = numbered.map(|(edit, _)| edit).collect();
                by_step.sort_by_key(|edit| edits.all.get(*edit).reached[side]);
                edits.by_step[side] = Some(by_step);
            }
        }
        edits
    }

    /// Adds an edit of some blocks of a program, old and new.
    fn add(&mut self, program: u32, sides: [&ProgramSide<'_>; 2], blocks: [&[u32]; 2]) {
        let reached = [0, 1].map(|side| {
            let reached = blocks[side].iter().filter_map(|block| sides[side].reached(*block as usize));
            reached.map(|(steps, _)| steps as u32).min().unwrap_or(NONE)
        });
        if reached == [NONE, NONE] {
            return;
        }
        let first = |side: usize| {
            let is_executed = |block: &&u32| sides[side].reached(**block as usize).is_some();
            blocks[side].iter().find(is_executed).or(blocks[side].first()).copied().unwrap_or(NONE)
        };
        let edit = self.all.len() as u32;
        for side in 0..2 {
            for block in blocks[side] {
                let (program, line) = sides[side].place(*block as usize);
                add_line(&mut self.of_line[side], program, line, edit);
            }
        }
        self.all.push(Edit { program, first: [first(0), first(1)], reached });
    }

    pub(super) fn len(&self) -> usize {
        self.all.len()
    }

    /// Returns true if there is one edit only.
    pub(super) fn is_single(&self) -> bool {
        self.all.len() == 1
    }

    fn of_place(&self, side: usize, program: &str, line: u32) -> Option<usize> {
        let runs = self.of_line[side].get(program)?;
        let run = &runs[runs.partition_point(|run| run.first <= line).checked_sub(1)?];
        let index = line - run.first;
        (index < run.count).then_some((run.edit + if run.is_counting { index } else { 0 }) as usize)
    }

    /// Returns the edit of the outermost call of numbered blocks, or of the blocks themselves.
    pub(super) fn of_numbers(&self, records: [&Record; 2], numbers: [Option<usize>; 2]) -> Option<usize> {
        let of = |side: usize| self.of_number(side, records[side], numbers[side]?);
        first_edit(of(0), of(1))
    }

    fn of_number(&self, side: usize, record: &Record, number: usize) -> Option<usize> {
        record.blocks.find_from_outermost(number, |program, line| self.of_place(side, program, line))
    }

    /// Returns the edit of the outermost call of blocks, or of the blocks themselves.
    fn of(&self, blocks: [Option<&BlockLocation>; 2]) -> Option<usize> {
        first_edit(self.of_side(0, blocks[0]), self.of_side(1, blocks[1]))
    }

    fn of_side(&self, side: usize, block: Option<&BlockLocation>) -> Option<usize> {
        block?.outermost_first().find_map(|block| self.of_place(side, &block.program, block.line))
    }

    /// Returns the edit that causes an effect at numbered blocks and steps: theirs, else the last one before the steps.
    pub(super) fn cause_of_numbers(
        &self,
        records: [&Record; 2],
        numbers: [Option<usize>; 2],
        steps: [Option<usize>; 2],
    ) -> Option<usize> {
        self.of_numbers(records, numbers).or_else(|| self.cause_of_steps(steps))
    }

    /// Returns the only edit, or the last one before some steps.
    fn cause_of_steps(&self, steps: [Option<usize>; 2]) -> Option<usize> {
        if self.is_single() {
            return Some(0);
        }
        let last = |side: usize| {
            let step = steps[side]? as u32;
            let is_before = |edit: Edit| edit.reached[side] <= step;
            let edit = match &self.by_step[side] {
                Some(by_step) => {
                    let behind = by_step.partition_point(|edit| is_before(self.all.get(*edit)));
                    by_step[behind.checked_sub(1)?]
                }
                None => self.all.partition_point(is_before).checked_sub(1)? as u32,
            };
            Some((step - self.all.get(edit).reached[side], edit as usize))
        };
        [last(0), last(1)].into_iter().flatten().min().map(|(_, edit)| edit)
    }

    /// Returns the blocks of the only edit if an effect names others.
    pub(super) fn blocks(&self, named: [Option<&BlockLocation>; 2]) -> Option<[Option<BlockLocation>; 2]> {
        if !self.is_single() {
            return None;
        }
        let Edit { program, first, .. } = self.all.get(0);
        let is_named = (0..2).all(|side| match (named[side], first[side]) {
            (Some(block), index) if index != NONE => self.of_side(side, Some(block)).is_some(),
            (None, NONE) => true,
            _ => false,
        });
        let block = |side: usize| {
            (first[side] != NONE)
                .then(|| self.programs[program as usize][side].location(first[side] as usize))
        };
        (!is_named).then(|| [block(0), block(1)])
    }

    /// Returns edits of single lines.
    #[cfg(test)]
    pub(super) fn of_lines(lines: &[u32]) -> Self {
        let program = |lines: &[u32], block: &str| {
            let location = |line: &u32| BlockLocation {
                program: "O0001".to_owned(),
                line: *line,
                block: block.to_owned(),
                calls: Vec::new(),
            };
            let blocks = lines.iter().map(|line| (location(line), Some((0, true))));
            ProgramSide::named(String::new(), blocks.collect())
        };
        Self::of_programs(vec![["X1.", "X2."].map(|block| program(lines, block))])
    }
}

/// Adds the edit of a line.
fn add_line(of_line: &mut BTreeMap<String, Vec<LineRun>>, program: &str, line: u32, edit: u32) {
    if !of_line.contains_key(program) {
        of_line.insert(program.to_owned(), Vec::new());
    }
    let Some(runs) = of_line.get_mut(program) else { return };
    if let Some(run) = runs.last_mut()
        && run.first + run.count == line
    {
        let is_first = run.count == 1;
        let last = run.edit + if run.is_counting { run.count - 1 } else { 0 };
        let (is_next, is_same) = (edit == last + 1, edit == last);
        if is_next && (run.is_counting || is_first) || is_same && (!run.is_counting || is_first) {
            (run.count, run.is_counting) = (run.count + 1, is_next);
            return;
        }
    }
    runs.push(LineRun { first: line, count: 1, edit, is_counting: false });
}

/// Returns the first of the edits of both sides.
fn first_edit(old: Option<usize>, new: Option<usize>) -> Option<usize> {
    match (old, new) {
        (Some(old), Some(new)) => Some(old.min(new)),
        (old, new) => old.or(new),
    }
}

/// Finds the edits that cause effects, by the blocks and steps of these.
pub(super) struct Causes<'a> {
    edits: &'a Edits<'a>,
    records: [&'a Record; 2],
    /// The first step of each block by its number, old and new.
    first: [OnceCell<Vec<u32>>; 2],
}

impl<'a> Causes<'a> {
    pub(super) fn new(edits: &'a Edits<'a>, records: [&'a Record; 2]) -> Self {
        Self { edits, records, first: Default::default() }
    }

    /// Returns the first step of a block.
    fn first(&self, side: usize, block: Option<&BlockLocation>) -> Option<usize> {
        let record = self.records[side];
        let number = record.blocks.find(block?)?;
        let first = self.first[side].get_or_init(|| {
            let mut first = vec![NONE; record.blocks.len()];
            for step in (0..record.steps.len()).rev() {
                first[record.steps.block_number(step)] = step as u32;
            }
            first
        });
        (first[number] != NONE).then_some(first[number] as usize)
    }

    /// Returns the edit of an effect by its blocks; the outcome of a run depends on all steps, its name on none.
    pub(super) fn of(&self, effect: &Effect) -> Vec<usize> {
        let blocks = [effect.old.as_ref(), effect.new.as_ref()];
        if effect.code == "program" {
            return Vec::new();
        }
        let cause = self.edits.of(blocks).or_else(|| {
            self.edits.cause_of_steps(match &*effect.code {
                "outcome" => self.records.map(|record| Some(record.steps.len())),
                _ => [self.first(0, blocks[0]), self.first(1, blocks[1])],
            })
        });
        cause.into_iter().collect()
    }

    /// Returns the edits of an effect on holes: those of its feeds and tools.
    pub(super) fn of_holes(&self, HoleEffect { effect, steps, tools }: &HoleEffect) -> Vec<usize> {
        let edit = |side: usize, number: usize| self.edits.of_number(side, self.records[side], number);
        let tools = (0..2).filter_map(|side| edit(side, tools[side]?));
        let feed = |side: usize| {
            let numbers = steps[side].iter().map(move |step| self.records[side].steps.block_number(*step));
            numbers.filter_map(move |number| edit(side, number))
        };
        let edits: BTreeSet<usize> = tools.chain((0..2).flat_map(feed)).collect();
        if edits.is_empty() { self.of(effect) } else { edits.into_iter().collect() }
    }
}
