//! Canned cycles G73 to G89, each a sequence of steps that the control expands.

/// Step of a cycle at a hole, after the tool has reached the R point level.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CycleStep {
    /// Feed to the bottom.
    FeedToBottom,
    /// G83: feed by Q, rapid back to R, rapid to the clearance above the last depth.
    Peck,
    /// G73: feed by Q, rapid back by the retract.
    HighSpeedPeck,
    /// Dwell P.
    Dwell,
    /// Dwell P at the R point level if the setting requires it.
    DwellAtR,
    /// Feed back to R.
    FeedToR,
    /// Rapid to the R point level, or to the initial level in G98.
    RapidToReturnLevel,
    /// After [`CycleStep::FeedToR`]: rapid on to the initial level in G98.
    RapidToInitialInG98,
    /// Rapid to the initial level in both G98 and G99.
    RapidToInitial,
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
    /// Spindle clockwise in rigid tapping; otherwise it turns as the program has started it.
    RigidForward,
    /// Spindle counterclockwise in rigid tapping.
    RigidReverse,
    /// Spindle clockwise behind a tapped hole; one that only rigid tapping has started stops.
    ForwardAgain,
    /// Spindle counterclockwise behind a tapped hole; one that only rigid tapping has started stops.
    ReverseAgain,
    /// G88: retract by hand.
    ManualRetract,
}

/// Canned cycle.
#[derive(Debug, PartialEq, Eq)]
pub struct Cycle {
    /// G code × 10.
    pub code: u32,
    /// False for G87, which reaches R from below after its shift; all others rapid to R first.
    pub rapids_to_r_first: bool,
    /// True for G73 and G83, which require Q.
    pub needs_q: bool,
    /// True for G84.2 and G84.3, which turn the spindle themselves.
    pub is_rigid: bool,
    /// Steps in order.
    pub steps: &'static [CycleStep],
    /// Description in a few words.
    pub description: &'static str,
}

impl Cycle {
    /// Returns true if Q is a length of the cycle: the depth of a peck, or the shift off the wall.
    pub fn uses_q(&self) -> bool {
        self.steps.iter().any(|step| matches!(step, Peck | HighSpeedPeck | Shift))
    }

    /// Returns true for G84 and G74, G84.2 and G84.3.
    pub fn taps(&self) -> bool {
        self.steps.iter().any(|step| matches!(step, RigidForward | RigidReverse))
    }
}

use CycleStep::{
    Dwell, DwellAtR, FeedToBottom, FeedToR, ForwardAgain, HighSpeedPeck, ManualRetract, Peck, RapidToInitial,
    RapidToInitialInG98, RapidToR, RapidToReturnLevel, ReverseAgain, RigidForward, RigidReverse, Shift,
    ShiftBack, SpindleForward, SpindleReverse, SpindleStop,
};

const fn row(code: u32, steps: &'static [CycleStep], description: &'static str) -> Cycle {
    Cycle { code, rapids_to_r_first: true, needs_q: false, is_rigid: false, steps, description }
}

/// G73: high-speed peck drilling cycle.
pub const HIGH_SPEED_PECK_DRILLING: Cycle = Cycle {
    needs_q: true,
    ..row(730, &[HighSpeedPeck, RapidToReturnLevel], "high-speed peck drilling cycle")
};
#[rustfmt::skip]
pub(super) const LEFT_HANDED_TAPPING: Cycle = row(740, &[RigidReverse, FeedToBottom, SpindleStop, Dwell, SpindleForward, FeedToR, DwellAtR, ReverseAgain, RapidToInitialInG98], "left-handed tapping cycle");
#[rustfmt::skip]
pub(super) const FINE_BORING: Cycle = row(760, &[FeedToBottom, Dwell, SpindleStop, Shift, RapidToReturnLevel, ShiftBack, SpindleForward], "fine boring cycle");
/// G81: drilling cycle.
pub const DRILLING: Cycle = row(810, &[FeedToBottom, RapidToReturnLevel], "drilling cycle, spot drilling");
pub(super) const COUNTER_BORING: Cycle =
    row(820, &[FeedToBottom, Dwell, RapidToReturnLevel], "drilling cycle, counter boring");
/// G83: peck drilling cycle.
pub const PECK_DRILLING: Cycle =
    Cycle { needs_q: true, ..row(830, &[Peck, RapidToReturnLevel], "peck drilling cycle") };
/// G84: tapping cycle.
#[rustfmt::skip]
pub const TAPPING: Cycle = row(840, &[RigidForward, FeedToBottom, SpindleStop, Dwell, SpindleReverse, FeedToR, DwellAtR, ForwardAgain, RapidToInitialInG98], "tapping cycle");
/// G84.2: rigid tapping, in the format of the series 15.
#[rustfmt::skip]
pub(super) const RIGID_TAPPING: Cycle = Cycle { code: 842, is_rigid: true, description: "rigid tapping cycle", ..TAPPING };
#[rustfmt::skip]
pub(super) const LEFT_HANDED_RIGID_TAPPING: Cycle = Cycle { code: 843, is_rigid: true, description: "left-handed rigid tapping cycle", ..LEFT_HANDED_TAPPING };
pub(super) const BORING_FEED_RETRACT: Cycle =
    row(850, &[FeedToBottom, FeedToR, RapidToInitialInG98], "boring cycle, retract by feed");
pub(super) const BORING_SPINDLE_STOP: Cycle = row(
    860,
    &[FeedToBottom, SpindleStop, RapidToReturnLevel, SpindleForward],
    "boring cycle, retract with the spindle stopped",
);
#[rustfmt::skip]
pub(super) const BACK_BORING: Cycle = Cycle { rapids_to_r_first: false, ..row(870, &[SpindleStop, Shift, RapidToR, ShiftBack, SpindleForward, FeedToBottom, Dwell, SpindleStop, Shift, RapidToInitial, ShiftBack, SpindleForward], "back boring cycle") };
/// G77 of a Haas.
pub(super) const BACK_BORING_OF_HAAS: Cycle = Cycle { code: 770, ..BACK_BORING };
/// G87 of a Haas.
pub(super) const BORING_STOP_OF_HAAS: Cycle = row(
    870,
    &[FeedToBottom, SpindleStop, ManualRetract, RapidToInitialInG98, SpindleForward],
    "boring cycle, manual retract",
);
pub(super) const BORING_MANUAL_RETRACT: Cycle = row(
    880,
    &[FeedToBottom, Dwell, SpindleStop, ManualRetract, RapidToInitialInG98, SpindleForward],
    "boring cycle, manual retract",
);
pub(super) const BORING_DWELL: Cycle =
    row(890, &[FeedToBottom, Dwell, FeedToR, RapidToInitialInG98], "boring cycle, dwell, retract by feed");
