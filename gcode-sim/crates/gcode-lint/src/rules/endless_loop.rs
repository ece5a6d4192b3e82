//! Rule: a loop that never ends, because no block changes its exit conditions or because it has no exit.
use std::collections::{BTreeMap, BTreeSet};

use gcode_lang::syntax::ast::{Condition, Statement};

use crate::components::strongly_connected_components;
use crate::control_flow::{Jump, raises_alarm};
use crate::expressions::condition_expressions;
use crate::literal;
use crate::prelude::*;
use crate::vacancy::{Locals, truth};
use crate::variables::{self, VariableUses};

pub(super) static RULE: Rule = Rule::new("endless-loop", Severity::Warning, "a loop that never ends", find);

/// First system variable. System variables may change by themselves.
const FIRST_SYSTEM: u32 = 1000;

fn find(context: &CheckContext<'_>, unit: &ProgramUnit<'_>) -> Vec<Diagnostic> {
    let mut found = Vec::new();
    let mut reported = vec![false; unit.program.ops().len()];
    for (block, op) in unit.reached_ops() {
        use gcode_lang::program::Statement::{Do, While};
        let OpKind::Statement(While { end, .. } | Do { end, .. }) = *op.kind() else { continue };
        let inside: Vec<OpIndex> = (block..=end).filter(|b| unit.is_reached[*b]).collect();
        if never_entered(unit, block)
            || has_exit(context, unit, &inside, |to| (block..=end).contains(&to) && unit.is_reached[to])
        {
            continue;
        }
        found.push(loop_finding(unit, block));
        reported[block..=end].fill(true);
    }
    found.extend(find_jump_loops(context, unit, &reported));
    found
}

/// Finds endless cycles closed by a GOTO, each component once.
fn find_jump_loops(context: &CheckContext<'_>, unit: &ProgramUnit<'_>, told: &[bool]) -> Vec<Diagnostic> {
    let mut found = Vec::new();
    let backward_target = |jump: &Jump| {
        let to = jump.to.filter(|to| *to <= jump.block)?;
        (unit.is_reached[jump.block] && !jump.is_return && !told[jump.block]).then_some(to)
    };
    if !unit.flow.jumps.iter().any(|jump| backward_target(jump).is_some()) {
        return found;
    }
    let components = strongly_connected_components(&unit.flow);
    let mut members: BTreeMap<usize, Vec<OpIndex>> = BTreeMap::new();
    for (block, circle) in components[..unit.flow.block_successors.len()].iter().enumerate() {
        members.entry(*circle).or_default().push(block);
    }
    for jump in &unit.flow.jumps {
        let Some(to) = backward_target(jump).filter(|to| components[*to] == components[jump.block]) else {
            continue;
        };
        let component = components[to];
        let Some(inside) = members.remove(&component) else { continue };
        if has_exit(context, unit, &inside, |to| components.get(to) == Some(&component)) {
            continue;
        }
        let message = format!("GOTO {} loops forever: no block in the loop exits it", jump.number);
        let finding =
            unit.finding(&RULE.kind, jump.block, message).label(unit.op(to).span, "it jumps back to here");
        found.push(
            finding.help("change a variable of the exit condition in the loop, or count the iterations"),
        );
    }
    found
}

fn loop_finding(unit: &ProgramUnit<'_>, block: OpIndex) -> Diagnostic {
    match condition(unit, block) {
        Some(condition) => {
            let uses = VariableUses::of(condition_expressions(condition));
            let mut names: Vec<String> = uses.reads.iter().map(|read| format!("#{}", read.number)).collect();
            names.dedup();
            let message = if names.is_empty() {
                "this loop never ends: its condition is always true".to_owned()
            } else {
                format!("this loop never ends: no block in it changes {}", names.join(" or "))
            };
            let help = match names.first() {
                Some(name) => format!("change {name} in the loop, {name}={name}+1"),
                None => "exit it by GOTO, or count the iterations".to_owned(),
            };
            unit.finding(&RULE.kind, block, message).help(help)
        }
        None => unit
            .finding(&RULE.kind, block, "this loop never ends: no block in it exits it")
            .help("exit it by GOTO, or count the iterations"),
    }
}

