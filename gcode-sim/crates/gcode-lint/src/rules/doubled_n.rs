//! Rule: a sequence number that is defined twice.
//!
//! The target of a jump then depends on the control's parameters and on the blocks read so far; without a jump it is a note.
use std::collections::BTreeMap;

use gcode_lang::source::Span;

use crate::parameters;
use crate::prelude::*;

pub(super) static RULE: Rule =
    Rule::new("doubled-n", Severity::Warning, "a sequence number that is defined twice", find);

fn find(context: &CheckContext<'_>, unit: &ProgramUnit<'_>) -> Vec<Diagnostic> {
    let mut first: BTreeMap<u32, (Span, bool)> = BTreeMap::new();
    let mut found = Vec::new();
    let parameters = parameters::parameter_blocks(unit.program);
    for (block, op) in unit.program.ops().iter().enumerate().filter(|(block, _)| !parameters[*block]) {
        let Some(number) = op.number.filter(|number| *number > 0) else { continue };
        match first.get_mut(&number) {
            None => {
                first.insert(number, (op.span, false));
            }
            Some((_, is_reported @ false)) => {
                *is_reported = true;
                let line = context.memory.sources().line_column(first[&number].0).line;
                let jump = unit.flow.jumps.iter().any(|jump| jump.number == number && !jump.is_return);
                let (severity, consequence) = match jump {
                    true => (Severity::Warning, ": the control decides which of the two GOTO takes"),
                    false => (Severity::Note, ": a search finds one of the two"),
                };
                let message = format!("N{number} is already defined in line {line}{consequence}");
                let finding = unit.finding(&RULE.kind, block, message).with_severity(severity);
                found.push(finding.help("give one of them another number"));
            }
            Some(_) => {}
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::super::testing::{NOWHERE, lines};
    use super::RULE;

    #[test]
    fn each_duplicate_number_is_reported_once() {
        assert_eq!(lines(&RULE, "O1\nN10 G0\nN010 G0\nN10 G0\nN20 M30\n"), [3]);
        let parameters = "O1\nN1241 G10 L52\nN1241 P1 R1.\nN1241 P2 R1.\nG11\nN1241 M30\n";
        assert_eq!(lines(&RULE, parameters), [6], "after G10 L52 N is no sequence number");
        assert_eq!(lines(&RULE, "O1\nN10 M30\nO2\nN10 M99\n(N10)\n"), NOWHERE, "each program has its own");
    }
}
