//! Corner words: `,R` and `,C` between two cutting moves.
use super::super::checked::ExecResult;
use super::super::data::ControlData;
use super::buffer::Lookahead;
use super::pending::{PathMove, PendingCorner};
use super::request::LookaheadRequest;
use crate::contour::Segment;
use gcode_lang::alarm::Alarm;
use gcode_lang::motion::{EventKind, PlanarArc, Position};

impl Lookahead {
    /// Takes the next move of the programmed path.
    pub(super) fn process_corner(
        &mut self,
        data: &ControlData,
        path_move: PathMove,
        request: &LookaheadRequest,
    ) -> ExecResult<()> {
        let piece = match self.pending_corner.take() {
            None => path_move,
            Some(corner) => self.blend_corner(data, corner, path_move, request)?,
        };
        let Some(blend) = request.blend else { return self.compensate(data, piece, request) };
        if let (Some(segment), Some(distance)) = (&piece.segment, request.distance) {
            self.set_offset(segment.parallel_end(distance) - segment.end());
        }
        let (order, behind) = (request.clone(), Vec::new());
        self.pending_corner = Some(PendingCorner {
            path_move: piece,
            request: order,
            blend,
            pending_items: behind,
            has_dwell: false,
        });
        Ok(())
    }

    /// Puts the corner's shape between two moves; the answer is what is left of the second.
    fn blend_corner(
        &mut self,
        data: &ControlData,
        corner: PendingCorner,
        path_move: PathMove,
        request: &LookaheadRequest,
    ) -> ExecResult<PathMove> {
        let block = path_move.backtrace.block;
        let (Some(first), Some(second)) = (&corner.path_move.segment, &path_move.segment) else {
            return Err(corner.no_move_alarm().located_at(block));
        };
        if !request.is_cut {
            return Err(Alarm::NoCutAfterCorner.located_at(block));
        }
        if corner.request.plane != request.plane {
            return Err(corner.no_move_alarm().located_at(block));
        }
        let is_right_side = |request: &LookaheadRequest| request.distance.map(f64::is_sign_negative);
        if is_right_side(&corner.request) != is_right_side(request)
            || corner.request.distance.is_some() && !self.is_compensating
        {
            return Err(Alarm::CornerInStartUp.located_at(corner.path_move.backtrace.block));
        }
        let too_long = |_| Alarm::CornerTooLarge.located_at(corner.path_move.backtrace.block);
        let Some(blended) = corner.blend.blend_between(first, second).map_err(too_long)? else {
            self.compensate(data, corner.path_move, &corner.request)?;
            corner.pending_items.into_iter().for_each(|held| self.defer(data, held));
            return Ok(path_move);
        };
        self.compensate(data, self.on_segment(&corner.path_move, blended.before), &corner.request)?;
        let unrestated = LookaheadRequest { is_restated: false, ..corner.request };
        self.compensate(data, self.on_segment(&corner.path_move, blended.between), &unrestated)?;
        corner.pending_items.into_iter().for_each(|held| self.defer(data, held));
        Ok(self.on_segment(&path_move, blended.after))
    }

    /// A piece that goes along another segment of its plane.
    fn on_segment(&self, path_move: &PathMove, segment: Segment) -> PathMove {
        let to: Position = self.with_plane_point(path_move.end_position(), segment.end());
        let rate = match path_move.kind {
            EventKind::Feed { rate, .. } | EventKind::Arc { rate, .. } => rate,
            EventKind::Rapid { .. }
            | EventKind::Skip { .. }
            | EventKind::Dwell { .. }
            | EventKind::ToolChange { .. }
            | EventKind::ToolLength { .. }
            | EventKind::WorkZeroUnknown { .. }
            | EventKind::Spindle { .. }
            | EventKind::Coolant { .. }
            | EventKind::Auxiliary { .. }
            | EventKind::Stop { .. } => return path_move.clone(),
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
}
