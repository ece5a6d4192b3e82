//! Lookahead: blocks that are read and not yet executed, because cutter compensation and corner words need the next move
//! before they know where one ends.
//!
//! Callers work on the programmed path; here it becomes the path of the tool centre. Moves go through two stages: corner
//! words shape the path ([`path_move`]), compensation puts the centre beside it ([`cutter_compensation`]). Each stage holds
//! back one move, and the items after a move that waits wait as well. Every event keeps the backtrace of its own block.

mod askew_plane;
mod cutter_compensation;
mod path_move;

pub(super) use self::askew_plane::AskewPlane;
use self::path_move::{PathMove, PendingCorner, PendingCornerArc, PendingItem, PendingMove};
use crate::contour::{Blend, Point};
use crate::data::ControlData;
use crate::functions::{ExecResult, locate};
use crate::state::State;
use gcode_lang::alarm::Alarm;
use gcode_lang::motion::{AxisIndex, Backtrace, EventKind, Position};
use gcode_lang::source::Span;
use gcode_lang::units::MmPerMin;

/// State of lookahead; `Default` if neither function is in use.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Lookahead {
    /// Plane whose coordinates all positions here have; `None` for those of the machine.
    askew_plane: Option<AskewPlane>,
    /// End of the programmed path so far.
    programmed_position: Position,
    /// Tool centre after the emitted events.
    tool_centre: Position,
    /// Offset of the centre from the path after all blocks read, as if nothing followed.
    offset: Position,
    plane: (AxisIndex, AxisIndex),
    /// Offset mode, in which corners are computed: a start-up move was read.
    pub(super) is_compensating: bool,
    /// G41 or G42 was repeated in a block without a move: the centre goes to beside the end of the block before.
    is_restated: bool,
    /// Blocks without a move in the plane since the last one with such a move.
    blocks_without_move: usize,
    pending_corner: Option<PendingCorner>,
    pending_move: Option<PendingMove>,
    /// Items that wait for the end of the pending move.
    pending_items: Vec<PendingItem>,
    pending_corner_arc: Option<PendingCornerArc>,
    ready: Vec<ReadyEvent>,
}

/// Event that no longer waits, with its seconds and its backtrace.
pub(super) type ReadyEvent = (EventKind, f64, Backtrace);

/// Compensation and corner words that one block commands.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct LookaheadRequest {
    /// The plane where it is askew to the machine's axes.
    pub(super) askew_plane: Option<AskewPlane>,
    pub(super) plane: (AxisIndex, AxisIndex),
    /// Distance of the centre to the left of the path; `None` without compensation, by G40 or by D0.
    pub(super) distance: Option<f64>,
    /// Direction of a wall that the tool comes to: I J K of G40.
    pub(super) wall_direction: Option<Point>,
    /// The block repeats G41 or G42 that was active before.
    pub(super) is_restated: bool,
    /// G28, G53, a canned cycle…: the block moves without compensation and ends lookahead.
    pub(super) suspends_compensation: bool,
    /// M00, M01, M02, M30: no later block is read before this one is executed.
    pub(super) blocks_lookahead: bool,
    /// The block counts as a block without a move if it has none: calls and returns don't.
    pub(super) counts_as_block: bool,
    /// The block names an axis of the plane: without a move it is a move of length 0.
    pub(super) has_zero_length: bool,
    pub(super) is_dwell: bool,
    /// G01, G02, G03.
    pub(super) is_cut: bool,
    pub(super) blend: Option<Blend>,
    pub(super) corner_arc: Option<CornerArc>,
    pub(super) backtrace: Backtrace,
}

/// G39 with its direction, if commanded, and its feed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct CornerArc {
    pub(super) direction: Option<Point>,
    pub(super) rate: MmPerMin,
}

impl Lookahead {
    /// Returns true if nothing waits and the tool centre is on the path.
    pub(super) fn is_idle(&self) -> bool {
        !self.is_compensating && self.pending_corner.is_none() && !self.is_offset()
    }

    /// Returns true in the offset mode, and with a vector that G40 alone has left.
    pub(super) fn is_offset(&self) -> bool {
        self.is_compensating || self.offset != Position::default()
    }

