//! Rule: a #3000 that is never reached, so that the test it belongs to has no effect.
use std::cell::OnceCell;

use gcode_lang::syntax::ast::Statement;

use crate::control_flow::raises_alarm;
use crate::prelude::*;
use crate::vacancy::{Locals, states, states_without_arguments, truth};
use crate::variables;

pub(super) static RULE: Rule =
    Rule::new("unreachable-alarm", Severity::Warning, "a #3000 that is never reached", find);

fn find(_: &CheckContext<'_>, unit: &ProgramUnit<'_>) -> Vec<Diagnostic> {
    if !unit.program.ops().iter().any(|op| raises_alarm(op.kind())) {
        return Vec::new();
    }
    // The result must hold for all calls of a program, also those outside the check.
    let of_any_call = OnceCell::new();
    let states = match unit.role {
        Role::Main => states_without_arguments(unit),
        _ if unit.piece.is_some() => states_without_arguments(unit),
        Role::Called | Role::Resident => of_any_call.get_or_init(|| states(unit, Locals::ANYTHING)),
    };
    let mut found = Vec::new();
    for (block, op) in unit.program.ops().iter().enumerate().filter(|(_, op)| raises_alarm(op.kind())) {
        if !unit.is_reached[block] {
            if unit.is_jump_commented_out(block) {
                continue;
            }
            let help = "jump to its number, or remove it";
            let message = "this alarm is never reached, so it never stops the program";
            found.push(unit.finding(&RULE.kind, block, message).help(help));
            continue;
        }
        let is_never_raised = match (&states[block], variables::statement(&unit.blocks, block)) {
            (None, _) => true,
            (Some(state), Some(Statement::IfThen { condition, .. })) => {
                truth(condition, state) == Some(false)
            }
            _ => false,
        };
        if is_never_raised {
            let message = "this alarm is never raised: the preceding blocks decide its condition";
            let help = "test the variable before it is set";
            found.push(unit.finding(&RULE.kind, block, message).with_span(op.span).help(help));
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::super::testing::{NOWHERE, lines};
    use super::RULE;

    #[test]
    fn an_alarm_without_a_path_to_it_is_reported() {
        let head = "O2\nIF[#24 EQ #0]GOTO 90\nX#24\nM99\n";
        assert_eq!(lines(&RULE, &format!("{head}N90 #3000=1(NO X)\n")), NOWHERE);
        assert_eq!(lines(&RULE, &format!("{head}N90 M99\nN91 #3000=1(NO X)\n")), [6]);
        let commented_out = |jump: &str| format!("O2\n({jump})\nX#24\nM99\nN50\n#3000=7(LIFE)\n");
        assert_eq!(lines(&RULE, &commented_out("IF[#1009EQ1]GOTO50,LIFE")), NOWHERE);
        assert_eq!(lines(&RULE, &commented_out("IF[#1009EQ1]GOTO 5")), [6]);
    }

    #[test]
    fn an_alarm_whose_condition_is_decided_is_reported() {
        assert_eq!(lines(&RULE, "O2\nIF[#24 EQ #0]THEN #24=0\nIF[#24 EQ #0]THEN #3000=1(NO X)\nM99\n"), [3]);
        assert_eq!(lines(&RULE, "O2\n#24=1.\nIF[#24 EQ #0]GOTO 9\nM99\nN9 #3000=1(NO X)\n"), [5]);
        assert_eq!(lines(&RULE, "O2\nIF[#24 EQ #0]THEN #3000=1(NO X)\nX#24\nM99\n"), NOWHERE);
    }
}
