//! Rule: a jump to a sequence number that is not defined, PS0128 at GOTO and PS0078 at M99 P.
use crate::calls::CalledProgramName;
use crate::context::{CheckContext, ProgramUnit, Role, RuleFinding};
use crate::rule::Rule;
use gcode_lang::alarm::kinds::{PS0078, PS0128};
use gcode_lang::diag::Severity;

pub(super) static RULE: Rule =
    Rule::new("missing-n", Severity::Error, "a jump to a sequence number that is not defined", find);

fn find(context: &CheckContext<'_>, unit: &ProgramUnit<'_>) -> Vec<RuleFinding> {
    let mut found = Vec::new();
    for jump in unit.flow.jumps.iter().filter(|jump| unit.is_reached[jump.block]) {
        let number = jump.number;
        if !jump.is_return {
            if jump.to.is_none() {
                let message =
                    format!("{PS0128}: sequence number N{number} is not in {}", unit.program.label());
                found.push(unit.finding(&RULE.kind, jump.block, message).help(HELP));
            }
            continue;
        }
        match unit.role {
            Role::Main if jump.to.is_none() => {
                let message = format!(
                    "{PS0078}: sequence number N{number}, where execution continues, is not in {}",
                    unit.program.label()
                );
                found.push(unit.finding(&RULE.kind, jump.block, message).help(HELP));
            }
            Role::Main | Role::Resident => {}
            Role::Called => {
                let lacking = unit
                    .callers
                    .iter()
                    .find(|(caller, _)| context.units[*caller].program.find_number(number, 0).is_none());
                if let Some((caller, site)) = lacking {
                    let caller = &context.units[*caller];
                    let message = format!(
                        "{PS0078}: sequence number N{number}, the return target, is not in {}",
                        caller.program.label()
                    );
                    let call = caller.op(caller.calls[*site].block).span;
                    found.push(
                        unit.finding(&RULE.kind, jump.block, message).label(call, "called here").help(HELP),
                    );
                }
            }
        }
    }
    for call in unit.calls.iter().filter(|call| unit.is_reached[call.block]) {
        if let (Some(number), Some(called)) = (call.start, context.called_unit(call)) {
            let program = context.units[called].program;
            if program.find_number(number, 0).is_none() {
                let label = program.label();
                let message = format!("{PS0078}: sequence number N{number}, the start, is not in {label}");
                found.push(unit.finding(&RULE.kind, call.block, message).help(HELP));
            }
        } else if let (Some(number), CalledProgramName::Missing) = (call.start, &call.target)
            && unit.program.find_number(number, 0).is_none()
        {
            let message =
                format!("{PS0078}: sequence number N{number}, the start, is not in {}", unit.program.label());
            found.push(unit.finding(&RULE.kind, call.block, message).help(HELP));
        }
    }
    found
}

const HELP: &str = "number the target block, or correct the jump";

#[cfg(test)]
mod tests {
    use super::super::testing::{NOWHERE, lines};
    use super::RULE;

    #[test]
    fn goto_needs_its_block() {
        assert_eq!(lines(&RULE, "O1\n#1=2\nIF[#1 EQ 1]GOTO 10\nGOTO 0020\nN20 M30\n"), [3]);
        assert_eq!(lines(&RULE, "O1\n#1=20\nGOTO #1\nN20 M30\n"), NOWHERE, "only a run knows #1");
    }

    #[test]
    fn a_return_needs_its_block_in_the_caller() {
        let called = "O2\nN7 M99 P50\n";
        assert_eq!(lines(&RULE, &format!("O1\nM98 P2\nN50 M30\n{called}")), NOWHERE);
        assert_eq!(lines(&RULE, &format!("O1\nM98 P2\nN5 M30\n{called}")), [5]);
        assert_eq!(lines(&RULE, called), NOWHERE, "nobody knows who calls it");
    }
}
