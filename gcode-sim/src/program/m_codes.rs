//! The table of M codes that the control itself acts on.

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MEffect {
    Stop,
    OptionalStop,
    /// M02 and M30.
    End,
    SpindleForward,
    SpindleReverse,
    SpindleStop,
    ToolChange,
    CoolantOn,
    CoolantOff,
    /// Overrides, orientation, rigid tapping: no effect on the path.
    NoEffect,
    /// M96 and M97: a signal that never comes in a run would call a macro.
    InterruptOn,
    InterruptOff,
    /// M98, M99, M198: taken out of the words when they were lowered.
    Call,
}

#[derive(Clone, Copy, Debug)]
pub struct MRow {
    pub code: u32,
    pub effect: MEffect,
    pub help: &'static str,
}

const fn row(code: u32, effect: MEffect, help: &'static str) -> MRow {
    MRow { code, effect, help }
}

/// Codes the control acts on. All others go to the machine builder's logic and have no effect on the control.
#[rustfmt::skip]
pub const M_CODES: &[MRow] = &[
    row(0, MEffect::Stop, "program stop"),
    row(1, MEffect::OptionalStop, "optional stop"),
    row(2, MEffect::End, "program end"),
    row(3, MEffect::SpindleForward, "spindle clockwise"),
    row(4, MEffect::SpindleReverse, "spindle counterclockwise"),
    row(5, MEffect::SpindleStop, "spindle stop"),
    row(6, MEffect::ToolChange, "tool change"),
    row(7, MEffect::CoolantOn, "mist"),
    row(8, MEffect::CoolantOn, "coolant"),
    row(9, MEffect::CoolantOff, "coolant off"),
    row(19, MEffect::SpindleStop, "oriented spindle stop"),
    row(29, MEffect::NoEffect, "rigid tapping"),
    row(30, MEffect::End, "program end, rewind"),
    row(48, MEffect::NoEffect, "overrides on"),
    row(49, MEffect::NoEffect, "overrides off"),
    row(96, MEffect::InterruptOn, "macro interrupt"),
    row(97, MEffect::InterruptOff, "macro interrupt off"),
    row(98, MEffect::Call, "subprogram call"),
    row(99, MEffect::Call, "return"),
    row(198, MEffect::Call, "call of an external file"),
];

/// Whether the program would run on without this code.
pub fn ends_or_stops(code: u32) -> bool {
    matches!(find(code), Some(MEffect::Stop | MEffect::OptionalStop | MEffect::End))
}

/// What the control does at an M code; `None` leaves it to the machine builder's logic.
pub fn find(code: u32) -> Option<MEffect> {
    M_CODES.iter().find(|row| row.code == code).map(|row| row.effect)
}
