//! Rule: more M codes in a block than the control accepts. Only the last counts, or the block raises an
//! alarm.
use gcode_lang::program::m_codes;

use crate::literal;
use crate::prelude::*;

pub(super) static RULE: Rule =
    Rule::new("several-m-codes", Severity::Error, "more M codes in a block than the control accepts", find);

fn find(context: &CheckContext<'_>, unit: &ProgramUnit<'_>) -> Vec<Diagnostic> {
    let settings = context.settings;
    let max = if settings.allows_three_m_codes { 3 } else { 1 };
    let mut found = Vec::new();
    for (block, words) in unit.reached_words() {
        let mut kept = Vec::new();
        for word in words.list.iter().filter(|word| word.letter == b'M') {
            // A code that calls a program is not an M code of the control.
            let is_call = |code: u32| settings.code_calls.find_call(b'M', code.saturating_mul(10)).is_some();
            let code = literal::word_count(word).filter(|code| !is_call(*code));
            let Some(code) = code else { continue };
            let lost = if kept.len() == max { kept.pop() } else { None };
            kept.push(code);
            let Some(first) = lost else { continue };
            if m_codes::ends_or_stops(first) || settings.plural_m_alarms {
                let alarm = Alarm::PluralM { first, second: code }.located_at(word.span);
                let finding = context.alarm_finding(unit, &RULE.kind, block, &alarm);
                found.push(context.unless_optional(finding));
            } else {
                let message =
                    format!("M{first:02} is lost: of several M codes in a block only the last counts");
                let help = "write each M code in a block of its own, or give --control M3B=1 for a control that accepts three";
                let finding = unit.finding(&RULE.kind, block, message).with_span(word.span).help(help);
                found.push(context.unless_optional(finding.with_severity(Severity::Warning)));
            }
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::super::testing::{NOWHERE, lines, messages};
    use super::RULE;
    use crate::check;
    use gcode_lang::control::Settings;
    use gcode_lang::program::NoLibrary;

    #[test]
    fn the_code_that_is_lost_is_reported() {
        let found = messages(&RULE, "O1\nM3 S100 M8\nM30 M5\nM30\n");
        assert_eq!(found[0], "M03 is lost: of several M codes in a block only the last counts");
        assert!(found[1].starts_with("PS0335: ") && found.len() == 2, "{found:?}");
    }

    #[test]
    fn a_code_that_calls_a_program_is_no_m_code() {
        let mut settings = Settings::default();
        settings.set("M6", "9001").unwrap();
        let checked = check("O1.nc", *b"O1\nM8 M6\nM30\nO9001\nM99\n", &settings, &mut NoLibrary);
        assert!(checked.findings.is_empty(), "{:?}", checked.findings);
    }

    #[test]
    fn a_call_is_no_m_code() {
        assert_eq!(lines(&RULE, "O1\nM98 P2 M8\nM8\nGOTO 5\nM3 M8\nN5 M30\nO2\nM9 M99\n"), NOWHERE);
    }
}
