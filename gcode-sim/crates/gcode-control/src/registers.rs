//! Everything that a program can read: variables, modes, positions, tables, signals and clocks.
use super::data::ControlData;
use super::linear_motion::CoordinateBasis;
use super::lookahead::Lookahead;
use super::outcome::BlockEffects;
use super::panel::{Clock, Panel};
use super::state::State;
use super::variables::{OperandStack, Vars};
use gcode_lang::control::Settings;

/// Values from which expressions, words and system variables are evaluated, and which blocks change.
#[derive(Clone, Debug)]
pub(super) struct Registers {
    pub(super) data: ControlData,
    pub(super) variables: Vars,
    /// Modes and positions, which a block of words replaces as a whole.
    pub(super) state: Box<State>,
    /// Blocks that are read and wait for the next move.
    pub(super) lookahead: Lookahead,
    pub(super) panel: Panel,
    pub(super) clock: Clock,
    pub(super) operand_stack: OperandStack,
    pub(super) block_effects: BlockEffects,
    /// Origin and units of axis words while a block can be a plain move.
    pub(super) plain_basis: Option<CoordinateBasis>,
}

impl Registers {
    pub(super) fn new(settings: Settings) -> Self {
        let variables = Vars::new(settings.extra_commons, settings.aliases_commons);
        Self {
            data: ControlData::new(settings),
            variables,
            state: Box::default(),
            lookahead: Lookahead::default(),
            panel: Panel::default(),
            clock: Clock::default(),
            operand_stack: OperandStack::default(),
            block_effects: BlockEffects::default(),
            plain_basis: None,
        }
    }

    /// Returns true if a program that continues from here can't distinguish the two, except by a clock that it reads.
    pub(super) fn continues_like(&self, other: &Self) -> bool {
        let Self {
            data,
            variables,
            state,
            lookahead,
            panel,
            clock,
            // Empty between two blocks.
            operand_stack: _,
            block_effects: _,
            // Derived from the rest.
            plain_basis: _,
        } = self;
        **state == *other.state
            && variables.has_same_values(&other.variables)
            && *lookahead == other.lookahead
            && *panel == other.panel
            && clock.continues_like(&other.clock)
            && *data == other.data
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::variables::Value;

    #[test]
    fn a_difference_that_a_program_can_read_makes_registers_differ() {
        let registers = Registers::new(Settings::default());
        let differs = |change: fn(&mut Registers)| {
            let mut other = registers.clone();
            change(&mut other);
            !registers.continues_like(&other)
        };
        assert!(!differs(|_| {}));
        assert!(differs(|r| r.variables.set(500, Value::Number(0.0))), "vacant is not 0");
        assert!(differs(|r| r.state.machine[1] = 0.001));
        assert!(differs(|r| r.panel.outputs = 1));
        assert!(differs(|r| r.data.settings.date += 1));
        assert!(differs(|r| r.data.set_work_offset(1, 0, 0.0)), "G54 has been set");
        assert!(differs(|r| r.clock.idle_seconds = 0.001));
        assert!(!differs(|r| r.clock.motion_seconds = 0.001), "motion alone decides nothing");
    }
}
