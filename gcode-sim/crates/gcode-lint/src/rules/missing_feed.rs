//! Rule: a feed move or a canned cycle that no F precedes on any path: PS0011, and PS0025 for an arc.
//!
//! The motion mode and the cycle are carried along all paths to a block. They are unknown where a setting of
//! the control decides them (at power-on), a caller or a called program; an unknown mode is no finding.
use gcode_lang::program::code_facts::AxisWords;
use gcode_lang::program::g_codes::{Effect, GCodeRow};
use gcode_lang::program::modes::{Motion, Rotation, Scaling, StrokeCheck};
use gcode_lang::program::{LoweredWord, WordOperand, Words};

use crate::context::has_feed_word;
use crate::prelude::*;

pub(super) static RULE: Rule = Rule::new("missing-feed", Severity::Error, "a feed move before any F", find);

fn find(context: &CheckContext<'_>, unit: &ProgramUnit<'_>) -> Vec<Diagnostic> {
    // The caller of a program may have set the feed.
    if unit.role != Role::Main {
        return Vec::new();
    }
    let before = modes_before(context, unit);
    let alarms = unit.reached_words().filter_map(|(block, words)| {
        let alarm = missing_feed_alarm(context, unit, block, words, &before[block]?)?;
        Some((block, alarm.located_at(unit.op(block).span)))
    });
    alarms.map(|(block, alarm)| context.alarm_finding(unit, &RULE.kind, block, &alarm)).collect()
}

/// Possible modes before a block: each is true if it holds on some path to the block.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct PossibleModes {
    /// F is commanded.
    has_feed: bool,
    /// The motion mode is G00.
    is_rapid: bool,
    /// The motion mode is not an arc.
    is_straight: bool,
    /// No canned cycle is in force.
    is_outside_cycle: bool,
    /// A canned cycle is in force.
    is_in_cycle: bool,
    /// No earlier block lacks F. The first that does stops the control, and its F serves the blocks after it.
    is_unreported: bool,
}

impl PossibleModes {
    /// Modes at power-on; a setting of the control decides between G00 and G01.
    const POWER_ON: Self = Self {
        has_feed: false,
        is_rapid: true,
        is_straight: true,
        is_outside_cycle: true,
        is_in_cycle: false,
        is_unreported: true,
    };
    const ANYTHING: Self = Self { has_feed: true, ..Self::POWER_ON };

    fn join(self, other: Self) -> Self {
        Self {
            has_feed: self.has_feed | other.has_feed,
            is_rapid: self.is_rapid | other.is_rapid,
            is_straight: self.is_straight | other.is_straight,
            is_outside_cycle: self.is_outside_cycle | other.is_outside_cycle,
            is_in_cycle: self.is_in_cycle | other.is_in_cycle,
            is_unreported: self.is_unreported | other.is_unreported,
        }
    }

    fn with_unknown_motion(self) -> Self {
        Self { is_rapid: true, is_straight: true, is_outside_cycle: true, ..self }
    }

    /// Returns the modes after a G code; a code of group 01 ends a cycle.
    fn after_effect(self, effect: Effect) -> Self {
        match effect {
            Effect::Motion(motion) => Self {
                is_rapid: motion == Motion::Rapid,
                is_straight: !matches!(motion, Motion::Clockwise | Motion::Counterclockwise),
                is_outside_cycle: true,
                is_in_cycle: false,
                ..self
            },
            Effect::Cycle(cycle) => {
                Self { is_outside_cycle: cycle.is_none(), is_in_cycle: cycle.is_some(), ..self }
            }
            _ => self,
        }
    }
}

/// Returns the possible modes before each block; `None` for an unreachable block.
fn modes_before(context: &CheckContext<'_>, unit: &ProgramUnit<'_>) -> Vec<Option<PossibleModes>> {
    // Any block may precede the start of a call with Q.
    let entries = std::iter::once(PossibleModes::POWER_ON).chain(std::iter::repeat(PossibleModes::ANYTHING));
    let starts = unit.entry_blocks.iter().copied().zip(entries);
    let next = |block: OpIndex, before: &PossibleModes| {
        let is_block = block < unit.program.ops().len();
        let after = if is_block { modes_after(context, unit, block, before) } else { *before };
        unit.flow.successors(block).map(|to| (to, after)).collect()
    };
    unit.flow.propagate(starts, |known, other| *known = known.join(other), next)
}

fn modes_after(
    context: &CheckContext<'_>,
    unit: &ProgramUnit<'_>,
    block: OpIndex,
    before: &PossibleModes,
) -> PossibleModes {
    let op = unit.op(block);
    let after = match op.kind() {
        OpKind::Words(words) => {
            let mut after = after_words(context, words, before);
            if let Some((_, short)) = words.form_if_skipped() {
                after = after.join(after_words(context, short, before));
            }
            after.is_unreported &= missing_feed_alarm(context, unit, block, words, before).is_none();
            after_call(context, unit, block, before, after)
        }
        // The conditional part may have F.
        OpKind::If { .. } => PossibleModes::ANYTHING,
        OpKind::Empty | OpKind::Statement(_) | OpKind::AssignDirect(_) | OpKind::Alarm(_) => *before,
    };
    if op.skip().is_some() { after.join(*before) } else { after }
}

