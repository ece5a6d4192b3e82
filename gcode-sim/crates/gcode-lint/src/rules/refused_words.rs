//! Rule: words that raise an alarm in their block whatever runs before: G83 without Q, L in a canned cycle, `S900.`.
//!
//! The control itself plans the block in every mode in which it can be read.
use std::sync::PoisonError;

use gcode_control::static_plan::StaticPlanner;
use gcode_lang::program::g_codes::Effect;
use gcode_lang::program::modes::Motion;
use gcode_lang::program::{CallCode, LoweredWord, WordOperand, Words, m_codes};
use gcode_lang::source::Span;

use crate::literal;
use crate::modes::modes_before;
use crate::parameters;
use crate::prelude::*;

pub(super) static RULE: Rule =
    Rule::new("refused-words", Severity::Error, "words that raise an alarm in this block", find);

fn find(context: &CheckContext<'_>, unit: &ProgramUnit<'_>) -> Vec<Diagnostic> {
    // A modal macro may take the words of any block as its arguments.
    if unit.calls.iter().any(|call| call.is_modal) {
        return Vec::new();
    }
    let known = context.planner.lock().unwrap_or_else(PoisonError::into_inner).take();
    let mut planner = known.unwrap_or_else(|| StaticPlanner::new(context.settings.clone()));
    let parameters = parameters::parameter_blocks(unit.program);
    let mut found = Vec::new();
    let has_modal_call = *context.may_call_modally.get_or_init(|| may_call_modally(context));
    for (block, words) in unit.reached_words().filter(|(block, _)| !parameters[*block]) {
        if let Some(call) = alarming_cancel(context, words).filter(|_| !has_modal_call) {
            let alarm = Alarm::CancelWithoutModalCall.located_at(call);
            found.push(context.alarm_finding(unit, &RULE.kind, block, &alarm));
            continue;
        }
        let calls_by_code = words.call().is_none() && unit.call_in(block).is_some();
        if calls_by_code {
            continue;
        }
        let motion = motion_of_plain_words(context, words);
        if matches!(motion, Some(Some(motion)) if !is_arc(motion)) {
            continue;
        }
        let Some(modes) = modes_before(context, unit)[block] else { continue };
        // Axis words without a code move as the block before them, and an arc needs its radius or centre.
        if motion.is_some() && modes.in_force().any(|modes| !is_arc(motion.flatten().unwrap_or(modes.motion)))
        {
            continue;
        }
        let alarm = planner.certain_alarm(words, unit.op(block).span, modes.in_force());
        if let Some(alarm) = alarm.filter(|alarm| !has_own_rule(&alarm.node, words)) {
            let finding = context.alarm_finding(unit, &RULE.kind, block, &alarm);
            // Older controls, and others by FCV (0001#1), repeat a cycle L times; options add offsets.
            let is_optional = match alarm.node {
                Alarm::ImproperAddress { letter: 'L' } => true,
                Alarm::OffsetNumber { .. } => !is_standard_offset(words),
                _ => false,
            };
            found.push(if is_optional || has_builder_code(context, words) {
                context.unless_optional(finding)
            } else {
                finding
            });
        }
    }
    *context.planner.lock().unwrap_or_else(PoisonError::into_inner) = Some(planner);
    found
}

/// Returns true for L2, with which G10 sets an offset of G54 to G59: every control has six.
fn is_standard_offset(words: &Words) -> bool {
    words.list.iter().any(|word| word.letter == b'L' && literal::word_count(word) == Some(2))
}

/// Returns the place of a G67 that raises an alarm if no modal call is in force.
pub(crate) fn alarming_cancel(context: &CheckContext<'_>, words: &Words) -> Option<Span> {
    let call = words.call().filter(|call| call.kind == CallCode::Cancel)?;
    let resets_modes = words.g_codes().next().is_some();
    context.settings.g67_alarms.unwrap_or(!resets_modes).then_some(call.span)
}

