//! The blocks of a record by their numbers. Those of a run are known by program and index; their text is read again.
use std::borrow::Cow;
use std::collections::BTreeMap;
use std::sync::Arc;

use super::block_location::BlockLocation;
use gcode_lang::motion::{Backtrace, CallChain};
use gcode_lang::program::{BlockTexts, Memory};
use gcode_lang::source::{Sources, Span};

/// Blocks by their numbers, in the order in which a run names them.
#[derive(Clone, Debug)]
pub(super) enum BlockList {
    /// Blocks of a record from a file.
    Listed(Vec<BlockLocation>),
    /// Blocks of a run.
    Executed(Box<ExecutedBlocks>),
}

/// A block of a run: its program in the memory, and its index there.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct BlockKey {
    program: u32,
    index: u32,
}

/// Program number of spans that are no block of a program; they are listed.
const OTHER: u32 = u32::MAX;

/// Number of steps before a block that is not executed.
const NOT_REACHED: u32 = u32::MAX;

/// Mark of a block that was never executed as a whole.
const IN_PART: u32 = 1 << 31;

/// Consecutive blocks of one call with consecutive numbers.
#[derive(Clone, Copy, Debug)]
struct NumberRun {
    first_number: u32,
    calls: u32,
    first: BlockKey,
}

/// A program of which a run executes blocks.
#[derive(Clone, Debug)]
struct ExecutedProgram {
    span: Span,
    texts: BlockTexts,
    /// Number of steps before the first execution of each block, with [`IN_PART`].
    reached: Vec<u32>,
}

/// Blocks that a run executes, with their numbers.
#[derive(Clone, Debug, Default)]
pub(super) struct BlockNumbers {
    programs: BTreeMap<u32, ExecutedProgram>,
    others: Vec<Span>,
    /// Calls by their numbers from 1: number of the outer call, and calling block.
    calls: Vec<(u32, BlockKey)>,
    call_numbers: BTreeMap<(u32, BlockKey), u32>,
    runs: Vec<NumberRun>,
    /// Number of blocks and first number of each run, by its calls and its first block.
    known: BTreeMap<(u32, BlockKey), (u32, u32)>,
    count: u32,
    last_program: u32,
    last_key: Option<(Span, BlockKey)>,
    last_calls: (CallChain, u32),
}

impl BlockNumbers {
    /// Records that the next block is executed after some steps, and whether as a whole.
    pub(super) fn reach(&mut self, memory: &Memory, block: Span, steps: usize, is_whole: bool) {
        if self.program_of(block).is_none() {
            let Some(id) = memory.id_at(block) else { return };
            let program = memory.get(id);
            let texts = program.block_texts().clone();
            let reached = vec![NOT_REACHED; texts.count()];
            self.programs.insert(id.0, ExecutedProgram { span: program.span, texts, reached });
        }
        let BlockKey { program, index } = self.key(block);
        let Some(program) = self.programs.get_mut(&program) else { return };
        let reached = &mut program.reached[index as usize];
        if *reached == NOT_REACHED {
            *reached = steps as u32 | IN_PART;
        }
        if is_whole {
            *reached &= !IN_PART;
        }
    }

    /// Corrects the numbers of steps before the blocks for removed steps, whose numbers are sorted.
    pub(super) fn remove_steps(&mut self, removed: &[usize]) {
        let reached = self.programs.values_mut().flat_map(|program| &mut program.reached);
        for reached in reached.filter(|reached| **reached != NOT_REACHED) {
            let steps = (*reached & !IN_PART) as usize;
            *reached -= removed.partition_point(|step| *step < steps) as u32;
        }
    }

    /// Returns the number of a block and its calls.
    pub(super) fn number(&mut self, backtrace: &Backtrace) -> usize {
        let key = self.key(backtrace.block);
        let calls = self.calls_number(&backtrace.calls);
        let before = self.known.range(..=(calls, key)).next_back();
        if let Some((&(of_calls, first), &(length, first_number))) = before
            && (of_calls, first.program) == (calls, key.program)
            && key.index - first.index < length
        {
            return (first_number + key.index - first.index) as usize;
        }
        let number = self.count;
        self.count += 1;
        if let Some(run) = self.runs.last()
            && (run.calls, run.first.program) == (calls, key.program)
            && key.index.checked_sub(run.first.index) == Some(number - run.first_number)
            && let Some((length, _)) = self.known.get_mut(&(calls, run.first))
        {
            *length += 1;
        } else {
            self.runs.push(NumberRun { first_number: number, calls, first: key });
            self.known.insert((calls, key), (1, number));
        }
        number as usize
    }

