//! The state of reading ahead: takes blocks on the programmed path and gives back events of the tool's centre.
use super::super::checked::ExecResult;
use super::super::data::ControlData;
use super::pending::{PathMove, PendingCorner, PendingCornerArc, PendingItem, PendingMove, ReadyEvent};
use super::request::LookaheadRequest;
use crate::contour::Point;
use gcode_lang::alarm::Alarm;
use gcode_lang::motion::{AxisIndex, Backtrace, EventKind, Position};
use gcode_lang::source::Span;

/// The state of reading ahead; `Default` where neither function is in use.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Lookahead {
    /// Where the programmed path has come to, in machine coordinates.
    pub(super) programmed_position: Position,
    /// Where the tool's centre has come to by what was told.
    pub(super) tool_centre: Position,
    /// What the centre is beside the path after all that was read, as if nothing followed.
    pub(super) offset: Position,
    pub(super) plane: (AxisIndex, AxisIndex),
    /// The offset mode: a start-up move was read.
    pub(super) is_compensating: bool,
    /// G41 or G42 stood again in a block without a move: the centre goes to beside the end of the block before.
    pub(super) is_restated: bool,
    /// Blocks without a move in the plane since the last one with such a move.
    pub(super) blocks_without_move: usize,
    pub(super) pending_corner: Option<PendingCorner>,
    pub(super) pending_move: Option<PendingMove>,
    /// What waits behind the open move.
    pub(super) pending_items: Vec<PendingItem>,
    pub(super) pending_corner_arc: Option<PendingCornerArc>,
    pub(super) ready: Vec<ReadyEvent>,
}

impl Lookahead {
    /// Whether nothing waits and the tool's centre is on the path.
    pub(crate) fn is_idle(&self) -> bool {
        !self.is_compensating && self.pending_corner.is_none() && !self.is_offset()
    }

    /// The offset mode, or a vector that G40 alone has left.
    pub(crate) fn is_offset(&self) -> bool {
        self.is_compensating || self.offset != Position::default()
    }

    /// The offset mode, in which corners are looked at.
    pub(crate) fn is_on(&self) -> bool {
        self.is_compensating
    }

    /// What the centre is beside the path, on an axis.
    pub(crate) fn offset(&self, axis: AxisIndex) -> f64 {
        self.offset[axis]
    }

    /// Whether a move waits for the next.
    pub(crate) fn has_pending_move(&self) -> bool {
        self.pending_move.is_some() || self.pending_corner.is_some()
    }

