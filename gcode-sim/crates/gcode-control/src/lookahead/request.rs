//! What a block commands of compensation and corner words, read off its plan.
use crate::contour::{Blend, Point};
use gcode_lang::motion::{AxisIndex, Backtrace};
use gcode_lang::units::MmPerMin;

/// One block, as far as it matters here.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct LookaheadRequest {
    pub(crate) plane: (AxisIndex, AxisIndex),
    /// Of the centre to the left of the path; `None` without compensation, be it by G40 or by D0.
    pub(crate) distance: Option<f64>,
    /// G40 with I J K: the direction of a wall that the tool comes to.
    pub(crate) wall_direction: Option<Point>,
    /// G41 or G42 stands in the block and was in force before.
    pub(crate) is_restated: bool,
    /// G28, G53, a drilling cycle…: without compensation, and nothing is read before it.
    pub(crate) suspends_compensation: bool,
    /// M00, M01, M02, M30: nothing is read before it is done.
    pub(crate) blocks_lookahead: bool,
    /// It counts as a block without a move if it has none: calls and returns don't.
    pub(crate) counts_as_block: bool,
    /// An axis of the plane is named: without a move, a move of length 0.
    pub(crate) has_zero_length: bool,
    pub(crate) is_dwell: bool,
    /// G01, G02, G03.
    pub(crate) is_cut: bool,
    pub(crate) blend: Option<Blend>,
    pub(crate) corner_arc: Option<CornerArc>,
    pub(crate) backtrace: Backtrace,
}

/// G39: its direction, if it has one, and its feed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct CornerArc {
    pub(crate) direction: Option<Point>,
    pub(crate) rate: MmPerMin,
}
