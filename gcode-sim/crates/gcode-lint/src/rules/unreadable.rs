//! Rule: a block that raises an alarm as it is read: unreadable text, or words that exclude each other.
use crate::context::{CheckContext, ProgramUnit, RuleFinding};
use crate::control_flow::is_loop_alarm;
use crate::rule::Rule;
use gcode_lang::alarm::{Alarm, LocatedAlarm, remedy};
use gcode_lang::diag::{FindingKind, Severity};
use gcode_lang::program::{OpKind, Statement};
use gcode_lang::source::Spanned;

pub(super) static RULE: Rule =
    Rule::new("unreadable", Severity::Error, "a block that raises an alarm as it is read", find);

fn find(context: &CheckContext<'_>, unit: &ProgramUnit<'_>) -> Vec<RuleFinding> {
    let alarms = alarm_blocks(unit).filter(|(_, alarm)| !has_own_rule(&alarm.node));
    let mut found: Vec<_> =
        alarms.map(|(block, alarm)| finding(context, unit, &RULE.kind, block, alarm)).collect();
    let refused = refused_blocks(context, unit).filter(|(_, alarm)| !has_own_rule(&alarm.node));
    found.extend(refused.map(|(block, alarm)| finding(context, unit, &RULE.kind, block, &alarm)));
    found
}

/// Iterates over the reachable blocks with syntax that this control refuses.
pub(super) fn refused_blocks<'a>(
    context: &'a CheckContext<'_>,
    unit: &'a ProgramUnit<'_>,
) -> impl Iterator<Item = (usize, LocatedAlarm)> + 'a {
    let ops = unit.program.ops().iter().enumerate().filter(|(block, _)| unit.is_reached[*block]);
    ops.filter_map(|(block, op)| {
        let form = op.dialect_syntax().iter().find(|form| !form.node.is_accepted(context.settings))?;
        Some((block, form.node.alarm().located_at(form.span)))
    })
}

/// Iterates over the reachable blocks that raise an alarm as they are read.
pub(super) fn alarm_blocks<'a>(unit: &'a ProgramUnit<'_>) -> impl Iterator<Item = (usize, &'a LocatedAlarm)> {
    unit.program.ops().iter().enumerate().filter(|(block, _)| unit.is_reached[*block]).filter_map(
        |(block, op)| match op.kind() {
            OpKind::Alarm(alarm) => Some((block, alarm)),
            OpKind::Statement(Statement::IfThen { then, .. }) => match &**then {
                Statement::Alarm(alarm) => Some((block, alarm)),
                _ => None,
            },
            _ => None,
        },
    )
}

fn has_own_rule(alarm: &Alarm) -> bool {
    is_loop_alarm(alarm)
        || matches!(alarm, Alarm::RoundBrackets { .. } | Alarm::RelationSymbol | Alarm::ImproperGCode { .. })
}

/// Converts an alarm to a finding with its number, sentence and remedy.
pub(super) fn finding(
    context: &CheckContext<'_>,
    unit: &ProgramUnit<'_>,
    kind: &'static FindingKind,
    block: usize,
    alarm: &Spanned<Alarm>,
) -> RuleFinding {
    let row = alarm.node.row();
    let found = unit.finding(kind, block, format!("{}: {}", row.code, row.message)).with_span(alarm.span);
    match remedy(&alarm.node, alarm.span, context.memory.sources()) {
        Some(help) => found.help(help),
        None => found,
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::{NOWHERE, lines, messages};
    use super::RULE;

    #[test]
    fn names_the_alarm_a_control_raises() {
        let found = messages(&RULE, "O1\nG0 X..5\nG0 X1. #1=5\nM30\n");
        assert!(found[0].starts_with("PS0007: ") && found[1].starts_with("PS0127: "), "{found:?}");
    }

    #[test]
    fn an_if_without_then_is_for_other_controls() {
        let found = messages(&RULE, "O1\nIF[#1 EQ 0]#2=1\nM30\n");
        assert!(found[0].starts_with("PS1137: "), "{found:?}");
    }

    #[test]
    fn what_nothing_reaches_alarms_nobody() {
        assert_eq!(lines(&RULE, "O1\nGOTO 5\nWRITTEN BY HAND\nN5 M30\nNOTES, FREE TEXT\n"), NOWHERE);
    }
}
