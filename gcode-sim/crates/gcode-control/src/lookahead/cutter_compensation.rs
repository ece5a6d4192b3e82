//! Cutter compensation: from the programmed path to the path of the tool's centre.
//!
//! After the operator's manual, "Details of cutter compensation": a block moves from the vector at its start to the
//! vector at its end, and the vector at its end depends on the next block that moves in the plane. Where a corner has
//! several vectors, the moves between them belong to the latter block.
use super::path_move::PendingItem;
use super::{Lookahead, LookaheadRequest, PathMove};
use crate::Executor;
use crate::contour::{self, Point, Segment};
use crate::eval::Checked;
use gcode_lang::alarm::Alarm;
use gcode_lang::motion::{Backtrace, EventKind, PlanarArc};
use gcode_lang::units::{Deg, MmPerMin};

/// A move whose end isn't known yet.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct PendingMove {
    pub(super) piece: PathMove,
    segment: Segment,
    /// The points it begins with: where the centre stands, and the rest of the way round the corner.
    starts: Vec<Point>,
    /// Of the centre to the left of the path.
    distance: f64,
    start_up: bool,
}

/// G39 without a direction: an arc at the corner, up to beside the next move.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct PendingCornerArc {
    place: Backtrace,
    rate: MmPerMin,
    distance: f64,
}

/// G39: its direction, if it has one, and its feed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct CornerArc {
    pub(super) towards: Option<Point>,
    pub(super) rate: MmPerMin,
}

impl PendingMove {
    fn beside_end(&self) -> Point {
        self.segment.beside_end(self.distance)
    }
}

impl Lookahead {
    /// Takes the next move of the shaped path.
    pub(super) fn drive(
        &mut self,
        core: &Executor,
        piece: PathMove,
        order: &LookaheadRequest,
    ) -> Checked<()> {
        let Some(segment) = piece.segment else {
            self.hold_behind(core, PendingItem::Move(piece));
            return Ok(());
        };
        let restated = std::mem::take(&mut self.restated) || order.restated;
        self.blocks_without_move = 0;
        let block = piece.place.block;
        if segment.is_arc() && (self.on != order.distance.is_some() || !self.on && self.is_offset()) {
            return Err(Alarm::ArcAtStartOrEnd.at(block));
        }
        let Some(distance) = order.distance else {
            return self.run_out(core, &piece, segment, order);
        };
        if segment.is_too_small(distance) {
            return Err(Alarm::Interference.at(block));
        }
        let start_up = !std::mem::replace(&mut self.on, true);
        let near = self.open.as_ref().map_or(distance, |open| open.distance.abs().copysign(distance));
        let mut starts = match self.open.take() {
            None => vec![self.point(&self.centre)],
            Some(open) => {
                let ends = if restated {
                    vec![open.beside_end()]
                } else if open.start_up && !(core.settings.start_up_b && outside(&open, &segment)) {
                    vec![segment.beside_start(near)]
                } else {
                    let met = contour::corner(&open.segment, &segment, open.distance, near);
                    met.map_err(|_| Alarm::NoIntersection.at(block))?
                };
                self.close(core, open, &ends)?
            }
        };
        if let Some(rounding) = self.rounding.take() {
            let end = segment.beside_start(distance);
            self.tell_rounding(core, &rounding, segment.from(), end)?;
            starts = vec![end];
        }
        let begins = starts.last().is_some_and(|start| segment.parallel_begins_at(*start, distance));
        if !begins {
            let what = "an arc that begins off its own parallel (a new D or G41, or blocks without a move)";
            return Err(Alarm::NotSimulated { what: what.into() }.at(block));
        }
        self.set_offset(segment.beside_end(distance) - segment.to());
        self.open = Some(PendingMove { piece, segment, starts, distance, start_up });
        Ok(())
    }

    /// A move without compensation: the one that cancels it, that takes up the vector of G40 alone, or any other.
    fn run_out(
        &mut self,
        core: &Executor,
        piece: &PathMove,
        segment: Segment,
        order: &LookaheadRequest,
    ) -> Checked<()> {
        if let Some(open) = self.open.take() {
            let ends = match order.towards {
                Some(direction) => vec![contour::towards(&open.segment, direction, open.distance)],
                None if core.settings.start_up_b && !open.start_up && outside(&open, &segment) => {
                    let met = contour::corner(&open.segment, &segment, open.distance, open.distance);
                    met.map_err(|_| Alarm::NoIntersection.at(piece.place.block))?
                }
                None => vec![open.beside_end()],
            };
            let rest = self.close(core, open, &ends)?;
            self.tell_corner(core, piece, &rest);
        }
        if let Some(rounding) = self.rounding.take() {
            let what = "G39 followed by the end of cutter compensation".into();
            return Err(Alarm::NotSimulated { what }.at(rounding.place.block));
        }
        self.on = false;
        self.set_offset(Point::zeros());
        self.tell_along(core, piece, segment.to(), 0.0);
        Ok(())
    }