    fn key(&mut self, block: Span) -> BlockKey {
        if let Some((known, key)) = self.last_key.filter(|(known, _)| known.source == block.source) {
            if known.start == block.start {
                return key;
            }
            // The next block of the same program.
            let next = BlockKey { index: key.index + 1, ..key };
            let texts = self.programs.get(&key.program).map(|program| &program.texts);
            if texts.is_some_and(|texts| {
                (next.index as usize) < texts.count() && texts.start(next.index as usize) == block.start
            }) {
                self.last_key = Some((block, next));
                return next;
            }
        }
        let found = self.program_of(block).and_then(|program| {
            let index = self.programs[&program].texts.index_at(block.start)?;
            Some(BlockKey { program, index: index as u32 })
        });
        let key = found.unwrap_or_else(|| {
            let known = self.others.iter().position(|other| *other == block);
            let index = known.unwrap_or_else(|| {
                self.others.push(block);
                self.others.len() - 1
            });
            BlockKey { program: OTHER, index: index as u32 }
        });
        self.last_key = Some((block, key));
        key
    }

    /// Returns the number of the executed program that contains a block.
    fn program_of(&mut self, block: Span) -> Option<u32> {
        let is_in = |program: &ExecutedProgram| {
            let span = program.span;
            span.source == block.source && span.start <= block.start && block.start <= span.end
        };
        if !self.programs.get(&self.last_program).is_some_and(is_in) {
            self.last_program =
                self.programs.iter().find(|(_, program)| is_in(program)).map(|(id, _)| *id)?;
        }
        Some(self.last_program)
    }

    fn calls_number(&mut self, calls: &CallChain) -> u32 {
        let Some(call) = calls else { return 0 };
        if let (Some(last), number) = &self.last_calls
            && Arc::ptr_eq(last, call)
        {
            return *number;
        }
        let outer = self.calls_number(&call.outer_calls);
        let caller = self.key(call.calling_block);
        let new = self.calls.len() as u32 + 1;
        let number = *self.call_numbers.entry((outer, caller)).or_insert(new);
        if number == new {
            self.calls.push((outer, caller));
        }
        self.last_calls = (Some(call.clone()), number);
        number
    }

    /// Returns block and calls of a number.
    fn entry(&self, number: usize) -> (BlockKey, u32) {
        let behind = self.runs.partition_point(|run| run.first_number as usize <= number);
        let run = &self.runs[behind - 1];
        let index = run.first.index + (number as u32 - run.first_number);
        (BlockKey { index, ..run.first }, run.calls)
    }

    /// Iterates over the blocks of a chain of calls, the innermost first.
    fn callers(&self, calls: u32) -> impl Iterator<Item = BlockKey> {
        let call = |number: u32| number.checked_sub(1).map(|index| self.calls[index as usize]);
        std::iter::successors(call(calls), move |(outer, _)| call(*outer)).map(|(_, caller)| caller)
    }

    fn span(&self, key: BlockKey) -> Span {
        match self.programs.get(&key.program) {
            Some(program) => program.texts.span(key.index as usize),
            None => self.others[key.index as usize],
        }
    }

    fn start(&self, key: BlockKey) -> Span {
        match self.programs.get(&key.program) {
            Some(program) => {
                let start = program.texts.start(key.index as usize);
                Span { source: program.texts.source(), start, end: start }
            }
            None => self.others[key.index as usize],
        }
    }

    /// Returns the place where a numbered block begins.
    pub(super) fn start_of(&self, number: usize) -> Span {
        self.start(self.entry(number).0)
    }
}

/// Blocks that a run executed, and the programs of its memory.
#[derive(Clone, Debug)]
pub(super) struct ExecutedBlocks {
    numbers: BlockNumbers,
    pub sources: Sources,
    pub programs: Vec<MemoryProgram>,
}

/// A program of the memory as text.
#[derive(Clone, Debug)]
pub(super) struct MemoryProgram {
    pub label: String,
    /// Label with the folder of a memory dump.
    path: String,
    span: Span,
    pub texts: BlockTexts,
}

impl ExecutedBlocks {
    pub(super) fn new(mut numbers: BlockNumbers, memory: &Memory) -> Self {
        numbers.last_calls = Default::default();
        let programs = memory.programs().iter().map(|program| MemoryProgram {
            label: program.label(),
            path: program.path(),
            span: program.span,
            texts: program.block_texts().clone(),
        });
        Self { numbers, sources: memory.sources().clone(), programs: programs.collect() }
    }

