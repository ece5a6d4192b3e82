//! Rule: a word that no block of this control accepts: `X10., Y5.` (PS0053), `X1E3` and missing axes
//! (PS0009). A block that a jump or an end can leave out may be for another machine that has the axis.
use std::cell::LazyCell;

use gcode_lang::control::Dialect;
use gcode_lang::program::g_codes::Effect;
use gcode_lang::program::modes::Motion;
use gcode_lang::program::{LoweredWord, Words};

use crate::control_flow::Successors;
use crate::piece::Piece;
use crate::prelude::*;

pub(super) static RULE: Rule =
    Rule::new("stray-word", Severity::Error, "a word that no block of this control accepts", find);

fn find(context: &CheckContext<'_>, unit: &ProgramUnit<'_>) -> Vec<Diagnostic> {
    let mut found = Vec::new();
    let can_be_left_out = LazyCell::new(|| blocks_that_can_be_left_out(unit));
    for (block, words) in unit.reached_words() {
        if unit.call_in(block).is_some() {
            continue;
        }
        let stray = words.list.iter().filter_map(|word| Some((word, alarm(context, words, word)?)));
        let is_known =
            |(word, _): &(&LoweredWord, Alarm)| word.comma || word.letter == b'E' || !can_be_left_out[block];
        found.extend(stray.filter(is_known).map(|(word, alarm)| {
            let finding = context.alarm_finding(unit, &RULE.kind, block, &alarm.located_at(word.span));
            match (word.comma, word.letter) {
                (true, _) => finding.help("remove the comma: words are not separated by commas"),
                (_, b'E') => {
                    finding.help("write the number in full, 1000. for 1E3: numbers have no exponent")
                }
                // Another machine has the axis.
                _ => context.unless_optional(finding),
            }
        }));
    }
    found
}

/// Returns for each block whether a block before it can jump over it, or end the program.
fn blocks_that_can_be_left_out(unit: &ProgramUnit<'_>) -> Vec<bool> {
    let of_piece = |piece: &Piece| (piece.left_out_until, piece.start.may_be_left_out);
    let (mut farthest, mut may_be_left) = unit.piece.as_ref().map(of_piece).unwrap_or_default();
    let after = |(block, successors): (usize, &Successors)| {
        let can_be_left_out = may_be_left || block < farthest;
        farthest = successors.jumps.iter().copied().fold(farthest, usize::max);
        may_be_left |= successors.may_leave();
        can_be_left_out
    };
    unit.flow.block_successors.iter().enumerate().map(after).collect()
}

fn alarm(context: &CheckContext<'_>, words: &Words, word: &LoweredWord) -> Option<Alarm> {
    let axes = &context.settings.axes;
    if word.comma {
        // `,A` is an angle of direct drawing dimension programming, which the simulator does not execute.
        return (!matches!(word.letter, b'R' | b'C' | b'A')).then_some(Alarm::CornerWords);
    }
    let is_refused = match word.letter {
        b'E' if axes.find(b'E').is_some() => false,
        // A Haas takes E in rapids and cycles, whose mode another block may set.
        b'E' if context.settings.codes == Dialect::HaasNgc => context
            .has_effect(words, |effect| matches!(effect, Effect::Motion(motion) if motion != Motion::Rapid)),
        b'E' => true,
        b'A'..=b'C' | b'U'..=b'Z' => axes.find(word.letter).is_none(),
        _ => false,
    };
    (is_refused && !context.g_code_rows(words).any(|row| row.facts.words.own.has(word.letter)))
        .then_some(Alarm::ImproperAddress { letter: char::from(word.letter) })
}

#[cfg(test)]
mod tests {
    use super::super::testing::{NOWHERE, lines, messages};
    use super::RULE;

    #[test]
    fn commas_exponents_and_missing_axes_are_reported() {
        let text = "O1\nG0 X10., Y5.\nG1 X1.E3 F100.\nG0 U5.\nM30\n";
        assert_eq!(lines(&RULE, text), [2, 3, 4]);
        let found = messages(&RULE, text);
        assert!(found[0].starts_with("PS0053: ") && found[1].starts_with("PS0009: "), "{found:?}");
    }

    #[test]
    fn a_missing_axis_in_a_block_that_can_be_left_out_is_accepted() {
        let text = "O1\nIF[#1 NE 0]GOTO 20\nG0 X1.\nGOTO 30\nN20 G0 U5.\nN30 M30\n";
        assert_eq!(lines(&RULE, text), NOWHERE);
        let both = "O1\nIF[#1 NE 0]GOTO 20\nG0 X1.\nN20 G0 U5.\nM30\n";
        assert_eq!(lines(&RULE, both), [4], "both ways lead through it");
        let guarded = "O1\nIF[#1 EQ 0]THEN #3000=1(NO A)\nG0 U5.\nM30\n";
        assert_eq!(lines(&RULE, guarded), NOWHERE);
    }

    #[test]
    fn corners_dwells_and_arguments_are_accepted() {
        assert_eq!(
            lines(&RULE, "O1\nG1 X10.,R2. F100.\nX20.,C1.\nG4 U1.\nG65 P2 E3. U1.\nM30\nO2\nM99\n"),
            NOWHERE
        );
    }
}