/// Returns the condition of a WHILE or of an IF … GOTO.
fn condition<'a>(unit: &'a ProgramUnit<'_>, block: OpIndex) -> Option<&'a Condition> {
    match variables::statement(&unit.blocks, block) {
        Some(Statement::While { condition, .. } | Statement::IfGoto { condition, .. }) => Some(condition),
        Some(Statement::IfThen { condition, then }) if matches!(**then, Statement::Goto(_)) => {
            Some(condition)
        }
        _ => None,
    }
}

fn never_entered(unit: &ProgramUnit<'_>, block: OpIndex) -> bool {
    condition(unit, block).is_some_and(|condition| truth(condition, &Locals::ANYTHING) == Some(false))
}

/// Returns true if a block of the set can lead out of it.
fn has_exit(
    context: &CheckContext<'_>,
    unit: &ProgramUnit<'_>,
    inside: &[OpIndex],
    contains: impl Fn(OpIndex) -> bool,
) -> bool {
    let mut written = None;
    inside.iter().copied().any(|block| {
        let op = unit.op(block);
        let ways = &unit.flow.block_successors[block];
        if ways.is_exit
            || ways.jumps_anywhere
            || raises_alarm(op.kind())
            || waits_for_operator(op.kind())
            || is_alarm(op.kind())
        {
            return true;
        }
        if unit.flow.successors(block).all(&contains) {
            return false;
        }
        match condition(unit, block) {
            Some(condition) => {
                let leaves_when =
                    !matches!(variables::statement(&unit.blocks, block), Some(Statement::While { .. }));
                truth(condition, &Locals::ANYTHING) == Some(leaves_when)
                    || written
                        .get_or_insert_with(|| WrittenVariables::collect(context, unit, inside))
                        .changes(&VariableUses::of(condition_expressions(condition)))
            }
            None => true,
        }
    })
}

fn is_alarm(kind: &OpKind) -> bool {
    matches!(kind, OpKind::Alarm(_))
}

/// Returns true if the block waits for the operator: M00, M01, `#3006`.
fn waits_for_operator(kind: &OpKind) -> bool {
    match kind {
        OpKind::Words(words) => {
            words.list.iter().any(|w| w.letter == b'M' && matches!(literal::word_count(w), Some(0 | 1)))
        }
        OpKind::Statement(gcode_lang::program::Statement::Assign { target, .. }) => target.is_variable(3006),
        _ => false,
    }
}

/// Variables that some blocks and the programs they call may write.
#[derive(Default)]
struct WrittenVariables {
    numbers: BTreeSet<u32>,
    /// Lowest number from which all variables may be written.
    all_from: Option<u32>,
}

impl WrittenVariables {
    fn collect(context: &CheckContext<'_>, unit: &ProgramUnit<'_>, blocks: &[OpIndex]) -> Self {
        let mut written = Self::default();
        let mut called = BTreeSet::new();
        // A modal call acts in every block that moves.
        let modal = unit.calls.iter().filter(|call| call.is_modal);
        for call in blocks.iter().filter_map(|block| unit.call_in(*block)).chain(modal) {
            // A macro has its own locals; a subprogram has its caller's.
            let first_number = if call.has_own_locals { 100 } else { 0 };
            match context.called_unit(call).map(|place| (place, &context.units[place])) {
                Some((place, program)) if program.calls.is_empty() => {
                    if called.insert((place, first_number)) {
                        written.add(program, 0..program.blocks.len(), first_number);
                    }
                }
                _ => written.all_from(first_number),
            }
        }
        written.add(unit, blocks.iter().copied(), 0);
        written
    }

    fn add(&mut self, unit: &ProgramUnit<'_>, blocks: impl Iterator<Item = OpIndex>, reach: u32) {
        for (target, _) in blocks.filter_map(|block| unit.blocks.get(block).and_then(variables::assignment)) {
            match literal::variable(target) {
                Some(number) if number >= reach => _ = self.numbers.insert(number),
                Some(_) => {}
                // A computed number may be that of any variable.
                None => self.all_from(reach),
            }
        }
    }

