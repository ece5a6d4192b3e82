//! What the control has read and not yet done: cutter compensation and corner words need the next move before they
//! know where one ends.
//!
//! Everything above this module works on the programmed path; here it becomes the path of the tool's centre. Moves
//! go through two stages: corner words shape the path ([`corner_words`]), compensation puts the centre beside it
//! ([`cutter_compensation`]). Each holds back one move; what comes behind a move that waits, waits as well. What is told keeps
//! the place of its own block.
mod corner_words;
mod cutter_compensation;
mod path_move;
mod request;

use path_move::{PathMove, PendingItem, ReadyEvent};
pub(super) use request::LookaheadRequest;

use self::corner_words::PendingCorner;
use self::cutter_compensation::{PendingCornerArc, PendingMove};
use super::Executor;
use super::eval::Checked;
use crate::contour::Point;
use gcode_lang::alarm::Alarm;
use gcode_lang::motion::{AxisIndex, Backtrace, EventKind, Position};
use gcode_lang::source::Span;

/// The state of reading ahead; `Default` where neither function is in use.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Lookahead {
    /// Where the programmed path has come to, in machine coordinates.
    at: Position,
    /// Where the tool's centre has come to by what was told.
    centre: Position,
    /// What the centre is beside the path after all that was read, as if nothing followed.
    offset: Position,
    plane: (AxisIndex, AxisIndex),
    /// The offset mode: a start-up move was read.
    on: bool,
    /// G41 or G42 stood again in a block without a move: the centre goes to beside the end of the block before.
    restated: bool,
    /// Blocks without a move in the plane since the last one with such a move.
    blocks_without_move: usize,
    corner: Option<PendingCorner>,
    open: Option<PendingMove>,
    /// What waits behind the open move.
    behind: Vec<PendingItem>,
    rounding: Option<PendingCornerArc>,
    ready: Vec<ReadyEvent>,
}

impl Lookahead {
    /// Whether nothing waits and the tool's centre is on the path.
    pub(super) fn is_idle(&self) -> bool {
        !self.on && self.corner.is_none() && !self.is_offset()
    }

    /// The offset mode, or a vector that G40 alone has left.
    pub(super) fn is_offset(&self) -> bool {
        self.on || self.offset != Position::default()
    }

    /// The offset mode, in which corners are looked at.
    pub(super) fn is_on(&self) -> bool {
        self.on
    }

    /// What the centre is beside the path, on an axis.
    pub(super) fn offset(&self, axis: AxisIndex) -> f64 {
        self.offset[axis]
    }

    /// Whether a move waits for the next.
    pub(super) fn waits(&self) -> bool {
        self.open.is_some() || self.corner.is_some()
    }

