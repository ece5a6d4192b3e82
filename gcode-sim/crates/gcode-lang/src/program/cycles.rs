//! Canned cycles G73 to G89, each a sequence of steps that the control expands.

/// Step of a cycle at a hole, after the tool has reached the R level.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CycleStep {
    /// Feed to the bottom.
    FeedToBottom,
    /// G83: feed by Q, rapid back to R, rapid to the clearance above the last depth.
    PeckFull,
    /// G73: feed by Q, rapid back by the retract.
    PeckShort,
    /// Dwell P.
    Dwell,
    /// Dwell P at the R level if the setting requires it.
    DwellAtR,
    /// Feed back to R.
    FeedToR,
    /// Rapid to R, or to the initial level in G98.
    RapidBack,
    /// After [`CycleStep::FeedToR`]: rapid on to the initial level in G98.
    RapidToInitial,
    /// Rapid to the initial level in both G98 and G99.
    RapidToInitialAlways,
    /// Rapid by Q in the plane, away from the wall.
    Shift,
    /// Rapid back to the axis of the hole.
    ShiftBack,
    /// G87: rapid to R in the shifted position.
    RapidToR,
    /// Spindle stop.
    SpindleStop,
    /// Spindle clockwise.
    SpindleForward,
    /// Spindle counterclockwise.
    SpindleReverse,
    /// G88: retract by hand.
    ManualRetract,
}

/// Canned cycle.
#[derive(Debug, PartialEq, Eq)]
pub struct Cycle {
    /// G code × 10.
    pub code: u32,
    /// False for G87, which reaches R from below after its shift; all others rapid to R first.
    pub starts_at_r: bool,
    /// True for G73 and G83, which require Q.
    pub needs_q: bool,
    /// Steps in order.
    pub steps: &'static [CycleStep],
    /// Description in a few words.
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
#[rustfmt::skip]
pub(super) const TAP_LEFT_HAND: Cycle = row(740, &[SpindleReverse, FeedToBottom, SpindleStop, Dwell, SpindleForward, FeedToR, DwellAtR, SpindleReverse, RapidToInitial], "tap, left hand");
#[rustfmt::skip]
pub(super) const BORE_SHIFT: Cycle = row(760, &[FeedToBottom, Dwell, SpindleStop, Shift, RapidBack, ShiftBack, SpindleForward], "bore, shift off the wall at the bottom");
/// G81.
pub const DRILL: Cycle = row(810, &[FeedToBottom, RapidBack], "drill");
pub(super) const DRILL_DWELL: Cycle =
    row(820, &[FeedToBottom, Dwell, RapidBack], "drill, dwell at the bottom");
/// G83.
pub const PECK_DRILL: Cycle =
    Cycle { needs_q: true, ..row(830, &[PeckFull, RapidBack], "drill in pecks, retract to R") };
/// G84.
#[rustfmt::skip]
pub const TAP: Cycle = row(840, &[SpindleForward, FeedToBottom, SpindleStop, Dwell, SpindleReverse, FeedToR, DwellAtR, SpindleForward, RapidToInitial], "tap");
pub(super) const BORE_FEED_BACK: Cycle =
    row(850, &[FeedToBottom, FeedToR, RapidToInitial], "bore, feed back");
pub(super) const BORE_SPINDLE_STOP: Cycle =
    row(860, &[FeedToBottom, SpindleStop, RapidBack, SpindleForward], "bore, stop the spindle at the bottom");
#[rustfmt::skip]
pub(super) const BACK_BORE: Cycle = Cycle { starts_at_r: false, ..row(870, &[SpindleStop, Shift, RapidToR, ShiftBack, SpindleForward, FeedToBottom, Dwell, SpindleStop, Shift, RapidToInitialAlways, ShiftBack, SpindleForward], "bore from the back") };
pub(super) const BORE_BY_HAND: Cycle = row(
    880,
    &[FeedToBottom, Dwell, SpindleStop, ManualRetract, RapidToInitial, SpindleForward],
    "bore, retract by hand",
);
pub(super) const BORE_DWELL: Cycle =
    row(890, &[FeedToBottom, Dwell, FeedToR, RapidToInitial], "bore, dwell, feed back");
