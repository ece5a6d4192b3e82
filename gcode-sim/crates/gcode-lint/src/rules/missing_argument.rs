//! Rule: a macro call without a required argument.
//!
//! Without the argument every path through the macro ends in its #3000, or multiplies or divides by the vacant variable.
use std::collections::{BTreeMap, BTreeSet};

use gcode_lang::alarm::kinds::PS0112;
use gcode_lang::program::argument_letter;
use gcode_lang::syntax::ast::{BinaryOp, Block, Expr, ExprKind, Statement};

use crate::control_flow::raises_alarm;
use crate::expressions::{ValueUse, block_expressions};
use crate::literal;
use crate::prelude::*;
use crate::unset_reads::{entry_locals, unset_reads};
use crate::vacancy::{Locals, NUMBER, States, UNSET, can_avoid, states, truth};
use crate::variables;

pub(super) static RULE: Rule =
    Rule::new("missing-argument", Severity::Error, "a macro call without a required argument", find);

fn find(context: &CheckContext<'_>, unit: &ProgramUnit<'_>) -> Vec<Diagnostic> {
    let mut found = Vec::new();
    let mut known: BTreeMap<(usize, Locals), Vec<MissingArgumentEffect>> = BTreeMap::new();
    for call in unit.calls.iter().filter(|call| unit.is_reached[call.block] && call.has_own_locals) {
        let Some(called) = context.called_unit(call) else { continue };
        let entry = entry_locals(call);
        let effects = known.entry((called, entry)).or_insert_with(|| {
            missing_argument_effects(context, &context.units[called], entry, call.is_modal)
        });
        for (severity, message) in effects {
            let finding = unit.finding(&RULE.kind, call.block, message.clone()).with_severity(*severity);
            found.push(finding.help("write the letter with its value"));
        }
    }
    found
}

/// Effect of a missing argument as a sentence: an error if the macro stops with its alarm, a warning if it
/// computes with 0, which may be intended.
type MissingArgumentEffect = (Severity, String);

fn missing_argument_effects(
    context: &CheckContext<'_>,
    called: &ProgramUnit<'_>,
    entry: Locals,
    modal: bool,
) -> Vec<MissingArgumentEffect> {
    let label = called.program.label();
    let letters = (1..=26).filter_map(|local| Some((local, argument_letter(local)?)));
    let missing: Vec<_> = letters.filter(|(local, _)| entry.0[*local] == UNSET).collect();
    let mut filled = entry;
    missing.iter().for_each(|(local, _)| filled.0[*local] = NUMBER);
    let mut effects = Vec::new();
    // Arguments that depend on each other may be omitted together even if each is required with the others.
    let can_alarm = unavoidable_alarm(context, called, &states(called, entry)).is_some();
    for (local, letter) in missing.iter().filter(|_| can_alarm) {
        let mut without = filled;
        without.0[*local] = UNSET;
        if let Some(alarm) = unavoidable_alarm(context, called, &states(called, without))
            && unavoidable_alarm(context, called, &states(called, filled)).is_none()
        {
            let message = format!(
                "{label} needs {letter} (#{local}): if it is omitted, the program stops with {alarm}"
            );
            effects.push((Severity::Error, message));
        }
    }
    // After a refusal no variable is read, and a modal macro may use values of its last call.
    if !effects.is_empty() || modal {
        return effects;
    }
    effects.extend(factors_left_out(called, entry).into_iter().filter_map(|(local, block, is_divisor)| {
        let letter = argument_letter(local as usize)?;
        let line = context.memory.sources().line_column(called.op(block).span).line;
        Some(match is_divisor {
            true => (
                Severity::Error,
                format!("{label} divides by {letter} (#{local}) in line {line}: if it is omitted, this is {PS0112}"),
            ),
            false => (
                Severity::Warning,
                format!("{label} uses {letter} (#{local}) in line {line}; if it is omitted, it is 0"),
            ),
        })
    }));
    effects
}

