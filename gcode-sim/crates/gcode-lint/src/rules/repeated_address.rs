//! Rule: an address twice in one block with two values, or two G codes of a group. The last counts, or with AD2 the repeated
//! address raises PS5074.
use gcode_lang::program::g_codes::{GCodeRow, spelled};
use gcode_lang::program::{LoweredWord, WordOperand, Words};

use crate::prelude::*;

pub(super) static RULE: Rule =
    Rule::of_block("repeated-address", Severity::Warning, "an address twice in one block", find);

fn find(context: &CheckContext<'_>, unit: &ProgramUnit<'_>, block: OpIndex) -> Vec<Diagnostic> {
    let words = unit.op(block).kind().words();
    // A block skip inside leaves one of the two.
    let Some(words) = words.filter(|words| words.form_if_skipped().is_none()) else { return Vec::new() };
    let arguments = words.call().into_iter().flat_map(|call| &call.arguments);
    // I, J and K of a macro call repeat: argument specification II.
    let arguments = arguments.filter(|word| !matches!(word.letter, b'I'..=b'K'));
    let plain = words.list.iter().filter(|word| !matches!(word.letter, b'G' | b'M'));
    let alarms = context.settings.alarms_on_repeated_address;
    let of_words = in_words(plain).into_iter().map(|pair| (pair, alarms));
    let found = of_words.chain(in_words(arguments).into_iter().map(|pair| (pair, false)));
    let finding = |((lost, kept), alarms): ((&LoweredWord, &LoweredWord), bool)| {
        let letter = char::from(kept.letter);
        let alarm = Alarm::RepeatedAddress { letter }.located_at(kept.span);
        let finding = match alarms {
            true => context.alarm_finding(unit, &RULE.kind, block, &alarm).with_severity(Severity::Error),
            false => {
                let message = format!("{letter} is there twice in the block: the last counts");
                unit.finding(&RULE.kind, block, message).with_span(kept.span)
            }
        };
        finding.label(lost.span, "without effect").help("correct the letter, or remove one of the two")
    };
    let mut found: Vec<_> = found.map(finding).collect();
    found.extend(of_a_group(context, words).into_iter().map(|((lost, row), (kept, by))| {
        let codes = [row, by].map(|row| spelled(row.code));
        let message =
            format!("G{} is lost: G{} is of the same group, and the last counts", codes[0], codes[1]);
        let finding = unit.finding(&RULE.kind, block, message).with_span(kept.span);
        finding.label(lost.span, "without effect").help("write the two codes in two blocks, or remove one")
    }));
    found
}

/// A word with the row of its G code.
type Code<'w> = (&'w LoweredWord, &'static GCodeRow);

/// Returns the G codes of a modal group before another of this group: the lost one and the one that counts.
fn of_a_group<'w>(context: &CheckContext<'_>, words: &'w Words) -> Vec<(Code<'w>, Code<'w>)> {
    let is_call = |code: u32| context.settings.code_calls.find_call(b'G', code).is_some();
    let row = |word| context.g_code_row(word).filter(|row| !is_call(row.code));
    let codes = words.list.iter().filter_map(|word| Some((word, row(word)?)));
    let (mut before, mut found) = (Vec::<Code<'w>>::new(), Vec::new());
    for code in codes.filter(|(_, row)| row.group().is_some()) {
        if let Some(lost) = before.iter().rev().find(|lost| lost.1.group() == code.1.group()) {
            found.extend((lost.1.code != code.1.code).then_some((*lost, code)));
        }
        before.push(code);
    }
    found
}

/// Returns the words whose letter a word before them has with another value: the lost one and the one that counts.
fn in_words<'w>(words: impl Iterator<Item = &'w LoweredWord>) -> Vec<(&'w LoweredWord, &'w LoweredWord)> {
    let number = |word: &LoweredWord| match word.value {
        WordOperand::Literal(number) => Some(number.value()),
        _ => None,
    };
    let (mut before, mut found) = (Vec::<&LoweredWord>::new(), Vec::new());
    for word in words {
        let same = |other: &&&LoweredWord| (other.letter, other.comma) == (word.letter, word.comma);
        if let Some(lost) = before.iter().rev().find(same) {
            let is_equal = number(lost).is_some_and(|value| Some(value) == number(word));
            found.extend((!is_equal).then_some((*lost, word)));
        }
        before.push(word);
    }
    found
}

#[cfg(test)]
mod tests {
    use super::super::testing::{NOWHERE, lines, messages};
    use super::RULE;

    #[test]
    fn an_address_with_two_values_is_reported() {
        let text = "O1\nG1 X10. X-40. F100\nG65 P2 A1. B2. A3.\nG3 X-50. X#1 R40.\nM30\nO2\nM99\n";
        assert_eq!(lines(&RULE, text), [2, 3, 4]);
        assert_eq!(messages(&RULE, text)[0], "X is there twice in the block: the last counts");
    }

    #[test]
    fn a_code_that_another_of_its_group_follows_is_reported() {
        let text = "O1\nG91 G28 Z0 G90\nG54 G55 G0 X1.\nG80 G81 Z-1. R1. F9.\nM30\n";
        assert_eq!(lines(&RULE, text), [2, 3, 4]);
        assert_eq!(messages(&RULE, text)[0], "G91 is lost: G90 is of the same group, and the last counts");
        assert_eq!(lines(&RULE, "O1\nG90 G0 G90 G80 G40 G17 G49 G98 X1.\nG4 P1 G53 G0 Z0\nM30\n"), NOWHERE);
    }

    #[test]
    fn codes_repeated_arguments_equal_values_and_a_skip_inside_are_right() {
        let text = "O1\nG90 G0 G17 M8 X1.\nG65 P2 I1. I2. J3. I4.\nG1 X5. Y2. X5. F9.\nX1. /X2.\nG1 X3. ,C1. C2.\nM30\nO2\nM99\n";
        assert_eq!(lines(&RULE, text), NOWHERE);
    }
}
