//! Possible modes before each block: the feed, the motion mode and the canned cycle, carried along all paths.
//!
//! A mode is unknown where a setting of the control decides it (at power-on), a caller or a called program.
use gcode_control::static_plan::ModesInForce;
use gcode_lang::program::code_facts::AxisWords;
use gcode_lang::program::cycles::{Cycle, DRILLING as DRILLING_CYCLE};
use gcode_lang::program::g_codes::{Effect, GCodeRow};
use gcode_lang::program::modes::{Motion, Rotation, Scaling, StrokeCheck};
use gcode_lang::program::{LoweredWord, WordOperand, Words};

use crate::context::has_feed_word;
use crate::prelude::*;

/// A cycle that needs no word of its own.
static DRILLING: Cycle = DRILLING_CYCLE;

/// Possible modes before a block: each is true if it holds on some path to the block.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct PossibleModes {
    /// F is commanded.
    has_feed: bool,
    /// The motion mode is G00.
    is_rapid: bool,
    /// The motion mode is not an arc.
    is_straight: bool,
    /// No canned cycle is in force.
    is_outside_cycle: bool,
    /// A canned cycle is in force.
    is_in_cycle: bool,
    /// The cycle in force, if it is the same on all paths.
    cycle: Option<&'static Cycle>,
    /// The depth of a peck is commanded.
    has_pecks: bool,
    /// No earlier block lacks F. The first that does stops the control, and its F serves the blocks after it.
    is_unreported: bool,
}

impl PossibleModes {
    /// Modes at power-on; a setting of the control decides between G00 and G01.
    const POWER_ON: Self = Self {
        has_feed: false,
        is_rapid: true,
        is_straight: true,
        is_outside_cycle: true,
        is_in_cycle: false,
        cycle: None,
        has_pecks: false,
        is_unreported: true,
    };
    const ANYTHING: Self = Self { has_feed: true, is_in_cycle: true, has_pecks: true, ..Self::POWER_ON };

    fn join(self, other: Self) -> Self {
        Self {
            has_feed: self.has_feed | other.has_feed,
            is_rapid: self.is_rapid | other.is_rapid,
            is_straight: self.is_straight | other.is_straight,
            is_outside_cycle: self.is_outside_cycle | other.is_outside_cycle,
            is_in_cycle: self.is_in_cycle | other.is_in_cycle,
            cycle: match (self.is_in_cycle, other.is_in_cycle) {
                (true, true) => self.cycle.filter(|_| self.cycle == other.cycle),
                (true, false) => self.cycle,
                (false, _) => other.cycle,
            },
            has_pecks: self.has_pecks | other.has_pecks,
            is_unreported: self.is_unreported | other.is_unreported,
        }
    }

    fn with_unknown_motion(self) -> Self {
        Self {
            is_rapid: true,
            is_straight: true,
            is_outside_cycle: true,
            is_in_cycle: true,
            cycle: None,
            has_pecks: true,
            ..self
        }
    }

    /// Returns the modes after a G code; a code of group 01 ends a cycle.
    fn after_effect(self, effect: Effect) -> Self {
        match effect {
            Effect::Motion(motion) => Self {
                is_rapid: motion == Motion::Rapid,
                is_straight: !matches!(motion, Motion::Clockwise | Motion::Counterclockwise),
                is_outside_cycle: true,
                is_in_cycle: false,
                cycle: None,
                has_pecks: false,
                ..self
            },
            Effect::Cycle(cycle) => Self {
                is_outside_cycle: cycle.is_none(),
                is_in_cycle: cycle.is_some(),
                cycle,
                has_pecks: cycle.is_some() && self.has_pecks,
                ..self
            },
            _ => self,
        }
    }

    /// Returns the modes in which a block can be read, the one that accepts most first.
    pub(crate) fn in_force(self) -> impl Iterator<Item = ModesInForce> {
        let motion = match (self.is_rapid, self.is_straight) {
            (true, _) => Motion::Rapid,
            (false, true) => Motion::Linear,
            (false, false) => Motion::Clockwise,
        };
        let modes = ModesInForce { motion, cycle: None, has_pecks: self.has_pecks };
        let in_cycle = ModesInForce { cycle: Some(self.cycle.unwrap_or(&DRILLING)), ..modes };
        let cycle = self.is_in_cycle.then_some(in_cycle);
        cycle.into_iter().chain(self.is_outside_cycle.then_some(modes))
    }
}

/// Returns the possible modes before each block; `None` for an unreachable block.
pub(super) fn modes_before(context: &CheckContext<'_>, unit: &ProgramUnit<'_>) -> Vec<Option<PossibleModes>> {
    // Any block may precede the start of a call, also of one with Q.
    let first = if unit.role == Role::Main { PossibleModes::POWER_ON } else { PossibleModes::ANYTHING };
    let entries = std::iter::once(first).chain(std::iter::repeat(PossibleModes::ANYTHING));
    let starts = unit.entry_blocks.iter().copied().zip(entries);
    let next = |block: OpIndex, before: &PossibleModes| {
        let is_block = block < unit.program.ops().len();
        let after = if is_block { modes_after(context, unit, block, before) } else { *before };
        unit.flow.successors(block).map(|to| (to, after)).collect()
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
    let mut after = after.join(*before);
    for op in called.program.ops() {
        match op.kind() {
            OpKind::Words(words) => {
                let sets_motion = words.list.iter().any(is_computed_g_code)
                    || context.has_effect(words, |e| matches!(e, Effect::Motion(_) | Effect::Cycle(_)));
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
    let names_axis = || words.list.iter().any(|word| context.settings.axes.find(word.letter).is_some());
    let lacks_feed = before.is_unreported
        && !before.has_feed
        && !has_feed_word(words)
        && names_axis()
        // The words may be arguments of a code that calls a program.
        && words.call().is_none()
        && unit.call_in(block).is_none();
    let modes = lacks_feed.then(|| modes_of_move(context, words, before)).flatten()?;
    let is_feed = !(modes.is_rapid && modes.is_outside_cycle);
    let is_arc = !modes.is_straight && !modes.is_in_cycle;
    is_feed.then_some(if is_arc { Alarm::ArcFeedZero } else { Alarm::FeedZero })
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
            | Effect::Rotation(Rotation::On | Rotation::Tilted | Rotation::TiltedFurther)
            | Effect::Mirror(_)
            | Effect::StrokeCheck(StrokeCheck::On)
    );
    !is_move || is_transform || matches!(row.effect, Effect::NotSimulated | Effect::Call)
}
