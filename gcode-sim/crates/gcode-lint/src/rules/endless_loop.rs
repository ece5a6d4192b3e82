//! Rule: a loop that never ends, because no block changes its exit conditions or because it has no exit.
use std::cell::LazyCell;
use std::collections::{BTreeMap, BTreeSet};

use gcode_lang::program::{LoweredWord, WordOperand, Words};
use gcode_lang::syntax::ast::{Condition, Statement};

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
fn find_jump_loops(context: &CheckContext<'_>, unit: &ProgramUnit<'_>, reported: &[bool]) -> Vec<Diagnostic> {
    let mut found = Vec::new();
    let backward_target = |jump: &Jump| {
        let to = jump.to.filter(|to| *to <= jump.block)?;
        (unit.is_reached[jump.block] && !jump.is_return && !reported[jump.block]).then_some(to)
    };
    if !unit.flow.jumps.iter().any(|jump| backward_target(jump).is_some()) {
        return found;
    }
    let components = unit.components();
    let mut members: BTreeMap<usize, Vec<OpIndex>> = BTreeMap::new();
    for (block, component) in components[..unit.flow.block_successors.len()].iter().enumerate() {
        members.entry(*component).or_default().push(block);
    }
    let mut closing: BTreeMap<usize, Vec<(&Jump, OpIndex)>> = BTreeMap::new();
    for jump in &unit.flow.jumps {
        if let Some(to) = backward_target(jump).filter(|to| components[*to] == components[jump.block]) {
            closing.entry(components[to]).or_default().push((jump, to));
        }
    }
    for (component, jumps) in closing {
        let inside = members.remove(&component).unwrap_or_default();
        let contains = |to: OpIndex| components.get(to) == Some(&component);
        if has_exit(context, unit, &inside, contains) {
            continue;
        }
        // Without this jump the blocks after the loop are reached; an inner loop ends by itself.
        let leads_out = jumps.iter().rfind(|(jump, _)| !contains(jump.block + 1));
        let Some((jump, to)) = leads_out.or(jumps.iter().max_by_key(|(jump, to)| jump.block - to)) else {
            continue;
        };
        let message = format!("GOTO {} loops forever: no block in the loop exits it", jump.number);
        let help = "change a variable of the exit condition in the loop, or count the iterations";
        let finding = unit.finding(&RULE.kind, jump.block, message).help(help);
        found.push(finding.label(unit.op(*to).span, "it jumps back to here"));
    }
    found
}

fn loop_finding(unit: &ProgramUnit<'_>, block: OpIndex) -> Diagnostic {
    const EXIT: &str = "exit it by GOTO, or count the iterations";
    let names = condition(unit, block).map(|condition| {
        let uses = VariableUses::of(condition_expressions(condition));
        let mut names: Vec<String> = uses.reads.iter().map(|read| format!("#{}", read.number)).collect();
        names.dedup();
        names
    });
    let (reason, help) = match names.as_deref() {
        None => ("no block in it exits it".to_owned(), EXIT.to_owned()),
        Some([]) => ("its condition is always true".to_owned(), EXIT.to_owned()),
        Some(all @ [name, ..]) => (
            format!("no block in it changes {}", all.join(" or ")),
            format!("change {name} in the loop, {name}={name}+1"),
        ),
    };
    unit.finding(&RULE.kind, block, format!("this loop never ends: {reason}")).help(help)
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
    // Blocks that only ask and dwell wait: the machine's logic or another device changes a common variable meanwhile.
    let is_wait = LazyCell::new(|| inside.iter().all(|block| only_waits(unit.op(*block).kind())));
    inside.iter().copied().any(|block| {
        let op = unit.op(block);
        let ways = &unit.flow.block_successors[block];
        if ways.is_exit
            || ways.jumps_anywhere
            || raises_alarm(op.kind())
            || waits_for_operator(op.kind())
            || matches!(op.kind(), OpKind::Alarm(_))
        {
            return true;
        }
        if unit.flow.successors(block).all(&contains) {
            return false;
        }
        match condition(unit, block) {
            Some(condition) => {
                let uses = VariableUses::of(condition_expressions(condition));
                if uses.reads.iter().any(|read| variables::is_common(read.number)) && *is_wait {
                    return true;
                }
                let leaves_when =
                    !matches!(variables::statement(&unit.blocks, block), Some(Statement::While { .. }));
                truth(condition, &Locals::ANYTHING) == Some(leaves_when)
                    || written
                        .get_or_insert_with(|| WrittenVariables::collect(context, unit, inside))
                        .changes(&uses)
            }
            None => true,
        }
    })
}

