//! Entries counted per block and kind: a loop repeats them at its blocks.
use std::collections::BTreeMap;

use gcode_lang::diag::{Diagnostic, FindingKind};
use gcode_lang::motion::Backtrace;
use gcode_lang::source::{SourceId, Span};

/// Entries in order of first occurrence; `K` distinguishes kinds at one block.
#[derive(Clone, Debug)]
pub(crate) struct PerBlock<K, T> {
    list: Vec<Counted<T>>,
    index: BTreeMap<(u32, u32, K), usize>,
}

/// An entry and its number of occurrences.
#[derive(Clone, Debug)]
pub(crate) struct Counted<T> {
    pub value: T,
    pub count: u64,
}

impl<K, T> Default for PerBlock<K, T> {
    fn default() -> Self {
        Self { list: Vec::new(), index: BTreeMap::new() }
    }
}

impl<K: Ord, T> PerBlock<K, T> {
    /// Counts an occurrence at a block; `first` makes the entry. Returns the entry and its index.
    pub(crate) fn count(
        &mut self,
        block: Span,
        kind: K,
        first: impl FnOnce() -> T,
    ) -> (usize, &mut Counted<T>) {
        let next = self.list.len();
        let index = *self.index.entry((block.source.0, block.start, kind)).or_insert(next);
        if index == next {
            self.list.push(Counted { value: first(), count: 0 });
        }
        let entry = &mut self.list[index];
        entry.count += 1;
        (index, entry)
    }

    pub(crate) fn get_mut(&mut self, index: usize) -> Option<&mut Counted<T>> {
        self.list.get_mut(index)
    }

    pub(crate) fn into_entries(self) -> impl Iterator<Item = Counted<T>> {
        self.list.into_iter()
    }
}

/// Findings about motion: one per block, code and detail, or one in the program.
#[derive(Debug, Default)]
pub(super) struct Findings {
    list: PerBlock<(&'static str, u32), Diagnostic>,
    /// Findings of which one counts all occurrences, by code and detail, with their index in the list and their number.
    in_program: BTreeMap<(&'static str, u32), (usize, u64)>,
}

impl Findings {
    /// Makes the finding on its first occurrence; later ones are counted.
    pub(super) fn add(
        &mut self,
        kind: &'static FindingKind,
        backtrace: &Backtrace,
        detail: u32,
        make: impl FnOnce(&'static FindingKind) -> Diagnostic,
    ) {
        self.list
            .count(backtrace.block, (kind.code, detail), || make(kind).with_backtrace(backtrace.clone()));
    }

    /// Returns true if a block has the finding.
    pub(super) fn has(&self, kind: &'static FindingKind, block: Span, detail: u32) -> bool {
        self.list.index.contains_key(&(block.source.0, block.start, (kind.code, detail)))
    }

    /// Makes the finding on its first occurrence in the program, and counts all; these are `count`.
    pub(super) fn add_in_program(
        &mut self,
        kind: &'static FindingKind,
        backtrace: &Backtrace,
        detail: u32,
        count: u64,
        make: impl FnOnce(&'static FindingKind) -> Diagnostic,
    ) {
        let list = &mut self.list;
        let entry = self.in_program.entry((kind.code, detail)).or_insert_with(|| {
            let first = || make(kind).with_backtrace(backtrace.clone());
            (list.count(backtrace.block, (kind.code, detail), first).0, 0)
        });
        entry.1 += count;
    }

    /// Appends findings of blocks.
    pub(super) fn append(&mut self, other: Self) {
        let mut entries: Vec<_> = other.list.index.into_iter().collect();
        entries.sort_unstable_by_key(|(_, index)| *index);
        for (((source, start, kind), _), other) in entries.into_iter().zip(other.list.list) {
            let block = Span { source: SourceId(source), start, end: start };
            let (_, entry) = self.list.count(block, kind, || other.value);
            entry.count += other.count - 1;
        }
    }

    pub(super) fn finish(self) -> Vec<Diagnostic> {
        let mut counts = vec![None; self.list.list.len()];
        for (index, count) in self.in_program.into_values() {
            counts[index] = Some(count);
        }
        let entries = self.list.into_entries().zip(counts);
        entries
            .map(|(entry, in_program)| match in_program {
                Some(count) => with_count_note(entry.value, count),
                None => with_repeat_note(entry.value, entry.count),
            })
            .collect()
    }
}

/// Adds a note with the number of further occurrences at the block.
pub(crate) fn with_repeat_note(finding: Diagnostic, count: u64) -> Diagnostic {
    match count {
        0 | 1 => finding,
        2 => finding.note("once more at the same block"),
        _ => finding.note(format!("{} more times at the same block", count - 1)),
    }
}

/// Adds a note with the number of further occurrences in the program.
pub(super) fn with_count_note(finding: Diagnostic, count: u64) -> Diagnostic {
    match count {
        0 | 1 => finding,
        2 => finding.note("once more in the program"),
        _ => finding.note(format!("{} more times in the program", count - 1)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_block_has_one_entry_per_kind_in_order_of_first_occurrence() {
        let block = |start| Span { source: SourceId(0), start, end: start + 1 };
        let mut per = PerBlock::default();
        for (start, kind) in [(9, 'a'), (3, 'a'), (9, 'b'), (9, 'a')] {
            per.count(block(start), kind, || (start, kind));
        }
        let all: Vec<_> = per.into_entries().map(|entry| (entry.value, entry.count)).collect();
        assert_eq!(all, [((9, 'a'), 2), ((3, 'a'), 1), ((9, 'b'), 1)]);
    }
}
