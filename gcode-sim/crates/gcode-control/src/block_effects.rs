//! What a block leaves behind for the run: something to tell, or its end. Most leave nothing, which is one question.
use std::cell::Cell;

use super::notes::Note;
use super::run::RunEnd;

#[derive(Clone, Debug, Default)]
pub(super) struct BlockEffects {
    some: Cell<bool>,
    /// What the block has to tell.
    note: Cell<Option<Note>>,
    /// How it has ended the run.
    over: Cell<Option<RunEnd>>,
}

impl BlockEffects {
    pub(super) fn is_none(&self) -> bool {
        !self.some.get()
    }

    pub(super) fn record_note(&self, note: Note) {
        self.note.set(Some(note));
        self.some.set(true);
    }

    pub(super) fn end_run(&self, over: RunEnd) {
        self.over.set(Some(over));
        self.some.set(true);
    }

    /// Whether the block has ended the run.
    pub(super) fn is_run_ended(&self) -> bool {
        self.over.get().is_some()
    }

    /// What there is, which is then no more.
    pub(super) fn take(&self) -> (Option<Note>, Option<RunEnd>) {
        self.some.set(false);
        (self.note.take(), self.over.take())
    }

    /// Does what leaves nothing behind.
    pub(super) fn without_effects<T>(&self, look: impl FnOnce() -> T) -> T {
        let before = (self.some.get(), self.note.get(), self.over.get());
        let seen = look();
        self.some.set(before.0);
        self.note.set(before.1);
        self.over.set(before.2);
        seen
    }
}
