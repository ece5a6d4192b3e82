//! The table of M codes that the control itself acts on.
use crate::control::CodeSet;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MEffect {
    Stop,
    OptionalStop,
    /// M02 and M30.
    End,
    SpindleForward,
    SpindleReverse,
    SpindleStop,
    /// M19, with the angle in P or R: the spindle stands, at which angle moves nothing.
    Orient,
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
    /// A control may have it; this one does not execute it.
    NotSimulated,
}

#[derive(Clone, Copy, Debug)]
pub struct MRow {
    pub code: u32,
    pub effect: MEffect,
    pub help: &'static str,
    /// The controls that have it so.
    pub on: &'static [CodeSet],
}

/// A code that all controls have.
const fn row(code: u32, effect: MEffect, help: &'static str) -> MRow {
    MRow { code, effect, help, on: CodeSet::EVERY }
}

const fn fanuc(code: u32, effect: MEffect, help: &'static str) -> MRow {
    MRow { code, effect, help, on: CodeSet::FANUC }
}

const fn haas(code: u32, effect: MEffect, help: &'static str) -> MRow {
    MRow { code, effect, help, on: CodeSet::HAAS }
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
    row(19, MEffect::Orient, "oriented spindle stop"),
    row(29, MEffect::NoEffect, "rigid tapping"),
    row(30, MEffect::End, "program end, rewind"),
    row(48, MEffect::NoEffect, "overrides on"),
    row(49, MEffect::NoEffect, "overrides off"),
    haas(78, MEffect::NotSimulated, "alarm where the skip signal came"),
    haas(79, MEffect::NotSimulated, "alarm where no skip signal came"),
    fanuc(96, MEffect::InterruptOn, "macro interrupt"),
    haas(96, MEffect::NotSimulated, "jump by an input"),
    fanuc(97, MEffect::InterruptOff, "macro interrupt off"),
    haas(97, MEffect::NotSimulated, "local call without P"),
    row(98, MEffect::Call, "subprogram call"),
    row(99, MEffect::Call, "return"),
    haas(109, MEffect::NotSimulated, "input by the operator"),
    fanuc(198, MEffect::Call, "call of an external file"),
];

/// Whether the program would run on without this code.
pub fn ends_or_stops(code: u32) -> bool {
    let stops = |row: &&MRow| matches!(row.effect, MEffect::Stop | MEffect::OptionalStop | MEffect::End);
    M_CODES.iter().filter(stops).any(|row| row.code == code)
}

/// What a control does at an M code; `None` leaves it to the machine builder's logic.
pub fn find(code: u32, set: CodeSet) -> Option<MEffect> {
    M_CODES.iter().find(|row| row.code == code && row.on.contains(&set)).map(|row| row.effect)
}
