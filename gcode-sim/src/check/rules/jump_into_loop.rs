//! A jump into a loop from outside: the control finds at END that no DO was passed (PS1124).
use crate::check::subject::{Finding, Subject, Unit};
use crate::program::{OpIndex, OpKind, Statement};

pub(super) const NAME: &str = "jump-into-loop";

pub(super) fn find(_: &Subject<'_>, unit: &Unit<'_>) -> Vec<Finding> {
    let mut found = Vec::new();
    for jump in unit.flow.jumps.iter().filter(|jump| unit.reached[jump.block] && !jump.returns) {
        let Some(to) = jump.to else { continue };
        let entered = loops(unit).find(|(first, last)| {
            (first + 1..=*last).contains(&to) && !(*first..=*last).contains(&jump.block)
        });
        if let Some((first, _)) = entered {
            let message = format!("PS1124: N{} stands in a loop that this jump doesn't begin", jump.number);
            let finding =
                unit.error(NAME, jump.block, message).label(unit.op(first).span, "the loop begins here");
            found.push(finding.help("jump to the block that begins the loop"));
        }
    }
    found
}

/// The first and the last block of each loop that has both.
fn loops(unit: &Unit<'_>) -> impl Iterator<Item = (OpIndex, OpIndex)> {
    unit.program.ops.iter().enumerate().filter_map(|(first, op)| match op.kind {
        OpKind::Statement(Statement::While { end, .. } | Statement::Do { end, .. }) => Some((first, end)),
        _ => None,
    })
}

#[cfg(test)]
mod tests {
    use super::super::testing::{NOWHERE, lines};
    use super::NAME;

    #[test]
    fn loops_are_entered_at_their_beginning() {
        let body = "N5 WHILE[#1 LT 3]DO1\nN6 #1=#1+1\nIF[#1 EQ 2]GOTO 6\nIF[#1 EQ 9]GOTO 9\nEND1\nN9 M30\n";
        assert_eq!(lines(NAME, &format!("O1\n#1=#500\nIF[#1 GT 0]GOTO 6\n{body}")), [3]);
        assert_eq!(lines(NAME, &format!("O1\n#1=#500\nIF[#1 GT 0]GOTO 5\n{body}")), NOWHERE);
    }
}
