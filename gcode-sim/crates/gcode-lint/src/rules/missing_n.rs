//! Rule: a jump to a sequence number that is not defined, PS0128 at GOTO and PS0078 at M99 P; GOTO 0 is PS1128.
use gcode_lang::alarm::kinds::{PS0078, PS0128};
use gcode_lang::program::Program;

use crate::calls::CalledProgramName;
use crate::control_flow::Jump;
use crate::prelude::*;

pub(super) static RULE: Rule =
    Rule::new("missing-n", Severity::Error, "a jump to a sequence number that is not defined", find);

fn find(context: &CheckContext<'_>, unit: &ProgramUnit<'_>) -> Vec<Diagnostic> {
    let mut found = Vec::new();
    let finding = |block: OpIndex, target: String, program: &Program| {
        let message = format!("{target} is not in {}", program.label());
        unit.finding(&RULE.kind, block, message).help(HELP)
    };
    let is_missing = |program: &Program, number: u32| program.find_number(number, 0).is_none();
    for jump in unit.flow.jumps.iter().filter(|jump| unit.is_reached[jump.block]) {
        let Jump { block, number, .. } = *jump;
        if !jump.is_return {
            if !(1..=99_999_999).contains(&number) {
                let alarm = Alarm::SequenceNumberRange { number: number.into() };
                let alarm = alarm.located_at(unit.op(block).span);
                found
                    .push(context.alarm_finding(unit, &RULE.kind, block, &alarm).help("write 1 to 99999999"));
                continue;
            }
            if jump.to.is_none() && !jump.is_far {
                found.push(finding(block, format!("{PS0128}: sequence number N{number}"), unit.program));
            }
            continue;
        }
        match unit.role {
            Role::Main if jump.to.is_none() => {
                let target = format!("{PS0078}: sequence number N{number}, where execution continues,");
                found.push(finding(block, target, unit.program));
            }
            Role::Main | Role::Resident => {}
            Role::Called => {
                let mut callers = unit.callers.iter().map(|(caller, site)| (&context.units[*caller], *site));
                if let Some((caller, site)) = callers.find(|(caller, _)| is_missing(caller.program, number)) {
                    let target = format!("{PS0078}: sequence number N{number}, the return target,");
                    let call = caller.op(caller.calls[site].block).span;
                    found.push(finding(block, target, caller.program).label(call, "called here"));
                }
            }
        }
    }
    for call in unit.calls.iter().filter(|call| unit.is_reached[call.block]) {
        let called = context.called_unit(call).map(|called| context.units[called].program);
        let own = (call.target == CalledProgramName::Missing).then_some(unit.program);
        if let (Some(number), Some(program)) = (call.start, called.or(own))
            && is_missing(program, number)
        {
            let target = format!("{PS0078}: sequence number N{number}, the start,");
            found.push(finding(call.block, target, program));
        }
    }
    found
}

const HELP: &str = "number the target block, or correct the jump";

#[cfg(test)]
mod tests {
    use super::super::testing::{NOWHERE, lines, messages};
    use super::RULE;

    #[test]
    fn goto_needs_its_target() {
        assert_eq!(lines(&RULE, "O1\n#1=2\nIF[#1 EQ 1]GOTO 10\nGOTO 0020\nN20 M30\n"), [3]);
        assert_eq!(lines(&RULE, "O1\n#1=20\nGOTO #1\nN20 M30\n"), NOWHERE, "only a run knows #1");
    }

    #[test]
    fn zero_is_no_target() {
        let found = messages(&RULE, "O1\n#1=2\nGOTO 0\nN0 M30\n");
        assert!(found.len() == 1 && found[0].starts_with("PS1128: GOTO 0"), "{found:?}");
        assert_eq!(lines(&RULE, "O1\nGOTO 1\nN1 M30\n"), NOWHERE);
    }

    #[test]
    fn a_return_needs_its_target_in_the_caller() {
        let called = "O2\nN7 M99 P50\n";
        assert_eq!(lines(&RULE, &format!("O1\nM98 P2\nN50 M30\n{called}")), NOWHERE);
        assert_eq!(lines(&RULE, &format!("O1\nM98 P2\nN5 M30\n{called}")), [5]);
        assert_eq!(lines(&RULE, called), NOWHERE, "its callers are unknown");
    }
}
