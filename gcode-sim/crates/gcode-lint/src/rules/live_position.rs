//! Rule: a momentary value that is read or written while a move may be in progress.
//!
//! Macro statements run as soon as they are read, ahead of the preceding move. #5021…, #5041…, clocks,
//! signals and the codes of the executing block then have the values of that instant.
//!
//! #5001… (end of the preceding block) and #5061… (latched by G31) do not depend on the instant.
use std::ops::RangeInclusive;

use gcode_lang::control::Dialect;
use gcode_lang::program::code_facts::Timing;
use gcode_lang::program::{Statement, WordOperand, Words};
use gcode_lang::source::Span;

use crate::calls::CallSite;
use crate::literal;
use crate::piece::later;
use crate::prelude::*;
use crate::variables::{self, VariableRead};

pub(super) static RULE: Rule =
    Rule::new("live-position", Severity::Warning, "a position read while a move may be in progress", find);

/// Inputs, clocks, codes of the executing block, positions, servo deviations, handle interruption, distance
/// to go.
const LIVE_VARIABLES: [RangeInclusive<u32>; 6] =
    [1000..=1035, 3001..=3002, 4201..=4330, 5021..=5060, 5101..=5140, 5181..=5200];

const OUTPUTS: RangeInclusive<u32> = 1100..=1135;

fn find(context: &CheckContext<'_>, unit: &ProgramUnit<'_>) -> Vec<Diagnostic> {
    if limits_lookahead(context, unit) {
        return Vec::new();
    }
    let pending = &pending_moves(context, unit)[..];
    let mut found = Vec::new();
    for (block, written) in unit.reached_blocks() {
        let Some(motion) = pending[block].flatten() else { continue };
        let reads = unit.reads(block);
        let is_live = |number: u32| {
            LIVE_VARIABLES.iter().any(|range| range.contains(&number)) && !is_difference(reads, number)
        };
        let mut live = reads.iter().filter(|read| is_live(read.number));
        // One finding per block: a probe reads several axes at once.
        let read = live.next().map(|read| (read.number, "read", Some(read.span)));
        let target = variables::assignment(written).and_then(|(target, _)| literal::variable(target));
        let set = target.filter(|number| OUTPUTS.contains(number)).map(|number| (number, "set", None));
        for (number, access, span) in read.into_iter().chain(set) {
            let message = format!("#{number} is {access} while the preceding move may still be in progress");
            let finding = unit.finding(&RULE.kind, block, message).label(motion, "the move");
            found.push(Diagnostic { span, ..finding.help(HELP) });
        }
    }
    found
}

/// Returns true if G103 of a Haas limits lookahead in a program, or may do so in a caller.
pub(crate) fn limits_lookahead(context: &CheckContext<'_>, unit: &ProgramUnit<'_>) -> bool {
    let limits = |words: &Words| words.list.iter().any(|word| matches!(word.value, WordOperand::G(1030, _)));
    context.settings.codes == Dialect::HaasNgc
        && (unit.role != Role::Main || unit.reached_words().any(|(_, words)| limits(words)))
}

/// Returns true for the position of an axis in machine and in work coordinates that a block reads together: their
/// difference is an offset, which does not change in a move.
fn is_difference(reads: &[VariableRead], number: u32) -> bool {
    let other = match number {
        5021..=5040 => number + 20,
        5041..=5060 => number - 20,
        _ => return false,
    };
    reads.iter().any(|read| read.number == other)
}

const HELP: &str = "insert a block before it that waits for the move: G53, M00 or G31";

/// Returns, for each node, a move that may still be in progress before it; the outer `None` is an unreachable
/// block.
pub(crate) fn pending_moves(context: &CheckContext<'_>, unit: &ProgramUnit<'_>) -> Vec<Option<Option<Span>>> {
    let next = |block: OpIndex, before: &Option<Span>, open: &mut Vec<_>| {
        let op = unit.program.ops().get(block);
        let called = unit.call_in(block);
        let after = match called {
            Some(call) => call_effect(context, call),
            None => op.and_then(|op| move_effect(context, op.kind())),
        };
        // A computed jump may lead from elsewhere.
        let is_computed = unit.flow.computed_node() == block;
        let after = match after {
            _ if is_computed => None,
            Some(true) => op.map(|op| op.span),
            Some(false) => None,
            None => *before,
        };
        let skipped = op.and_then(|op| op.skip()).map(|_| (block + 1, *before));
        open.extend(unit.flow.successors(block).map(|to| (to, after)).chain(skipped));
    };
    let start = unit.piece.as_ref().and_then(|piece| piece.start.pending_move);
    let far =
        unit.piece.iter().flat_map(|piece| &piece.entries).map(|entry| (entry.block, entry.pending_move));
    unit.flow.propagate(
        std::iter::once((0, start)).chain(far),
        |known, other| *known = later(*known, other),
        next,
    )
}

/// Returns the effect of a call: that of a program that only moves, or does neither; false if it is unknown.
fn call_effect(context: &CheckContext<'_>, call: &CallSite) -> Option<bool> {
    let Some(called) = context.called_unit(call).filter(|_| !call.is_modal) else { return Some(false) };
    let called = &context.units[called];
    let effects: Vec<bool> =
        called.reached_ops().filter_map(|(_, op)| move_effect(context, op.kind())).collect();
    let is_known = called.calls.is_empty() && effects.iter().all(|is_move| *is_move);
    if is_known { effects.last().copied() } else { Some(false) }
}

/// Returns true if a block starts a move, false if it waits for all preceding moves.
fn move_effect(context: &CheckContext<'_>, kind: &OpKind) -> Option<bool> {
    match kind {
        OpKind::Words(words) => words_effect(context, words),
        // A message stops until the operator restarts.
        OpKind::Statement(Statement::Assign { target, .. }) if target.is_variable(3006) => Some(false),
        _ => None,
    }
}

