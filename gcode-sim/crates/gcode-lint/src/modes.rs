//! Possible modes before each block, carried along all paths.
//!
//! A mode is unknown where a setting of the control decides it (at power-on), a caller or a called program.
use gcode_control::static_plan::CertainModes;
use gcode_lang::program::code_facts::AxisWords;
use gcode_lang::program::g_codes::{Effect, GCodeRow};
use gcode_lang::program::modes::{FeedMode, Mirror, Rotation, Scaling, StrokeCheck};
use gcode_lang::program::{LoweredWord, WordOperand, Words};

use crate::context::has_feed_word;
use crate::possible_modes::PossibleModes;
use crate::prelude::*;

/// Returns the possible modes before each block; `None` for an unreachable block.
pub(crate) fn modes_before<'u>(
    context: &CheckContext<'_>,
    unit: &'u ProgramUnit<'_>,
) -> &'u [Option<PossibleModes>] {
    unit.modes.get_or_init(|| propagated_modes(context, unit))
}

fn propagated_modes(context: &CheckContext<'_>, unit: &ProgramUnit<'_>) -> Vec<Option<PossibleModes>> {
    // Any block may precede the start of a call, also of one with Q.
    let first = match (&unit.piece, unit.role) {
        (Some(piece), _) => piece.start.modes,
        (None, Role::Main) => PossibleModes::POWER_ON,
        (None, Role::Called | Role::Resident) => PossibleModes::ANYTHING,
    };
    let far = unit.piece.iter().flat_map(|piece| &piece.entries).map(|entry| entry.modes);
    let entries = std::iter::once(first).chain(far).chain(std::iter::repeat(PossibleModes::ANYTHING));
    let starts = unit.entry_blocks.iter().copied().zip(entries);
    let next = |block: OpIndex, before: &PossibleModes, open: &mut Vec<_>| {
        let is_block = block < unit.program.ops().len();
        let after = if is_block { modes_after(context, unit, block, before) } else { *before };
        open.extend(unit.flow.successors(block).map(|to| (to, after)));
    };
    unit.flow.propagate(starts, |known, other| *known = known.join(other), next)
}

fn modes_after(
    context: &CheckContext<'_>,
    unit: &ProgramUnit<'_>,
    block: OpIndex,
    before: &PossibleModes,
) -> PossibleModes {
    let op = unit.op(block);
    let after = match op.kind() {
        OpKind::Words(words) => {
            let mut after = after_words(context, words, before);
            if let Some((_, short)) = words.form_if_skipped() {
                after = after.join(after_words(context, short, before));
            }
            after.is_unreported &= missing_feed_alarm(context, unit, block, words, before).is_none();
            after_call(context, unit, block, before, after)
        }
        // The conditional part may have F.
        OpKind::If { .. } => PossibleModes::ANYTHING,
        OpKind::Empty | OpKind::Statement(_) | OpKind::AssignDirect(_) | OpKind::Alarm(_) => *before,
    };
    if op.skip().is_some() { after.join(*before) } else { after }
}

fn after_words(context: &CheckContext<'_>, words: &Words, before: &PossibleModes) -> PossibleModes {
    let mut after = *before;
    for word in &words.list {
        if is_computed_g_code(word) {
            after = after.with_unknown_motion();
        } else if let Some(row) = context.g_code_row(word) {
            after = after.after_effect(row.effect);
        }
    }
    if context.has_effect(words, |effect| effect == Effect::Mirror(Mirror::On)) && !context.names_axis(words)
    {
        after.certain.mirror = before.certain.mirror;
    }
    let has_pecks = after.is_in_cycle && words.list.iter().any(|word| b"QIJK".contains(&word.letter));
    PossibleModes {
        has_feed: after.has_feed || has_feed_word(words),
        has_pecks: after.has_pecks || has_pecks,
        ..after
    }
}

