//! A loop that never ends: nothing in it changes what its exits ask, or it has no exit.
use crate::check::flow::raises;
use crate::check::literal;
use crate::check::subject::{Finding, Subject, Unit};
use crate::check::vacancy::{Locals, truth};
use crate::check::variables::{self, Uses};
use crate::program::{OpIndex, OpKind, Operand};
use crate::syntax::ast::{Condition, Statement};

pub(super) const NAME: &str = "endless-loop";

/// Variables from here on are the control's own and change by themselves.
const FIRST_SYSTEM: u32 = 1000;

pub(super) fn find(subject: &Subject<'_>, unit: &Unit<'_>) -> Vec<Finding> {
    let mut found = Vec::new();
    let mut told = vec![false; unit.program.ops.len()];
    for (block, op) in unit.program.ops.iter().enumerate().filter(|(block, _)| unit.reached[*block]) {
        use crate::program::Statement::{Do, While};
        let OpKind::Statement(While { end, .. } | Do { end, .. }) = op.kind else { continue };
        let inside: Vec<bool> =
            (0..told.len()).map(|b| (block..=end).contains(&b) && unit.reached[b]).collect();
        if never_entered(unit, block) || escapes(subject, unit, &inside) {
            continue;
        }
        found.push(loop_finding(unit, block));
        told[block..=end].fill(true);
    }
    let before = unit.flow.before();
    for jump in unit.flow.jumps.iter().filter(|jump| unit.reached[jump.block] && !jump.returns) {
        let Some(to) = jump.to.filter(|to| *to <= jump.block && !told[jump.block]) else { continue };
        let inside = circle(unit, &before, to, jump.block);
        if !inside[to] || escapes(subject, unit, &inside) {
            continue;
        }
        let message = format!("GOTO {} goes round for ever: nothing in between leads out", jump.number);
        let back = unit.op(to).span;
        let finding = unit.warning(NAME, jump.block, message).label(back, "it goes back to here");
        found.push(finding.help("change what the exit asks, or count the passes"));
        told.iter_mut().zip(inside).for_each(|(told, inside)| *told |= inside);
    }
    found
}

fn loop_finding(unit: &Unit<'_>, block: OpIndex) -> Finding {
    match condition(unit, block) {
        Some(condition) => {
            let uses = variables::of_condition(condition);
            let mut names: Vec<String> = uses.reads.iter().map(|read| format!("#{}", read.number)).collect();
            names.dedup();
            let message = if names.is_empty() {
                "once begun, this loop never ends: its condition is always true".to_owned()
            } else {
                format!("once begun, this loop never ends: nothing in it changes {}", names.join(" or "))
            };
            let help = match names.first() {
                Some(name) => format!("change {name} in the loop, {name}={name}+1"),
                None => "leave it by GOTO, or count the passes".to_owned(),
            };
            unit.warning(NAME, block, message).help(help)
        }
        None => unit
            .warning(NAME, block, "this loop never ends: nothing in it leads out")
            .help("leave it by GOTO, or count the passes"),
    }
}

/// The condition of a WHILE or of an IF … GOTO.
fn condition<'a>(unit: &'a Unit<'_>, block: OpIndex) -> Option<&'a Condition> {
    match variables::statement(&unit.blocks, block) {
        Some(Statement::While { condition, .. } | Statement::IfGoto { condition, .. }) => Some(condition),
        Some(Statement::IfThen { condition, then }) if matches!(**then, Statement::Goto(_)) => {
            Some(condition)
        }
        _ => None,
    }
}

fn never_entered(unit: &Unit<'_>, block: OpIndex) -> bool {
    condition(unit, block).is_some_and(|condition| truth(condition, &Locals::ANYTHING) == Some(false))
}

/// Whether anything in a set of blocks can lead out of it.
fn escapes(subject: &Subject<'_>, unit: &Unit<'_>, inside: &[bool]) -> bool {
    let blocks = (0..inside.len()).filter(|block| inside[*block]);
    let mut all = blocks.clone();
    all.any(|block| {
        let op = unit.op(block);
        let ways = &unit.flow.ways[block];
        if ways.leaves || ways.anywhere || raises(&op.kind) || waits(&op.kind) || is_alarm(&op.kind) {
            return true;
        }
        let out = |to: &OpIndex| !inside.get(*to).copied().unwrap_or(false);
        if !unit.flow.after(block).iter().any(out) {
            return false;
        }
        match condition(unit, block) {
            Some(condition) => {
                let leaves_when =
                    !matches!(variables::statement(&unit.blocks, block), Some(Statement::While { .. }));
                truth(condition, &Locals::ANYTHING) == Some(leaves_when)
                    || changes(subject, unit, &variables::of_condition(condition), blocks.clone())
            }
            None => true,
        }
    })
}

fn is_alarm(kind: &OpKind) -> bool {
    matches!(kind, OpKind::Alarm(_))
}

/// The operator is asked: M00, M01, `#3006`.
fn waits(kind: &OpKind) -> bool {
    match kind {
        OpKind::Words(words) => {
            words.list.iter().any(|w| w.letter == b'M' && matches!(literal::count(w), Some(0 | 1)))
        }
        OpKind::Statement(crate::program::Statement::Assign { target, .. }) => {
            matches!(target, Operand::Number(number) if *number == 3006.0)
        }
        _ => false,
    }
}

