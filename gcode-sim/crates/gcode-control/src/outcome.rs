//! Limits, end and record of a run: no program can read any of it.
use std::cell::{Cell, RefCell};
use std::collections::{BTreeMap, BTreeSet};
use std::sync::atomic::{AtomicBool, AtomicU64};

use super::notes::Note;
use gcode_lang::alarm::Alarm;
use gcode_lang::motion::{Backtrace, StopKind};
use gcode_lang::program::modes::{GroupSet, WorkSystem};
use gcode_lang::source::Span;

/// Limit of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Limits {
    /// Largest number of blocks executed, macro statements included.
    pub blocks: u64,
}

impl Default for Limits {
    fn default() -> Self {
        Self { blocks: 10_000_000 }
    }
}

/// Progress of a run, shared with the thread that waits for it.
#[derive(Debug, Default)]
pub struct Progress {
    /// Number of blocks executed, updated at intervals.
    pub blocks: AtomicU64,
    /// Set by the waiting thread: the run ends with [`Outcome::Limit`] and keeps its results so far.
    pub cancel: AtomicBool,
}

/// End of a run.
#[derive(Clone, Debug)]
pub enum Outcome {
    /// M02, M30, the M99 that ends the run, or the end of the program.
    End,
    /// An alarm has stopped the control.
    Alarm(AlarmStop),
    /// The limit of blocks or of moves, [`Progress::cancel`], or a loop that provably never ends:
    /// [`Control::endless_loop`](super::Control::endless_loop).
    Limit,
}

/// Alarm that has stopped the control.
#[derive(Clone, Debug)]
pub struct AlarmStop {
    /// Alarm.
    pub alarm: Alarm,
    /// Part of the block that the alarm is about.
    pub span: Span,
    /// Block and the calls that led to it.
    pub backtrace: Backtrace,
}

/// Stop until the operator continues.
#[derive(Clone, Debug, PartialEq)]
pub struct OperatorStop {
    /// Cause.
    pub kind: StopKind,
    /// Message text; empty without one.
    pub text: String,
    /// Variables that the text names, with their values.
    pub variables: Vec<(u32, f64)>,
}

/// Effects of a block on the run: notes, or the end. Most blocks have none.
#[derive(Clone, Debug, Default)]
pub(super) struct BlockEffects {
    /// Number of executed blocks at which the run pauses; 0 after an effect, so that one comparison tests both.
    pause: Cell<u64>,
    notes: RefCell<BTreeSet<Note>>,
    run_end: Cell<Option<RunEnd>>,
}

impl BlockEffects {
    /// Lets the run execute up to this number of blocks; must not be 0.
    #[inline(always)]
    pub(super) fn set_pause(&self, blocks: u64) {
        self.pause.set(blocks);
    }

    /// Returns true if the run pauses after this number of blocks, because of their number or an effect.
    #[inline(always)]
    pub(super) fn is_pause(&self, blocks: u64) -> bool {
        blocks >= self.pause.get()
    }

    /// Returns true if no block has had an effect since [`BlockEffects::set_pause`].
    #[inline(always)]
    pub(super) fn is_none(&self) -> bool {
        self.pause.get() != 0
    }

    pub(super) fn record_note(&self, note: Note) {
        self.notes.borrow_mut().insert(note);
        self.pause.set(0);
    }

    pub(super) fn end_run(&self, run_end: RunEnd) {
        self.run_end.set(Some(run_end));
        self.pause.set(0);
    }

    /// Returns true if a block has ended the run.
    pub(super) fn is_run_ended(&self) -> bool {
        self.run_end.get().is_some()
    }

    /// Takes the effects; none is left.
    pub(super) fn take(&self) -> (BTreeSet<Note>, Option<RunEnd>) {
        (self.notes.take(), self.run_end.take())
    }