/// Returns the locals that are vacant as a factor on every path through a program, with the block and true for a divisor.
///
/// A macro that tests a local, compares or sets it makes a case of its absence, and a vacant term of a sum is no offset.
fn factors_left_out(called: &ProgramUnit<'_>, entry: Locals) -> Vec<(u32, OpIndex, bool)> {
    let states = states(called, entry);
    let unset: BTreeSet<_> = unset_reads(called, &states).into_iter().map(|(read, _)| read).collect();
    let mut blocks: BTreeMap<u32, BTreeSet<OpIndex>> = BTreeMap::new();
    let mut divisors = BTreeSet::new();
    for (block, written) in called.blocks.iter().enumerate() {
        for (local, is_divisor) in factor_reads(written) {
            if unset.contains(&(block, local)) {
                blocks.entry(local).or_default().insert(block);
                divisors.extend(is_divisor.then_some((block, local)));
            }
        }
    }
    blocks.retain(|local, blocks| !is_optional(called, *local) && !can_avoid(called, entry, blocks));
    let first = blocks.into_iter().filter_map(|(local, blocks)| {
        let divides = blocks.iter().all(|block| divisors.contains(&(*block, local)));
        Some((local, *blocks.first()?, divides))
    });
    first.collect()
}

/// Returns true if a program tests, compares or sets a local.
fn is_optional(called: &ProgramUnit<'_>, local: u32) -> bool {
    called.blocks.iter().enumerate().any(|(index, block)| {
        let is_set = block.items.iter().filter_map(variables::item_assignment);
        let mut is_set = is_set.map(|(target, _)| literal::variable(target));
        is_set.any(|number| number == Some(local))
            || called.reads(index).iter().any(|read| {
                read.number == local && matches!(read.usage, ValueUse::VacancyTest | ValueUse::Comparison)
            })
    })
}

/// Returns the locals that are factors or divisors by themselves in a block, with true for a divisor.
pub(super) fn factor_reads(block: &Block) -> Vec<(u32, bool)> {
    let mut found = Vec::new();
    for (expr, _) in block_expressions(block) {
        collect_factors(expr, &mut found);
    }
    found
}

fn collect_factors(expr: &Expr, found: &mut Vec<(u32, bool)>) {
    if let ExprKind::Binary(op @ (BinaryOp::Mul | BinaryOp::Div), left, right) = &expr.kind {
        let is_divisor = *op == BinaryOp::Div;
        let factors = [(left, false), (right, is_divisor)].into_iter();
        found.extend(factors.filter_map(|(part, is_divisor)| Some((literal::variable(part)?, is_divisor))));
    }
    expr.operands().for_each(|part| collect_factors(part, found));
}

/// Returns the alarm that every path through a program ends in; `None` if one path ends otherwise.
fn unavoidable_alarm(context: &CheckContext<'_>, unit: &ProgramUnit<'_>, states: &States) -> Option<String> {
    let ops = unit.program.ops();
    let mut first = None;
    // One past the last block is the end of the program.
    if states[ops.len()].is_some() {
        return None;
    }
    for (block, state) in states[..ops.len()].iter().enumerate() {
        let Some(state) = state else { continue };
        if raises_alarm(ops[block].kind()) {
            let is_certain = match variables::statement(&unit.blocks, block) {
                Some(Statement::IfThen { condition, .. }) => truth(condition, state) == Some(true),
                _ => true,
            };
            if is_certain && first.is_none() {
                first = Some(block);
            }
        } else if unit.flow.block_successors[block].is_exit || matches!(ops[block].kind(), OpKind::Alarm(_)) {
            return None;
        }
    }
    first.map(|block| alarm_text(context, unit, block))
}

