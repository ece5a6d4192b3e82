//! Cutter compensation: from the programmed path to the path of the tool centre.
//!
//! Source: operator's manual, "Details of cutter compensation". A block moves from the vector at its start to the vector
//! at its end, which depends on the next block that moves in the plane. If a corner has several vectors, the moves between
//! them belong to the latter block.
use super::path_move::{PathMove, PendingCornerArc, PendingItem, PendingMove};
use super::{CornerArc, Lookahead, LookaheadRequest};
use crate::contour;
use crate::contour::{Point, Segment};
use crate::data::ControlData;
use crate::functions::ExecResult;
use gcode_lang::alarm::Alarm;
use gcode_lang::motion::{EventKind, PlanarArc};
use gcode_lang::units::Deg;

impl Lookahead {
    /// Takes the next move of the path that corner words have shaped.
    pub(super) fn compensate(
        &mut self,
        data: &ControlData,
        path_move: PathMove,
        request: &LookaheadRequest,
    ) -> ExecResult<()> {
        let Some(segment) = path_move.segment else {
            self.defer_behind_move(data, PendingItem::Move(path_move));
            return Ok(());
        };
        let restated = std::mem::take(&mut self.is_restated) || request.is_restated;
        self.blocks_without_move = 0;
        let block = path_move.backtrace.block;
        if segment.is_arc()
            && (self.is_compensating != request.distance.is_some()
                || !self.is_compensating && self.is_offset())
        {
            return Err(Alarm::ArcAtStartOrEnd.located_at(block));
        }
        let Some(distance) = request.distance else {
            return self.cancel_compensation(data, &path_move, segment, request);
        };
        if segment.is_too_small(distance) {
            return Err(Alarm::Interference.located_at(block));
        }
        let start_up = !std::mem::replace(&mut self.is_compensating, true);
        let near = self.pending_move.as_ref().map_or(distance, |open| open.distance.abs().copysign(distance));
        let mut starts = match self.pending_move.take() {
            None => vec![self.plane_point(&self.tool_centre)],
            Some(open) => {
                let ends = if restated {
                    vec![open.beside_end()]
                } else if open.is_start_up
                    && !(data.settings.starts_up_by_type_b && is_outside_corner(&open, &segment))
                {
                    vec![segment.parallel_start(near)]
                } else {
                    let met = contour::corner_points(&open.segment, &segment, open.distance, near);
                    met.map_err(|_| Alarm::NoIntersection.located_at(block))?
                };
                self.close_move(data, open, &ends)?
            }
        };
        if let Some(rounding) = self.pending_corner_arc.take() {
            let end = segment.parallel_start(distance);
            self.emit_corner_arc(data, &rounding, segment.start(), end)?;
            starts = vec![end];
        }
        let begins_on_parallel =
            starts.last().is_some_and(|start| segment.is_parallel_start(*start, distance));
        if !begins_on_parallel {
            let what = "an arc that begins off its own parallel (a new D or G41, or blocks without a move)";
            return Err(Alarm::NotSimulated { what: what.into() }.located_at(block));
        }
        self.set_offset(segment.parallel_end(distance) - segment.end());
        self.pending_move =
            Some(PendingMove { path_move, segment, start_points: starts, distance, is_start_up: start_up });
        Ok(())
    }

    /// Takes a move without compensation: the one that cancels it, takes up the vector of G40 alone, or any other.
    fn cancel_compensation(
        &mut self,
        data: &ControlData,
        path_move: &PathMove,
        segment: Segment,
        request: &LookaheadRequest,
    ) -> ExecResult<()> {
        if let Some(open) = self.pending_move.take() {
            let ends = match request.wall_direction {
                Some(direction) => vec![contour::wall_corner(&open.segment, direction, open.distance)],
                None if data.settings.starts_up_by_type_b
                    && !open.is_start_up
                    && is_outside_corner(&open, &segment) =>
                {
                    let met = contour::corner_points(&open.segment, &segment, open.distance, open.distance);
                    met.map_err(|_| Alarm::NoIntersection.located_at(path_move.backtrace.block))?
                }
                None => vec![open.beside_end()],
            };
            let rest = self.close_move(data, open, &ends)?;
            self.emit_corner(data, path_move, &rest);
        }
        if let Some(rounding) = self.pending_corner_arc.take() {
            let what = "G39 followed by the end of cutter compensation".into();
            return Err(Alarm::NotSimulated { what }.located_at(rounding.backtrace.block));
        }
        self.is_compensating = false;
        self.set_offset(Point::default());
        self.emit_along(data, path_move, segment.end(), 0.0);
        Ok(())
    }

