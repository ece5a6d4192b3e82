//! Rule: DO and END that do not pair: a missing partner, nested loops of one number, or overlapping loops.
use gcode_lang::alarm::kinds::{PS0124, PS0126, PS1124};
use gcode_lang::source::Span;
use gcode_lang::syntax::ast::{Item, Statement};

use crate::prelude::*;

pub(super) static RULE: Rule =
    Rule::new("loop-pairs", Severity::Error, "DO and END that do not pair, or loops that overlap", find);

fn find(_: &CheckContext<'_>, unit: &ProgramUnit<'_>) -> Vec<Diagnostic> {
    let mut found = Vec::new();
    let mut report = |block: OpIndex, message: String, help: &str, label: Option<(Span, String)>| {
        if unit.is_reached[block] {
            let labels = label.into_iter().collect();
            found.push(Diagnostic { labels, ..unit.finding(&RULE.kind, block, message).help(help) });
        }
    };
    let mut unpaired = Vec::new();
    let mut open: Vec<(i64, usize, Span)> = Vec::new();
    for (block, read) in unit.blocks.iter().enumerate() {
        let Some((number, begins)) = read.items.iter().find_map(loop_word) else { continue };
        if !(1..=3).contains(&number) {
            // The fault is in its DO.
            if begins || !unpaired.contains(&number) {
                let word = if begins { "DO" } else { "END" };
                let message = format!("{PS0126}: {word}{number}: a loop's number is 1, 2 or 3");
                report(block, message, "number it 1, 2 or 3", None);
            }
            unpaired.push(number);
        } else if begins {
            if let Some((.., outer)) = open.iter().find(|(n, ..)| *n == number) {
                let message = format!("{PS0124}: DO{number} inside an open DO{number}");
                let label = (*outer, "the outer loop begins here".to_owned());
                report(block, message, "give the inner loop another number, 1 to 3", Some(label));
            }
            open.push((number, block, read.span));
        } else if let Some(place) = open.iter().rposition(|(n, ..)| *n == number) {
            let crossed = open.split_off(place);
            if let Some((inner, _, begun)) = crossed.get(1) {
                let message = format!("{PS0124}: END{number} while DO{inner} is open: the loops overlap");
                let label = (*begun, format!("DO{inner} begins here"));
                report(block, message, &format!("write END{inner} before END{number}"), Some(label));
            }
            // Their ENDs follow this one and are not a second fault.
            open.extend(crossed.into_iter().skip(1));
        } else {
            let message = format!("{PS1124}: END{number} without a DO{number} before it");
            report(block, message, "write its DO, or remove it", None);
        }
    }
    for (number, block, _) in open {
        let message = format!("{PS0124}: DO{number} has no END{number}");
        report(block, message, &format!("write END{number} after the loop"), None);
    }
    found
}

/// Returns the number of a loop and true if it begins in this item.
fn loop_word(item: &Item) -> Option<(i64, bool)> {
    match item {
        Item::Statement(statement) => match &statement.node {
            Statement::While { number, .. } | Statement::Do(number) => Some((number.node, true)),
            Statement::End(number) => Some((number.node, false)),
            _ => None,
        },
        // `WHILE(#1 GT 0)DO1` has its own fault; its END has none.
        Item::Unreadable(unreadable) => Some((unreadable_loop_number(&unreadable.text)?, true)),
        Item::Word(_) | Item::Skip(_) => None,
    }
}

/// Returns the number after the DO of an unreadable WHILE.
fn unreadable_loop_number(text: &[u8]) -> Option<i64> {
    let text: Vec<u8> =
        text.iter().filter(|b| !b.is_ascii_whitespace()).map(u8::to_ascii_uppercase).collect();
    let place = text.windows(2).rposition(|two| two == b"DO").filter(|_| text.starts_with(b"WH"))?;
    match text.get(place + 2) {
        Some(digit @ b'1'..=b'3') => Some(i64::from(digit - b'0')),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::{NOWHERE, lines, messages};
    use super::RULE;

    #[test]
    fn loops_pair_and_nest() {
        assert_eq!(lines(&RULE, "O1\n#1=0\nWHILE[#1 LT 3]DO1\n#1=#1+1\nM30\n"), [3]);
        assert_eq!(lines(&RULE, "O1\nEND1\nM30\n"), [2]);
        assert_eq!(lines(&RULE, "O1\nDO4\n#1=#500\nEND4\nM30\n"), [2]);
        assert_eq!(
            lines(
                &RULE,
                "O1\n#1=0\nDO1\nDO2\n#1=#1+1\nIF[#1 GT 3]GOTO 5\nEND2\nEND1\nDO1\nGOTO 5\nEND1\nN5 M30\n"
            ),
            NOWHERE,
        );
    }

    #[test]
    fn one_fault_is_told_once() {
        assert_eq!(lines(&RULE, "O1\n#1=0\nWHILE(#1 LT 3)DO1\n#1=#1+1\nEND1\nM30\n"), NOWHERE);
        assert_eq!(lines(&RULE, "O1\n#1=0\nDO1\nDO1\n#1=#1+1\nEND1\nEND1\nM30\n"), [4]);
    }

    #[test]
    fn overlapping_loops_are_one_fault() {
        let text = "O1\n#1=0\nWHILE[#1 LT 3]DO1\nWHILE[#1 LT 2]DO2\n#1=#1+1\nEND1\nEND2\nM30\n";
        let found = messages(&RULE, text);
        assert_eq!(found, ["PS0124: END1 while DO2 is open: the loops overlap"]);
    }
}
