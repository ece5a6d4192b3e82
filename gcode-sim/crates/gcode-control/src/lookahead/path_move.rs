//! One move of the programmed path, and the telling of moves of the tool's centre with the time they take.
use super::super::data::ControlData;
use super::buffer::Lookahead;
use super::pending::{PathMove, PendingItem};
use crate::contour::Point;
use gcode_lang::motion::{EventKind, MAX_AXES, PlanarArc, Position};

/// Moves shorter than this, mm and degrees, are rounding and aren't told.
const MIN_LENGTH: f64 = 1e-9;

impl Lookahead {
    /// Tells something, or lets it wait behind the move that waits.
    pub(super) fn defer(&mut self, data: &ControlData, item: PendingItem) {
        if let Some(corner) = &mut self.pending_corner {
            corner.pending_items.push(item);
        } else if self.pending_move.is_some() {
            self.pending_items.push(item);
        } else {
            self.emit_pending(data, item);
        }
    }

    /// Moves of other axes go on where the centre stands in the plane.
    pub(super) fn emit_pending(&mut self, data: &ControlData, item: PendingItem) {
        match item {
            PendingItem::Move(piece) => {
                let to = self.with_plane_point(piece.end_position(), self.plane_point(&self.tool_centre));
                self.emit_straight(data, &piece, to);
            }
            PendingItem::Other(kind, seconds, place) => self.ready.push((kind, seconds, place)),
        }
    }

    /// Tells a straight move of a piece's block.
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
            | EventKind::Stop { .. } => (EventKind::Rapid { to }, data.rapid_seconds(&from, &to)),
        };
        self.ready.push((kind, seconds, path_move.backtrace.clone()));
    }

    /// Tells the move itself, to a point in the plane; an arc at `distance` to its left.
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
        self.tool_centre = to;
        let kind = EventKind::Arc { to, arc, rate: *rate };
        self.ready.push((kind, length / rate.0 * 60.0, path_move.backtrace.clone()));
    }
}