/// Returns true if one of the programs may call a macro modally, or a caller or a called program that is not here may.
fn may_call_modally(context: &CheckContext<'_>) -> bool {
    let is_unclear = |unit: &ProgramUnit<'_>| {
        let is_computed =
            |word: &LoweredWord| word.letter == b'G' && !matches!(word.value, WordOperand::G(..));
        unit.role == Role::Resident
            || unit.calls.iter().any(|call| call.is_modal || context.called_unit(call).is_none())
            || unit.reached_ops().any(|(_, op)| matches!(op.kind(), OpKind::If { .. }))
            || unit.reached_words().any(|(_, words)| words.list.iter().any(is_computed))
    };
    context.units.iter().any(is_unclear)
}

/// Returns true for the alarms that `stray-word` and `missing-offset` report.
fn has_own_rule(alarm: &Alarm, words: &Words) -> bool {
    let is_stray = |word: &LoweredWord| word.comma && !matches!(word.letter, b'R' | b'C');
    match alarm {
        Alarm::ImproperAddress { letter: 'A'..='C' | 'E' | 'U'..='Z' } => true,
        Alarm::CornerWords => words.list.iter().any(is_stray),
        Alarm::OffsetNumber { .. } => words.list.iter().any(|word| matches!(word.letter, b'H' | b'D')),
        _ => false,
    }
}

/// Returns true if a block has an M code of the machine builder, which may call a macro with the words as arguments.
fn has_builder_code(context: &CheckContext<'_>, words: &Words) -> bool {
    let codes = words.list.iter().filter(|word| word.letter == b'M').filter_map(literal::word_count);
    codes.into_iter().any(|code| m_codes::find(code, context.settings.codes).is_none())
}

/// Returns the motion code, if there is one, of a block of axis words that raises no alarm of this rule unless it is an arc;
/// `None` for any other block.
fn motion_of_plain_words(context: &CheckContext<'_>, words: &Words) -> Option<Option<Motion>> {
    let mut motion = None;
    let mut has_centre = false;
    let is_plain = words.list.iter().all(|word| match word.letter {
        b'G' => context.g_code_row(word).is_some_and(|row| match row.effect {
            Effect::Motion(commanded) => {
                motion = Some(commanded);
                true
            }
            _ => false,
        }),
        b'I' | b'J' | b'K' | b'R' => {
            has_centre = true;
            true
        }
        letter => !word.comma && (letter == b'F' || context.settings.axes.find(letter).is_some()),
    });
    (is_plain && words.call().is_none()).then_some(if has_centre { Some(Motion::Linear) } else { motion })
}

fn is_arc(motion: Motion) -> bool {
    matches!(motion, Motion::Clockwise | Motion::Counterclockwise)
}

#[cfg(test)]
mod tests {
    use super::super::testing::{NOWHERE, lines, messages};
    use super::RULE;
    use crate::{ControlKnowledge, check_loaded};
    use gcode_lang::control::Settings;
    use gcode_lang::diag::Severity;
    use gcode_lang::program::{Memory, NoLibrary};

    #[test]
    fn the_alarm_of_the_control_is_named() {
        for (block, alarm) in [
            ("G83 X1. Z-5. R1. F100.", "PS0045"),
            ("G99 G73 Z-#1 R#2 F#9", "PS0045"),
            ("G81 X1. Z-5. R1. F100. L3", "PS0009"),
            ("S900. M3", "PS0007"),
            ("T1.", "PS0007"),
            ("G43 H-1 Z5.", "PS0006"),
            ("G2 X5. F100.", "PS0022"),
            ("G30 P5 Z0", "PS0046"),
            ("X5. L3", "PS0009"),
            ("M98 P2 D2.0", "PS0007"),
            ("G08 P2", "PS0109"),
            ("S123456 M3", "PS0003"),
            ("G51 X0 Y0 P0", "PS0142"),
            ("G10 P1 R50.", "PS1144"),
            ("G65 P2 I1. I2. I3. I4. I5. I6. I7. I8. I9. I10. I11.", "PS1095"),
            ("G01 X20. ,R4. ,C4. F300.", "PS0053"),
            ("G10 L2 P7 X0", "PS0030"),
            ("G54.1 P400 X0", "PS0030"),
            ("G53.1", "PS5458"),
            ("G68.2 X0 Y0 Z0 I0 J30. K0 G53.1", "PS5458"),
        ] {
            let found = messages(&RULE, &format!("O1\n{block}\nM30\nO2\nM99\n"));
            assert!(found.len() == 1 && found[0].starts_with(alarm), "{block}: {found:?}");
        }
    }

