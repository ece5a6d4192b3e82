//! One entry for each block and kind, with how often it came up: a loop does the same at its block over and over.
use std::collections::BTreeMap;

use gcode_lang::diag::Diagnostic;
use gcode_lang::source::Span;

/// Entries in the order in which they first came up; `K` tells kinds at one block from one another.
#[derive(Clone, Debug)]
pub(crate) struct PerBlock<K, T> {
    list: Vec<Counted<T>>,
    index: BTreeMap<(u32, u32, K), usize>,
}

/// What came up, and how often.
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
    /// Counts one more at a block. The first makes the entry; of a later one the caller sees what is there.
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

/// With a note of how often more it came up at its block.
pub(crate) fn with_repeat_note(finding: Diagnostic, times: u64) -> Diagnostic {
    match times {
        0 | 1 => finding,
        2 => finding.note("once more at the same block"),
        _ => finding.note(format!("{} more times at the same block", times - 1)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use gcode_lang::source::SourceId;

    #[test]
    fn a_block_has_one_entry_for_each_kind_in_the_order_of_the_first() {
        let block = |start| Span { source: SourceId(0), start, end: start + 1 };
        let mut per = PerBlock::default();
        for (start, kind) in [(9, 'a'), (3, 'a'), (9, 'b'), (9, 'a')] {
            per.count(block(start), kind, || (start, kind));
        }
        let all: Vec<_> = per.into_entries().map(|entry| (entry.value, entry.count)).collect();
        assert_eq!(all, [((9, 'a'), 2), ((3, 'a'), 1), ((9, 'b'), 1)]);
    }
}
