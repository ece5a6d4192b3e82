//! What a run records for its caller: counts, stops, notes, printed lines. No program can read any of it.
use std::collections::BTreeMap;

use super::notes::Note;
use super::outcome::OperatorStop;
use gcode_lang::motion::{Backtrace, StopKind};
use gcode_lang::program::modes::WorkSystem;
use gcode_lang::source::Span;

/// As many operator stops are kept; a program that loops over M00 must not fill the memory.
const MAX_STOPS: usize = 10_000;

/// The record of a run.
#[derive(Clone, Debug)]
pub(super) struct RunLog {
    pub(super) blocks: u64,
    pub(super) moves: u64,
    /// The run ends beyond this number of moves.
    pub(super) max_moves: u64,
    pub(super) stops: Vec<OperatorStop>,
    pub(super) printed: PrintedLines,
    /// M codes that went to the machine builder's logic, with the block of the first of each.
    pub(super) auxiliary_codes: BTreeMap<u32, Span>,
    /// Each note with the first block it is about.
    pub(super) notes: BTreeMap<Note, Span>,
    /// Where the work coordinate system in effect was selected.
    pub(super) work_selected: Backtrace,
    /// Systems that the run has moved in while nothing had set them, with where each was selected.
    pub(super) unset_systems: Vec<(WorkSystem, Backtrace)>,
}

impl Default for RunLog {
    fn default() -> Self {
        Self {
            blocks: 0,
            moves: 0,
            max_moves: u64::MAX,
            stops: Vec::new(),
            printed: PrintedLines::default(),
            auxiliary_codes: BTreeMap::new(),
            notes: BTreeMap::new(),
            work_selected: Backtrace::default(),
            unset_systems: Vec::new(),
        }
    }
}

impl RunLog {
    /// Keeps a note with the first block it is about.
    pub(super) fn note(&mut self, note: Note, block: Span) {
        self.notes.entry(note).or_insert(block);
    }

    /// Keeps an operator stop, as long as there aren't too many.
    #[inline(never)]
    pub(super) fn record_stop(&mut self, kind: StopKind, text: &str, variables: &[(u32, f64)]) {
        if self.stops.len() < MAX_STOPS {
            self.stops.push(OperatorStop { kind, text: text.to_owned(), variables: variables.to_vec() });
        }
    }
}

/// Lines printed so far, without their ends.
#[derive(Clone, Debug, Default)]
pub(super) struct PrintedLines {
    pub(super) lines: Vec<Vec<u8>>,
    /// Their length with their ends.
    pub(super) bytes: usize,
}

#[cfg(test)]
mod tests {
    use gcode_lang::source::SourceId;

    use super::*;

    #[test]
    fn a_note_keeps_its_first_block_and_stops_are_counted_out() {
        let mut log = RunLog::default();
        let block = |start| Span { source: SourceId(0), start, end: start + 1 };
        log.note(Note::NoAngle, block(4));
        log.note(Note::NoAngle, block(9));
        assert_eq!(log.notes.get(&Note::NoAngle), Some(&block(4)));
        for _ in 0..=MAX_STOPS {
            log.record_stop(StopKind::M00, "", &[]);
        }
        assert_eq!(log.stops.len(), MAX_STOPS);
    }
}