    /// What is to be told, and where it comes from.
    pub(crate) fn ready_events(&self) -> impl Iterator<Item = (&EventKind, &Backtrace)> + '_ {
        self.ready.iter().map(|(kind, _, place)| (kind, place))
    }

    /// Lets something wait behind the move that waits.
    pub(crate) fn push_pending(&mut self, kind: EventKind, backtrace: Backtrace) {
        let item = PendingItem::Other(kind, 0.0, backtrace);
        match &mut self.pending_corner {
            Some(corner) => corner.pending_items.push(item),
            None => self.pending_items.push(item),
        }
    }

    /// Begins where the tool stands, if nothing has been read ahead.
    pub(crate) fn start_at(&mut self, at: Position) {
        if self.is_idle() {
            (self.programmed_position, self.tool_centre) = (at, at);
        }
    }

    /// Takes a block's events, on the programmed path, and holds back what waits for the next move.
    pub(crate) fn process_block(
        &mut self,
        data: &ControlData,
        request: &LookaheadRequest,
        events: &[(EventKind, f64)],
    ) -> ExecResult<()> {
        self.plane = request.plane;
        if request.suspends_compensation {
            self.check_no_corner(request)?;
            self.close_pending_move(data)?;
        }
        if let Some(arc) = &request.corner_arc {
            self.check_no_corner(request)?;
            self.start_corner_arc(data, arc, request)?;
        }
        let mut has_moved = false;
        for (kind, seconds) in events {
            let Some(piece) = PathMove::new(kind, self.programmed_position, request) else {
                self.defer(data, PendingItem::Other(kind.clone(), *seconds, request.backtrace.clone()));
                continue;
            };
            self.programmed_position = piece.end_position();
            has_moved |= piece.segment.is_some();
            if request.suspends_compensation {
                self.suspend(data, &piece);
            } else {
                self.process_corner(data, piece, request)?;
            }
        }
        if request.blend.is_some() && self.pending_corner.is_none() {
            return Err(Alarm::CornerTooLarge.located_at(request.backtrace.block));
        }
        if !has_moved {
            self.process_block_without_move(data, request)?;
        }
        if request.blocks_lookahead {
            self.check_no_corner(request)?;
            self.close_pending_move(data)?;
        }
        Ok(())
    }

    /// A block that doesn't move in the plane is read over; several of them, one with a move of length 0, and the end
    /// of the offset mode leave the centre beside the end of the last move.
    fn process_block_without_move(
        &mut self,
        data: &ControlData,
        request: &LookaheadRequest,
    ) -> ExecResult<()> {
        match &mut self.pending_corner {
            Some(corner) if request.is_dwell && !corner.has_dwell => corner.has_dwell = true,
            Some(_) if request.counts_as_block => self.check_no_corner(request)?,
            _ => {}
        }
        self.is_restated |= self.is_compensating && request.is_restated;
        if self.is_compensating && request.distance.is_none() {
            if request.wall_direction.is_some() {
                let what = "G40 with I, J, K and without a move".into();
                return Err(Alarm::NotSimulated { what }.located_at(request.backtrace.block));
            }
            self.close_pending_move(data)?;
            self.is_compensating = false;
        }
        if request.counts_as_block && !request.suspends_compensation {
            self.count_block(data, request)?;
        }
        Ok(())
    }

    /// Counts a block without a move.
    fn count_block(&mut self, data: &ControlData, request: &LookaheadRequest) -> ExecResult<()> {
        self.blocks_without_move += 1;
        if request.has_zero_length || self.blocks_without_move + 2 > data.settings.lookahead_blocks {
            self.close_pending_move(data)?;
        }
        Ok(())
    }

    /// A block that has only a sequence number.
    pub(crate) fn count_number(&mut self, data: &ControlData, block: Span) -> ExecResult<()> {
        if let Some(corner) = &self.pending_corner {
            return Err(corner.no_move_alarm().located_at(block));
        }
        self.blocks_without_move += 1;
        if self.blocks_without_move + 2 > data.settings.lookahead_blocks {
            self.close_pending_move(data)?;
        }
        Ok(())
    }

    /// Nothing but a dwell may stand between a corner word and the next move.
    fn check_no_corner(&self, request: &LookaheadRequest) -> ExecResult<()> {
        match &self.pending_corner {
            Some(corner) => Err(corner.no_move_alarm().located_at(request.backtrace.block)),
            None => Ok(()),
        }
    }

    /// The program ends: what waits is done, if nothing is against it.
    pub(crate) fn finish(&mut self, data: &ControlData, block: Span) -> ExecResult<()> {
        if let Some(corner) = &self.pending_corner {
            return Err(corner.no_move_alarm().located_at(block));
        }
        self.close_pending_move(data)
    }

    /// Does all that waits before the run ends by an alarm. A move that would cut into the part, or go beyond the
    /// stroke, isn't begun.
    pub(crate) fn finish_before_alarm(&mut self, data: &ControlData, refused: Option<Span>) {
        let initial_centre = self.tool_centre;
        if let Some(corner) = self.pending_corner.take()
            && refused != Some(corner.path_move.backtrace.block)
        {
            let before = self.clone();
            match self.compensate(data, corner.path_move, &corner.request) {
                Ok(()) => corner.pending_items.into_iter().for_each(|held| self.defer(data, held)),
                // What can't be joined is left out: the run is over.
                Err(_) => *self = before,
            }
        }
        if self.pending_move.as_ref().is_some_and(|open| refused == Some(open.path_move.backtrace.block)) {
            self.pending_move = None;
        }
        if self.close_pending_move(data).is_err() {
            self.pending_items.clear();
        }
        if let Some(beyond) = self.ready.iter().position(|(kind, ..)| data.check_move(kind).is_err()) {
            self.ready.truncate(beyond);
            self.tool_centre =
                self.ready.iter().rev().find_map(|(kind, ..)| kind.end().copied()).unwrap_or(initial_centre);
        }
        for axis in 0..data.settings.axes.len() {
            self.offset[axis] = self.tool_centre[axis] - self.programmed_position[axis];
        }
    }

    /// The point of a position in the plane.
    pub(super) fn plane_point(&self, position: &Position) -> Point {
        Point::new(position[self.plane.0], position[self.plane.1])
    }

    /// A position with another point in the plane.
    pub(super) fn with_plane_point(&self, mut position: Position, point: Point) -> Position {
        (position[self.plane.0], position[self.plane.1]) = (point.x, point.y);
        position
    }

    /// Ends the path for a drilling cycle; what is ready stays. The answer is where the tool's centre stands.
    pub(crate) fn end_path(&mut self) -> Position {
        let (centre, ready) = (self.tool_centre, self.take_ready());
        *self = Self { ready, ..Self::default() };
        centre
    }

    /// What no longer waits, which is then no longer there.
    pub(crate) fn take_ready(&mut self) -> Vec<ReadyEvent> {
        std::mem::take(&mut self.ready)
    }

    pub(super) fn set_offset(&mut self, offset: Point) {
        self.offset = self.with_plane_point(Position::default(), offset);
    }
}
