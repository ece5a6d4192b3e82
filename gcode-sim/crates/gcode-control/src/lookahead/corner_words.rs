//! Corner words: `,R` and `,C` between two cutting moves.
use super::path_move::PendingItem;
use super::{Lookahead, LookaheadRequest, PathMove};
use crate::Executor;
use crate::contour::{Blend, Segment};
use crate::eval::Checked;
use gcode_lang::alarm::Alarm;
use gcode_lang::motion::{EventKind, PlanarArc, Position};

/// A move with a corner word, waiting for the one that makes the corner.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct PendingCorner {
    pub(super) piece: PathMove,
    pub(super) order: LookaheadRequest,
    blend: Blend,
    pub(super) behind: Vec<PendingItem>,
    /// The one dwell that may stand between the two moves has been read.
    pub(super) dwelt: bool,
}

impl PendingCorner {
    pub(super) fn no_move(&self) -> Alarm {
        Alarm::NoMoveAfterCorner
    }
}

impl Lookahead {
    /// Takes the next move of the programmed path.
    pub(super) fn shape(
        &mut self,
        core: &Executor,
        piece: PathMove,
        order: &LookaheadRequest,
    ) -> Checked<()> {
        let piece = match self.corner.take() {
            None => piece,
            Some(corner) => self.blend(core, corner, piece, order)?,
        };
        let Some(blend) = order.blend else { return self.drive(core, piece, order) };
        if let (Some(segment), Some(distance)) = (&piece.segment, order.distance) {
            self.set_offset(segment.beside_end(distance) - segment.to());
        }
        let (order, behind) = (order.clone(), Vec::new());
        self.corner = Some(PendingCorner { piece, order, blend, behind, dwelt: false });
        Ok(())
    }

    /// Puts the corner's shape between two moves; the answer is what is left of the second.
    fn blend(
        &mut self,
        core: &Executor,
        corner: PendingCorner,
        piece: PathMove,
        order: &LookaheadRequest,
    ) -> Checked<PathMove> {
        let block = piece.place.block;
        let (Some(first), Some(second)) = (&corner.piece.segment, &piece.segment) else {
            return Err(corner.no_move().at(block));
        };
        if !order.cuts {
            return Err(Alarm::NoCutAfterCorner.at(block));
        }
        if corner.order.plane != order.plane {
            return Err(corner.no_move().at(block));
        }
        let side = |order: &LookaheadRequest| order.distance.map(f64::is_sign_negative);
        if side(&corner.order) != side(order) || corner.order.distance.is_some() && !self.on {
            return Err(Alarm::CornerInStartUp.at(corner.piece.place.block));
        }
        let too_long = |_| Alarm::CornerTooLarge.at(corner.piece.place.block);
        let Some(blended) = corner.blend.between(first, second).map_err(too_long)? else {
            self.drive(core, corner.piece, &corner.order)?;
            corner.behind.into_iter().for_each(|held| self.defer(core, held));
            return Ok(piece);
        };
        self.drive(core, self.part(&corner.piece, blended.before), &corner.order)?;
        let calm = LookaheadRequest { restated: false, ..corner.order };
        self.drive(core, self.part(&corner.piece, blended.between), &calm)?;
        corner.behind.into_iter().for_each(|held| self.defer(core, held));
        Ok(self.part(&piece, blended.after))
    }

    /// A piece that goes along another segment of its plane.
    fn part(&self, piece: &PathMove, segment: Segment) -> PathMove {
        let to: Position = self.with(piece.to(), segment.to());
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
        PathMove { kind, segment, place: piece.place.clone() }
    }
}
