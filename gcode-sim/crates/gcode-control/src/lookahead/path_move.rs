//! Moves that wait for the next one, the corner words between them, and the events of the tool centre.
use super::{Lookahead, LookaheadRequest};
use crate::contour::{Blend, Point, Segment};
use crate::data::ControlData;
use crate::functions::ExecResult;
use gcode_lang::alarm::Alarm;
use gcode_lang::motion::{Backtrace, EventKind, MAX_AXES, PlanarArc, Position};
use gcode_lang::units::MmPerMin;

/// Longest move, mm and degrees, that is a rounding error and causes no event.
const MIN_LENGTH: f64 = 1e-9;

/// Move of one block.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct PathMove {
    pub(super) kind: EventKind,
    /// Path in the plane; `None` if the move leaves the plane's axes still.
    pub(super) segment: Option<Segment>,
    pub(super) backtrace: Backtrace,
}

/// Move with a corner word that waits for the move after the corner.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct PendingCorner {
    pub(super) path_move: PathMove,
    pub(super) request: LookaheadRequest,
    pub(super) blend: Blend,
    pub(super) pending_items: Vec<PendingItem>,
    /// The one dwell that may stand between the two moves has been read.
    pub(super) has_dwell: bool,
}

/// Move whose end isn't known yet.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct PendingMove {
    pub(super) path_move: PathMove,
    pub(super) segment: Segment,
    /// Points at its start: the tool centre, and the rest of the path round the corner.
    pub(super) start_points: Vec<Point>,
    /// Distance of the centre to the left of the path.
    pub(super) distance: f64,
    pub(super) is_start_up: bool,
}

/// G39 without a direction: an arc at the corner, to beside the next move.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct PendingCornerArc {
    pub(super) backtrace: Backtrace,
    pub(super) rate: MmPerMin,
    pub(super) distance: f64,
}

/// Item that waits for the end of a move.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum PendingItem {
    /// Move of other axes only.
    Move(PathMove),
    /// Other event with its seconds.
    Other(EventKind, f64, Backtrace),
}

impl PendingMove {
    pub(super) fn beside_end(&self) -> Point {
        self.segment.parallel_end(self.distance)
    }
}

impl PathMove {
    /// Returns the move of an event; `None` for an event without motion.
    pub(super) fn new(kind: &EventKind, from: Position, request: &LookaheadRequest) -> Option<Self> {
        let point = |p: &Position| Point::new(p[request.plane.0], p[request.plane.1]);
        let (from, to) = (point(&from), point(kind.end()?));
        let segment = match kind {
            EventKind::Arc { arc, .. } => {
                Segment::Arc { from, to, centre: Point::new(arc.centre.0, arc.centre.1), sweep: arc.sweep }
            }
            _ => Segment::Line { from, to },
        };
        let segment = segment.has_length().then_some(segment);
        Some(Self { kind: kind.clone(), segment, backtrace: request.backtrace.clone() })
    }

    pub(super) fn end_position(&self) -> Position {
        self.kind.end().copied().unwrap_or_default()
    }
}

impl Lookahead {
    /// Takes the next move of the programmed path.
    pub(super) fn process_corner(
        &mut self,
        data: &ControlData,
        path_move: PathMove,
        request: &LookaheadRequest,
    ) -> ExecResult<()> {
        let path_move = match self.pending_corner.take() {
            None => path_move,
            Some(corner) => self.blend_corner(data, corner, path_move, request)?,
        };
        let Some(blend) = request.blend else { return self.compensate(data, path_move, request) };
        if let (Some(segment), Some(distance)) = (&path_move.segment, request.distance) {
            self.set_offset(segment.parallel_end(distance) - segment.end());
        }
        let (request, pending_items) = (request.clone(), Vec::new());
        self.pending_corner =
            Some(PendingCorner { path_move, request, blend, pending_items, has_dwell: false });
        Ok(())
    }

    /// Inserts the element of a corner between two moves and returns the rest of the second.
    fn blend_corner(
        &mut self,
        data: &ControlData,
        corner: PendingCorner,
        path_move: PathMove,
        request: &LookaheadRequest,
    ) -> ExecResult<PathMove> {
        let block = path_move.backtrace.block;
        let corner_block = corner.path_move.backtrace.block;
        let (Some(first), Some(second)) = (&corner.path_move.segment, &path_move.segment) else {
            return Err(Alarm::NoMoveAfterCorner.located_at(block));
        };
        if !request.is_cut {
            return Err(Alarm::NoCutAfterCorner.located_at(block));
        }
        if corner.request.plane != request.plane {
            return Err(Alarm::NoMoveAfterCorner.located_at(block));
        }
        let is_right_side = |request: &LookaheadRequest| request.distance.map(f64::is_sign_negative);
        if is_right_side(&corner.request) != is_right_side(request)
            || corner.request.distance.is_some() && !self.is_compensating
        {
            return Err(Alarm::CornerInStartUp.located_at(corner_block));
        }
        let too_long = |_| Alarm::CornerTooLarge.located_at(corner_block);
        let Some(blended) = corner.blend.blend_between(first, second).map_err(too_long)? else {
            self.compensate(data, corner.path_move, &corner.request)?;
            self.defer_all(data, corner.pending_items);
            return Ok(path_move);
        };
        self.compensate(data, self.on_segment(&corner.path_move, blended.before), &corner.request)?;
        let unrestated = LookaheadRequest { is_restated: false, ..corner.request };
        self.compensate(data, self.on_segment(&corner.path_move, blended.between), &unrestated)?;
        self.defer_all(data, corner.pending_items);
        Ok(self.on_segment(&path_move, blended.after))
    }