/// Returns true for a block that asks, jumps or dwells, and does nothing else.
fn only_waits(kind: &OpKind) -> bool {
    use gcode_lang::program::Statement;
    let is_dwell = |words: &Words| {
        let is_g04 = |word: &LoweredWord| matches!(word.value, WordOperand::G(40, _));
        let is_time = |word: &LoweredWord| matches!(word.letter, b'P' | b'X' | b'U');
        words.list.iter().any(is_g04) && words.list.iter().all(|word| is_g04(word) || is_time(word))
    };
    match kind {
        OpKind::Empty => true,
        OpKind::Words(words) => is_dwell(words),
        OpKind::Statement(Statement::IfThen { then, .. }) => matches!(**then, Statement::Goto(_)),
        OpKind::Statement(statement) => matches!(
            statement,
            Statement::Goto(_)
                | Statement::IfGoto { .. }
                | Statement::While { .. }
                | Statement::Do { .. }
                | Statement::End { .. }
        ),
        OpKind::AssignDirect(_) | OpKind::If { .. } | OpKind::Alarm(_) => false,
    }
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

/// Returns the word of the variable that gets the operator's key: P of M109 on a Haas.
fn input_variable(kind: &OpKind) -> Option<&LoweredWord> {
    let words = &kind.words()?.list;
    let is_input = |word: &LoweredWord| word.letter == b'M' && literal::word_count(word) == Some(109);
    words.iter().any(is_input).then(|| words.iter().find(|word| word.letter == b'P'))?
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
        for block in blocks {
            if let Some((target, _)) = unit.blocks.get(block).and_then(variables::assignment) {
                self.insert(literal::variable(target), reach);
            }
            if let Some(word) = unit.blocks.get(block).and_then(|_| input_variable(unit.op(block).kind())) {
                self.insert(literal::word_count(word), reach);
            }
        }
    }

    /// Adds a variable; a computed number may be that of any.
    fn insert(&mut self, number: Option<u32>, reach: u32) {
        match number {
            Some(number) if number >= reach => _ = self.numbers.insert(number),
            Some(_) => {}
            None => self.all_from(reach),
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
    fn a_loop_must_change_its_condition() {
        assert_eq!(lines(&RULE, "O1\n#1=0\nWHILE[#1 LT 3]DO1\nG91 X1.\n#2=#1+1\nEND1\nM30\n"), [3]);
        assert_eq!(lines(&RULE, "O1\n#1=0\nWHILE[#1 LT 3]DO1\nG91 X1.\n#1=#1+1\nEND1\nM30\n"), NOWHERE);
        let found = messages(&RULE, "O1\n#1=0\nWHILE[#1 LT #2]DO1\nG65 P2 X#1\nEND1\nM30\nO2\n#1=5\nM99\n");
        assert_eq!(
            found,
            ["this loop never ends: no block in it changes #1 or #2"],
            "a macro has its own #1"
        );
    }

    /// The manual of a Haas waits for a key so: M109 P501 and a jump back while #501 is 0.
    #[test]
    fn the_key_of_the_operator_ends_a_loop() {
        let text = |variable| format!("O1\nN1 #501=0\nN5 M109 P{variable}\nIF[#501 EQ 0]GOTO5\nM30\n");
        assert_eq!(lines(&RULE, &text("501")), NOWHERE);
        assert_eq!(lines(&RULE, &text("#500")), NOWHERE, "it may be any");
        assert_eq!(lines(&RULE, &text("502")), [4]);
    }

    /// A handshake: the machine's logic sets a common variable while the program does nothing.
    #[test]
    fn a_wait_for_a_common_variable_may_end() {
        assert_eq!(lines(&RULE, "O1\nWHILE[#500 EQ 0]DO1\nEND1\nM30\n"), NOWHERE);
        assert_eq!(lines(&RULE, "O1\n#590=6\nN1 IF[#590 EQ 3]GOTO2\nG04 P1000\nGOTO1\nN2 M30\n"), NOWHERE);
        assert_eq!(lines(&RULE, "O1\nWHILE[#500 EQ 0]DO1\nG91 X1.\nEND1\nM30\n"), [2]);
        assert_eq!(lines(&RULE, "O1\nWHILE[#500 EQ 0]DO1\n#1=1\nEND1\nM30\n"), [2]);
        assert_eq!(lines(&RULE, "O1\nWHILE[#1 EQ #0]DO1\nEND1\nM30\n"), [2], "nothing else sets a local");
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
    fn backward_jumps_form_loops() {
        assert_eq!(lines(&RULE, "O1\nN1 G0 X1.\nX2.\nGOTO 1\nM30\n"), [4]);
        assert_eq!(lines(&RULE, "O1\n#1=0\nN1 G0 X1.\nIF[#1 EQ 5]GOTO 9\nGOTO 1\nN9 M30\n"), [5]);
        assert_eq!(
            lines(&RULE, "O1\n#1=0\nN1 G0 X1.\n#1=#1+1\nIF[#1 EQ 5]GOTO 9\nGOTO 1\nN9 M30\n"),
            NOWHERE
        );
        assert_eq!(lines(&RULE, "O1\nN1 G0 X1.\nX2.\nM99\n"), NOWHERE, "M99 repeats a main program");
    }

    #[test]
    fn nested_and_adjacent_loops_are_separate() {
        let twice = "O1\n#1=0\nN1 X1.\nIF[#2 EQ 5]GOTO 1\nX2.\nGOTO 1\nM30\n";
        assert_eq!(lines(&RULE, twice), [6], "one loop, reported at the GOTO that keeps it from its end");
        let beside = "O1\nN1 IF[#500 EQ 1]GOTO 2\n#500=#500+1\nGOTO 1\nN2 X1.\nGOTO 2\nM30\n";
        assert_eq!(lines(&RULE, beside), [6]);
        let crossed = "O1\n#1=0\nN1 X1.\nN2 #1=#1+1\nIF[#1 LT 5]GOTO 1\nIF[#1 LT 9]GOTO 2\nM30\n";
        assert_eq!(lines(&RULE, crossed), NOWHERE);
    }

    #[test]
    fn the_jump_that_repeats_a_loop_that_ends_is_reported() {
        let counted = "N10 G01 X1. F100.\n#1=3\nN30 #1=#1-1\nIF[#1 GT 0]GOTO 30\nGOTO 10\nM30\n";
        assert_eq!(messages(&RULE, counted), ["GOTO 10 loops forever: no block in the loop exits it"]);
        assert_eq!(lines(&RULE, counted), [5]);
        let without_end = counted.replace("M30\n", "");
        assert_eq!(lines(&RULE, &without_end), [5]);
        let two = "O1\nN1 X1.\nN2 X2.\nIF[#500 EQ 1]GOTO 2\nIF[#501 EQ 1]GOTO 9\nGOTO 1\nN9 GOTO 2\n";
        assert_eq!(lines(&RULE, two), [7], "the last block");
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
