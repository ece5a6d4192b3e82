//! What waits for the next move, and what no longer does.
use super::request::LookaheadRequest;
use crate::contour::{Blend, Point, Segment};
use gcode_lang::alarm::Alarm;
use gcode_lang::motion::{Backtrace, EventKind, Position};
use gcode_lang::units::MmPerMin;

/// A move with a corner word, waiting for the one that makes the corner.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct PendingCorner {
    pub(super) path_move: PathMove,
    pub(super) request: LookaheadRequest,
    pub(super) blend: Blend,
    pub(super) pending_items: Vec<PendingItem>,
    /// The one dwell that may stand between the two moves has been read.
    pub(super) has_dwell: bool,
}

impl PendingCorner {
    pub(super) fn no_move_alarm(&self) -> Alarm {
        Alarm::NoMoveAfterCorner
    }
}

/// A move whose end isn't known yet.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct PendingMove {
    pub(super) path_move: PathMove,
    pub(super) segment: Segment,
    /// The points it begins with: where the centre stands, and the rest of the way round the corner.
    pub(super) start_points: Vec<Point>,
    /// Of the centre to the left of the path.
    pub(super) distance: f64,
    pub(super) is_start_up: bool,
}

/// G39 without a direction: an arc at the corner, up to beside the next move.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct PendingCornerArc {
    pub(super) backtrace: Backtrace,
    pub(super) rate: MmPerMin,
    pub(super) distance: f64,
}

impl PendingMove {
    pub(super) fn beside_end(&self) -> Point {
        self.segment.parallel_end(self.distance)
    }
}

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
pub(crate) type ReadyEvent = (EventKind, f64, Backtrace);

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
