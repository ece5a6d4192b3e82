//! What is said about the motion: one finding per kind and block, however often the block runs.
use super::per_block::{PerBlock, with_repeat_note};
use gcode_lang::diag::{Diagnostic, FindingKind};
use gcode_lang::motion::Backtrace;

/// Findings in the order in which they first came up, by what tells one kind from another.
#[derive(Debug, Default)]
pub(super) struct Findings(PerBlock<(&'static str, u32), Diagnostic>);

impl Findings {
    /// Makes the finding the first time; later it is only counted.
    pub(super) fn add(
        &mut self,
        kind: &'static FindingKind,
        place: &Backtrace,
        detail: u32,
        make: impl FnOnce(&'static FindingKind) -> Diagnostic,
    ) {
        self.0.count(place.block, (kind.code, detail), || make(kind).with_backtrace(place.clone()));
    }

    pub(super) fn finish(self) -> Vec<Diagnostic> {
        self.0.into_entries().map(|entry| with_repeat_note(entry.value, entry.count)).collect()
    }
}
