//! Rule: a feed move or a canned cycle that no F precedes on any path: PS0011, and PS0025 for an arc. In G93 each feed move
//! needs an F of its own: PS1202.
//!
//! An unknown motion mode is no finding, see [`crate::modes`].
use crate::modes::{lacks_inverse_time, missing_feed_alarm, modes_before};
use crate::prelude::*;

pub(super) static RULE: Rule = Rule::new("missing-feed", Severity::Error, "a feed move before any F", find);

fn find(context: &CheckContext<'_>, unit: &ProgramUnit<'_>) -> Vec<Diagnostic> {
    // A modal macro may take the words of any block as its arguments.
    let takes_words = unit.calls.iter().any(|call| call.is_modal);
    let before = modes_before(context, unit);
    let alarms = unit.reached_words().filter_map(|(block, words)| {
        let modes = &before[block]?;
        // The caller of a program may have set the feed.
        let missing = (unit.role == Role::Main)
            .then(|| missing_feed_alarm(context, unit, block, words, modes))
            .flatten();
        let lacks_time = || !takes_words && lacks_inverse_time(context, unit, block, words, modes);
        let alarm = missing.or_else(|| lacks_time().then_some(Alarm::NoInverseTime))?;
        Some((block, alarm.located_at(unit.op(block).span)))
    });
    alarms.map(|(block, alarm)| context.alarm_finding(unit, &RULE.kind, block, &alarm)).collect()
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
    fn each_feed_move_of_g93_needs_an_f() {
        for (text, found) in [
            ("O1\nG93 G01 X1. F10.\nX2.\nM30\n", 3),
            ("O1\nG93 G01 X1. F10.\nG0 X5.\nG02 X2. R5.\nG94\nM30\n", 4),
            ("O2\nG93 G01 X1. F10.\nX2.\nM99\n", 3),
        ] {
            let messages = messages(&RULE, text);
            assert!(messages.len() == 1 && messages[0].starts_with("PS1202"), "{text}: {messages:?}");
            assert_eq!(lines(&RULE, text), [found], "{text}");
        }
        for text in [
            "O1\nG93 G01 X1. F10.\nX2. F#1\nG0 X5.\nM30\n",
            "O1\nG93 G01 X1. F10.\nG94 X2.\nX3.\nM30\n",
            "O1\nG93 G01 X1. F10.\nIF[#500 EQ 1]GOTO 5\nG94\nN5 X2.\nM30\n",
            "O1\nG93 G01 X1. F10.\nG#1\nX2.\nM30\n",
            "O1\nG93 G01 X1. F10.\nM98 P7\nX2.\nM30\n",
            "O2\nG01 X2.\nM99\n",
        ] {
            assert_eq!(lines(&RULE, text), NOWHERE, "{text}");
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
