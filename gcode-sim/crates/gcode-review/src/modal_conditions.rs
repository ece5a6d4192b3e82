//! Modal conditions of a move: offsets, compensation, cycle and modes as a program commands them, without their
//! values.
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::kinds;
use gcode_control::{BlockCommands, State, modal_code};
use gcode_lang::control::Dialect;
use gcode_lang::diag::FindingKind;
use gcode_lang::program::modes::ModalGroup;

/// One kind of modal condition.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub(super) enum ModalAspect {
    /// G54 to G59, G54.1 with its P, G154 with its P on a Haas.
    System,
    /// G43 or G44 with H, G49.
    Length,
    /// G41 or G42 with D, G40.
    Cutter,
    /// G61 to G64.
    Path,
    /// G98, G99; only while a cycle is in force.
    Level,
    /// With its Q.
    Cycle,
}

impl ModalAspect {
    pub(super) const ALL: [Self; 6] =
        [Self::System, Self::Length, Self::Cutter, Self::Path, Self::Level, Self::Cycle];

    /// Returns the group of its G codes, the kind of a change of it, and its name in a list of what a record lacks.
    pub(super) fn row(self) -> (u32, &'static FindingKind, &'static str) {
        match self {
            Self::System => (14, &kinds::WORK_SYSTEM, "the work offset by its number"),
            Self::Length => (8, &kinds::TOOL_LENGTH, "tool length offsets by their numbers"),
            Self::Cutter => (7, &kinds::CUTTER_SIDE, "the cutter's side and D"),
            Self::Path => (15, &kinds::PATH_MODE, "G61 to G64"),
            Self::Level => (10, &kinds::RETURN_LEVEL, "G98 and G99"),
            Self::Cycle => (9, &kinds::CYCLE, "the canned cycle"),
        }
    }

    /// Returns true if a block commands it, by a code of its group or by the number of its offset.
    fn is_commanded(self, commands: &BlockCommands) -> bool {
        let letter = match self {
            Self::Length => Some('H'),
            Self::Cutter => Some('D'),
            Self::System | Self::Path | Self::Level | Self::Cycle => None,
        };
        commands.modes.iter().any(|(group, _)| *group == self.row().0)
            || letter.is_some_and(|letter| commands.valued_letters.contains(&letter))
    }

    /// Returns those that a block commands.
    pub(super) fn commanded_by(commands: &BlockCommands) -> [bool; 6] {
        Self::ALL.map(|aspect| aspect.is_commanded(commands))
    }

    fn read(self, state: &State, dialect: Dialect) -> String {
        let modal = &state.modal;
        let code = ModalGroup::of(self.row().0).map_or(0, |group| state.code_in_force(group));
        let group = modal_code(code);
        match (self, modal.work, modal.cycle) {
            (Self::System, ..) => modal.work.name(dialect),
            (Self::Length, ..) if code != 490 => format!("{group} H{}", state.modal_words.h),
            (Self::Cutter, ..) if code != 400 => format!("{group} D{}", state.modal_words.d),
            (Self::Level | Self::Cycle, _, None) => String::new(),
            (Self::Cycle, _, Some(cycle)) if cycle.uses_q() => match state.cycle.q {
                Some(q) => format!("{group} Q{q}"),
                None => group,
            },
            _ => group,
        }
    }
}

/// Modal conditions in force at a step, one of each aspect.
#[derive(Clone, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct ModalConditions(pub [ModalSetting; 6]);

/// A modal code as written in programs, and the number of the block that commanded it last.
#[derive(Clone, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct ModalSetting {
    /// Empty for none.
    pub text: String,
    pub block_number: Option<usize>,
}

impl ModalConditions {
    /// Returns the conditions before the first block; no block has set them.
    pub(super) fn at_power_on() -> Self {
        let state = State::default();
        Self(
            ModalAspect::ALL.map(|aspect| ModalSetting {
                text: aspect.read(&state, Dialect::default()),
                block_number: None,
            }),
        )
    }

    pub(super) fn word(&self, aspect: ModalAspect) -> &ModalSetting {
        &self.0[aspect as usize]
    }

    pub(super) fn set(&mut self, aspect: ModalAspect, word: ModalSetting) {
        self.0[aspect as usize] = word;
    }

    /// Returns the conditions after a block that commands some of them; the others keep their block.
    ///
    /// A block that commands what is in force already is the one to edit for the moves behind it.
    pub(super) fn after_block(
        &self,
        state: &State,
        dialect: Dialect,
        commanded: [bool; 6],
        block_number: usize,
    ) -> Self {
        let mut next = self.clone();
        for aspect in ModalAspect::ALL {
            let text = aspect.read(state, dialect);
            let is_commanded = commanded[aspect as usize] && !text.is_empty();
            if is_commanded || next.word(aspect).text != text {
                next.set(aspect, ModalSetting { text, block_number: Some(block_number) });
            }
        }
        next
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use gcode_lang::program::modes::WorkSystem;

    #[test]
    fn an_additional_work_coordinate_system_has_the_name_of_its_dialect() {
        let mut state = State::default();
        state.modal.work = WorkSystem::Additional(9);
        assert_eq!(ModalAspect::System.read(&state, Dialect::Fanuc31i), "G54.1 P9");
        assert_eq!(ModalAspect::System.read(&state, Dialect::HaasNgc), "G154 P9");
    }
}
