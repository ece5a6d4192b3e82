//! What a block leaves behind for the run: something to tell, or its end. Most leave nothing, which is one question.
use std::cell::Cell;

use super::notes::Note;

#[derive(Clone, Debug, Default)]
pub(super) struct BlockEffects {
    has_effects: Cell<bool>,
    /// What the block has to tell.
    note: Cell<Option<Note>>,
    /// How it has ended the run.
    run_end: Cell<Option<RunEnd>>,
}

impl BlockEffects {
    pub(super) fn is_none(&self) -> bool {
        !self.has_effects.get()
    }

    pub(super) fn record_note(&self, note: Note) {
        self.note.set(Some(note));
        self.has_effects.set(true);
    }

    pub(super) fn end_run(&self, run_end: RunEnd) {
        self.run_end.set(Some(run_end));
        self.has_effects.set(true);
    }

    /// Whether the block has ended the run.
    pub(super) fn is_run_ended(&self) -> bool {
        self.run_end.get().is_some()
    }

    /// What there is, which is then no more.
    pub(super) fn take(&self) -> (Option<Note>, Option<RunEnd>) {
        self.has_effects.set(false);
        (self.note.take(), self.run_end.take())
    }

    /// Does what leaves nothing behind.
    pub(super) fn without_effects<T>(&self, inspect: impl FnOnce() -> T) -> T {
        let before = (self.has_effects.get(), self.note.get(), self.run_end.get());
        let result = inspect();
        self.has_effects.set(before.0);
        self.note.set(before.1);
        self.run_end.set(before.2);
        result
    }
}

/// How a block can end the run without an alarm.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum RunEnd {
    ProgramEnd,
    /// It is in a loop that never ends.
    EndlessLoop,
    /// It has made more moves than it may.
    MoveLimit,
}
