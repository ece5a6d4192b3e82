//! Rule: a feed move that no F precedes on any path, PS0011.
use gcode_lang::program::code_facts::AxisWords;
use gcode_lang::program::{Op, WordOperand, Words};

use crate::prelude::*;

pub(super) static RULE: Rule = Rule::new("missing-feed", Severity::Error, "a feed move before any F", find);

/// G01, G02 and G03, × 10.
const FEED_MOVES: [u32; 3] = [10, 20, 30];

fn find(context: &CheckContext<'_>, unit: &ProgramUnit<'_>) -> Vec<Diagnostic> {
    // The caller of a program may have set the feed.
    if unit.role != Role::Main {
        return Vec::new();
    }
    let may_have_feed = feed_before(context, unit);
    let moves_without_feed = unit.reached_words().filter(|(block, words)| {
        may_have_feed[*block] == Some(false) && !has_feed_word(words) && is_feed_move(context, words)
    });
    let alarm = |block| Alarm::FeedZero.located_at(unit.op(block).span);
    moves_without_feed
        .map(|(block, _)| context.alarm_finding(unit, &RULE.kind, block, &alarm(block)))
        .collect()
}

/// Returns, for each block, whether some path to it may have an F; `None` for an unreachable block.
fn feed_before(context: &CheckContext<'_>, unit: &ProgramUnit<'_>) -> Vec<Option<bool>> {
    // Any block may precede the start of a call with Q.
    let starts = unit.entry_blocks.iter().enumerate().map(|(nth, start)| (*start, nth > 0));
    let next = |block: OpIndex, before: &bool| {
        let after = *before || block < unit.program.ops().len() && may_set_feed(context, unit, block);
        unit.flow.successors(block).map(|to| (to, after)).collect()
    };
    unit.flow.propagate(starts, |known, other| *known |= other, next)
}

/// Returns true if a block has an F or calls a program that may have one.
fn may_set_feed(context: &CheckContext<'_>, unit: &ProgramUnit<'_>, block: OpIndex) -> bool {
    let has_feed = |op: &Op| matches!(op.kind(), OpKind::Words(words) if has_feed_word(words));
    if has_feed(unit.op(block)) || matches!(unit.op(block).kind(), OpKind::If { .. }) {
        return true;
    }
    unit.call_in(block).is_some_and(|call| match context.called_unit(call) {
        None => true,
        Some(called) => {
            let called = &context.units[called];
            // Its own calls are not followed; they may have an F.
            !called.calls.is_empty() || called.program.ops().iter().any(has_feed)
        }
    })
}

fn has_feed_word(words: &Words) -> bool {
    words.list.iter().any(|word| word.letter == b'F')
}

/// Returns true for G01, G02 or G03 with an axis, without another code that uses the axis words.
fn is_feed_move(context: &CheckContext<'_>, words: &Words) -> bool {
    let has_axis = words.list.iter().any(|word| context.settings.axes.find(word.letter).is_some());
    let mut has_feed_code = false;
    for word in &words.list {
        let WordOperand::G(code, row) = word.value else { continue };
        has_feed_code |= FEED_MOVES.contains(&code);
        if row.row_for(context.settings.codes).is_none_or(|row| row.facts.axis_words != AxisWords::Move) {
            return false;
        }
    }
    has_feed_code && has_axis && words.call().is_none()
}

#[cfg(test)]
mod tests {
    use super::super::testing::{NOWHERE, lines};
    use super::RULE;

    #[test]
    fn a_feed_move_without_f_on_every_path_is_reported() {
        assert_eq!(lines(&RULE, "O1\nG0 X5.\nG1 X10.\nM30\n"), [3]);
        assert_eq!(
            lines(&RULE, "O1\nIF[#500 EQ 1]GOTO 5\nG2 X1. R5.\nN5 G1 X10.\nG1 Y5. F100.\nM30\n"),
            [3, 4]
        );
        assert_eq!(lines(&RULE, "O1\nM98 P2\nG1 X10.\nM30\nO2\nG0 X1.\nM99\n"), [3]);
    }

    #[test]
    fn an_f_on_one_path_suffices() {
        for text in [
            "O1\nF100.\nG1 X10.\nM30\n",
            "O1\nG1 X10. F#1\nG3 X5. R3.\nM30\n",
            "O1\nIF[#500 EQ 1]GOTO 5\nF50.\nN5 G1 X10.\nM30\n",
            "O1\nM98 P2\nG1 X10.\nM30\nO2\nF100.\nM99\n",
            "O1\nM98 P7\nG1 X10.\nM30\n",
            "O2\nG1 X10.\nM99\n",
            "O1\nG1 G4 X1.\nG1\nG0 X5.\nG91 G1 G28 Z0.\nM30\n",
        ] {
            assert_eq!(lines(&RULE, text), NOWHERE, "{text}");
        }
    }
}
