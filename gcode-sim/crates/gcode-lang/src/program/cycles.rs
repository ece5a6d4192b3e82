//! The drilling cycles G73 to G89: each a row of steps that the control expands.

/// What a cycle does at a hole after the tool has come to the R level.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CycleStep {
    /// Feed to the bottom.
    FeedToBottom,
    /// G83: feed by Q, rapid back to R, rapid down to the clearance above the last depth.
    PeckFull,
    /// G73: feed by Q, rapid back by the retract.
    PeckShort,
    /// Dwell P.
    Dwell,
    /// Dwell P at the R level, where the setting says so.
    DwellAtR,
    /// Feed back to R.
    FeedToR,
    /// Rapid to R, or to the initial level under G98.
    RapidBack,
    /// After [`Step::FeedToR`]: rapid on to the initial level under G98.
    RapidToInitial,
    /// Rapid to the initial level whatever G98/G99 say.
    RapidToInitialAlways,
    /// Rapid by Q in the plane, away from the wall.
    Shift,
    /// Rapid back to the hole's axis.
    ShiftBack,
    /// G87: rapid to R while shifted.
    RapidToR,
    /// Spindle stop.
    SpindleStop,
    /// Spindle on, clockwise (M03).
    SpindleForward,
    /// Spindle on, counterclockwise (M04).
    SpindleReverse,
    /// G88: the operator retracts by hand.
    ManualRetract,
}

/// One drilling cycle.
#[derive(Debug, PartialEq, Eq)]
pub struct Cycle {
    /// G code × 10.
    pub code: u32,
    /// G87 goes to R from below, after its shift; all others rapid to R first.
    pub starts_at_r: bool,
    /// G73 and G83 can't do without Q.
    pub needs_q: bool,
    /// Steps of one hole, in order.
    pub steps: &'static [CycleStep],
    /// One line of help.
    pub help: &'static str,
}

impl Cycle {
    /// Returns true if Q is a length of the cycle: the depth of a peck, or the shift off the wall.
    pub fn uses_q(&self) -> bool {
        self.steps.iter().any(|step| matches!(step, PeckFull | PeckShort | Shift))
    }
}

use CycleStep::{
    Dwell, DwellAtR, FeedToBottom, FeedToR, ManualRetract, PeckFull, PeckShort, RapidBack, RapidToInitial,
    RapidToInitialAlways, RapidToR, Shift, ShiftBack, SpindleForward, SpindleReverse, SpindleStop,
};

const fn row(code: u32, steps: &'static [CycleStep], help: &'static str) -> Cycle {
    Cycle { code, starts_at_r: true, needs_q: false, steps, help }
}

/// G73.
pub const PECK_DRILL_SHORT: Cycle =
    Cycle { needs_q: true, ..row(730, &[PeckShort, RapidBack], "drill in pecks, short retract") };
/// G74.
#[rustfmt::skip]
pub const TAP_LEFT_HAND: Cycle = row(740, &[SpindleReverse, FeedToBottom, SpindleStop, Dwell, SpindleForward, FeedToR, DwellAtR, SpindleReverse, RapidToInitial], "tap, left hand");
/// G76.
#[rustfmt::skip]
pub const BORE_SHIFT: Cycle = row(760, &[FeedToBottom, Dwell, SpindleStop, Shift, RapidBack, ShiftBack, SpindleForward], "bore, shift off the wall at the bottom");
/// G81.
pub const DRILL: Cycle = row(810, &[FeedToBottom, RapidBack], "drill");
/// G82.
pub const DRILL_DWELL: Cycle = row(820, &[FeedToBottom, Dwell, RapidBack], "drill, dwell at the bottom");
/// G83.
pub const PECK_DRILL: Cycle =
    Cycle { needs_q: true, ..row(830, &[PeckFull, RapidBack], "drill in pecks, retract to R") };
/// G84.
#[rustfmt::skip]
pub const TAP: Cycle = row(840, &[SpindleForward, FeedToBottom, SpindleStop, Dwell, SpindleReverse, FeedToR, DwellAtR, SpindleForward, RapidToInitial], "tap");
/// G85.
pub const BORE_FEED_BACK: Cycle = row(850, &[FeedToBottom, FeedToR, RapidToInitial], "bore, feed back");
/// G86.
pub const BORE_SPINDLE_STOP: Cycle =
    row(860, &[FeedToBottom, SpindleStop, RapidBack, SpindleForward], "bore, stop the spindle at the bottom");
/// G87.
#[rustfmt::skip]
pub const BACK_BORE: Cycle = Cycle { starts_at_r: false, ..row(870, &[SpindleStop, Shift, RapidToR, ShiftBack, SpindleForward, FeedToBottom, Dwell, SpindleStop, Shift, RapidToInitialAlways, ShiftBack, SpindleForward], "bore from the back") };
/// G88.
pub const BORE_BY_HAND: Cycle = row(
    880,
    &[FeedToBottom, Dwell, SpindleStop, ManualRetract, RapidToInitial, SpindleForward],
    "bore, retract by hand",
);
/// G89.
pub const BORE_DWELL: Cycle =
    row(890, &[FeedToBottom, Dwell, FeedToR, RapidToInitial], "bore, dwell, feed back");
