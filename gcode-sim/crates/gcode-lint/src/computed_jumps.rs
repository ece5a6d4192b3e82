//! States that the computed jumps of a program that is checked in pieces bring to its numbered blocks.
//!
//! A computed GOTO, an unreadable block and the return of a program that is not known may lead to each numbered block, also to
//! one of an earlier piece. The pieces are checked in passes, the first without such jumps. A pass that finds more states than
//! its first piece with a number began with is followed by one that begins with all of them.
use super::context::{CheckContext, ProgramUnit};
use super::modes::modes_before;
use super::piece::PieceEntry;
use super::vacancy::states_without_arguments;

/// What is known of the computed jumps of a program.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct ComputedJumps {
    /// The states of all of them so far; `None` if there is none.
    states: Option<PieceEntry>,
    /// Those that the first piece with a sequence number took into account.
    of_first_numbers: Option<Option<PieceEntry>>,
}

impl ComputedJumps {
    /// Returns the entry of a piece by these jumps: at the node from which all of its numbered blocks follow.
    pub(super) fn entry(&self, blocks: usize) -> Option<PieceEntry> {
        self.states.map(|states| PieceEntry { block: blocks + 1, ..states })
    }

    /// Adds the jumps of a piece that has the entry of the earlier ones.
    pub(super) fn add(&mut self, context: &CheckContext<'_>, unit: &ProgramUnit<'_>) {
        let node = unit.flow.computed_node();
        if let Some(modes) = modes_before(context, unit)[node] {
            let locals = states_without_arguments(unit)[node];
            self.states = Some(PieceEntry { block: 0, modes, locals, pending_move: None });
        }
        if unit.flow.has_numbers() {
            self.of_first_numbers.get_or_insert(self.states);
        }
    }

    /// Returns true if a piece was checked without some of the states that lead to its blocks.
    pub(super) fn are_outdated(&self) -> bool {
        self.of_first_numbers.is_some_and(|first| first != self.states)
    }

    /// Returns true if they lead from piece to piece, also back.
    pub(super) fn lead_back(&self) -> bool {
        self.of_first_numbers.is_some() && self.states.is_some()
    }

    /// Returns what the next pass begins with.
    pub(super) fn for_next_pass(self) -> Self {
        Self { of_first_numbers: None, ..self }
    }
}
