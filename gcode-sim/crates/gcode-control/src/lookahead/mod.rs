//! What the control has read and not yet done: cutter compensation and corner words need the next move before they
//! know where one ends.
//!
//! Everything above this module works on the programmed path; here it becomes the path of the tool's centre. Moves
//! go through two stages: corner words shape the path ([`corner_words`]), compensation puts the centre beside it
//! ([`cutter_compensation`]). Each holds back one move; what comes behind a move that waits, waits as well. What is told keeps
//! the place of its own block.
mod buffer;
mod corner_words;
mod cutter_compensation;
mod path_move;
mod pending;
mod request;

pub(super) use self::buffer::Lookahead;
pub(super) use self::pending::ReadyEvent;
pub(super) use self::request::{CornerArc, LookaheadRequest};