    #[test]
    fn modes_of_earlier_blocks_count() {
        assert_eq!(lines(&RULE, "O1\nG81 Z-5. R1. F9.\nX1. K2\nX2. L2\nG80\nM30\n"), [4]);
        assert_eq!(lines(&RULE, "O1\nG81 Z-5. R1. F9.\nG28 Z5.\nM30\n"), [3]);
        assert_eq!(lines(&RULE, "O1\nG2 X5. R5. F9.\nX7.\nG1 X9.\nY3.\nG40 X1.\nM30\n"), [3]);
        assert_eq!(lines(&RULE, "O1\nG2 X5. R5. F9.\nIF[#500 EQ 1]GOTO 5\nG0 Z9.\nN5 X7.\nM30\n"), NOWHERE);
        assert_eq!(
            lines(&RULE, "O1\nG83 Z-5. R1. Q1. F9.\nX1.\nG83 X2.\nM30\n"),
            NOWHERE,
            "Q stays in force"
        );
        assert_eq!(lines(&RULE, "O1\nG83 Z-5. R1. Q1. F9.\nG80\nG83 X2. Z-5. R1.\nM30\n"), [4]);
        assert_eq!(lines(&RULE, "O1\nIF[#500 EQ 1]GOTO 5\nG73 Z-5. R1. Q1. F9.\nN5 G83 X2.\nM30\n"), NOWHERE);
        assert_eq!(lines(&RULE, "O1\nG81 Z-5. R1. F9.\nM98 P2\nG28 Z5.\nM30\nO2\nG80\nM99\n"), NOWHERE);
    }

    /// A larger number of tool offsets is an option, a seventh offset of G10 L2 is none.
    #[test]
    fn an_offset_that_an_option_adds_is_a_note() {
        let severity = |block: &str| {
            let mut memory = Memory::default();
            memory.load("O1.nc", format!("O1\n{block}\nM30\n").into_bytes());
            let checked =
                check_loaded(memory, &Settings::default(), ControlKnowledge::Assumed, &mut NoLibrary);
            checked.findings.iter().map(|finding| finding.severity).collect::<Vec<_>>()
        };
        assert_eq!(severity("G10 L2 P7 X0"), [Severity::Error]);
        assert_eq!(severity("G10 L2 P6 X0"), []);
        assert_eq!(severity("G10 L10 P5000 R1."), [Severity::Note]);
        assert_eq!(severity("G54.1 P400"), [Severity::Note]);
    }

    #[test]
    fn modes_that_rule_out_a_code_count() {
        for (text, line) in [
            ("O1\nG68 X0 Y0 R10.\nG91 G28 Z0\nG69\nG28 Z0\nM30\n", 3),
            ("O1\nG68 X0 Y0 R10.\nG0 X5.\nG53 Z0\nG69\nG53 Z0\nM30\n", 4),
            ("O1\nG51 X0 Y0 P2000\nG52 X1.\nG50\nG52 X0\nM30\n", 3),
            ("O1\nG51.1 X0\nG28 Z0\nG50.1 X0\nG28 Z0\nM30\n", 3),
            ("O1\nG41 D1 G1 X1. F9.\nG31 Z-5.\nG40 X0\nG31 Z-5.\nM30\n", 3),
            ("O1\nG68.2 X0 Y0 Z0 I0 J9. K0\nG53.1\nG69\nG53.1\nM30\n", 5),
            ("O1\nG68.2 X0 Y0 Z0 I0 J9. K0\nG53.1\nG92 X0\nG69\nG92 X0\nM30\n", 4),
            ("O1\nG68.2 X0 Y0 Z0 I0 J9. K0\nG43.4 H1\nG69\nG43.4 H1\nG49\nM30\n", 3),
            ("O1\nG93 G1 X1. F9.\nG81 Z-5. R1. F9.\nG80\nG94\nG81 Z-5. R1. F9.\nM30\n", 3),
            ("O1\nG43.4 H1\nG68.2 X0 Y0 Z0 I0 J9. K0\nG49\nG68.2 X0 Y0 Z0 I0 J9. K0\nG69\nM30\n", 3),
        ] {
            assert_eq!(lines(&RULE, text), [line], "{text}");
        }
        for text in [
            "O1\nIF[#500 EQ 1]GOTO 5\nG68 X0 Y0 R10.\nN5 G28 Z0\nM30\n",
            "O1\nG68 X0 Y0 R10.\nM98 P2\nG28 Z0\nM30\nO2\nG69\nM99\n",
            "O1\nG93 G1 X1. F9.\nG95 G81 Z-5. R1. F.1\nM30\n",
            "O1\nIF[#500 EQ 1]GOTO 5\nG93 G1 X1. F9.\nN5 G81 Z-5. R1. F9.\nM30\n",
            "O1\nG68 X0 Y0 R10.\nG53\nG69\nM30\n",
            "O1\nG68 X0 Y0 R10.\nG#1\nG28 Z0\nM30\n",
            "O2\nG28 Z0\nM99\n",
            "O2\nG53.1\nM99\n",
            "O1\nM98 P2\nG53.1\nM30\nO2\nG68.2 X0 Y0 Z0 I0 J9. K0\nM99\n",
            "O1\nIF[#500 EQ 1]GOTO 5\nG68.2 X0 Y0 Z0 I0 J9. K0\nN5 G53.1\nM30\n",
            "O1\nIF[#500 EQ 1]GOTO 5\nG43.4 H1\nN5 G68.2 X0 Y0 Z0 I0 J9. K0\nM30\n",
            "O1\nG68.2 P3 Q1 X0 Y0 Z0 I1. J0 K0\nG68.2 P3 Q2 I0 J0 K1.\nG53.1\nG68.4 X1. Y0 Z0 I0 J0 K0\nG53.1\nG69\nM30\n",
        ] {
            assert_eq!(lines(&RULE, text), NOWHERE, "{text}");
        }
    }

