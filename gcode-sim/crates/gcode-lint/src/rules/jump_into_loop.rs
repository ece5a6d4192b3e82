//! Rule: a jump into a loop from outside. At END the control finds no DO and raises PS1124.
use gcode_lang::alarm::kinds::PS1124;
use gcode_lang::program::Statement;

use crate::prelude::*;

pub(super) static RULE: Rule =
    Rule::new("jump-into-loop", Severity::Error, "a jump into a loop from outside", find);

fn find(_: &CheckContext<'_>, unit: &ProgramUnit<'_>) -> Vec<Diagnostic> {
    let mut found = Vec::new();
    let enclosing = enclosing_loops(unit);
    for jump in unit.flow.jumps.iter().filter(|jump| unit.is_reached[jump.block] && !jump.is_return) {
        let Some(to) = jump.to else { continue };
        let entered = enclosing[to].iter().find(|(first, last)| !(*first..=*last).contains(&jump.block));
        if let Some((first, _)) = entered.copied() {
            let message = format!("{PS1124}: N{} is in a loop that this jump does not begin", jump.number);
            let finding = unit
                .finding(&RULE.kind, jump.block, message)
                .label(unit.op(first).span, "the loop begins here");
            found.push(finding.help("jump to the block that begins the loop"));
        }
    }
    found
}

/// Returns, for each block, the first and last blocks of its loops, outer loops first; at most three.
fn enclosing_loops(unit: &ProgramUnit<'_>) -> Vec<Vec<(OpIndex, OpIndex)>> {
    let mut around = vec![Vec::new(); unit.program.ops().len()];
    for (first, op) in unit.program.ops().iter().enumerate() {
        if let OpKind::Statement(Statement::While { end, .. } | Statement::Do { end, .. }) = *op.kind() {
            around[first + 1..=end].iter_mut().for_each(|loops: &mut Vec<_>| loops.push((first, end)));
        }
    }
    around
}

#[cfg(test)]
mod tests {
    use super::super::testing::{NOWHERE, lines};
    use super::RULE;

    #[test]
    fn loops_are_entered_at_their_beginning() {
        let body = "N5 WHILE[#1 LT 3]DO1\nN6 #1=#1+1\nIF[#1 EQ 2]GOTO 6\nIF[#1 EQ 9]GOTO 9\nEND1\nN9 M30\n";
        assert_eq!(lines(&RULE, &format!("O1\n#1=#500\nIF[#1 GT 0]GOTO 6\n{body}")), [3]);
        assert_eq!(lines(&RULE, &format!("O1\n#1=#500\nIF[#1 GT 0]GOTO 5\n{body}")), NOWHERE);
    }
}