    fn all_from(&mut self, number: u32) {
        self.all_from = Some(self.all_from.map_or(number, |from| from.min(number)));
    }

    /// Returns true if one of the variables occurs in the condition, or if the condition can change by
    /// itself.
    fn changes(&self, uses: &VariableUses) -> bool {
        uses.reads_computed
            || uses.reads.iter().map(|read| read.number).any(|number| {
                number >= FIRST_SYSTEM
                    || self.numbers.contains(&number)
                    || self.all_from.is_some_and(|from| number >= from)
            })
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::{NOWHERE, lines, messages};
    use super::RULE;

    #[test]
    fn what_the_condition_asks_must_change() {
        assert_eq!(lines(&RULE, "O1\n#1=0\nWHILE[#1 LT 3]DO1\nG91 X1.\n#2=#1+1\nEND1\nM30\n"), [3]);
        assert_eq!(lines(&RULE, "O1\n#1=0\nWHILE[#1 LT 3]DO1\nG91 X1.\n#1=#1+1\nEND1\nM30\n"), NOWHERE);
        let found = messages(&RULE, "O1\n#1=0\nWHILE[#1 LT #2]DO1\nG65 P2 X#1\nEND1\nM30\nO2\n#1=5\nM99\n");
        assert_eq!(
            found,
            ["this loop never ends: no block in it changes #1 or #2"],
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
            assert_eq!(lines(&RULE, &text), NOWHERE, "{exit}");
        }
        assert_eq!(
            lines(&RULE, "O1\nWHILE[#1005 EQ 0]DO1\nEND1\nM30\n"),
            NOWHERE,
            "a signal changes by itself"
        );
        assert_eq!(lines(&RULE, "O1\n#1=0\nDO1\n#1=#1+1\nEND1\nM30\n"), [3]);
    }

    #[test]
    fn jumps_that_go_round() {
        assert_eq!(lines(&RULE, "O1\nN1 G0 X1.\nX2.\nGOTO 1\nM30\n"), [4]);
        assert_eq!(lines(&RULE, "O1\n#1=0\nN1 G0 X1.\nIF[#1 EQ 5]GOTO 9\nGOTO 1\nN9 M30\n"), [5]);
        assert_eq!(
            lines(&RULE, "O1\n#1=0\nN1 G0 X1.\n#1=#1+1\nIF[#1 EQ 5]GOTO 9\nGOTO 1\nN9 M30\n"),
            NOWHERE
        );
        assert_eq!(
            lines(&RULE, "O1\nN1 G0 X1.\nX2.\nM99\n"),
            NOWHERE,
            "M99 is how a main program goes round"
        );
    }

    #[test]
    fn circles_inside_and_beside_one_another() {
        let twice = "O1\n#1=0\nN1 X1.\nIF[#2 EQ 5]GOTO 1\nX2.\nGOTO 1\nM30\n";
        assert_eq!(lines(&RULE, twice), [4], "one circle, told at its first GOTO");
        let beside = "O1\nN1 IF[#500 EQ 1]GOTO 2\n#500=#500+1\nGOTO 1\nN2 X1.\nGOTO 2\nM30\n";
        assert_eq!(lines(&RULE, beside), [6]);
        let crossed = "O1\n#1=0\nN1 X1.\nN2 #1=#1+1\nIF[#1 LT 5]GOTO 1\nIF[#1 LT 9]GOTO 2\nM30\n";
        assert_eq!(lines(&RULE, crossed), NOWHERE);
    }

    #[test]
    fn thousands_of_jumps_take_no_time() {
        let mut text = String::from("O1\n#1=0\nN1 #1=#1+0\n");
        for place in 2..2_000 {
            text.push_str(&format!("N{place} X{place}.\nIF[#1 EQ {place}]GOTO {}\n", place - 1));
        }
        assert_eq!(lines(&RULE, &format!("{text}M30\n")), NOWHERE);
    }
}
