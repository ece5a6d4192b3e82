//! Rule: a G code that the control does not have.
//!
//! Notes report M codes of the machine builder and codes that are not simulated.
use std::collections::BTreeSet;

use crate::context::{CheckContext, ProgramUnit, RuleFinding};
use crate::literal;
use gcode_lang::alarm::Alarm;
use gcode_lang::program::g_codes::{Effect, spelled};
use gcode_lang::program::m_codes::{self, MCodeEffect};
use gcode_lang::program::{LoweredWord, OpKind, WordOperand};

use super::unreadable::{alarm_blocks, finding, refused_blocks};
use crate::rule::Rule;
use gcode_lang::alarm::kinds::PS0010;
use gcode_lang::diag::Severity;

pub(super) static RULE: Rule =
    Rule::new("unknown-code", Severity::Error, "a G or M code the control does not have", find);

fn find(context: &CheckContext<'_>, unit: &ProgramUnit<'_>) -> Vec<RuleFinding> {
    let written = alarm_blocks(unit).map(|(block, alarm)| (block, alarm.clone()));
    let all = written.chain(refused_blocks(context, unit));
    let improper = all.filter(|(_, alarm)| matches!(alarm.node, Alarm::ImproperGCode { .. }));
    let mut found: Vec<_> =
        improper.map(|(block, alarm)| finding(context, unit, &RULE.kind, block, &alarm)).collect();
    let mut reported = BTreeSet::new();
    for (block, op) in unit.program.ops().iter().enumerate().filter(|(block, _)| unit.is_reached[*block]) {
        let OpKind::Words(words) = op.kind() else { continue };
        for word in &words.list {
            let Some((name, message, certain)) = describe_code(context, word) else { continue };
            if certain {
                let help = "correct it, or name the macro it calls with --code";
                found.push(unit.finding(&RULE.kind, block, message).with_span(word.span).help(help));
            } else if reported.insert(name) {
                found.push(
                    unit.finding(&RULE.kind, block, message)
                        .with_severity(Severity::Note)
                        .with_span(word.span),
                );
            }
        }
    }
    found
}

/// Returns name, message and certainty of a fault; only a certain one raises an alarm.
fn describe_code(context: &CheckContext<'_>, word: &LoweredWord) -> Option<(String, String, bool)> {
    match (word.letter, word.value) {
        (b'G', WordOperand::G(code, found)) => {
            let row = found.row_for(context.settings.codes);
            let name = format!("G{}", spelled(code));
            let calls = context.settings.code_calls.find_call(b'G', code).is_some();
            match row.map(|row| row.effect) {
                _ if calls => None,
                None => Some((name.clone(), format!("{PS0010}: the control has no {name}"), true)),
                Some(Effect::NotSimulated) => {
                    let help = row.map_or("", |row| row.help);
                    Some((name.clone(), format!("{name} ({help}) is not simulated"), false))
                }
                Some(_) => None,
            }
        }
        (b'M', _) => {
            let code = literal::word_count(word)?;
            let calls = context.settings.code_calls.find_call(b'M', code.saturating_mul(10)).is_some();
            let name = format!("M{code:02}");
            match m_codes::find(code, context.settings.codes) {
                _ if calls => None,
                Some(MCodeEffect::NotSimulated) => {
                    Some((name.clone(), format!("{name} is not simulated"), false))
                }
                Some(_) => None,
                None => {
                    let message = format!("{name} is a code of the machine builder: its effect is unknown");
                    Some((name, message, false))
                }
            }
        }
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::lines;
    use super::RULE;

    #[test]
    fn every_unknown_g_and_each_machine_m_once() {
        assert_eq!(lines(&RULE, "O1\nG0 G154 P1\nG12 I5.\nG54.1 P3\nM88\nM88\nM8\nG#1\nM30\n"), [2, 3, 5]);
    }
}
