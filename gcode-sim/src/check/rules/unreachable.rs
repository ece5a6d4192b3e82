//! Blocks that nothing reaches: behind M30, M99, GOTO or a #3000 without a number that something jumps to.
use crate::check::flow::raises;
use crate::check::subject::{Finding, Subject, Unit};
use crate::program::OpKind;

pub(super) const NAME: &str = "unreachable";

pub(super) fn find(subject: &Subject<'_>, unit: &Unit<'_>) -> Vec<Finding> {
    let mut found: Vec<Finding> = Vec::new();
    let ops = &unit.program.ops;
    let mut block = 0;
    while block < ops.len() {
        if unit.reached[block] {
            block += 1;
            continue;
        }
        let end = (block..ops.len()).find(|next| unit.reached[*next]).unwrap_or(ops.len());
        // Comments and numbers alone do nothing; an alarm that is lost is told by its own rule.
        let lost: Vec<_> = (block..end)
            .filter(|b| !matches!(ops[*b].kind, OpKind::Empty) && !raises(&ops[*b].kind))
            .collect();
        if let (Some(first), Some(last)) = (lost.first(), lost.last()) {
            let line = |block: usize| subject.memory.sources().place(ops[block].span).line;
            let message = if first == last {
                "nothing reaches this block".to_owned()
            } else {
                format!("nothing reaches this block and what follows, up to line {}", line(*last))
            };
            let help = "take it out, or jump to its number";
            found.push(unit.warning(NAME, *first, message).help(help));
        }
        block = end;
    }
    found
}

#[cfg(test)]
mod tests {
    use super::super::testing::{NOWHERE, lines, messages};
    use super::NAME;

    #[test]
    fn what_stands_behind_the_end_needs_a_jump() {
        assert_eq!(lines(NAME, "O1\nG0 X1.\nM30\nG0 X2.\nM30\n"), [4]);
        assert_eq!(lines(NAME, "O1\n#1=1\nIF[#1 EQ 2]GOTO 9\nM30\n(REMARK)\nN9 G0 X2.\nM30\n"), NOWHERE);
        assert_eq!(lines(NAME, "O1\n#1=1\nGOTO#1\nN1 G0\nM30\nN9 G0 X2.\nM30\n"), NOWHERE, "#1 may be 9");
        assert_eq!(lines(NAME, "O1\n/M30\nG0 X2.\nM30\n"), NOWHERE, "the switch may be on");
    }

    #[test]
    fn a_called_program_may_return_behind_the_end() {
        assert_eq!(lines(NAME, "O1\nM98 P2\nM30\nN9 G0 X1.\nM30\nO2\nM99 P9\n"), NOWHERE);
        assert_eq!(lines(NAME, "O1\nM98 P2\nM30\nN9 G0 X1.\nM30\nO2\nM99\n"), [4]);
    }

    #[test]
    fn a_run_of_blocks_is_one_finding() {
        let found = messages(NAME, "O1\nGOTO 5\nG0 X1.\nG0 X2.\nN5 M30\n");
        assert_eq!(found, ["nothing reaches this block and what follows, up to line 4"]);
    }
}
