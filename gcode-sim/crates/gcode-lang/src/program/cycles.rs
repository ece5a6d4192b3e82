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
    SpindleStop,
    SpindleForward,
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
    pub steps: &'static [CycleStep],
    pub help: &'static str,
}

use CycleStep::{
    Dwell, DwellAtR, FeedToBottom, FeedToR, ManualRetract, PeckFull, PeckShort, RapidBack, RapidToInitial,
    RapidToInitialAlways, RapidToR, Shift, ShiftBack, SpindleForward, SpindleReverse, SpindleStop,
};

const fn row(code: u32, steps: &'static [CycleStep], help: &'static str) -> Cycle {
    Cycle { code, starts_at_r: true, needs_q: false, steps, help }
}

/// All drilling cycles, by code.
#[rustfmt::skip]
pub const CYCLES: [Cycle; 12] = [
    Cycle { needs_q: true, ..row(730, &[PeckShort, RapidBack], "drill in pecks, short retract") },
    row(740, &[SpindleReverse, FeedToBottom, SpindleStop, Dwell, SpindleForward, FeedToR, DwellAtR, SpindleReverse, RapidToInitial], "tap, left hand"),
    row(760, &[FeedToBottom, Dwell, SpindleStop, Shift, RapidBack, ShiftBack, SpindleForward], "bore, shift off the wall at the bottom"),
    row(810, &[FeedToBottom, RapidBack], "drill"),
    row(820, &[FeedToBottom, Dwell, RapidBack], "drill, dwell at the bottom"),
    Cycle { needs_q: true, ..row(830, &[PeckFull, RapidBack], "drill in pecks, retract to R") },
    row(840, &[SpindleForward, FeedToBottom, SpindleStop, Dwell, SpindleReverse, FeedToR, DwellAtR, SpindleForward, RapidToInitial], "tap"),
    row(850, &[FeedToBottom, FeedToR, RapidToInitial], "bore, feed back"),
    row(860, &[FeedToBottom, SpindleStop, RapidBack, SpindleForward], "bore, stop the spindle at the bottom"),
    Cycle { starts_at_r: false, ..row(870, &[SpindleStop, Shift, RapidToR, ShiftBack, SpindleForward, FeedToBottom, Dwell, SpindleStop, Shift, RapidToInitialAlways, ShiftBack, SpindleForward], "bore from the back") },
    row(880, &[FeedToBottom, Dwell, SpindleStop, ManualRetract, RapidToInitial, SpindleForward], "bore, retract by hand"),
    row(890, &[FeedToBottom, Dwell, FeedToR, RapidToInitial], "bore, dwell, feed back"),
];

/// The row of a cycle by its place in [`CYCLES`].
pub fn find(code: u32) -> Option<&'static Cycle> {
    CYCLES.iter().find(|cycle| cycle.code == code)
}