    /// Runs a function and discards its effects.
    pub(super) fn without_effects<T>(&self, inspect: impl FnOnce() -> T) -> T {
        let (pause, notes, run_end) = (self.pause.get(), self.notes.take(), self.run_end.get());
        let result = inspect();
        self.pause.set(pause);
        self.notes.replace(notes);
        self.run_end.set(run_end);
        result
    }
}

/// End of a run without an alarm.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum RunEnd {
    ProgramEnd,
    /// The program is in a loop that never ends.
    EndlessLoop,
    /// The run has exceeded its number of moves.
    MoveLimit,
}

/// Largest number of operator stops kept; a program that loops over M00 must not fill the memory.
const MAX_STOPS: usize = 10_000;

/// Work offset that the run has used before anything set it.
#[derive(Clone, Debug)]
pub struct UnsetWorkOffset {
    /// Work coordinate system.
    pub system: WorkSystem,
    /// Axes used without an offset, as bits.
    pub axes: u8,
    /// Something has set the offset of another axis.
    pub is_partly_set: bool,
    /// Block that selected the system first.
    pub selected: Backtrace,
}

/// Record of a run.
#[derive(Clone, Debug, Default)]
pub(super) struct RunLog {
    pub(super) blocks: u64,
    pub(super) moves: u64,
    /// Number of moves beyond which the run ends.
    pub(super) max_moves: u64,
    pub(super) stops: Vec<OperatorStop>,
    /// Printed lines without their ends.
    pub(super) printed: Vec<Vec<u8>>,
    /// Length of the printed lines with their ends.
    pub(super) printed_bytes: usize,
    /// M codes for the machine builder's logic, each with its first block.
    pub(super) builder_m_codes: BTreeMap<u32, Span>,
    /// Notes, each with its first block.
    pub(super) notes: BTreeMap<Note, Span>,
    /// Block that selected the active work coordinate system.
    pub(super) work_selected: Backtrace,
    pub(super) unset_systems: Vec<UnsetWorkOffset>,
    /// Axes that blocks have placed in the coordinates of G54, as bits.
    pub(super) first_placed_axes: u8,
    /// The same of the other work coordinate systems.
    pub(super) other_placed_axes: BTreeMap<WorkSystem, u8>,
    /// A length offset counts behind G53 although a parameter may have cancelled it.
    pub(super) restores_length: bool,
    /// Modal groups that a block has commanded, without group 01.
    pub(super) commanded_groups: GroupSet,
    /// Those that a move preceded, or a canned cycle G98 and G99.
    pub(super) late_groups: GroupSet,
    /// A canned cycle has drilled.
    pub(super) has_drilled: bool,
    /// The text of the main program has ended without M02, M30 or M99.
    pub(super) lacks_end: bool,
}

impl RunLog {
    /// Returns a copy without stops and printed lines.
    pub(super) fn without_lists(&self) -> Self {
        let Self {
            stops: _,
            printed: _,
            builder_m_codes,
            notes,
            work_selected,
            unset_systems,
            other_placed_axes,
            ..
        } = self;
        Self {
            stops: Vec::new(),
            printed: Vec::new(),
            builder_m_codes: builder_m_codes.clone(),
            notes: notes.clone(),
            work_selected: work_selected.clone(),
            unset_systems: unset_systems.clone(),
            other_placed_axes: other_placed_axes.clone(),
            ..*self
        }
    }

    /// Records a note with its first block.
    pub(super) fn note(&mut self, note: Note, block: Span) {
        self.notes.entry(note).or_insert(block);
    }

    /// Records an operator stop, up to [`MAX_STOPS`].
    #[inline(never)]
    pub(super) fn record_stop(&mut self, kind: StopKind, text: &str, variables: &[(u32, f64)]) {
        if self.stops.len() < MAX_STOPS {
            self.stops.push(OperatorStop { kind, text: text.to_owned(), variables: variables.to_vec() });
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use gcode_lang::source::SourceId;

    #[test]
    fn a_note_keeps_its_first_block_and_the_number_of_stops_is_limited() {
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
