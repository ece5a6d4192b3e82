//! Rule: a variable that does not exist (PS0115) or that cannot be written (PS0116) or read (PS1115).
use std::ops::RangeInclusive;

use gcode_lang::alarm::LocatedAlarm;

use crate::prelude::*;
use crate::{literal, variables};

pub(super) static RULE: Rule = Rule::of_block(
    "no-such-variable",
    Severity::Error,
    "a variable that does not exist, or cannot be read or written",
    find,
);

/// Numbers that no option and no machine builder gives.
const NEVER: RangeInclusive<i64> = 34..=99;

fn find(context: &CheckContext<'_>, unit: &ProgramUnit<'_>, block: OpIndex) -> Vec<Diagnostic> {
    let mut found = Vec::new();
    let mut report = |alarm: LocatedAlarm| {
        let finding = context.alarm_finding(unit, &RULE.kind, block, &alarm);
        found.push(match alarm.node {
            // No control has a variable between its locals and its common variables.
            Alarm::NoSuchVariable { number } if !NEVER.contains(&number) => context.unless_optional(finding),
            _ => finding,
        });
    };
    for read in unit.reads(block) {
        if let Err(alarm) = context.variables.read(read.number) {
            report(alarm.located_at(read.span));
        }
    }
    for (target, _) in unit.blocks[block].items.iter().filter_map(variables::item_assignment) {
        if let Some(number) = literal::variable(target)
            && let Err(alarm) = context.variables.write(number)
        {
            report(alarm.located_at(target.span));
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::super::testing::{NOWHERE, lines, messages};
    use super::RULE;

    /// Locals are #1 to #33; #5021 and up are positions; #3000 is write-only.
    #[test]
    fn missing_and_protected_variables_are_reported() {
        let text = "O1\n#34=1\n#5021=5\n#4001=1\n#0=1\n#1=#99\nG0 X#450\n#1=#3000\n#[30+4]=1\nM30\n";
        assert_eq!(lines(&RULE, text), [2, 3, 4, 5, 6, 7, 8, 9]);
        let codes: Vec<_> = messages(&RULE, text).iter().map(|m| m[..6].to_owned()).collect();
        assert_eq!(codes, ["PS0115", "PS0116", "PS0116", "PS0116", "PS0115", "PS0115", "PS1115", "PS0115"]);
    }

    #[test]
    fn existing_variables_are_accepted() {
        let text = "O1\n#33=1\n#100=#0\n#199=#5021\n#500=#999\n#5221=0\n#3006=1(LOOK)\n#1=10\n#[#1]=#[#1+30]\nIF[#3100 EQ #0]GOTO 9\n#3000=1(STOP)\nN9 M30\n";
        assert_eq!(lines(&RULE, text), NOWHERE);
    }
}
