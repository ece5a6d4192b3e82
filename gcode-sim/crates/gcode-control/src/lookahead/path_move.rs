//! One move of the programmed path, and the telling of moves of the tool's centre with the time they take.
use super::{Lookahead, LookaheadRequest};
use crate::Executor;
use crate::contour::{Point, Segment};
use gcode_lang::motion::{Backtrace, EventKind, MAX_AXES, PlanarArc, Position};

/// Moves shorter than this, mm and degrees, are rounding and aren't told.
const MIN_LENGTH: f64 = 1e-9;

/// A move of one block.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct PathMove {
    pub(super) kind: EventKind,
    /// What it does in the plane, if it moves there.
    pub(super) segment: Option<Segment>,
    pub(super) backtrace: Backtrace,
}

/// What waits behind a move.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum PendingItem {
    /// A move of other axes only.
    Move(PathMove),
    /// Anything else, with its seconds.
    Other(EventKind, f64, Backtrace),
}

/// What is to be told: the event, its seconds, its place.
pub(super) type ReadyEvent = (EventKind, f64, Backtrace);

impl PathMove {
    /// `None` for an event that is no move.
    pub(super) fn new(kind: &EventKind, from: Position, request: &LookaheadRequest) -> Option<Self> {
        let point = |p: &Position| Point::new(p[request.plane.0], p[request.plane.1]);
        let to = point(kind.end()?);
        let segment = match kind {
            EventKind::Arc { arc, .. } => Segment::Arc {
                from: point(&from),
                to,
                centre: Point::new(arc.centre.0, arc.centre.1),
                sweep: arc.sweep,
            },
            _ => Segment::Line { from: point(&from), to },
        };
        let segment = segment.has_length().then_some(segment);
        Some(Self { kind: kind.clone(), segment, backtrace: request.backtrace.clone() })
    }

    /// Where it ends on the programmed path.
    pub(super) fn end_position(&self) -> Position {
        self.kind.end().copied().unwrap_or_default()
    }
}

impl Lookahead {
    /// Tells something, or lets it wait behind the move that waits.
    pub(super) fn defer(&mut self, executor: &Executor, item: PendingItem) {
        if let Some(corner) = &mut self.pending_corner {
            corner.pending_items.push(item);
        } else if self.pending_move.is_some() {
            self.pending_items.push(item);
        } else {
            self.emit_pending(executor, item);
        }
    }

    /// Moves of other axes go on where the centre stands in the plane.
    pub(super) fn emit_pending(&mut self, executor: &Executor, item: PendingItem) {
        match item {
            PendingItem::Move(piece) => {
                let to = self.with_plane_point(piece.end_position(), self.plane_point(&self.tool_centre));
                self.emit_straight(executor, &piece, to);
            }
            PendingItem::Other(kind, seconds, place) => self.ready.push((kind, seconds, place)),
        }
    }

    /// Tells a straight move of a piece's block.
    pub(super) fn emit_straight(&mut self, executor: &Executor, path_move: &PathMove, to: Position) {
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
            EventKind::Skip { rate, has_signal: touched, .. } => {
                (EventKind::Skip { to, rate, has_signal: touched }, length / rate.0 * 60.0)
            }
            EventKind::Rapid { .. }
            | EventKind::Dwell { .. }
            | EventKind::ToolChange { .. }
            | EventKind::ToolLength { .. }
            | EventKind::WorkZeroUnknown { .. }
            | EventKind::Spindle { .. }
            | EventKind::Coolant { .. }
            | EventKind::Auxiliary { .. }
            | EventKind::Stop { .. } => (EventKind::Rapid { to }, executor.rapid_seconds(&from, &to)),
        };
        self.ready.push((kind, seconds, path_move.backtrace.clone()));
    }

    /// Tells the move itself, to a point in the plane; an arc at `distance` to its left.
    pub(super) fn emit_along(
        &mut self,
        executor: &Executor,
        path_move: &PathMove,
        end: Point,
        distance: f64,
    ) {
        let to = self.with_plane_point(path_move.end_position(), end);
        let (EventKind::Arc { arc, rate, .. }, Some(segment)) = (&path_move.kind, &path_move.segment) else {
            return self.emit_straight(executor, path_move, to);
        };
        let start = self.plane_point(&self.tool_centre);
        let middle = Point::new(arc.centre.0, arc.centre.1);
        let radius = ((start - middle).norm() + (end - middle).norm()) / 2.0;
        let sweep = segment.sweep_between(start, end, distance);
        let length = radius * sweep.abs().to_rad();
        if length < MIN_LENGTH {
            return self.emit_straight(executor, path_move, to);
        }
        let arc = PlanarArc { sweep, ..*arc };
        self.tool_centre = to;
        let kind = EventKind::Arc { to, arc, rate: *rate };
        self.ready.push((kind, length / rate.0 * 60.0, path_move.backtrace.clone()));
    }
}
