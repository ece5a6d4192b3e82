//! Rule: blocks that are never reached: after M30, M99, GOTO or #3000, without a jump to them.
use gcode_lang::program::{LoweredWord, Statement, m_codes};

use crate::control_flow::raises_alarm;
use crate::literal;
use crate::prelude::*;

pub(super) static RULE: Rule =
    Rule::new("unreachable", Severity::Warning, "blocks that are never reached", find);

fn find(context: &CheckContext<'_>, unit: &ProgramUnit<'_>) -> Vec<Diagnostic> {
    let mut found: Vec<Diagnostic> = Vec::new();
    let ops = unit.program.ops();
    let mut block = 0;
    while block < ops.len() {
        if unit.is_reached[block] {
            block += 1;
            continue;
        }
        let end = (block..ops.len()).find(|next| unit.is_reached[*next]).unwrap_or(ops.len());
        // Comments and numbers alone have no effect, nor has an end, a stop or a jump after an end or an alarm; an
        // unreachable alarm has its own rule.
        let missed: Vec<_> = (block..end).filter(|b| !is_harmless(unit, *b)).collect();
        if let (Some(first), Some(last)) = (missed.first(), missed.last())
            && !is_started_by_number(unit, block, *first)
        {
            let line = |block: usize| context.memory.sources().line_column(ops[block].span).line;
            let message = if first == last {
                "this block is never reached".to_owned()
            } else {
                format!("this block and the following ones, up to line {}, are never reached", line(*last))
            };
            let help = "remove it, or jump to its number";
            found.push(unit.finding(&RULE.kind, *first, message).help(help));
        }
        block = end;
    }
    found
}

/// Returns true if a number alone on its line precedes the first of some blocks after the end of a program: an operator
/// searches the number and starts there.
fn is_started_by_number(unit: &ProgramUnit<'_>, block: OpIndex, first: OpIndex) -> bool {
    let is_end = |before: OpIndex| {
        let is_return = matches!(unit.op(before).kind(), OpKind::Words(words) if words.call().is_some());
        unit.flow.block_successors[before].is_exit && !is_return && !raises_alarm(unit.op(before).kind())
    };
    let is_number =
        |block: OpIndex| unit.op(block).number.is_some() && matches!(unit.op(block).kind(), OpKind::Empty);
    block.checked_sub(1).is_some_and(is_end) && (block..first).any(is_number)
}

/// Returns true for a block whose loss is no fault.
fn is_harmless(unit: &ProgramUnit<'_>, block: OpIndex) -> bool {
    let kind = unit.op(block).kind();
    match kind {
        OpKind::Empty => true,
        OpKind::Words(words) => {
            let stops = |word: &LoweredWord| {
                word.letter == b'M' && literal::word_count(word).is_some_and(m_codes::ends_or_stops)
            };
            words.list.len() <= 1
                && (unit.flow.block_successors[block].is_exit || words.list.iter().any(stops))
        }
        OpKind::Statement(Statement::Goto(_)) => true,
        // A loop that is always left by a jump still requires its END.
        OpKind::Statement(Statement::End { start, .. }) => unit.is_reached[*start],
        _ => raises_alarm(kind),
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::{NOWHERE, lines, messages};
    use super::RULE;

    #[test]
    fn blocks_after_the_end_need_a_jump() {
        assert_eq!(lines(&RULE, "O1\nG0 X1.\nM30\nG0 X2.\nM30\n"), [4]);
        assert_eq!(lines(&RULE, "O1\n#1=1\nIF[#1 EQ 2]GOTO 9\nM30\n(REMARK)\nN9 G0 X2.\nM30\n"), NOWHERE);
        assert_eq!(lines(&RULE, "O1\n#1=1\nGOTO#1\nN1 G0\nM30\nN9 G0 X2.\nM30\n"), NOWHERE, "#1 may be 9");
        assert_eq!(lines(&RULE, "O1\nG0 X1.\nM02\n\nN6 (FOR T6)\nG0 X2.\nM02\n"), NOWHERE, "N6 is searched");
        assert_eq!(lines(&RULE, "O1\nG0 X1.\nM02\nN6 G0 X2.\nM02\n"), [4]);
        assert_eq!(lines(&RULE, "O1\nG0 X1.\nGOTO 7\nN6\nG0 X2.\nN7 M02\n"), [5]);
        assert_eq!(lines(&RULE, "O1\n/M30\nG0 X2.\nM30\n"), NOWHERE, "the switch may be on");
    }

    #[test]
    fn a_part_that_the_program_itself_calls_is_reached() {
        for jump in ["M97 P9", "M97 P#1", "M98 Q9", "M98 Q#1", "M96 P9 Q5", "M96 P#1 Q5"] {
            assert_eq!(lines(&RULE, &format!("O1\n#1=9\n{jump}\nM30\nN9 G0 X2.\nM99\n")), NOWHERE, "{jump}");
        }
        assert_eq!(lines(&RULE, "O1\nM97 P8\nM30\nN9 G0 X2.\nM99\nN8 M99\n"), [4]);
        assert_eq!(lines(&RULE, "O1\nM96 P9\nM30\nN9 G0 X2.\nM99\n"), [4], "of a Fanuc: an interrupt");
    }

    #[test]
    fn an_end_after_an_alarm_is_accepted() {
        assert_eq!(lines(&RULE, "O1\n#1=#500\nIF[#1 EQ 0]GOTO 9\nM30\nN9 #3000=1(NO)\nM30\n"), NOWHERE);
        assert_eq!(lines(&RULE, "O1\n#3000=1(NO)\nM00\nM30\n"), NOWHERE);
        assert_eq!(lines(&RULE, "O1\n#3000=1(NO)\nM00 X1.\nM30\n"), [3]);
        assert_eq!(lines(&RULE, "O1\n#3000=1(NO)\nG0 X1.\nM30\n"), [3]);
        assert_eq!(lines(&RULE, "O1\nIF[#500 EQ 1]GOTO 8\nN7 #3000=1(NO)\nGOTO 7\nN8 M30\n"), NOWHERE);
        let left = "O1\nN3 WHILE[#500 LT 3]DO1\n#500=#500+1\nGOTO 3\nEND1\nM30\n";
        assert_eq!(lines(&RULE, left), NOWHERE, "a loop needs its END");
    }

    #[test]
    fn a_called_program_may_return_after_the_end() {
        assert_eq!(lines(&RULE, "O1\nM98 P2\nM30\nN9 G0 X1.\nM30\nO2\nM99 P9\n"), NOWHERE);
        assert_eq!(lines(&RULE, "O1\nM98 P2\nM30\nN9 G0 X1.\nM30\nO2\nM99\n"), [4]);
    }

    /// What an unreadable block is meant to do is unknown: it may be the jump.
    #[test]
    fn an_unreadable_block_may_jump_anywhere() {
        assert_eq!(lines(&RULE, "O1\nIF[#500.1]GOTO 9\nM30\nN9 G0 X2.\nM30\n"), NOWHERE);
        assert_eq!(lines(&RULE, "O1\nIF[#500.1]GOTO 9\nM30\nG0 X2.\nM30\n"), [4], "it has no number");
    }

    #[test]
    fn consecutive_blocks_are_one_finding() {
        let found = messages(&RULE, "O1\nGOTO 5\nG0 X1.\nG0 X2.\nN5 M30\n");
        assert_eq!(found, ["this block and the following ones, up to line 4, are never reached"]);
    }
}