    /// A move of G28, G53 and the like: in the plane it takes the vector away, and the next move starts up anew.
    pub(super) fn leave(&mut self, core: &Executor, piece: &PathMove) {
        if piece.segment.is_none() {
            return self.tell_held(core, PendingItem::Move(piece.clone()));
        }
        self.on = false;
        self.set_offset(Point::zeros());
        self.tell_straight(core, piece, piece.to());
    }

    /// Ends the open move with the centre beside its end, as where nothing follows.
    pub(super) fn settle(&mut self, core: &Executor) -> Checked<()> {
        self.blocks_without_move = 0;
        if let Some(open) = self.open.take() {
            let end = open.beside_end();
            self.set_offset(end - open.segment.to());
            self.close(core, open, &[end])?;
        }
        Ok(())
    }

    /// Tells the open move, now that the points at its end are known, and what waited behind it. The answer is where
    /// the next move begins. A way against the programmed one would cut into the part (operator's manual,
    /// interference check).
    fn close(&mut self, core: &Executor, open: PendingMove, ends: &[Point]) -> Checked<Vec<Point>> {
        if let (Some(start), Some(end)) = (open.starts.last(), ends.first()) {
            if !open.start_up && open.segment.is_reversed(*start, *end, open.distance) {
                return Err(Alarm::Interference.at(open.piece.place.block));
            }
            self.tell_corner(core, &open.piece, &open.starts);
            self.tell_along(core, &open.piece, *end, open.distance);
        }
        for held in std::mem::take(&mut self.behind) {
            self.tell_held(core, held);
        }
        Ok(ends.to_vec())
    }

    /// The moves from point to point of a corner; the first is where the centre stands.
    fn tell_corner(&mut self, core: &Executor, piece: &PathMove, points: &[Point]) {
        for point in points.iter().skip(1) {
            let to = self.with(self.centre, *point);
            self.tell_straight(core, piece, to);
        }
    }

    fn hold_behind(&mut self, core: &Executor, held: PendingItem) {
        if self.open.is_some() {
            self.behind.push(held);
        } else {
            self.tell_held(core, held);
        }
    }

    /// G39: round the corner to beside a direction at once, or to beside the next move when that is read.
    pub(super) fn round(
        &mut self,
        core: &Executor,
        arc: &CornerArc,
        order: &LookaheadRequest,
    ) -> Checked<()> {
        self.settle(core)?;
        let Some(distance) = order.distance else {
            let what = "G39 without an offset of the cutter (D0)".into();
            return Err(Alarm::NotSimulated { what }.at(order.place.block));
        };
        let rounding = PendingCornerArc { place: order.place.clone(), rate: arc.rate, distance };
        let Some(direction) = arc.towards else {
            self.rounding = Some(rounding);
            return Ok(());
        };
        let corner = self.point(&self.at);
        let end = Segment::Line { from: corner, to: corner + direction }.beside_start(distance);
        self.tell_rounding(core, &rounding, corner, end)?;
        self.set_offset(end - corner);
        Ok(())
    }

    fn tell_rounding(
        &mut self,
        core: &Executor,
        rounding: &PendingCornerArc,
        corner: Point,
        end: Point,
    ) -> Checked<()> {
        let (from, to) = (self.point(&self.centre) - corner, end - corner);
        let turn = Deg::atan2(from.x * to.y - from.y * to.x, from.dot(to));
        // Round the outside of a corner the tool turns to the side that it isn't on.
        let outside = -rounding.distance.signum();
        let sweep = if turn.abs().0 > 180.0 - 1e-6 { Deg(180.0 * outside) } else { turn };
        if sweep.0 * outside < -1e-6 {
            return Err(Alarm::Interference.at(rounding.place.block));
        }
        let to = self.with(self.centre, end);
        let arc = PlanarArc { plane: self.plane, centre: (corner.x, corner.y), sweep };
        let segment = Segment::Arc { from: self.point(&self.centre), to: end, centre: corner, sweep };
        let piece = PathMove {
            kind: EventKind::Arc { to, arc, rate: rounding.rate },
            segment: Some(segment),
            place: rounding.place.clone(),
        };
        self.tell_along(core, &piece, end, 0.0);
        Ok(())
    }
}

fn outside(open: &PendingMove, next: &Segment) -> bool {
    contour::is_outside(&open.segment, next, open.distance)
}
