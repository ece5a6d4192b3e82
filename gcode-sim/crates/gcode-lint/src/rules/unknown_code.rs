//! Rule: a G code that the control does not have.
//!
//! Notes report M codes of a stated machine's builder, codes that are not simulated, and unknown G codes where the control
//! is assumed.
use std::collections::BTreeSet;

use gcode_lang::alarm::kinds::PS0010;
use gcode_lang::alarm::lacking_code_help;
use gcode_lang::control::Dialect;
use gcode_lang::program::g_codes::{Effect, other_control, spelled};
use gcode_lang::program::m_codes::{self, MCodeEffect};
use gcode_lang::program::{LoweredWord, WordOperand};

use crate::ControlKnowledge;
use crate::literal;
use crate::prelude::*;

pub(super) static RULE: Rule =
    Rule::new("unknown-code", Severity::Error, "a G or M code the control does not have", find);

fn find(context: &CheckContext<'_>, unit: &ProgramUnit<'_>) -> Vec<Diagnostic> {
    let is_improper = |alarm: &Alarm| matches!(alarm, Alarm::ImproperGCode { .. });
    let mut found = context.reading_findings(unit, &RULE.kind, is_improper);
    let mut reported = BTreeSet::new();
    for (block, words) in unit.reached_words() {
        for word in &words.list {
            let Some((message, help)) = code_fault(context, word) else { continue };
            let finding = unit.finding(&RULE.kind, block, message.clone()).with_span(word.span);
            let finding = match help {
                Some(help) => context.unless_optional(finding).help(help),
                None => finding.with_severity(Severity::Note),
            };
            if finding.severity != Severity::Note || reported.insert(message) {
                found.push(finding);
            }
        }
    }
    found
}

/// Returns the message for a code that does not run as written, with the remedy of one that raises an alarm.
fn code_fault(context: &CheckContext<'_>, word: &LoweredWord) -> Option<(String, Option<String>)> {
    let settings = context.settings;
    let is_call = |code: u32| settings.code_calls.find_call(word.letter, code).is_some();
    match (word.letter, word.value) {
        (b'G', WordOperand::G(code, _)) if !is_call(code) => {
            let name = format!("G{}", spelled(code));
            match context.g_code_row(word) {
                None => {
                    let help = lacking_code_help(&spelled(code), other_control(code));
                    Some((format!("{PS0010}: {} has no {name}", settings.codes.name()), Some(help)))
                }
                Some(row) if row.effect == Effect::NotSimulated => {
                    Some((format!("{name} ({}) is not simulated", row.description), None))
                }
                Some(_) => None,
            }
        }
        (b'M', _) => {
            let is_declared = |code: u32| settings.declared_codes.find(b'M', code).is_some();
            let code = literal::word_count(word)
                .filter(|code| !is_call(code.saturating_mul(10)) && !is_declared(code.saturating_mul(10)))?;
            let fault = match m_codes::find(code, settings.codes) {
                Some(MCodeEffect::NotSimulated) => "is not simulated",
                Some(_) => return None,
                None if m_codes::is_auxiliary(code, settings.codes) => return None,
                None if settings.codes == Dialect::HaasNgc => "is not simulated: its effect is unknown",
                // Every machine has such codes, and nothing is known about them.
                None if context.knowledge == ControlKnowledge::Assumed => return None,
                None => "is a code of the machine builder: its effect is unknown",
            };
            Some((format!("M{code:02} {fault}"), None))
        }
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::{lines, messages_if_assumed};
    use super::RULE;

    #[test]
    fn m_codes_of_the_builder_are_reported_if_the_machine_is_stated() {
        let text = "O1\nM88\nM30\n";
        assert_eq!(lines(&RULE, text), [2]);
        assert!(messages_if_assumed(&RULE, text).is_empty());
        assert_eq!(messages_if_assumed(&RULE, "O1\nG12 I5.\nM30\n").len(), 1);
    }

    #[test]
    fn unknown_g_codes_are_reported_always_and_m_codes_once() {
        assert_eq!(lines(&RULE, "O1\nG0 G154 P1\nG12 I5.\nG54.1 P3\nM88\nM88\nM8\nG#1\nM30\n"), [2, 3, 5]);
    }
}
