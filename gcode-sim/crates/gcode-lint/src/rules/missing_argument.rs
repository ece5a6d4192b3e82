//! Rule: a macro call without a required argument.
//!
//! Without the argument every path through the macro ends in its #3000, or the macro computes with a vacant
//! variable.
use std::collections::{BTreeMap, BTreeSet};

use gcode_lang::program::argument_letter;
use gcode_lang::syntax::ast::Statement;

use crate::control_flow::raises_alarm;
use crate::expressions::ValueUse;
use crate::prelude::*;
use crate::unset_reads::{entry_locals, unset_reads};
use crate::vacancy::{Locals, NUMBER, States, UNSET, states, truth};
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
        for lack in effects {
            let finding = match lack {
                MissingArgumentEffect::Alarm(message) => {
                    unit.finding(&RULE.kind, call.block, message.clone())
                }
                MissingArgumentEffect::DefaultsToZero(message) => {
                    unit.finding(&RULE.kind, call.block, message.clone()).with_severity(Severity::Warning)
                }
            };
            found.push(finding.help("write the letter with its value"));
        }
    }
    found
}

/// Effect of a missing argument, as a sentence.
enum MissingArgumentEffect {
    /// The macro stops with its alarm.
    Alarm(String),
    /// The macro computes with 0, which may be intended.
    DefaultsToZero(String),
}

/// Returns the effects of a call's missing arguments.
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
    let mut reported = BTreeSet::new();
    // Arguments that depend on each other may be omitted together even if each is required with the others.
    let can_alarm = unavoidable_alarm(context, called, &states(called, entry)).is_some();
    for (local, letter) in missing.iter().filter(|_| can_alarm) {
        let mut without = filled;
        without.0[*local] = UNSET;
        if let Some(alarm) = unavoidable_alarm(context, called, &states(called, without))
            && unavoidable_alarm(context, called, &states(called, filled)).is_none()
        {
            reported.insert(*local as u32);
            let message = format!(
                "{label} needs {letter} (#{local}): if it is omitted, the program stops with {alarm}"
            );
            effects.push(MissingArgumentEffect::Alarm(message));
        }
    }
    // After a refusal no variable is read, and a modal macro may use values of its last call.
    if !effects.is_empty() || modal {
        return effects;
    }
    let states = states(called, entry);
    for ((block, local), (_, usage)) in unset_reads(called, &states) {
        let Some(letter) = argument_letter(local as usize) else { continue };
        if usage == ValueUse::Computed && reported.insert(local) {
            let line = context.memory.sources().line_column(called.op(block).span).line;
            let message =
                format!("{label} uses {letter} (#{local}) in line {line}; if it is omitted, it is 0");
            effects.push(MissingArgumentEffect::DefaultsToZero(message));
        }
    }
    effects
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
    let number =
        variables::assignment(written).and_then(|(_, value)| crate::literal::constant(value)).map_or_else(
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
    fn the_macro_says_what_it_needs() {
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
        assert_eq!(call("").len(), 2, "R and D; F is not looked at before they are there");
    }

    /// A ball requires neither K nor Q, a nose of arcs both.
    #[test]
    fn letters_that_belong_together_may_both_be_left_out() {
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
    fn each_call_is_looked_at() {
        let text = format!("O1\nG65 P2 R1. D2. F3.\nG65 P2 R1. F3.\nM30\n{DRILL}");
        assert_eq!(lines(&RULE, &text), [3]);
    }
}