fn words_effect(context: &CheckContext<'_>, words: &Words) -> Option<bool> {
    let mut has_axis = false;
    for word in &words.list {
        match (word.letter, word.value) {
            (b'G', WordOperand::G(..)) => {
                match context.g_code_row(word).map(|row| row.facts.timing) {
                    // G53 waits; G31 ends at its signal; G04 and G10 wait on some controls.
                    Some(Timing::Waits) => return Some(false),
                    // These codes only set coordinates.
                    Some(Timing::MovesNothing) => return None,
                    Some(Timing::ReadAhead) | None => {}
                }
            }
            // Coolant and spindle codes do not wait; the effect of the machine builder's codes is unknown.
            (b'M', _) if !matches!(literal::word_count(word), Some(3 | 4 | 5 | 7 | 8 | 9)) => {
                return Some(false);
            }
            (letter, _) => has_axis |= word.axis.is_some() || context.settings.axes.find(letter).is_some(),
        }
    }
    has_axis.then_some(true)
}

#[cfg(test)]
mod tests {
    use super::super::testing::{NOWHERE, lines};
    use super::RULE;
    use crate::check;
    use gcode_lang::control::Settings;
    use gcode_lang::program::NoLibrary;

    #[test]
    fn a_position_read_after_a_move_is_reported() {
        assert_eq!(lines(&RULE, "O1\nG0 X10.\n#100=#5041\n#101=#5023*2\nM30\n"), [3, 4]);
        assert_eq!(lines(&RULE, "O1\nG0 X10.\nM8\nIF[#5023 LT 0]GOTO 9\nN9 M30\n"), [4]);
    }

    #[test]
    fn signals_and_clocks_are_momentary_values() {
        for read in ["#100=#1005", "#100=#3001", "#100=#4201", "IF[#1032 EQ 0]GOTO 9", "#100=[#_UI[3]]"] {
            assert_eq!(lines(&RULE, &format!("O1\nG0 X10.\n{read}\nN9 M30\n")), [3], "{read}");
            assert_eq!(lines(&RULE, &format!("O1\nG0 X10.\nM00\n{read}\nN9 M30\n")), NOWHERE, "{read}");
        }
        for written in ["#1100=1", "#1132=5", "IF[#1 EQ 1]THEN #1131=0"] {
            assert_eq!(lines(&RULE, &format!("O1\n#1=1\nG0 X10.\n{written}\nM30\n")), [4], "{written}");
            assert_eq!(lines(&RULE, &format!("O1\n#1=1\nG0 X10.\nG53\n{written}\nM30\n")), NOWHERE);
        }
        assert_eq!(lines(&RULE, "O1\nG0 X10.\n#100=#4001+#3011+#1100\n#3003=1\nM30\n"), NOWHERE);
    }

    #[test]
    fn a_difference_of_coordinates_is_an_offset() {
        assert_eq!(lines(&RULE, "O1\nG0 X10.\n#100=#5021-#5041\n#101=ABS[#5043-#5023]\nM30\n"), NOWHERE);
        assert_eq!(lines(&RULE, "O1\nG0 X10.\n#100=#5021-#5042\n#101=#5021-#5041+#5023\nM30\n"), [3, 4]);
    }

    #[test]
    fn calls_and_computed_jumps_are_known_or_no_reason() {
        let called = |block: &str, of_called: &str| {
            lines(&RULE, &format!("O1\n{block}\n#100=#5041\nM30\nO2\n{of_called}\nM99\n"))
        };
        assert_eq!(called("M98 P2", "G0 X5."), [3]);
        assert_eq!(called("G0 X5.\nM98 P2", "#1=5"), [4]);
        assert_eq!(called("M98 P2", "G0 X5.\nM00"), NOWHERE);
        assert_eq!(called("G65 P2 X5.", "#1=5"), NOWHERE, "X is an argument");
        assert_eq!(called("G0 X5.\nG65 P3", "#1=5"), NOWHERE, "O3 is unknown");
        assert_eq!(
            lines(&RULE, "O1\nN1 #100=#5041\nG0 X5.\nGOTO#500\nM30\n"),
            NOWHERE,
            "#500 may be another"
        );
    }

    #[test]
    fn a_limit_of_lookahead_waits() {
        let mut settings = Settings::default();
        settings.set("DIALECT", "haas-ngc").unwrap();
        let found = |text: &str| {
            let checked = check("O1.nc", text.as_bytes(), &settings, &mut NoLibrary);
            checked.findings.iter().filter(|finding| finding.kind == &RULE.kind).count()
        };
        assert_eq!(found("O1\nG0 X10.\n#100=#5041\nM30\n"), 1);
        assert_eq!(found("O1\nG103 P1\nG0 X10.\n#100=#5041\nM30\n"), 0);
        assert_eq!(found("O2\nG0 X10.\n#100=#5041\nM99\n"), 0, "its caller may limit lookahead");
    }

    #[test]
    fn a_block_that_waits_ends_the_move() {
        for stop in ["M00", "G53", "#3006=1(LOOK)", "G31 Z-5. F50.", "M50"] {
            assert_eq!(lines(&RULE, &format!("O1\nG0 X10.\n{stop}\n#100=#5041\nM30\n")), NOWHERE, "{stop}");
        }
        assert_eq!(lines(&RULE, "O1\nG0 X10.\n#100=#5001\n#101=#5063\nM30\n"), NOWHERE);
        assert_eq!(lines(&RULE, "O1\n#100=#5041\nG0 X10.\nM30\n"), NOWHERE);
    }
}