    /// Returns a name of a program that no other program of the memory has: its label, else with its folder, else with its
    /// place among those of the same folder.
    pub(super) fn unique_name(&self, number: usize) -> String {
        let MemoryProgram { label, path, .. } = &self.programs[number];
        if self.programs.iter().filter(|other| other.label == *label).count() == 1 {
            return label.clone();
        }
        let before = self.programs[..number].iter().filter(|other| other.path == *path).count();
        if before == 0 { path.clone() } else { format!("{path} {}", before + 1) }
    }

    /// Returns the name of the program that contains a span.
    fn label(&self, span: Span) -> &str {
        let before =
            |program: &MemoryProgram| (program.span.source, program.span.end) < (span.source, span.start);
        let found = self.programs.get(self.programs.partition_point(before));
        let is_in =
            |program: &&MemoryProgram| program.span.source == span.source && program.span.start <= span.start;
        found.filter(is_in).map_or(&self.sources.get(span.source).name, |program| &program.label)
    }

    fn place(&self, key: BlockKey) -> (&str, u32) {
        let start = self.numbers.start(key);
        (self.label(start), self.sources.line_column(start).line)
    }

    fn location_of(&self, key: BlockKey) -> BlockLocation {
        let (program, line) = self.place(key);
        let block = self.sources.text(self.numbers.span(key)).trim().to_owned();
        BlockLocation { program: program.to_owned(), line, block, calls: Vec::new() }
    }

    fn location(&self, number: usize) -> BlockLocation {
        let (key, calls) = self.numbers.entry(number);
        let calls = self.numbers.callers(calls).map(|caller| self.location_of(caller)).collect();
        BlockLocation { calls, ..self.location_of(key) }
    }

    /// Returns the first number of a block by its location.
    fn find(&self, location: &BlockLocation) -> Option<usize> {
        let of_program = |(program, found): (usize, &MemoryProgram)| {
            let lines = self.sources.get(found.texts.source()).line_range(location.line)?;
            (found.label == location.program).then(|| {
                let [first, end] = [lines.start, lines.end].map(|offset| found.texts.first_from(offset));
                (program as u32, first as u32, end as u32)
            })
        };
        let blocks: Vec<_> = self.programs.iter().enumerate().filter_map(of_program).collect();
        self.numbers
            .known
            .iter()
            .filter_map(|((_, of_run), (length, first_number))| {
                let numbers = blocks.iter().filter(|(program, ..)| *program == of_run.program);
                let numbers = numbers.flat_map(|(_, first, end)| {
                    let from = (*first).max(of_run.index);
                    (from..(*end).min(of_run.index + length)).map(|index| first_number + index - of_run.index)
                });
                numbers.map(|number| number as usize).find(|number| self.location(*number) == *location)
            })
            .min()
    }

    /// Returns the number of steps before the first execution of a block, and whether it was ever executed as a whole.
    pub(super) fn reached(&self, program: usize, index: usize) -> Option<(usize, bool)> {
        let reached = *self.numbers.programs.get(&(program as u32))?.reached.get(index)?;
        (reached != NOT_REACHED).then_some(((reached & !IN_PART) as usize, reached & IN_PART == 0))
    }
}

impl BlockList {
    /// Returns the number of blocks.
    pub(super) fn len(&self) -> usize {
        match self {
            Self::Listed(all) => all.len(),
            Self::Executed(executed) => executed.numbers.count as usize,
        }
    }

    /// Returns a block with its calls.
    pub(super) fn location(&self, number: usize) -> Cow<'_, BlockLocation> {
        match self {
            Self::Listed(all) => Cow::Borrowed(&all[number]),
            Self::Executed(executed) => Cow::Owned(executed.location(number)),
        }
    }

    /// Returns the first number of a block.
    pub(super) fn find(&self, location: &BlockLocation) -> Option<usize> {
        match self {
            Self::Listed(all) => all.iter().position(|block| block == location),
            Self::Executed(executed) => executed.find(location),
        }
    }

    /// Returns the first result of a function of program and line: of the outermost call first, of the block itself
    /// last.
    pub(super) fn find_from_outermost<T>(
        &self,
        number: usize,
        mut of: impl FnMut(&str, u32) -> Option<T>,
    ) -> Option<T> {
        match self {
            Self::Listed(all) => {
                all[number].outermost_first().find_map(|block| of(&block.program, block.line))
            }
            Self::Executed(executed) => {
                let (key, calls) = executed.numbers.entry(number);
                let mut chain = vec![key];
                chain.extend(executed.numbers.callers(calls));
                chain.into_iter().rev().find_map(|key| {
                    let (program, line) = executed.place(key);
                    of(program, line)
                })
            }
        }
    }
}
