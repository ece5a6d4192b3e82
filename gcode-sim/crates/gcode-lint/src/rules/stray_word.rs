//! Rule: a word that no block of this control accepts: `X10., Y5.` (PS0053), `X1E3` and missing axes
//! (PS0009).
use gcode_lang::control::Dialect;
use gcode_lang::program::g_codes::Effect;
use gcode_lang::program::modes::Motion;
use gcode_lang::program::{LoweredWord, Words};

use crate::prelude::*;

pub(super) static RULE: Rule =
    Rule::new("stray-word", Severity::Error, "a word that no block of this control accepts", find);

fn find(context: &CheckContext<'_>, unit: &ProgramUnit<'_>) -> Vec<Diagnostic> {
    let mut found = Vec::new();
    for (block, words) in unit.reached_words() {
        if unit.call_in(block).is_some() {
            continue;
        }
        let stray = words.list.iter().filter_map(|word| Some((word, alarm(context, words, word)?)));
        found.extend(stray.map(|(word, alarm)| {
            let finding = context.alarm_finding(unit, &RULE.kind, block, &alarm.located_at(word.span));
            match (word.comma, word.letter) {
                (true, _) => finding.help("remove the comma: words are not separated by commas"),
                (_, b'E') => {
                    finding.help("write the number in full, 1000. for 1E3: numbers have no exponent")
                }
                // Another machine has the axis.
                _ => context.unless_optional(finding),
            }
        }));
    }
    found
}

fn alarm(context: &CheckContext<'_>, words: &Words, word: &LoweredWord) -> Option<Alarm> {
    let axes = &context.settings.axes;
    if word.comma {
        // `,A` is an angle of direct drawing dimension programming, which the simulator does not execute.
        return (!matches!(word.letter, b'R' | b'C' | b'A')).then_some(Alarm::CornerWords);
    }
    let is_refused = match word.letter {
        // A Haas takes E in rapids and cycles, whose mode another block may set.
        b'E' if context.settings.codes == Dialect::HaasNgc => context
            .has_effect(words, |effect| matches!(effect, Effect::Motion(motion) if motion != Motion::Rapid)),
        b'E' => true,
        b'A'..=b'C' | b'U'..=b'Z' => axes.find(word.letter).is_none(),
        _ => false,
    };
    (is_refused && !context.g_code_rows(words).any(|row| row.facts.words.own.has(word.letter)))
        .then_some(Alarm::ImproperAddress { letter: char::from(word.letter) })
}

#[cfg(test)]
mod tests {
    use super::super::testing::{NOWHERE, lines, messages};
    use super::RULE;

    #[test]
    fn commas_exponents_and_missing_axes_are_reported() {
        let text = "O1\nG0 X10., Y5.\nG1 X1.E3 F100.\nG0 U5.\nM30\n";
        assert_eq!(lines(&RULE, text), [2, 3, 4]);
        let found = messages(&RULE, text);
        assert!(found[0].starts_with("PS0053: ") && found[1].starts_with("PS0009: "), "{found:?}");
    }

    #[test]
    fn corners_dwells_and_arguments_are_accepted() {
        assert_eq!(
            lines(&RULE, "O1\nG1 X10.,R2. F100.\nX20.,C1.\nG4 U1.\nG65 P2 E3. U1.\nM30\nO2\nM99\n"),
            NOWHERE
        );
    }
}
