//! Corner words: `,R` and `,C` between two cutting moves.
use super::piece::Held;
use super::{Ahead, Order, Piece};
use crate::alarm::Alarm;
use crate::contour::{Blend, Segment};
use crate::exec::Core;
use crate::exec::eval::Checked;
use crate::motion::{Arc2, EventKind, Position};

/// A move with a corner word, waiting for the one that makes the corner.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Corner {
    pub(super) piece: Piece,
    pub(super) order: Order,
    blend: Blend,
    pub(super) behind: Vec<Held>,
    /// The one dwell that may stand between the two moves has been read.
    pub(super) dwelt: bool,
}

impl Corner {
    pub(super) fn no_move(&self) -> Alarm {
        Alarm::NoMoveAfterCorner
    }
}

impl Ahead {
    /// Takes the next move of the programmed path.
    pub(super) fn shape(&mut self, core: &Core, piece: Piece, order: &Order) -> Checked<()> {
        let piece = match self.corner.take() {
            None => piece,
            Some(corner) => self.blend(core, corner, piece, order)?,
        };
        let Some(blend) = order.blend else { return self.drive(core, piece, order) };
        if let (Some(segment), Some(distance)) = (&piece.segment, order.distance) {
            self.set_offset(segment.beside_end(distance) - segment.to());
        }
        let (order, behind) = (order.clone(), Vec::new());
        self.corner = Some(Corner { piece, order, blend, behind, dwelt: false });
        Ok(())
    }

    /// Puts the corner's shape between two moves; the answer is what is left of the second.
    fn blend(&mut self, core: &Core, corner: Corner, piece: Piece, order: &Order) -> Checked<Piece> {
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
        let side = |order: &Order| order.distance.map(f64::is_sign_negative);
        if side(&corner.order) != side(order) || corner.order.distance.is_some() && !self.on {
            return Err(Alarm::CornerInStartUp.at(corner.piece.place.block));
        }
        let too_long = |_| Alarm::CornerTooLarge.at(corner.piece.place.block);
        let Some(blended) = corner.blend.between(first, second).map_err(too_long)? else {
            self.drive(core, corner.piece, &corner.order)?;
            corner.behind.into_iter().for_each(|held| self.hold(core, held));
            return Ok(piece);
        };
        self.drive(core, self.part(&corner.piece, blended.before), &corner.order)?;
        let calm = Order { restated: false, ..corner.order };
        self.drive(core, self.part(&corner.piece, blended.between), &calm)?;
        corner.behind.into_iter().for_each(|held| self.hold(core, held));
        Ok(self.part(&piece, blended.after))
    }

    /// A piece that goes along another segment of its plane.
    fn part(&self, piece: &Piece, segment: Segment) -> Piece {
        let to: Position = self.with(piece.to(), segment.to());
        let rate = match piece.kind {
            EventKind::Feed { rate, .. } | EventKind::Arc { rate, .. } => rate,
            EventKind::Rapid { .. }
            | EventKind::Skip { .. }
            | EventKind::Dwell { .. }
            | EventKind::Tool { .. }
            | EventKind::ToolLength { .. }
            | EventKind::Unplaced { .. }
            | EventKind::Spindle { .. }
            | EventKind::Coolant { .. }
            | EventKind::Auxiliary { .. }
            | EventKind::Stop { .. } => return piece.clone(),
        };
        let kind = match segment {
            Segment::Line { .. } => EventKind::Feed { to, rate },
            Segment::Arc { centre, sweep, .. } => {
                let arc = Arc2 { plane: self.plane, centre: (centre.x, centre.y), sweep };
                EventKind::Arc { to, arc, rate }
            }
        };
        let segment = segment.has_length().then_some(segment);
        Piece { kind, segment, place: piece.place.clone() }
    }
}