fn after_words(context: &CheckContext<'_>, words: &Words, before: &PossibleModes) -> PossibleModes {
    let mut after = *before;
    for word in &words.list {
        if is_computed_g_code(word) {
            after = after.with_unknown_motion();
        } else if let Some(row) = context.g_code_row(word) {
            after = after.after_effect(row.effect);
        }
    }
    PossibleModes { has_feed: after.has_feed || has_feed_word(words), ..after }
}

/// Returns the modes after the call of a block, if it has one; `after` are the modes after its words.
fn after_call(
    context: &CheckContext<'_>,
    unit: &ProgramUnit<'_>,
    block: OpIndex,
    before: &PossibleModes,
    after: PossibleModes,
) -> PossibleModes {
    let Some(call) = unit.call_in(block) else { return after };
    let called = context.called_unit(call).map(|called| &context.units[called]);
    // A modal call is repeated after later blocks, or takes their words as arguments. The calls of a called
    // program are not followed.
    let Some(called) = called.filter(|called| !call.is_modal && called.calls.is_empty()) else {
        return PossibleModes::ANYTHING;
    };
    // The words may be arguments of a code that calls a program.
    let mut after = after.join(*before);
    for op in called.program.ops() {
        match op.kind() {
            OpKind::Words(words) => {
                let sets_motion = words.list.iter().any(is_computed_g_code)
                    || context.has_effect(words, |e| matches!(e, Effect::Motion(_) | Effect::Cycle(_)));
                after = if sets_motion { after.with_unknown_motion() } else { after };
                after.has_feed |= has_feed_word(words);
            }
            OpKind::If { .. } => return PossibleModes::ANYTHING,
            OpKind::Empty | OpKind::Statement(_) | OpKind::AssignDirect(_) | OpKind::Alarm(_) => {}
        }
    }
    after
}

fn is_computed_g_code(word: &LoweredWord) -> bool {
    word.letter == b'G' && !matches!(word.value, WordOperand::G(..))
}

/// Returns the alarm of a block that is a feed move or a canned cycle without a preceding F, if no block before it has raised it.
fn missing_feed_alarm(
    context: &CheckContext<'_>,
    unit: &ProgramUnit<'_>,
    block: OpIndex,
    words: &Words,
    before: &PossibleModes,
) -> Option<Alarm> {
    let names_axis = || words.list.iter().any(|word| context.settings.axes.find(word.letter).is_some());
    let lacks_feed = before.is_unreported
        && !before.has_feed
        && !has_feed_word(words)
        && names_axis()
        // The words may be arguments of a code that calls a program.
        && words.call().is_none()
        && unit.call_in(block).is_none();
    let modes = lacks_feed.then(|| modes_of_move(context, words, before)).flatten()?;
    let is_feed = !(modes.is_rapid && modes.is_outside_cycle);
    let is_arc = !modes.is_straight && !modes.is_in_cycle;
    is_feed.then_some(if is_arc { Alarm::ArcFeedZero } else { Alarm::FeedZero })
}

/// Returns the modes in which a block moves its axes; `None` if its axis words may be no move.
fn modes_of_move(context: &CheckContext<'_>, words: &Words, before: &PossibleModes) -> Option<PossibleModes> {
    let mut modes = *before;
    for word in words.list.iter().filter(|word| word.letter == b'G') {
        // A computed code and one that the control lacks have no row.
        let row = context.g_code_row(word).filter(|row| !uses_axis_words(row))?;
        modes = modes.after_effect(row.effect);
    }
    Some(modes)
}

/// Returns true for a code for which the axis words of its block are neither a move nor a hole, and for one that
/// raises another alarm.
fn uses_axis_words(row: &GCodeRow) -> bool {
    let is_move = matches!(row.facts.axis_words, AxisWords::Move | AxisWords::Hole);
    // The axis words of these modes are a centre, an axis of reflection or limits.
    let is_transform = matches!(
        row.effect,
        Effect::Scaling(Scaling::On)
            | Effect::Rotation(Rotation::On | Rotation::Tilted | Rotation::TiltedFurther)
            | Effect::Mirror(_)
            | Effect::StrokeCheck(StrokeCheck::On)
    );
    !is_move || is_transform || matches!(row.effect, Effect::NotSimulated | Effect::Call)
}

#[cfg(test)]
mod tests {
    use super::super::testing::{NOWHERE, lines, messages};
    use super::RULE;

    #[test]
    fn a_feed_move_is_reported_if_no_path_has_an_f() {
        assert_eq!(lines(&RULE, "O1\nG0 X5.\nG1 X10.\nM30\n"), [3]);
        assert_eq!(
            lines(&RULE, "O1\nIF[#500 EQ 1]GOTO 5\nG2 X1. R5.\nN5 G1 X10.\nG1 Y5. F100.\nM30\n"),
            [3, 4]
        );
        assert_eq!(lines(&RULE, "O1\nM98 P2\nG1 X10.\nM30\nO2\nG0 X1.\nM99\n"), [3]);
    }

