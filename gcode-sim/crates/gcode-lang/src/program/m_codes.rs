//! Table of the M codes that the control itself executes.
use crate::control::Dialect;

/// Effect of an M code on the control.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MCodeEffect {
    /// M00: stop.
    Stop,
    /// M01: stop if the switch is on.
    OptionalStop,
    /// M02 and M30: end of the program.
    End,
    /// Spindle clockwise.
    SpindleForward,
    /// Spindle counterclockwise.
    SpindleReverse,
    /// Spindle stop.
    SpindleStop,
    /// M19 with the angle in P or R: stop of the spindle. The angle causes no motion.
    Orient,
    /// M06: tool change.
    ToolChange,
    /// G84 and G74 turn the spindle themselves until the cycle ends.
    RigidTapping,
    /// Mist or coolant on.
    CoolantOn,
    /// Coolant off.
    CoolantOff,
    /// Overrides and rigid tapping: no effect on the path.
    NoEffect,
    /// M59 and M69 of a Haas: sets or clears the output P, #12000 + P.
    Output {
        /// True for M59.
        is_on: bool,
    },
    /// M78 and M79 of a Haas beside G31: an alarm after the motion.
    SkipAlarm(SkipAlarm),
    /// M75 of a Haas beside G31: the point that G35 and G136 need.
    SkipReference,
    /// M96 of a Haas: jumps to the sequence number P if the input Q is 0.
    JumpByInput,
    /// M109 of a Haas: the operator's key into the variable P.
    OperatorInput,
    /// M96: enables a macro interrupt, whose signal never comes in a run.
    InterruptOn,
    /// M97: disables the macro interrupt.
    InterruptOff,
    /// M98, M99, M198: lowering has separated the call.
    Call,
    /// A control may have the code; the simulator does not execute it.
    NotSimulated,
}

/// Condition of the alarm after a G31.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SkipAlarm {
    /// M78: the signal came.
    OnSignal,
    /// M79: no signal came.
    OnMiss,
}

/// M code with its effect.
#[derive(Clone, Copy, Debug)]
pub struct MCodeRow {
    /// Number.
    pub code: u32,
    /// Effect.
    pub effect: MCodeEffect,
    /// Description in a few words.
    pub description: &'static str,
    /// Controls with this meaning of the code.
    pub dialects: &'static [Dialect],
}

/// Returns a row that applies to all controls.
const fn row(code: u32, effect: MCodeEffect, description: &'static str) -> MCodeRow {
    MCodeRow { code, effect, description, dialects: Dialect::ALL_CONTROLS }
}

const fn fanuc(code: u32, effect: MCodeEffect, description: &'static str) -> MCodeRow {
    MCodeRow { code, effect, description, dialects: Dialect::FANUC }
}

const fn haas(code: u32, effect: MCodeEffect, description: &'static str) -> MCodeRow {
    MCodeRow { code, effect, description, dialects: Dialect::HAAS }
}

/// Codes with an effect on the control. All others go to the machine builder's logic.
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
    row(29, MCodeEffect::RigidTapping, "rigid tapping"),
    row(30, MCodeEffect::End, "program end, rewind"),
    row(48, MCodeEffect::NoEffect, "overrides on"),
    row(49, MCodeEffect::NoEffect, "overrides off"),
    haas(16, MCodeEffect::ToolChange, "tool change"),
    haas(59, MCodeEffect::Output { is_on: true }, "output on"),
    haas(69, MCodeEffect::Output { is_on: false }, "output off"),
    haas(75, MCodeEffect::SkipReference, "reference point of G35 and G136"),
    haas(78, MCodeEffect::SkipAlarm(SkipAlarm::OnSignal), "alarm where the skip signal came"),
    haas(79, MCodeEffect::SkipAlarm(SkipAlarm::OnMiss), "alarm where no skip signal came"),
    fanuc(96, MCodeEffect::InterruptOn, "macro interrupt"),
    haas(96, MCodeEffect::JumpByInput, "jump by an input"),
    fanuc(97, MCodeEffect::InterruptOff, "macro interrupt off"),
    haas(97, MCodeEffect::NotSimulated, "local call without P"),
    row(98, MCodeEffect::Call, "subprogram call"),
    row(99, MCodeEffect::Call, "return"),
    haas(109, MCodeEffect::OperatorInput, "input by the operator"),
    fanuc(198, MCodeEffect::Call, "call of an external file"),
];

/// M codes of a Haas's machine that move no axis of a program and change nothing that a program reads: brakes of the rotary
/// axes, chip conveyor, coolant spigot, pallet ready, tool turret, door, air, coolant through the spindle, sleep, probe arm, display, spindle
/// speed variation.
const AUXILIARY_OF_HAAS: &[u32] = &[
    10, 11, 12, 13, 31, 33, 34, 35, 36, 39, 73, 74, 80, 81, 83, 84, 88, 89, 95, 104, 105, 130, 131, 138, 139,
];

/// Returns true for a code that the machine's logic executes without an effect on path and variables.
pub fn is_auxiliary(code: u32, dialect: Dialect) -> bool {
    dialect == Dialect::HaasNgc && AUXILIARY_OF_HAAS.contains(&code)
}

/// Returns true for a code that stops or ends the program.
pub fn ends_or_stops(code: u32) -> bool {
    let stops = |row: &&MCodeRow| {
        matches!(row.effect, MCodeEffect::Stop | MCodeEffect::OptionalStop | MCodeEffect::End)
    };
    M_CODES.iter().filter(stops).any(|row| row.code == code)
}

/// Returns the effect of an M code; `None` if the machine builder's logic executes it.
pub fn find(code: u32, dialect: Dialect) -> Option<MCodeEffect> {
    M_CODES.iter().find(|row| row.code == code && row.dialects.contains(&dialect)).map(|row| row.effect)
}
