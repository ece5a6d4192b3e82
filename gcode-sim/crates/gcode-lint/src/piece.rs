//! Piece of a long program: consecutive blocks that control enters at the first and leaves behind the last.
use gcode_lang::program::OpIndex;
use gcode_lang::program::modes::Unit;
use gcode_lang::source::Span;

use super::locals::Locals;
use super::possible_modes::PossibleModes;
use super::possible_units::PossibleUnits;
use super::role::Role;

/// Place of a piece in its program, and what the pieces before it leave.
#[derive(Clone, Debug)]
pub(crate) struct Piece {
    /// Role of the whole program.
    pub role: Role,
    pub start: PieceStart,
    /// Blocks to which jumps of other pieces lead.
    pub entries: Vec<PieceEntry>,
    /// Blocks that jump behind the piece, each with the index of its target.
    pub far_jumps: Vec<(OpIndex, usize)>,
    /// Blocks before this one can be left out: an earlier piece jumps over them.
    pub left_out_until: OpIndex,
    pub is_first: bool,
    pub is_last: bool,
}

/// Block, or node of the control flow, to which jumps of other pieces lead, with the states that they bring.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct PieceEntry {
    pub block: OpIndex,
    pub modes: PossibleModes,
    /// States of the locals; `None` if the conditions of these jumps are never true.
    pub locals: Option<Locals>,
    pub pending_move: Option<Span>,
}

impl PieceEntry {
    /// Adds the states of another jump to the same block.
    pub(super) fn join(&mut self, other: Self) {
        self.modes = self.modes.join(other.modes);
        match (&mut self.locals, other.locals) {
            (Some(mine), Some(others)) => mine.join(others),
            (mine, others) => *mine = mine.or(others),
        }
        self.pending_move = later(self.pending_move, other.pending_move);
    }
}

/// Returns the later one of two moves, of which either may be in progress.
pub(crate) fn later(one: Option<Span>, other: Option<Span>) -> Option<Span> {
    one.into_iter().chain(other).max_by_key(|span| span.start)
}

/// State before the first block of a piece.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PieceStart {
    pub modes: PossibleModes,
    pub locals: Locals,
    /// Move that may still be in progress.
    pub pending_move: Option<Span>,
    /// Units that the blocks before it command, and the unit in which they are judged.
    pub units: (PossibleUnits, Option<Unit>),
    /// A block before it may end the program, or jump anywhere.
    pub may_be_left_out: bool,
}

impl PieceStart {
    /// Returns the state before the first block of a program.
    pub(super) fn of_program(role: Role) -> Self {
        let (modes, locals) = match role {
            Role::Main => (PossibleModes::POWER_ON, Locals::UNSET),
            Role::Called | Role::Resident => (PossibleModes::ANYTHING, Locals::ANYTHING),
        };
        let units = (PossibleUnits::default(), None);
        Self { modes, locals, pending_move: None, units, may_be_left_out: false }
    }
}