    /// Returns true if a move waits for the next one.
    pub(super) fn has_pending_move(&self) -> bool {
        self.pending_move.is_some() || self.pending_corner.is_some()
    }

    /// Checks the stroke of the moves that no longer wait, each with its own block.
    pub(super) fn check_stroke(&self, data: &ControlData, state: &State) -> ExecResult<()> {
        if state.virtual_plane.is_some() {
            let block = self.ready.last().map_or(Span::default(), |(_, _, backtrace)| backtrace.block);
            return locate(data.check_moves_of(state, self.ready.iter().map(|(kind, ..)| kind)), block);
        }
        self.ready.iter().try_for_each(|(kind, _, backtrace)| locate(data.check_move(kind), backtrace.block))
    }

    /// Adds an event that isn't a move after the pending move.
    pub(super) fn push_pending(&mut self, kind: EventKind, backtrace: Backtrace) {
        let item = PendingItem::Other(kind, 0.0, backtrace);
        match &mut self.pending_corner {
            Some(corner) => corner.pending_items.push(item),
            None => self.pending_items.push(item),
        }
    }

    /// Begins at the tool if nothing waits; returns an alarm if what waits is in another plane than that of a request.
    pub(super) fn start_at(&mut self, at: Position, request: &LookaheadRequest) -> ExecResult<()> {
        if self.is_idle() {
            self.askew_plane = request.askew_plane;
            let at = self.in_plane(&at);
            (self.programmed_position, self.tool_centre) = (at, at);
        } else if self.askew_plane != request.askew_plane {
            let what = "a change of the tilted plane in cutter compensation (command G40 before it)".into();
            return Err(Alarm::NotSimulated { what }.located_at(request.backtrace.block));
        }
        Ok(())
    }

    fn in_plane(&self, machine: &Position) -> Position {
        self.askew_plane.map_or(*machine, |plane| plane.in_plane(machine))
    }

    fn on_machine(&self, position: &Position) -> Position {
        self.askew_plane.map_or(*position, |plane| plane.on_machine(position))
    }

    /// Returns the offset of the centre from the path in machine coordinates.
    pub(super) fn machine_offset(&self) -> Position {
        self.on_machine(&self.offset)
    }

    /// Adds a move that no longer waits, from a position on.
    fn push_ready(
        &mut self,
        data: &ControlData,
        from: &Position,
        kind: EventKind,
        seconds: f64,
        backtrace: &Backtrace,
    ) {
        let Some(plane) = self.askew_plane else {
            return self.ready.push((kind, seconds, backtrace.clone()));
        };
        plane.emit(from, kind, seconds, data.settings.chord_tolerance, |kind, seconds| {
            self.ready.push((kind, seconds, backtrace.clone()));
        });
    }

    /// Takes the events of a block on the programmed path, and holds back those that wait for the next move.
    pub(super) fn process_block(
        &mut self,
        data: &ControlData,
        request: &LookaheadRequest,
        events: &[(EventKind, f64)],
    ) -> ExecResult<()> {
        self.plane = request.plane;
        let block = request.backtrace.block;
        if request.suspends_compensation {
            self.check_no_corner(block)?;
            self.close_pending_move(data)?;
        }
        if let Some(arc) = &request.corner_arc {
            self.check_no_corner(block)?;
            self.start_corner_arc(data, arc, request)?;
        }
        let mut has_moved = false;
        for (kind, seconds) in events {
            let in_plane = self.askew_plane.map(|plane| plane.move_in_plane(kind));
            let kind = in_plane.as_ref().unwrap_or(kind);
            let Some(path_move) = PathMove::new(kind, self.programmed_position, request) else {
                self.defer(data, PendingItem::Other(kind.clone(), *seconds, request.backtrace.clone()));
                continue;
            };
            self.programmed_position = path_move.end_position();
            has_moved |= path_move.segment.is_some();
            if request.suspends_compensation {
                self.suspend(data, &path_move);
            } else {
                self.process_corner(data, path_move, request)?;
            }
        }
        if request.blend.is_some() && self.pending_corner.is_none() {
            return Err(Alarm::CornerTooLarge.located_at(block));
        }
        if !has_moved {
            self.process_block_without_move(data, request)?;
        }
        if request.blocks_lookahead {
            self.finish(data, block)?;
        }
        Ok(())
    }