/// Whether something a condition asks can change while these blocks are gone through.
fn changes(
    subject: &Subject<'_>,
    unit: &Unit<'_>,
    uses: &Uses,
    mut blocks: impl Iterator<Item = OpIndex>,
) -> bool {
    let numbers: Vec<u32> = uses.reads.iter().map(|read| read.number).collect();
    if uses.reads_any || numbers.iter().any(|number| *number >= FIRST_SYSTEM) {
        return true;
    }
    blocks.any(|block| writes(unit, block, &numbers) || calls_write(subject, unit, block, &numbers))
}

/// Whether a block assigns one of these variables, or may: its target's number is computed.
fn writes(unit: &Unit<'_>, block: OpIndex, numbers: &[u32]) -> bool {
    let target = unit.blocks.get(block).and_then(variables::assignment);
    target.is_some_and(|(target, _)| literal::variable(target).is_none_or(|number| numbers.contains(&number)))
}

/// Whether a call in a block may change one of these: a macro the common ones, a subprogram any.
fn calls_write(subject: &Subject<'_>, unit: &Unit<'_>, block: OpIndex, numbers: &[u32]) -> bool {
    // A modal call acts in any block that moves.
    let modal = unit.calls.iter().filter(|call| call.modal);
    unit.call_in(block).into_iter().chain(modal).any(|call| {
        let reach = |number: &&u32| !call.own_locals || **number >= 100;
        let reached: Vec<u32> = numbers.iter().filter(reach).copied().collect();
        if reached.is_empty() {
            return false;
        }
        match subject.called(call) {
            None => true,
            Some(called) => {
                let called = &subject.units[called];
                !called.calls.is_empty() || (0..called.blocks.len()).any(|b| writes(called, b, &reached))
            }
        }
    })
}

/// The blocks on the ways from `to` back to `from`.
fn circle(unit: &Unit<'_>, before: &[Vec<OpIndex>], to: OpIndex, from: OpIndex) -> Vec<bool> {
    let forward = unit.flow.reached([to]);
    let mut backward = vec![false; forward.len()];
    let mut open = vec![from];
    while let Some(block) = open.pop() {
        if !std::mem::replace(&mut backward[block], true) {
            open.extend(&before[block]);
        }
    }
    forward.into_iter().zip(backward).map(|(forward, backward)| forward && backward).collect()
}

#[cfg(test)]
mod tests {
    use super::super::testing::{NOWHERE, lines, messages};
    use super::NAME;

    #[test]
    fn what_the_condition_asks_must_change() {
        assert_eq!(lines(NAME, "O1\n#1=0\nWHILE[#1 LT 3]DO1\nG91 X1.\n#2=#1+1\nEND1\nM30\n"), [3]);
        assert_eq!(lines(NAME, "O1\n#1=0\nWHILE[#1 LT 3]DO1\nG91 X1.\n#1=#1+1\nEND1\nM30\n"), NOWHERE);
        let found = messages(NAME, "O1\n#1=0\nWHILE[#1 LT #2]DO1\nG65 P2 X#1\nEND1\nM30\nO2\n#1=5\nM99\n");
        assert_eq!(
            found,
            ["once begun, this loop never ends: nothing in it changes #1 or #2"],
            "a macro has its own #1"
        );
    }

    #[test]
    fn exits_end_a_loop() {
        for exit in [
            "IF[#1 GT 3]GOTO 9\n#1=#1+1",
            "GOTO 9",
            "M99",
            "IF[#500 EQ 1]THEN #3000=1(STOP)",
            "M00",
            "M98 P2",
            "#[#1]=5",
        ] {
            let text = format!("O1\n#1=0\nWHILE[#1 LT 3]DO1\n{exit}\nEND1\nN9 M30\nO2\n#1=5\nM99\n");
            assert_eq!(lines(NAME, &text), NOWHERE, "{exit}");
        }
        assert_eq!(
            lines(NAME, "O1\nWHILE[#1005 EQ 0]DO1\nEND1\nM30\n"),
            NOWHERE,
            "a signal changes by itself"
        );
        assert_eq!(lines(NAME, "O1\n#1=0\nDO1\n#1=#1+1\nEND1\nM30\n"), [3]);
    }

    #[test]
    fn jumps_that_go_round() {
        assert_eq!(lines(NAME, "O1\nN1 G0 X1.\nX2.\nGOTO 1\nM30\n"), [4]);
        assert_eq!(lines(NAME, "O1\n#1=0\nN1 G0 X1.\nIF[#1 EQ 5]GOTO 9\nGOTO 1\nN9 M30\n"), [5]);
        assert_eq!(lines(NAME, "O1\n#1=0\nN1 G0 X1.\n#1=#1+1\nIF[#1 EQ 5]GOTO 9\nGOTO 1\nN9 M30\n"), NOWHERE);
        assert_eq!(lines(NAME, "O1\nN1 G0 X1.\nX2.\nM99\n"), NOWHERE, "M99 is how a main program goes round");
    }
}
