//! Rule: a program whose last block leads on to its end without M02, M30 or M99, PS5010.
use gcode_lang::program::Op;

use crate::literal;
use crate::prelude::*;

pub(super) static RULE: Rule =
    Rule::new("missing-end", Severity::Error, "a program that ends without M02, M30 or M99", find);

fn find(context: &CheckContext<'_>, unit: &ProgramUnit<'_>) -> Vec<Diagnostic> {
    // A main program that is the last text of a file without `%` may end there.
    let is_closed = unit.role != Role::Main || unit.program.is_closed;
    if !is_closed || !unit.reaches_end || unit.piece.as_ref().is_some_and(|piece| !piece.is_last) {
        return Vec::new();
    }
    let Some(last) = unit.program.ops().len().checked_sub(1) else { return Vec::new() };
    let mut from_last = unit.program.ops().iter().rev().filter(|op| !matches!(op.kind(), OpKind::Empty));
    if from_last.next().is_some_and(may_end) {
        return Vec::new();
    }
    let alarm = Alarm::EndOfRecord.located_at(unit.op(last).span);
    let help = match unit.role {
        Role::Main => "write M30 at the end of the program",
        Role::Called | Role::Resident => "write M99 at the end of the program",
    };
    vec![context.alarm_finding(unit, &RULE.kind, last, &alarm).help(help)]
}

/// Returns true if a block has an M code that is computed: it may be M30 or M99.
fn may_end(op: &Op) -> bool {
    let OpKind::Words(words) = op.kind() else { return false };
    words.list.iter().any(|word| word.letter == b'M' && literal::word_number(word).is_none())
}

#[cfg(test)]
mod tests {
    use super::super::testing::{NOWHERE, lines, messages};
    use super::RULE;

    #[test]
    fn a_program_needs_its_end() {
        assert_eq!(lines(&RULE, "O1\nG0 X1.\n%\n"), [2]);
        assert_eq!(lines(&RULE, "%\nO1\nG0 X1.\n"), [3], "cut off before its end and its %");
        assert_eq!(lines(&RULE, "O1\nM98 P2\nM30\nO2\nG0 X1.\n"), [5], "a subprogram has to return");
        assert_eq!(lines(&RULE, "O1\n#32=30\nM#32\nG0 X1.\n%\n"), [4], "the blocks behind it are no end");
        assert_eq!(lines(&RULE, "O1\n#32=30\nM5 X#32\n%\n"), [3]);
        assert_eq!(lines(&RULE, "O1\nM30\nN9 G0 X1.\n%\n"), NOWHERE, "its last block is not reached");
        assert_eq!(lines(&RULE, "O1\nIF[#500 EQ 1]GOTO 9\nM30\nN9 G0 X1.\n%\n"), [4]);
        assert_eq!(
            messages(&RULE, "O1\nG0 X1.\nO2\nM30\n"),
            ["PS5010: the program ends without M02, M30 or M99"]
        );
    }

    #[test]
    fn a_program_with_an_end_is_accepted() {
        for text in [
            "O1\nG0 X1.\nM02\n%\n",
            "O1\nG0 X1.\n",
            "%\nO1\nG0 X1.\nM30\n",
            "O1\nN1 G0 X1.\nGOTO 1\n%\n",
            "O1\nG0 X1.\nM99\n%\n",
            "O1\nIF[#500 EQ 1]GOTO 9\nM30\nN9 #3000=1(NO)\n%\n",
            "G0 X1.\nM30\n(NOTES)\n%\n",
            "O1\nM98 P2\nM30\nO2\n#32=99\nM#32\n(RETURNS)\n%\n",
        ] {
            assert_eq!(messages(&RULE, text), [""; 0], "{text}");
        }
    }
}