    /// Returns a cut along another segment of its plane.
    fn on_segment(&self, path_move: &PathMove, segment: Segment) -> PathMove {
        let to: Position = self.with_plane_point(path_move.end_position(), segment.end());
        let (EventKind::Feed { rate, .. } | EventKind::Arc { rate, .. }) = path_move.kind else {
            return path_move.clone();
        };
        let kind = match segment {
            Segment::Line { .. } => EventKind::Feed { to, rate },
            Segment::Arc { centre, sweep, .. } => {
                let arc = PlanarArc { plane: self.plane, centre: (centre.x, centre.y), sweep };
                EventKind::Arc { to, arc, rate }
            }
        };
        let segment = segment.has_length().then_some(segment);
        PathMove { kind, segment, backtrace: path_move.backtrace.clone() }
    }

    /// Emits an item, or keeps it until the end of the move that waits.
    pub(super) fn defer(&mut self, data: &ControlData, item: PendingItem) {
        match &mut self.pending_corner {
            Some(corner) => corner.pending_items.push(item),
            None => self.defer_behind_move(data, item),
        }
    }

    pub(super) fn defer_all(&mut self, data: &ControlData, items: Vec<PendingItem>) {
        items.into_iter().for_each(|item| self.defer(data, item));
    }

    /// Emits an item, or keeps it until the end of the move that compensation holds back.
    pub(super) fn defer_behind_move(&mut self, data: &ControlData, item: PendingItem) {
        if self.pending_move.is_some() {
            self.pending_items.push(item);
        } else {
            self.emit_pending(data, item);
        }
    }

    /// Emits an item; moves of other axes leave the tool centre where it is in the plane.
    pub(super) fn emit_pending(&mut self, data: &ControlData, item: PendingItem) {
        match item {
            PendingItem::Move(path_move) => {
                let to = self.with_plane_point(path_move.end_position(), self.plane_point(&self.tool_centre));
                self.emit_straight(data, &path_move, to);
            }
            PendingItem::Other(kind, seconds, backtrace) => self.ready.push((kind, seconds, backtrace)),
        }
    }

    /// Emits a straight move at the rate of a move's block.
    pub(super) fn emit_straight(&mut self, data: &ControlData, path_move: &PathMove, to: Position) {
        let from = std::mem::replace(&mut self.tool_centre, to);
        let squares: f64 = (0..MAX_AXES).map(|axis| (to[axis] - from[axis]) * (to[axis] - from[axis])).sum();
        let length = squares.sqrt();
        if length < MIN_LENGTH {
            return;
        }
        let (kind, seconds) = match path_move.kind {
            EventKind::Feed { rate, .. } | EventKind::Arc { rate, .. } => {
                (EventKind::Feed { to, rate }, length / rate.0 * 60.0)
            }
            EventKind::Skip { rate, has_signal, .. } => {
                (EventKind::Skip { to, rate, has_signal }, length / rate.0 * 60.0)
            }
            _ => {
                (EventKind::Rapid { to }, data.rapid_seconds(&self.on_machine(&from), &self.on_machine(&to)))
            }
        };
        self.push_ready(data, &from, kind, seconds, &path_move.backtrace);
    }

    /// Emits a move to a point in the plane; an arc at `distance` to its left.
    pub(super) fn emit_along(&mut self, data: &ControlData, path_move: &PathMove, end: Point, distance: f64) {
        let to = self.with_plane_point(path_move.end_position(), end);
        let (EventKind::Arc { arc, rate, .. }, Some(segment)) = (&path_move.kind, &path_move.segment) else {
            return self.emit_straight(data, path_move, to);
        };
        let start = self.plane_point(&self.tool_centre);
        let middle = Point::new(arc.centre.0, arc.centre.1);
        let radius = ((start - middle).norm() + (end - middle).norm()) / 2.0;
        let sweep = segment.sweep_between(start, end, distance);
        let length = radius * sweep.abs().to_rad();
        if length < MIN_LENGTH {
            return self.emit_straight(data, path_move, to);
        }
        let arc = PlanarArc { sweep, ..*arc };
        let from = std::mem::replace(&mut self.tool_centre, to);
        let kind = EventKind::Arc { to, arc, rate: *rate };
        self.push_ready(data, &from, kind, length / rate.0 * 60.0, &path_move.backtrace);
    }
}