    /// Reads over a block that doesn't move in the plane. Several of them, one with a move of length 0, and the end of
    /// the offset mode leave the centre beside the end of the last move.
    fn process_block_without_move(
        &mut self,
        data: &ControlData,
        request: &LookaheadRequest,
    ) -> ExecResult<()> {
        let block = request.backtrace.block;
        match &mut self.pending_corner {
            Some(corner) if request.is_dwell && !corner.has_dwell => corner.has_dwell = true,
            Some(_) if request.counts_as_block => self.check_no_corner(block)?,
            _ => {}
        }
        self.is_restated |= self.is_compensating && request.is_restated;
        if self.is_compensating && request.distance.is_none() {
            if request.wall_direction.is_some() {
                let what = "G40 with I, J, K and without a move".into();
                return Err(Alarm::NotSimulated { what }.located_at(block));
            }
            self.close_pending_move(data)?;
            self.is_compensating = false;
        }
        if request.counts_as_block && !request.suspends_compensation {
            self.count_block(data, request.has_zero_length)?;
        }
        Ok(())
    }

    /// Counts a block without a move.
    fn count_block(&mut self, data: &ControlData, has_zero_length: bool) -> ExecResult<()> {
        self.blocks_without_move += 1;
        if has_zero_length || self.blocks_without_move + 2 > data.settings.lookahead_blocks {
            self.close_pending_move(data)?;
        }
        Ok(())
    }

    /// Counts a block that has only a sequence number.
    pub(super) fn count_sequence_number(&mut self, data: &ControlData, block: Span) -> ExecResult<()> {
        self.check_no_corner(block)?;
        self.count_block(data, false)
    }

    /// Raises the alarm of a corner word without a move after it; only a dwell may stand between the two.
    fn check_no_corner(&self, block: Span) -> ExecResult<()> {
        if self.pending_corner.is_some() {
            return Err(Alarm::NoMoveAfterCorner.located_at(block));
        }
        Ok(())
    }

    /// Executes what waits, because no move follows.
    pub(super) fn finish(&mut self, data: &ControlData, block: Span) -> ExecResult<()> {
        self.check_no_corner(block)?;
        self.close_pending_move(data)
    }

    /// Executes all that waits before an alarm ends the run. The block `refused`, whose move would cut into the part or
    /// exceed the stroke, doesn't begin.
    pub(super) fn finish_before_alarm(&mut self, data: &ControlData, refused: Option<Span>) {
        let initial_centre = self.tool_centre;
        if let Some(corner) = self.pending_corner.take()
            && refused != Some(corner.path_move.backtrace.block)
        {
            let before = self.clone();
            match self.compensate(data, corner.path_move, &corner.request) {
                Ok(()) => self.defer_all(data, corner.pending_items),
                // A move that can't be joined is left out: the run is over.
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
            let last = self.ready.iter().rev().find_map(|(kind, ..)| kind.end());
            self.tool_centre = last.map_or(initial_centre, |last| self.in_plane(last));
        }
        for axis in 0..data.settings.axes.len() {
            self.offset[axis] = self.tool_centre[axis] - self.programmed_position[axis];
        }
    }

    /// Returns the point of a position in the plane.
    fn plane_point(&self, position: &Position) -> Point {
        Point::new(position[self.plane.0], position[self.plane.1])
    }

    /// Returns a position with another point in the plane.
    fn with_plane_point(&self, mut position: Position, point: Point) -> Position {
        (position[self.plane.0], position[self.plane.1]) = (point.x, point.y);
        position
    }

    /// Ends the path for a canned cycle and returns the tool centre; events that are ready stay.
    pub(super) fn end_path(&mut self) -> Position {
        let (centre, ready) = (self.on_machine(&self.tool_centre), self.take_ready());
        *self = Self { ready, ..Self::default() };
        centre
    }

    /// Takes the events that no longer wait.
    pub(super) fn take_ready(&mut self) -> Vec<ReadyEvent> {
        std::mem::take(&mut self.ready)
    }

    fn set_offset(&mut self, offset: Point) {
        self.offset = self.with_plane_point(Position::default(), offset);
    }
}