/// Returns the modes after the call of a block, if it has one; `after` are the modes after its words.
fn after_call(
    context: &CheckContext<'_>,
    unit: &ProgramUnit<'_>,
    block: OpIndex,
    before: &PossibleModes,
    after: PossibleModes,
) -> PossibleModes {
    let Some(call) = unit.call_in(block) else { return after };
    let called = context.called_unit(call).map(|called| &context.units[called]);
    // A modal call is repeated after later blocks, or takes their words as arguments. The calls of a called
    // program are not followed.
    let Some(called) = called.filter(|called| !call.is_modal && called.calls.is_empty()) else {
        return PossibleModes::ANYTHING;
    };
    // The words may be arguments of a code that calls a program.
    // It may end a mode.
    let mut after = after.join(*before).with_certain(|modes| *modes = CertainModes::NONE);
    for op in called.program.ops() {
        match op.kind() {
            OpKind::Words(words) => {
                let sets_mode = |effect| {
                    matches!(
                        effect,
                        Effect::Motion(_) | Effect::Cycle(_) | Effect::FeedMode(_) | Effect::Distance(_)
                    )
                };
                let sets_motion =
                    words.list.iter().any(is_computed_g_code) || context.has_effect(words, sets_mode);
                after = if sets_motion { after.with_unknown_motion() } else { after };
                after.has_feed |= has_feed_word(words);
            }
            OpKind::If { .. } => return PossibleModes::ANYTHING,
            OpKind::Empty | OpKind::Statement(_) | OpKind::AssignDirect(_) | OpKind::Alarm(_) => {}
        }
    }
    after
}

fn is_computed_g_code(word: &LoweredWord) -> bool {
    word.letter == b'G' && !matches!(word.value, WordOperand::G(..))
}

/// Returns the alarm of a block that is a feed move or a canned cycle without a preceding F, if no block before it has raised it.
pub(crate) fn missing_feed_alarm(
    context: &CheckContext<'_>,
    unit: &ProgramUnit<'_>,
    block: OpIndex,
    words: &Words,
    before: &PossibleModes,
) -> Option<Alarm> {
    let modes = (before.is_unreported && !before.has_feed)
        .then(|| modes_without_feed_word(context, unit, block, words, before))
        .flatten()?;
    let is_feed = !(modes.is_rapid && modes.is_outside_cycle);
    let is_arc = !modes.is_straight && !modes.is_in_cycle;
    is_feed.then_some(if is_arc { Alarm::ArcFeedZero } else { Alarm::FeedZero })
}

/// Returns true for a feed move without F in G93, in which each needs its own; a canned cycle is none.
pub(crate) fn lacks_inverse_time(
    context: &CheckContext<'_>,
    unit: &ProgramUnit<'_>,
    block: OpIndex,
    words: &Words,
    before: &PossibleModes,
) -> bool {
    let may_be_inverse = before.is_inverse_time
        || context.has_effect(words, |effect| effect == Effect::FeedMode(FeedMode::InverseTime));
    let modes =
        may_be_inverse.then(|| modes_without_feed_word(context, unit, block, words, before)).flatten();
    modes.is_some_and(|modes| !modes.is_other_feed_mode && !modes.is_rapid && !modes.is_in_cycle)
}

/// Returns the modes in which a block without F moves its axes; `None` for any other block.
fn modes_without_feed_word(
    context: &CheckContext<'_>,
    unit: &ProgramUnit<'_>,
    block: OpIndex,
    words: &Words,
    before: &PossibleModes,
) -> Option<PossibleModes> {
    let lacks_feed = !has_feed_word(words)
        && context.names_axis(words)
        // The words may be arguments of a code that calls a program.
        && words.call().is_none()
        && unit.call_in(block).is_none();
    lacks_feed.then(|| modes_of_move(context, words, before)).flatten()
}

/// Returns the modes in which a block moves its axes; `None` if its axis words may be no move.
fn modes_of_move(context: &CheckContext<'_>, words: &Words, before: &PossibleModes) -> Option<PossibleModes> {
    let mut modes = *before;
    for word in words.list.iter().filter(|word| word.letter == b'G') {
        // A computed code and one that the control lacks have no row.
        let row = context.g_code_row(word).filter(|row| !uses_axis_words(row))?;
        modes = modes.after_effect(row.effect);
    }
    Some(modes)
}

/// Returns true for a code for which the axis words of its block are neither a move nor a hole, and for one that
/// raises another alarm.
fn uses_axis_words(row: &GCodeRow) -> bool {
    let is_move = matches!(row.facts.axis_words, AxisWords::Move | AxisWords::Hole);
    // The axis words of these modes are a centre, an axis of reflection or limits.
    let is_transform = matches!(
        row.effect,
        Effect::Scaling(Scaling::On)
            | Effect::Rotation(
                Rotation::On
                    | Rotation::Tilted
                    | Rotation::TiltedFurther
                    | Rotation::AlongTool
                    | Rotation::Feature
            )
            | Effect::Mirror(_)
            | Effect::StrokeCheck(StrokeCheck::On)
    );
    !is_move || is_transform || matches!(row.effect, Effect::NotSimulated | Effect::Call)
}
