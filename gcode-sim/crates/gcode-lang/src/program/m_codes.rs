//! The table of M codes that the control itself acts on.
use crate::control::CodeSet;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MCodeEffect {
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
pub struct MCodeRow {
    pub code: u32,
    pub effect: MCodeEffect,
    pub help: &'static str,
    /// The controls that have it so.
    pub code_sets: &'static [CodeSet],
}

/// A code that all controls have.
const fn row(code: u32, effect: MCodeEffect, help: &'static str) -> MCodeRow {
    MCodeRow { code, effect, help, code_sets: CodeSet::ALL_CONTROLS }
}

const fn fanuc(code: u32, effect: MCodeEffect, help: &'static str) -> MCodeRow {
    MCodeRow { code, effect, help, code_sets: CodeSet::FANUC }
}

const fn haas(code: u32, effect: MCodeEffect, help: &'static str) -> MCodeRow {
    MCodeRow { code, effect, help, code_sets: CodeSet::HAAS }
}

/// Codes the control acts on. All others go to the machine builder's logic and have no effect on the control.
#[rustfmt::skip]
pub const M_CODES: &[MCodeRow] = &[
    row(0, MCodeEffect::Stop, "program stop"),
    row(1, MCodeEffect::OptionalStop, "optional stop"),
    row(2, MCodeEffect::End, "program end"),
    row(3, MCodeEffect::SpindleForward, "spindle clockwise"),
    row(4, MCodeEffect::SpindleReverse, "spindle counterclockwise"),
    row(5, MCodeEffect::SpindleStop, "spindle stop"),
    row(6, MCodeEffect::ToolChange, "tool change"),
    row(7, MCodeEffect::CoolantOn, "mist"),
    row(8, MCodeEffect::CoolantOn, "coolant"),
    row(9, MCodeEffect::CoolantOff, "coolant off"),
    row(19, MCodeEffect::Orient, "oriented spindle stop"),
    row(29, MCodeEffect::NoEffect, "rigid tapping"),
    row(30, MCodeEffect::End, "program end, rewind"),
    row(48, MCodeEffect::NoEffect, "overrides on"),
    row(49, MCodeEffect::NoEffect, "overrides off"),
    haas(78, MCodeEffect::NotSimulated, "alarm where the skip signal came"),
    haas(79, MCodeEffect::NotSimulated, "alarm where no skip signal came"),
    fanuc(96, MCodeEffect::InterruptOn, "macro interrupt"),
    haas(96, MCodeEffect::NotSimulated, "jump by an input"),
    fanuc(97, MCodeEffect::InterruptOff, "macro interrupt off"),
    haas(97, MCodeEffect::NotSimulated, "local call without P"),
    row(98, MCodeEffect::Call, "subprogram call"),
    row(99, MCodeEffect::Call, "return"),
    haas(109, MCodeEffect::NotSimulated, "input by the operator"),
    fanuc(198, MCodeEffect::Call, "call of an external file"),
];

/// Whether the program would run on without this code.
pub fn ends_or_stops(code: u32) -> bool {
    let stops = |row: &&MCodeRow| {
        matches!(row.effect, MCodeEffect::Stop | MCodeEffect::OptionalStop | MCodeEffect::End)
    };
    M_CODES.iter().filter(stops).any(|row| row.code == code)
}

/// What a control does at an M code; `None` leaves it to the machine builder's logic.
pub fn find(code: u32, set: CodeSet) -> Option<MCodeEffect> {
    M_CODES.iter().find(|row| row.code == code && row.code_sets.contains(&set)).map(|row| row.effect)
}
