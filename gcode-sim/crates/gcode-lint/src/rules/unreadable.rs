//! Rule: a block that raises an alarm as it is read: unreadable text, or words that exclude each other. A block behind `;`
//! in its line and a program O0 are notes.
use gcode_lang::program::{DialectSyntax, PROGRAM_ZERO_NOTE};

use crate::prelude::*;

pub(super) static RULE: Rule =
    Rule::new("unreadable", Severity::Error, "a block that raises an alarm as it is read", find);

fn find(context: &CheckContext<'_>, unit: &ProgramUnit<'_>) -> Vec<Diagnostic> {
    let mut found = context.reading_findings(unit, &RULE.kind, |alarm| !has_own_rule(alarm));
    for (block, op) in unit.reached_ops() {
        for syntax in op.dialect_syntax().iter().filter(|syntax| syntax.node.is_accepted(context.settings)) {
            let (message, help) = match syntax.node {
                DialectSyntax::BlockAfterSemicolon => (
                    "the text behind ; is a block of its own, and it is executed",
                    "write the block on a line of its own, a comment in round brackets",
                ),
                DialectSyntax::ProgramZero => PROGRAM_ZERO_NOTE,
                _ => continue,
            };
            let finding = unit.finding(&RULE.kind, block, message).with_span(syntax.span).help(help);
            found.push(finding.with_severity(Severity::Note));
        }
    }
    found
}

/// Returns true for the alarms that `loop-pairs`, `round-brackets`, `relation-symbol` and `unknown-code` report.
fn has_own_rule(alarm: &Alarm) -> bool {
    use Alarm::{
        ImproperGCode, LoopNumber, MissingDo, MissingEnd, RelationSymbol, RoundBrackets,
        RoundBracketsForValue,
    };
    matches!(
        alarm,
        MissingEnd { .. }
            | MissingDo { .. }
            | LoopNumber { .. }
            | RoundBrackets { .. }
            | RoundBracketsForValue
            | RelationSymbol
            | ImproperGCode { .. }
    )
}

#[cfg(test)]
mod tests {
    use super::super::testing::{NOWHERE, lines, messages};
    use super::RULE;

    #[test]
    fn the_finding_names_the_alarm_of_the_control() {
        let found = messages(&RULE, "O1\nG0 X..5\nG0 X1. #1=5\nM30\n");
        assert!(found[0].starts_with("PS0007: ") && found[1].starts_with("PS0127: "), "{found:?}");
    }

    #[test]
    fn an_if_without_then_is_refused() {
        let found = messages(&RULE, "O1\nIF[#1 EQ 0]#2=1\nM30\n");
        assert!(found[0].starts_with("PS1137: "), "{found:?}");
    }

    #[test]
    fn a_block_behind_a_semicolon_is_a_note() {
        let found = messages(&RULE, "O1\nG43; H01 (TOOL 1)\nG0 X1.; TO THE LEFT\nG0 X2.;\nM30\n");
        assert_eq!(found, ["the text behind ; is a block of its own, and it is executed"]);
    }

    #[test]
    fn a_program_with_the_number_0_is_a_note() {
        let found = messages(&RULE, "O0000\nG0 X1.\nM30\n");
        assert!(found[0].starts_with("O0 is no program number") && found.len() == 1, "{found:?}");
        assert_eq!(lines(&RULE, "O0001\nG0 X1.\nM30\n"), NOWHERE);
    }

    #[test]
    fn an_extra_bracket_behind_a_condition_is_named() {
        for block in ["IF[#500 EQ 1]]GOTO 5", "IF[#500 EQ 1]]THEN #2=1", "WHILE[#500 EQ 1]]DO1\nEND1"] {
            let found = messages(&RULE, &format!("O1\n{block}\nN5 M30\n"));
            assert!(found[0].starts_with("PS1131: "), "{block}: {found:?}");
        }
    }

    #[test]
    fn unreachable_blocks_are_ignored() {
        assert_eq!(lines(&RULE, "O1\nGOTO 5\nWRITTEN BY HAND\nN5 M30\nNOTES, FREE TEXT\n"), NOWHERE);
    }
}
