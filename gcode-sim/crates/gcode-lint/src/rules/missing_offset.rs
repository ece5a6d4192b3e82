//! Rule: an H or D beyond the tool offsets of the control, PS0030.
use crate::literal;
use crate::prelude::*;

pub(super) static RULE: Rule =
    Rule::new("missing-offset", Severity::Error, "an H or D number beyond the tool offsets", find);

/// Number of tool offsets that the options of a control give at most.
const MOST_OFFSETS: i64 = 999;

fn find(context: &CheckContext<'_>, unit: &ProgramUnit<'_>) -> Vec<Diagnostic> {
    let max = context.settings.tool_offsets;
    let mut found = Vec::new();
    for (block, words) in unit.reached_words() {
        // H and D in a block with a call may be arguments.
        if unit.call_in(block).is_some() {
            continue;
        }
        for word in words.list.iter().filter(|word| matches!(word.letter, b'H' | b'D')) {
            let number = literal::word_count(word).filter(|number| *number as usize > max);
            let Some(number) = number.map(i64::from) else { continue };
            let alarm = Alarm::OffsetNumber { number }.located_at(word.span);
            let help = format!("correct the number: this control has {max}, or give --control OFFSETS=…");
            let finding = context.alarm_finding(unit, &RULE.kind, block, &alarm).help(help);
            found.push(if number > MOST_OFFSETS { finding } else { context.unless_optional(finding) });
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
    fn a_number_beyond_the_last_offset_is_reported() {
        assert_eq!(lines(&RULE, "O1\nG43 H999 Z5.\nG41 D401\nM30\n"), [2, 3]);
        assert_eq!(lines(&RULE, "O1\nG43 H1 Z5.\nG41 D400\nG43 H#1\nG65 P2 H999\nM30\nO2\nM99\n"), NOWHERE);
    }
}