    #[test]
    fn the_motion_mode_is_carried_to_later_blocks() {
        for (text, found) in [
            ("O1\nG1\nX10.\nM30\n", 3),
            ("O1\nG0 X1.\nIF[#500 EQ 1]GOTO 5\nG1\nGOTO 6\nN5 G2\nN6 X1. R5.\nM30\n", 7),
            ("O1\nG1\n#1=5.\nG91 X#1\nM30\n", 4),
            ("O1\nG1\nG4 X1.\nM8\nM98 P2\nX10.\nM30\nO2\nM9\nM99\n", 6),
            ("O1\nG81 X10. Z-5. R2.\nM30\n", 2),
            ("O1\nG90 G99 G83 Z-5. R2. Q1. L0\nM30\n", 2),
            ("O1\nG0 G81 R2. K0\nX10.\nM30\n", 3),
            ("O1\nG1\nG81 R2.\nG80\nX10.\nM30\n", 5),
            ("O1\nG33 Z-5.\nM30\n", 2),
            ("O1\nG1\nG69 X5.\nM30\n", 3),
        ] {
            assert_eq!(lines(&RULE, text), [found], "{text}");
        }
    }

    #[test]
    fn an_arc_has_an_alarm_of_its_own() {
        for (text, alarm) in [
            ("O1\nG2 X1. R5.\nM30\n", "PS0025"),
            ("O1\nG1\nG3 X1. R5.\nM30\n", "PS0025"),
            ("O1\nG2\nG1 X1.\nM30\n", "PS0011"),
            ("O1\nG2\nG81 X1. Z-5. R2.\nM30\n", "PS0011"),
            ("O1\nIF[#500 EQ 1]GOTO 5\nG1\nGOTO 6\nN5 G2\nN6 X1. R5.\nM30\n", "PS0011"),
        ] {
            let found = messages(&RULE, text);
            assert!(found.len() == 1 && found[0].starts_with(alarm), "{text}: {found:?}");
        }
    }

    #[test]
    fn the_first_block_on_a_path_is_reported() {
        assert_eq!(lines(&RULE, "O1\nG1 X10.\nY10.\nG1 X0.\nM30\n"), [2]);
        assert_eq!(lines(&RULE, "O1\nG1\nWHILE[#500 EQ 1]DO1\nX10.\nY10.\nEND1\nM30\n"), [4]);
    }

    #[test]
    fn an_unknown_motion_mode_is_not_reported() {
        for text in [
            // At power-on, a setting decides between G00 and G01.
            "O1\nX10.\nM30\n",
            "O1\nIF[#500 EQ 1]GOTO 5\nG1\nN5 X10.\nM30\n",
            "O1\nG0\n/G1\nX10.\nM30\n",
            "O1\nG0\nG#1\nX10.\nM30\n",
            "O1\nG1\nG#1 X10.\nM30\n",
            "O1\nG1\nM98 P2\nX10.\nM30\nO2\nG0\nM99\n",
            "O1\nG1\nM98 P2\nX10.\nM30\nO2\nG#1\nM99\n",
            "O1\nG1\nM98 P7\nX10.\nM30\n",
            "O1\nG1\nG66.1 P2\nG1 X10.\nM30\nO2\nM99\n",
            "O1\nM98 P2\nM30\nO2\nX10.\nM99\n",
        ] {
            assert_eq!(lines(&RULE, text), NOWHERE, "{text}");
        }
    }

    #[test]
    fn axis_words_that_are_no_feed_move_are_not_reported() {
        for text in [
            "O1\nG1\nG0 X10.\nX5.\nM30\n",
            "O1\nG81 R2.\nG0 X10.\nM30\n",
            "O1\nG0\nG81 R2.\nG80\nX10.\nM30\n",
            "O1\nG1\nG28 X0.\nG53 X0.\nG92 X0.\nG10 L2 P1 X0.\nG52 X0.\nM30\n",
            "O1\nG1\nG68 X0. Y0. R30.\nG69\nG51 X0. Y0. P2000\nG50\nG51.1 X0.\nG50.1 X0.\nM30\n",
        ] {
            assert_eq!(lines(&RULE, text), NOWHERE, "{text}");
        }
    }

    #[test]
    fn an_f_on_one_path_suffices() {
        for text in [
            "O1\nF100.\nG1 X10.\nM30\n",
            "O1\nG1 X10. F#1\nG3 X5. R3.\nM30\n",
            "O1\nIF[#500 EQ 1]GOTO 5\nF50.\nN5 G1 X10.\nM30\n",
            "O1\nM98 P2\nG1 X10.\nM30\nO2\nF100.\nM99\n",
            "O1\nM98 P7\nG1 X10.\nM30\n",
            "O2\nG1 X10.\nM99\n",
            "O1\nG1 G4 X1.\nG1\nG0 X5.\nG91 G1 G28 Z0.\nM30\n",
        ] {
            assert_eq!(lines(&RULE, text), NOWHERE, "{text}");
        }
    }
}