    #[test]
    fn a_computed_word_that_may_be_vacant_beside_another_is_accepted() {
        assert_eq!(lines(&RULE, "O1\n#1=2.\nG91 G03 I-#1 Z.1 L#4 F9.\nM30\n"), NOWHERE);
        assert_eq!(lines(&RULE, "O1\n#1=2.\nG91 G03 Z.1 F#1\nM30\n"), [3]);
    }

    #[test]
    fn a_g67_alone_needs_a_g66() {
        assert_eq!(lines(&RULE, "O1\nG00 X1.\nG67\nM30\n"), [3]);
        for text in [
            "O1\nG40 G80 G67\nM30\n",
            "O1\nG66 P2\nG67\nM30\nO2\nM99\n",
            "O1\nM98 P2\nG67\nM30\nO2\nG66 P3\nM99\nO3\nM99\n",
            "O1\nM98 P9\nG67\nM30\n",
            "O1\nG#1 X1.\nG67\nM30\n",
            "O2\nG67\nM99\n",
        ] {
            assert_eq!(lines(&RULE, text), NOWHERE, "{text}");
        }
    }

    #[test]
    fn words_that_a_value_or_a_caller_decides_are_accepted() {
        for text in [
            "O1\nG83 Z-5. R1. Q#1 F9.\nM30\n",
            "O1\nG4 P500\nG4 X1.5\nG10 L2 P1 X1.\nG10 L52\nN6004 R1\nG11\nM30\n",
            "O1\nT#1 M6\nS[#500*2] M3\nG#1 X5. L3\nG43 H#1 Z5.\nG2 X1. R#3 F9.\nM30\n",
            "O2\nG83 X5.\nX2. K3\nM99\n",
            "O1\nG66 P2 A1.\nX5. L3\nG67\nM30\nO2\nM99\n",
            "O1\nM98 P2 L3\nG65 P2 L3 D5.\nM30\nO2\nM99\n",
            "O1\nM88 P1.5 Q2\nM30\n",
            "O1\nG51 X0 Y0 P#1\nG50\nG10 L#1 P1 R50.\nG10 L10 P#1 R50.\nM30\n",
            "O1\nG01 X20. ,R4. F300.\nY20. ,C#1\nX0\nM30\n",
            "O1\nG68 X0 Y0 R45.\nG69\nG51 X0 Y0 P2000\nG50\nG54.1 P5\nM30\n",
        ] {
            assert_eq!(messages(&RULE, text), [""; 0], "{text}");
        }
    }
}
