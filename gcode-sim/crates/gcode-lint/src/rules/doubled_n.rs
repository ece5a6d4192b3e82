//! Rule: a sequence number that is defined twice.
//!
//! The target of a jump then depends on the control's parameters and on the blocks read so far; without a jump it is a note.
//! In a long program the numbers begin anew at N9999: many notes are one.
use std::collections::BTreeSet;

use gcode_lang::motion::Backtrace;
use gcode_lang::source::{Sources, Span};

use crate::parameters;
use crate::prelude::*;

pub(super) static RULE: Rule =
    Rule::new("doubled-n", Severity::Warning, "a sequence number that is defined twice", find);

/// Most notes of a program that are told one by one.
const MAX_NOTES: usize = 20;

fn find(context: &CheckContext<'_>, unit: &ProgramUnit<'_>) -> Vec<Diagnostic> {
    // Of a long program all pieces together have their findings.
    if unit.piece.is_some() {
        return Vec::new();
    }
    let jumps = unit.flow.jumps.iter().filter(|jump| !jump.is_return).map(|jump| jump.number).collect();
    doubled_numbers(context.memory.sources(), sequence_numbers(unit), &jumps)
}

/// Returns the sequence numbers of a program with their blocks, in order.
pub(crate) fn sequence_numbers(unit: &ProgramUnit<'_>) -> Vec<(u32, Span)> {
    let parameters = parameters::parameter_blocks(unit.program);
    let ops = unit.program.ops().iter().zip(&parameters);
    let mut left_out = unit.left_out.numbers.iter().peekable();
    let mut numbers: Vec<(u32, Span)> = Vec::new();
    // A block that is left out stands behind one of its run: either both are parameter input or neither.
    let mut is_input = false;
    for (op, is_parameter) in ops {
        while let Some(before) = left_out.next_if(|one| one.block.start < op.span.start) {
            numbers.extend((!is_input).then_some((before.number, before.block)));
        }
        is_input = *is_parameter;
        numbers.extend(op.number.filter(|_| !is_input).map(|number| (number, op.span)));
    }
    numbers.retain(|(number, _)| *number > 0);
    numbers
}

/// Returns a finding for each number of a program that is defined twice. `jumps` are the numbers to which GOTO leads.
pub(crate) fn doubled_numbers(
    sources: &Sources,
    mut numbers: Vec<(u32, Span)>,
    jumps: &BTreeSet<u32>,
) -> Vec<Diagnostic> {
    numbers.sort_unstable_by_key(|(number, block)| (*number, block.start));
    let of_number = numbers.chunk_by(|one, other| one.0 == other.0);
    let doubled = of_number.filter_map(|all| Some((all.first()?, all.get(1)?)));
    let mut doubled: Vec<_> =
        doubled.map(|((number, first), (_, second))| (*number, *first, *second)).collect();
    doubled.sort_unstable_by_key(|(_, _, second)| second.start);
    let finding = |(number, first, block): (u32, Span, Span)| {
        let line = sources.line_column(first).line;
        let jump = jumps.contains(&number);
        let (severity, consequence) = match jump {
            true => (Severity::Warning, ": the control decides which of the two GOTO takes"),
            false => (Severity::Note, ": a search finds one of the two"),
        };
        let message = format!("N{number} is already defined in line {line}{consequence}");
        Diagnostic::new(&RULE.kind, message)
            .with_severity(severity)
            .with_backtrace(Backtrace { block, calls: None })
            .label(first, "the first one")
            .help("give one of them another number")
    };
    fold_notes(doubled.into_iter().map(finding).collect())
}

/// Makes many notes one, at the place of the first: a program whose numbers begin anew is no mistake, and needs no remedy.
fn fold_notes(found: Vec<Diagnostic>) -> Vec<Diagnostic> {
    let is_note = |finding: &Diagnostic| finding.severity == Severity::Note;
    let (mut notes, mut found): (Vec<_>, Vec<_>) = found.into_iter().partition(is_note);
    if MAX_NOTES < notes.len() {
        let others = notes.len() - 1;
        notes.truncate(1);
        for note in &mut notes {
            note.message = format!("{}, so for {others} other numbers of this program", note.message);
            note.help = None;
        }
    }
    found.extend(notes);
    found
}

#[cfg(test)]
mod tests {
    use super::super::testing::{NOWHERE, lines, messages};
    use super::RULE;

    #[test]
    fn numbers_that_begin_anew_are_one_note() {
        let numbered = |count: usize| -> String {
            let numbers = (1..=count).chain(1..=count);
            numbers.map(|number| format!("N{number} G4 X1.\n")).collect::<String>()
        };
        assert_eq!(lines(&RULE, &format!("O1\n{}M30\n", numbered(20))).len(), 20);
        let text = format!("O1\n{}M30\n", numbered(21));
        assert_eq!(lines(&RULE, &text), [23], "the block behind O1 and 21 others");
        let note = "N1 is already defined in line 2: a search finds one of the two, so for 20 other numbers of this program";
        assert_eq!(messages(&RULE, &text), [note]);
        // A number that a GOTO names is a warning of its own.
        let jump = format!("O1\n{}IF[#500 EQ 1]GOTO 7\nM30\n", numbered(22));
        assert_eq!(lines(&RULE, &jump), [24, 30]);
    }

    #[test]
    fn each_duplicate_number_is_reported_once() {
        assert_eq!(lines(&RULE, "O1\nN10 G0\nN010 G0\nN10 G0\nN20 M30\n"), [3]);
        let parameters = "O1\nN1241 G10 L52\nN1241 P1 R1.\nN1241 P2 R1.\nG11\nN1241 M30\n";
        assert_eq!(lines(&RULE, parameters), [6], "after G10 L52 N is no sequence number");
        // Moves of one form, all but two of which are left out; the second N1 is among them, the third is told once.
        let moves =
            "O1\nG90\nN1X1.\nN2X2.\nN3X3.\nN1X4.\nN2X5.\nN1X6.\nN4X7.\nM30\n(THE END OF THE WHOLE PROGRAM)\n";
        assert_eq!(lines(&RULE, moves), [6, 7]);
        assert_eq!(lines(&RULE, "O1\nN10 M30\nO2\nN10 M99\n(N10)\n"), NOWHERE, "each program has its own");
    }
}