    /// What is to be told, and where it comes from.
    pub(super) fn told(&self) -> impl Iterator<Item = (&EventKind, &Backtrace)> + '_ {
        self.ready.iter().map(|(kind, _, place)| (kind, place))
    }

    /// Lets something wait behind the move that waits.
    pub(super) fn wait_behind(&mut self, kind: EventKind, place: Backtrace) {
        let held = PendingItem::Other(kind, 0.0, place);
        match &mut self.corner {
            Some(corner) => corner.behind.push(held),
            None => self.behind.push(held),
        }
    }

    /// Begins where the tool stands, if nothing has been read ahead.
    fn begin(&mut self, at: Position) {
        if self.is_idle() {
            (self.at, self.centre) = (at, at);
        }
    }

    /// Takes a block's events, on the programmed path, and holds back what waits for the next move.
    fn block(
        &mut self,
        core: &Executor,
        order: &LookaheadRequest,
        events: &[(EventKind, f64)],
    ) -> Checked<()> {
        self.plane = order.plane;
        if order.suspends_compensation {
            self.no_corner(order)?;
            self.settle(core)?;
        }
        if let Some(arc) = &order.corner_arc {
            self.no_corner(order)?;
            self.round(core, arc, order)?;
        }
        let mut moved = false;
        for (kind, seconds) in events {
            let Some(piece) = PathMove::new(kind, self.at, order) else {
                self.defer(core, PendingItem::Other(kind.clone(), *seconds, order.place.clone()));
                continue;
            };
            self.at = piece.to();
            moved |= piece.segment.is_some();
            if order.suspends_compensation {
                self.leave(core, &piece);
            } else {
                self.shape(core, piece, order)?;
            }
        }
        if order.blend.is_some() && self.corner.is_none() {
            return Err(Alarm::CornerTooLarge.at(order.place.block));
        }
        if !moved {
            self.without_move(core, order)?;
        }
        if order.blocks_lookahead {
            self.no_corner(order)?;
            self.settle(core)?;
        }
        Ok(())
    }

    /// A block that doesn't move in the plane is read over; several of them, one with a move of length 0, and the end
    /// of the offset mode leave the centre beside the end of the last move.
    fn without_move(&mut self, core: &Executor, order: &LookaheadRequest) -> Checked<()> {
        match &mut self.corner {
            Some(corner) if order.dwells && !corner.dwelt => corner.dwelt = true,
            Some(_) if order.counts => self.no_corner(order)?,
            _ => {}
        }
        self.restated |= self.on && order.restated;
        if self.on && order.distance.is_none() {
            if order.towards.is_some() {
                let what = "G40 with I, J, K and without a move".into();
                return Err(Alarm::NotSimulated { what }.at(order.place.block));
            }
            self.settle(core)?;
            self.on = false;
        }
        if order.counts && !order.suspends_compensation {
            self.count(core, order)?;
        }
        Ok(())
    }

    /// Counts a block without a move.
    fn count(&mut self, core: &Executor, order: &LookaheadRequest) -> Checked<()> {
        self.blocks_without_move += 1;
        if order.no_length || self.blocks_without_move + 2 > core.settings.blocks_read {
            self.settle(core)?;
        }
        Ok(())
    }

    /// A block that has only a sequence number.
    pub(super) fn count_number(&mut self, core: &Executor, block: Span) -> Checked<()> {
        if let Some(corner) = &self.corner {
            return Err(corner.no_move().at(block));
        }
        self.blocks_without_move += 1;
        if self.blocks_without_move + 2 > core.settings.blocks_read {
            self.settle(core)?;
        }
        Ok(())
    }

    /// Nothing but a dwell may stand between a corner word and the next move.
    fn no_corner(&self, order: &LookaheadRequest) -> Checked<()> {
        match &self.corner {
            Some(corner) => Err(corner.no_move().at(order.place.block)),
            None => Ok(()),
        }
    }

    /// The program ends: what waits is done, if nothing is against it.
    fn end(&mut self, core: &Executor, block: Span) -> Checked<()> {
        if let Some(corner) = &self.corner {
            return Err(corner.no_move().at(block));
        }
        self.settle(core)
    }

    /// Does all that waits before the run ends by an alarm. A move that would cut into the part, or go beyond the
    /// stroke, isn't begun.
    fn complete(&mut self, core: &Executor, refused: Option<Span>) {
        let stands = self.centre;
        if let Some(corner) = self.corner.take()
            && refused != Some(corner.piece.place.block)
        {
            let before = self.clone();
            match self.drive(core, corner.piece, &corner.order) {
                Ok(()) => corner.behind.into_iter().for_each(|held| self.defer(core, held)),
                // What can't be joined is left out: the run is over.
                Err(_) => *self = before,
            }
        }
        if self.open.as_ref().is_some_and(|open| refused == Some(open.piece.place.block)) {
            self.open = None;
        }
        if self.settle(core).is_err() {
            self.behind.clear();
        }
        if let Some(beyond) = self.ready.iter().position(|(kind, ..)| core.within_stroke(kind).is_err()) {
            self.ready.truncate(beyond);
            self.centre =
                self.ready.iter().rev().find_map(|(kind, ..)| kind.end().copied()).unwrap_or(stands);
        }
        for axis in 0..core.settings.axes.len() {
            self.offset[axis] = self.centre[axis] - self.at[axis];
        }
    }

    /// The point of a position in the plane.
    fn point(&self, position: &Position) -> Point {
        Point::new(position[self.plane.0], position[self.plane.1])
    }

    /// A position with another point in the plane.
    fn with(&self, mut position: Position, point: Point) -> Position {
        (position[self.plane.0], position[self.plane.1]) = (point.x, point.y);
        position
    }

    fn set_offset(&mut self, offset: Point) {
        self.offset = self.with(Position::default(), offset);
    }
}
