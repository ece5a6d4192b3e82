//! Rule: a block that raises an alarm as it is read: unreadable text, or words that exclude each other.
use crate::prelude::*;

pub(super) static RULE: Rule =
    Rule::new("unreadable", Severity::Error, "a block that raises an alarm as it is read", find);

fn find(context: &CheckContext<'_>, unit: &ProgramUnit<'_>) -> Vec<Diagnostic> {
    context.reading_findings(unit, &RULE.kind, |alarm| !has_own_rule(alarm))
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
    fn unreachable_blocks_are_ignored() {
        assert_eq!(lines(&RULE, "O1\nGOTO 5\nWRITTEN BY HAND\nN5 M30\nNOTES, FREE TEXT\n"), NOWHERE);
    }
}
