//! Rule: an H or D beyond the tool offsets of the control, PS0030.
use crate::context::{CheckContext, ProgramUnit, RuleFinding};
use crate::literal;
use gcode_lang::alarm::Alarm;
use gcode_lang::program::OpKind;

use super::unreadable::finding;
use crate::rule::Rule;
use gcode_lang::diag::Severity;

pub(super) static RULE: Rule =
    Rule::new("missing-offset", Severity::Error, "an H or D number beyond the tool offsets", find);

fn find(context: &CheckContext<'_>, unit: &ProgramUnit<'_>) -> Vec<RuleFinding> {
    let max = context.settings.tool_offsets;
    let mut found = Vec::new();
    for (block, op) in unit.program.ops().iter().enumerate().filter(|(block, _)| unit.is_reached[*block]) {
        let OpKind::Words(words) = op.kind() else { continue };
        // H and D in a block with a call may be arguments.
        if unit.call_in(block).is_some() {
            continue;
        }
        for word in words.list.iter().filter(|word| matches!(word.letter, b'H' | b'D')) {
            let Some(number) = literal::word_count(word).filter(|number| *number as usize > max) else {
                continue;
            };
            let alarm = Alarm::OffsetNumber { number: i64::from(number) }.located_at(word.span);
            let finding = finding(context, unit, &RULE.kind, block, &alarm);
            found
                .push(finding.help(format!(
                    "correct the number: this control has {max}, or give --control OFFSETS=…"
                )));
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::super::testing::{NOWHERE, lines};
    use super::RULE;

    /// The default of the setting OFFSETS is 400.
    #[test]
    fn beyond_the_last_there_is_none() {
        assert_eq!(lines(&RULE, "O1\nG43 H999 Z5.\nG41 D401\nM30\n"), [2, 3]);
        assert_eq!(lines(&RULE, "O1\nG43 H1 Z5.\nG41 D400\nG43 H#1\nG65 P2 H999\nM30\nO2\nM99\n"), NOWHERE);
    }
}
