//! Corner words: `,R` and `,C` between two cutting moves.
use super::path_move::PendingItem;
use super::{Lookahead, LookaheadRequest, PathMove};
use crate::Executor;
use crate::contour::{Blend, Segment};
use crate::evaluation::ExecResult;
use gcode_lang::alarm::Alarm;
use gcode_lang::motion::{EventKind, PlanarArc, Position};

/// A move with a corner word, waiting for the one that makes the corner.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct PendingCorner {
    pub(super) path_move: PathMove,
    pub(super) request: LookaheadRequest,
    blend: Blend,
    pub(super) pending_items: Vec<PendingItem>,
    /// The one dwell that may stand between the two moves has been read.
    pub(super) has_dwell: bool,
}

impl PendingCorner {
    pub(super) fn no_move_alarm(&self) -> Alarm {
        Alarm::NoMoveAfterCorner
    }
}

impl Lookahead {
    /// Takes the next move of the programmed path.
    pub(super) fn process_corner(
        &mut self,
        core: &Executor,
        piece: PathMove,
        order: &LookaheadRequest,
    ) -> ExecResult<()> {
        let piece = match self.pending_corner.take() {
            None => piece,
            Some(corner) => self.blend_corner(core, corner, piece, order)?,
        };
        let Some(blend) = order.blend else { return self.compensate(core, piece, order) };
        if let (Some(segment), Some(distance)) = (&piece.segment, order.distance) {
            self.set_offset(segment.parallel_end(distance) - segment.end());
        }
        let (order, behind) = (order.clone(), Vec::new());
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
        core: &Executor,
        corner: PendingCorner,
        piece: PathMove,
        order: &LookaheadRequest,
    ) -> ExecResult<PathMove> {
        let block = piece.backtrace.block;
        let (Some(first), Some(second)) = (&corner.path_move.segment, &piece.segment) else {
            return Err(corner.no_move_alarm().located_at(block));
        };
        if !order.is_cut {
            return Err(Alarm::NoCutAfterCorner.located_at(block));
        }
        if corner.request.plane != order.plane {
            return Err(corner.no_move_alarm().located_at(block));
        }
        let side = |order: &LookaheadRequest| order.distance.map(f64::is_sign_negative);
        if side(&corner.request) != side(order) || corner.request.distance.is_some() && !self.is_compensating
        {
            return Err(Alarm::CornerInStartUp.located_at(corner.path_move.backtrace.block));
        }
        let too_long = |_| Alarm::CornerTooLarge.located_at(corner.path_move.backtrace.block);
        let Some(blended) = corner.blend.blend_between(first, second).map_err(too_long)? else {
            self.compensate(core, corner.path_move, &corner.request)?;
            corner.pending_items.into_iter().for_each(|held| self.defer(core, held));
            return Ok(piece);
        };
        self.compensate(core, self.on_segment(&corner.path_move, blended.before), &corner.request)?;
        let calm = LookaheadRequest { is_restated: false, ..corner.request };
        self.compensate(core, self.on_segment(&corner.path_move, blended.between), &calm)?;
        corner.pending_items.into_iter().for_each(|held| self.defer(core, held));
        Ok(self.on_segment(&piece, blended.after))
    }

    /// A piece that goes along another segment of its plane.
    fn on_segment(&self, piece: &PathMove, segment: Segment) -> PathMove {
        let to: Position = self.with_plane_point(piece.end_position(), segment.end());
        let rate = match piece.kind {
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
            | EventKind::Stop { .. } => return piece.clone(),
        };
        let kind = match segment {
            Segment::Line { .. } => EventKind::Feed { to, rate },
            Segment::Arc { centre, sweep, .. } => {
                let arc = PlanarArc { plane: self.plane, centre: (centre.x, centre.y), sweep };
                EventKind::Arc { to, arc, rate }
            }
        };
        let segment = segment.has_length().then_some(segment);
        PathMove { kind, segment, backtrace: piece.backtrace.clone() }
    }
}
