//! Rule: a call of a program that is neither in the file nor in the folders, PS0076, or PS0310 by name.
use gcode_lang::alarm::kinds::{PS0076, PS0310};

use crate::calls::CalledProgramName;
use crate::context::MACROS;
use crate::prelude::*;

pub(super) static RULE: Rule =
    Rule::new("missing-program", Severity::Error, "a call of a program that is not found", find);

fn find(context: &CheckContext<'_>, unit: &ProgramUnit<'_>) -> Vec<Diagnostic> {
    let mut found = Vec::new();
    let mut reported: Vec<&CalledProgramName> = Vec::new();
    for call in unit.calls.iter().filter(|call| unit.is_reached[call.block]) {
        // One finding per missing program, regardless of the number of calls.
        if context.called_unit(call).is_some()
            || call.target != CalledProgramName::Missing && reported.contains(&&call.target)
        {
            continue;
        }
        reported.push(&call.target);
        let label = call.target.label();
        let (message, help) = match call.target {
            CalledProgramName::Computed => continue,
            // M98 Q alone starts in this program.
            CalledProgramName::Missing if call.start.is_some() => continue,
            CalledProgramName::Missing => {
                (format!("{PS0076}: a call without a program number"), "write the program number after P")
            }
            CalledProgramName::Number(number) => (
                format!("{PS0076}: program {label} is not found"),
                match MACROS.contains(&number) {
                    true => {
                        "a macro of the machine or the probe: save it from the control, and give its folder with --lib"
                    }
                    false => "give the folder that holds it with --lib",
                },
            ),
            CalledProgramName::Name(_) => (
                format!("{PS0310}: program {label} is not found"),
                "give the folder that holds it with --lib, or put it into the same file",
            ),
        };
        found.push(unit.finding(&RULE.kind, call.block, message).with_span(call.span).help(help));
    }
    found
}

#[cfg(test)]
mod tests {
    use super::super::testing::lines;
    use super::RULE;

    #[test]
    fn a_missing_program_is_reported_once() {
        let text =
            "O1\nM98 P30002\nG65 P3 A1.\nM98 P2 L2\n#1=2\nG65 P#1\nG65 A1.\nG65 P3 A2.\nM30\nO2\nM99\n";
        assert_eq!(lines(&RULE, text), [3, 7]);
    }
}
