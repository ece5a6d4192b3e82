//! What a move is made under: offsets, compensation, cycle and modes as a program calls them, whatever the tables hold of them.
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use gcode_control::State;
use gcode_lang::program::modes::WorkSystem;

/// One kind of modal condition.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub(super) enum ModalAspect {
    /// G54 to G59, G54.1 with its P.
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

    /// The code of a change of it.
    pub(super) fn code(self) -> &'static str {
        match self {
            Self::System => "work-system",
            Self::Length => "tool-length",
            Self::Cutter => "cutter-side",
            Self::Path => "path-mode",
            Self::Level => "return-level",
            Self::Cycle => "cycle",
        }
    }

    /// The group of its G codes.
    pub(super) fn group(self) -> u32 {
        match self {
            Self::System => 14,
            Self::Length => 8,
            Self::Cutter => 7,
            Self::Path => 15,
            Self::Level => 10,
            Self::Cycle => 9,
        }
    }

    fn read(self, state: &State) -> String {
        let modal = &state.modal;
        let group = |number| {
            let code = modal.code(number).unwrap_or_default();
            if code.is_multiple_of(10) {
                format!("G{:02}", code / 10)
            } else {
                format!("G{}.{}", code / 10, code % 10)
            }
        };
        let with = |number, off: u32, letter: char, value: u32| match modal.code(number) == Some(off) {
            true => group(number),
            false => format!("{} {letter}{value}", group(number)),
        };
        match (self, modal.cycle, state.cycle.q) {
            (Self::System, ..) => match modal.work {
                WorkSystem::Standard(_) => group(self.group()),
                WorkSystem::Additional(number) => format!("G54.1 P{number}"),
            },
            (Self::Length, ..) => with(self.group(), 490, 'H', state.codes.h),
            (Self::Cutter, ..) => with(self.group(), 400, 'D', state.codes.d),
            (Self::Path, ..) => group(self.group()),
            (Self::Level | Self::Cycle, None, _) => String::new(),
            (Self::Level, Some(_), _) => group(self.group()),
            (Self::Cycle, Some(cycle), Some(q)) if cycle.uses_q() => format!("{} Q{q}", group(self.group())),
            (Self::Cycle, Some(_), _) => group(self.group()),
        }
    }
}

/// What is in force while a step is made.
#[derive(Clone, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct ModalConditions(pub [ModalSetting; 6]);

/// One of them as a program writes it, and the block that has put it in force, by its number in the record.
#[derive(Clone, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct ModalSetting {
    /// Empty for none.
    pub text: String,
    pub place: Option<usize>,
}

impl ModalConditions {
    /// Before the first block: no block has put it in force.
    pub(super) fn at_power_on() -> Self {
        let state = State::default();
        Self(ModalAspect::ALL.map(|aspect| ModalSetting { text: aspect.read(&state), place: None }))
    }

    pub(super) fn word(&self, aspect: ModalAspect) -> &ModalSetting {
        &self.0[aspect as usize]
    }

    pub(super) fn set(&mut self, aspect: ModalAspect, word: ModalSetting) {
        self.0[aspect as usize] = word;
    }

    /// As a block leaves it: what is as before keeps the block that put it in force.
    pub(super) fn after_block(&self, state: &State, place: usize) -> Self {
        let mut next = self.clone();
        for aspect in ModalAspect::ALL {
            let text = aspect.read(state);
            if next.word(aspect).text != text {
                next.set(aspect, ModalSetting { text, place: Some(place) });
            }
        }
        next
    }
}