    /// Emits a move of G28, G53 or a cycle: in the plane it cancels the vector, and the next move starts up again.
    pub(super) fn suspend(&mut self, data: &ControlData, path_move: &PathMove) {
        if path_move.segment.is_none() {
            return self.emit_pending(data, PendingItem::Move(path_move.clone()));
        }
        self.is_compensating = false;
        self.set_offset(Point::default());
        self.emit_straight(data, path_move, path_move.end_position());
    }

    /// Ends the pending move with the centre beside its end, as if nothing followed.
    pub(super) fn close_pending_move(&mut self, data: &ControlData) -> ExecResult<()> {
        self.blocks_without_move = 0;
        if let Some(pending_move) = self.pending_move.take() {
            let end = pending_move.beside_end();
            self.set_offset(end - pending_move.segment.end());
            self.close_move(data, pending_move, &[end])?;
        }
        Ok(())
    }

    /// Emits the pending move, whose end points are now known, and the items after it; returns the start of the next
    /// move. A path against the programmed one would cut into the part (operator's manual, interference check).
    fn close_move(
        &mut self,
        data: &ControlData,
        open: PendingMove,
        ends: &[Point],
    ) -> ExecResult<Vec<Point>> {
        if let (Some(start), Some(end)) = (open.start_points.last(), ends.first()) {
            if !open.is_start_up && open.segment.is_reversed(*start, *end, open.distance) {
                return Err(Alarm::Interference.located_at(open.path_move.backtrace.block));
            }
            self.emit_corner(data, &open.path_move, &open.start_points);
            self.emit_along(data, &open.path_move, *end, open.distance);
        }
        for item in std::mem::take(&mut self.pending_items) {
            self.emit_pending(data, item);
        }
        Ok(ends.to_vec())
    }

    /// Emits the moves from point to point of a corner; the first point is the tool centre.
    fn emit_corner(&mut self, data: &ControlData, path_move: &PathMove, points: &[Point]) {
        for point in points.iter().skip(1) {
            let to = self.with_plane_point(self.tool_centre, *point);
            self.emit_straight(data, path_move, to);
        }
    }

    /// G39: goes round the corner to beside a direction at once, or to beside the next move when that is read.
    pub(super) fn start_corner_arc(
        &mut self,
        data: &ControlData,
        arc: &CornerArc,
        request: &LookaheadRequest,
    ) -> ExecResult<()> {
        self.close_pending_move(data)?;
        let Some(distance) = request.distance else {
            let what = "G39 without an offset of the cutter (D0)".into();
            return Err(Alarm::NotSimulated { what }.located_at(request.backtrace.block));
        };
        let corner_arc = PendingCornerArc { backtrace: request.backtrace.clone(), rate: arc.rate, distance };
        let Some(direction) = arc.direction else {
            self.pending_corner_arc = Some(corner_arc);
            return Ok(());
        };
        let corner = self.plane_point(&self.programmed_position);
        let end = Segment::Line { from: corner, to: corner + direction }.parallel_start(distance);
        self.emit_corner_arc(data, &corner_arc, corner, end)?;
        self.set_offset(end - corner);
        Ok(())
    }

    fn emit_corner_arc(
        &mut self,
        data: &ControlData,
        rounding: &PendingCornerArc,
        corner: Point,
        end: Point,
    ) -> ExecResult<()> {
        let (from, to) = (self.plane_point(&self.tool_centre) - corner, end - corner);
        let rotation = Deg::atan2(from.x * to.y - from.y * to.x, from.dot(to));
        // Round the outside of a corner the path bends away from the side of the tool.
        let outside = -rounding.distance.signum();
        let sweep = if rotation.abs().0 > 180.0 - 1e-6 { Deg(180.0 * outside) } else { rotation };
        if sweep.0 * outside < -1e-6 {
            return Err(Alarm::Interference.located_at(rounding.backtrace.block));
        }
        let to = self.with_plane_point(self.tool_centre, end);
        let arc = PlanarArc { plane: self.plane, centre: (corner.x, corner.y), sweep };
        let segment =
            Segment::Arc { from: self.plane_point(&self.tool_centre), to: end, centre: corner, sweep };
        let path_move = PathMove {
            kind: EventKind::Arc { to, arc, rate: rounding.rate },
            segment: Some(segment),
            backtrace: rounding.backtrace.clone(),
        };
        self.emit_along(data, &path_move, end, 0.0);
        Ok(())
    }
}

fn is_outside_corner(open: &PendingMove, next: &Segment) -> bool {
    contour::is_outside(&open.segment, next, open.distance)
}
