//! Motion that may be in force in blocks that the run skips.
use crate::registers::Registers;
use gcode_lang::program::g_codes::Effect;
use gcode_lang::program::modes::Motion;
use gcode_lang::program::{OpKind, WordOperand, Words};

/// Motion that may be in force in a stretch of blocks that the run skips.
#[derive(Clone, Copy, Debug)]
pub(super) struct PossibleMotion {
    /// Code 01 may be another than G00.
    may_feed: bool,
    /// A canned cycle may be in force.
    may_drill: bool,
    /// Ways may meet in the stretch: a block may set a mode, and none ends it.
    has_ways: bool,
}

impl PossibleMotion {
    /// Returns the motion in force now, for blocks in a row.
    pub(super) fn of(registers: &Registers) -> Self {
        let modal = &registers.state.modal;
        Self { may_feed: modal.motion != Motion::Rapid, may_drill: modal.cycle.is_some(), has_ways: false }
    }

    /// Returns the motion in force now, for blocks that any way may reach.
    pub(super) fn of_ways(registers: &Registers) -> Self {
        Self { has_ways: true, ..Self::of(registers) }
    }

    /// Returns the motion in force behind two ways.
    pub(super) fn or(self, other: Self) -> Self {
        Self {
            may_feed: self.may_feed || other.may_feed,
            may_drill: self.may_drill || other.may_drill,
            has_ways: self.has_ways,
        }
    }

    /// Returns the motion in force behind an operation.
    pub(super) fn behind(self, registers: &Registers, kind: &OpKind) -> Self {
        match kind {
            OpKind::Words(words) => self.behind_words(registers, words),
            OpKind::If { then, .. } => self.or(self.behind(registers, then)),
            OpKind::Empty | OpKind::AssignDirect(_) | OpKind::Statement(_) | OpKind::Alarm(_) => self,
        }
    }

    /// Returns the motion in force in a block of words and behind it.
    pub(super) fn behind_words(self, registers: &Registers, words: &Words) -> Self {
        let any = Self { may_feed: true, may_drill: true, ..self };
        if words.call().is_some() {
            return any;
        }
        let codes = words.list.iter().filter(|word| word.letter == b'G');
        let behind = codes.fold(self, |motion, word| {
            let WordOperand::G(_, found) = &word.value else { return any };
            match found.row_for(registers.data.settings.codes).map(|row| &row.effect) {
                Some(Effect::Motion(code)) => {
                    Self { may_feed: *code != Motion::Rapid, may_drill: false, ..motion }
                }
                Some(Effect::Cycle(cycle)) => Self { may_drill: cycle.is_some(), ..motion },
                _ => motion,
            }
        });
        let may_differ = self.has_ways || words.form_if_skipped().is_some();
        if may_differ { self.or(behind) } else { behind }
    }

    /// Returns true if a block with axis words may drill by a canned cycle.
    pub(super) fn drills(self) -> bool {
        self.may_drill
    }

    /// Returns true if a block with axis words may cut.
    pub(super) fn cuts(self) -> bool {
        self.may_feed || self.may_drill
    }
}
