//! What is said about the motion: one finding per kind and block, however often the block runs.
use std::collections::BTreeMap;

use crate::diag::Diagnostic;
use crate::motion::Place;

/// Findings in the order in which they first came up.
#[derive(Debug, Default)]
pub(super) struct Findings {
    list: Vec<(Diagnostic, u64)>,
    /// By what tells one kind from another, and where.
    seen: BTreeMap<(&'static str, u32, u32, u32), usize>,
}

impl Findings {
    /// Makes the finding the first time; later it is only counted.
    pub(super) fn add(
        &mut self,
        code: &'static str,
        place: &Place,
        detail: u32,
        make: impl FnOnce() -> Diagnostic,
    ) {
        let key = (code, place.block.source.0, place.block.start, detail);
        match self.seen.get(&key) {
            Some(index) => self.list[*index].1 += 1,
            None => {
                self.seen.insert(key, self.list.len());
                self.list.push((make().at(place.clone()), 1));
            }
        }
    }

    pub(super) fn finish(self) -> Vec<Diagnostic> {
        let told = self.list.into_iter().map(|(finding, times)| match times {
            1 => finding,
            2 => finding.note("and once more at the same block"),
            _ => finding.note(format!("and {} more times at the same block", times - 1)),
        });
        told.collect()
    }
}