/// Returns the alarm as in messages, `MC3007 (R MISSING)`.
fn alarm_text(context: &CheckContext<'_>, unit: &ProgramUnit<'_>, block: OpIndex) -> String {
    let written = &unit.blocks[block];
    let number = variables::assignment(written).and_then(|(_, value)| literal::constant(value)).map_or_else(
        || "its alarm".to_owned(),
        |n| format!("MC{:04}", f64::from(context.settings.macro_alarm_base) + n),
    );
    match written.comments.first() {
        Some(text) => format!("{number} ({})", String::from_utf8_lossy(&text.text).trim()),
        None => number,
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::{lines, messages};
    use super::RULE;

    const DRILL: &str = "O2\nIF[#18 EQ #0]GOTO 90\nIF[#7 LE 0]THEN #3000=2(D MISSING)\n\
                         IF[#6 EQ #0]THEN #6=1.\nX#18 Z-#7 Y#25\n#30=#7*#9\nM99\nN90 #3000=1(R MISSING)\n";

    #[test]
    fn a_macro_requires_the_arguments_it_tests() {
        let call = |words: &str| messages(&RULE, &format!("O1\nG65 P2 {words}\nM30\n{DRILL}"));
        assert_eq!(call("R5. D2. F3."), [""; 0]);
        assert_eq!(call("R#500 D#501 F#502"), [""; 0], "values that only a run knows");
        assert_eq!(
            call("D2. F3."),
            ["O2 needs R (#18): if it is omitted, the program stops with MC3001 (R MISSING)"
                .replace("O2", "O0002")]
        );
        assert_eq!(
            call("R5. F3."),
            ["O0002 needs D (#7): if it is omitted, the program stops with MC3002 (D MISSING)"]
        );
        assert_eq!(call("R5. D2."), ["O0002 uses F (#9) in line 9; if it is omitted, it is 0"]);
        assert_eq!(call("").len(), 2, "R and D; F is not checked before they are present");
    }

    /// Each call leaves out B (#2); only a product or quotient on every path, of a local never tested, is known.
    #[test]
    fn arguments_that_a_macro_makes_cases_of_are_accepted() {
        let found = |body: &str| {
            let text = format!("O1\nG65 P2 A1. X5.\nM30\nO2\n{body}M99\n");
            messages(&RULE, &text)
        };
        for body in [
            "#30=#24+#2\n",
            "#[2200+#2]=#1\n",
            "X[#24-#2]\n",
            "#30=SIN[#2]\n",
            "IF[#1 EQ 1]GOTO 5\n#30=#1*#2\nN5 X#24\n",
            "#30=#1*#2\nIF[#2 EQ #0]GOTO 5\nX#30\nN5\n",
            "IF[#2 LT 1.]GOTO 5\n#30=#1*#2\nN5\n",
            "GOTO#500\nN5 #30=#1*#2\nN6\n",
        ] {
            assert_eq!(found(body), [""; 0], "{body}");
        }
        assert_eq!(found("IF[#1 EQ 1]GOTO 5\n#30=#1*#2\nM99\nN5 #31=#2*2\n").len(), 1, "on both paths");
        let row = "#10=0\nWHILE[#10 LT #24]DO1\nX[#1+#10*#2]\n#10=#10+1\nEND1\n";
        assert_eq!(found(row).len(), 1, "a loop runs at least once");
        assert_eq!(found(&row.replace("X[", "IF[#10 EQ 9]GOTO 5\nX[").replace("END1", "N5 END1")), [""; 0]);
        assert_eq!(
            found("X#24\n#30=#1/#2\n"),
            ["O0002 divides by B (#2) in line 6: if it is omitted, this is PS0112"]
        );
    }

    /// A ball requires neither K nor Q, a nose of arcs both.
    #[test]
    fn arguments_that_depend_on_each_other_may_be_omitted_together() {
        let arcs = "O2\nIF[[#6 EQ #0]AND[#17 EQ #0]]GOTO 20\nIF[#6 LE 0]THEN #3000=1(K MISSING)\n\
                    IF[#17 LE 0]THEN #3000=2(Q MISSING)\nN20 X1.\nM99\n";
        let call = |words: &str| messages(&RULE, &format!("O1\nG65 P2 {words}\nM30\n{arcs}"));
        assert_eq!(call(""), [""; 0]);
        assert_eq!(call("K14. Q4."), [""; 0]);
        assert_eq!(
            call("K14."),
            ["O0002 needs Q (#17): if it is omitted, the program stops with MC3002 (Q MISSING)"]
        );
    }

    #[test]
    fn each_call_is_checked() {
        let text = format!("O1\nG65 P2 R1. D2. F3.\nG65 P2 R1. F3.\nM30\n{DRILL}");
        assert_eq!(lines(&RULE, &text), [3]);
    }
}
