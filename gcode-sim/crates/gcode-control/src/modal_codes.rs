//! The G codes of a block put in force, and what else than a move uses its axis words.
use super::checked::{ExecResult, locate};
use super::plan::BlockPlan;
use super::planner::Planner;
use super::state::{CycleState, PolarPoint};
use super::transform_order;
use super::words::BlockWords;
use gcode_lang::alarm::Alarm;
use gcode_lang::program::code_facts::{CoordinateUse, LookaheadUse};
use gcode_lang::program::g_codes::{Effect, GCodeRow, OneShot, spelled};
use gcode_lang::program::modes::{CutterSide, Mirror, Polar, Rotation, Scaling};
use gcode_lang::source::Span;

/// What uses the axis words of a block that doesn't simply move.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum AxisWordUse {
    OneShot(OneShot),
    AdditionalWork,
    Scale,
    MirrorOn,
    MirrorOff,
    Rotate,
    Tilt,
}

impl Planner<'_> {
    /// 1. Modal G codes in the order they stand in; the answer is what uses the axis words instead of a move.
    #[inline]
    pub(super) fn apply_modal_codes(
        &self,
        block_words: &BlockWords,
        plan: &mut BlockPlan,
        span: Span,
    ) -> ExecResult<Option<AxisWordUse>> {
        if block_words.has_non_motion_words() {
            return self.apply_all_codes(block_words, plan, span);
        }
        if let Some(motion) = block_words.motion {
            plan.state.set_motion_mode(motion);
        }
        Ok(None)
    }

    /// As [`Planner::apply_modal_codes`], of a block with other codes than those of group 01.
    #[inline(never)]
    fn apply_all_codes(
        &self,
        block_words: &BlockWords,
        plan: &mut BlockPlan,
        span: Span,
    ) -> ExecResult<Option<AxisWordUse>> {
        let state = &mut plan.state;
        let before = state.modal;
        let mut axis_use = None;
        let mut is_cycle_active = before.cycle.is_some();
        for row in block_words.g_codes() {
            if let Effect::Motion(motion) = row.effect {
                state.set_motion_mode(motion);
                is_cycle_active = false;
                continue;
            }
            let new = locate(axis_use_of(row, block_words, state.modal.cutter), span)?;
            if new.is_some() && axis_use.is_some() && new != axis_use {
                let what = "several one-shot G codes in one block".into();
                return Err(Alarm::NotSimulated { what }.located_at(span));
            }
            axis_use = new.or(axis_use);
            state.modal.apply(row);
            if row.effect == Effect::Cycle(None) {
                state.cycle = CycleState::default();
                is_cycle_active = false;
            }
        }
        let modal = state.modal;
        if modal.plane != before.plane && self.registers.lookahead.is_offset() {
            return Err(Alarm::PlaneInCompensation.located_at(span));
        }
        if modal.plane != before.plane && state.transform.rotation.is_some() {
            return Err(Alarm::PlaneInRotation.located_at(span));
        }
        if before.scaling == Scaling::On
            && modal.scaling == Scaling::On
            && let Some(row) = block_words.g_codes().find(|row| row.facts.coordinates != CoordinateUse::Free)
        {
            return Err(Alarm::CodeInScaling { code: spelled(row.code) }.located_at(span));
        }
        locate(transform_order::check(block_words, &before, state, self.data.names_axis(block_words)), span)?;
        if modal.scaling == Scaling::Off {
            state.transform.scaling = None;
        }
        if modal.rotation == Rotation::Off {
            state.transform.rotation = None;
            state.transform.tilt = None;
        }
        if modal.polar == Polar::On && before.polar == Polar::Off {
            state.polar = PolarPoint::default();
        }
        if modal.work != before.work {
            state.last_end_point = None;
            self.data.recompute_position(state);
        } else if state.transform != self.registers.state.transform {
            self.data.apply_transform_change(state);
        }
        if modal.cycle.is_some() && !is_cycle_active {
            let axis = locate(self.drilling_axis(block_words, state), span)?;
            state.cycle.axis = Some(axis);
            state.cycle.initial = state.programmed[axis];
            state.cycle.is_initial_unknown = state.work_zero_unknown >> axis & 1 == 1;
        }
        // G54 P is G54.1 P.
        let selects_additional_work = block_words.has(b'P')
            && axis_use.is_none()
            && modal.cycle.is_none()
            && block_words.has_non_motion_code(|effect| effect == Effect::Work(1));
        Ok(if selects_additional_work { Some(AxisWordUse::AdditionalWork) } else { axis_use })
    }
}

/// What uses the axis words because of a code, if anything.
fn axis_use_of(
    row: &GCodeRow,
    block_words: &BlockWords,
    cutter: CutterSide,
) -> Result<Option<AxisWordUse>, Alarm> {
    if row.facts.lookahead == LookaheadUse::Alarms && cutter != CutterSide::Off {
        return Err(Alarm::ToolOffsetInCompensation);
    }
    block_words.mark_letters_read(row.facts.words.without_effect);
    Ok(match row.effect {
        Effect::NotSimulated | Effect::Call => return Err(not_simulated(row.code, row.help)),
        Effect::OneShot(one) => Some(AxisWordUse::OneShot(one)),
        Effect::AdditionalWork => Some(AxisWordUse::AdditionalWork),
        Effect::Scaling(Scaling::On) => Some(AxisWordUse::Scale),
        Effect::Mirror(Mirror::On) => Some(AxisWordUse::MirrorOn),
        Effect::Mirror(Mirror::Off) => Some(AxisWordUse::MirrorOff),
        Effect::Rotation(Rotation::On) => Some(AxisWordUse::Rotate),
        Effect::Rotation(Rotation::Tilted) => Some(AxisWordUse::Tilt),
        Effect::Scaling(Scaling::Off)
        | Effect::Rotation(Rotation::Off)
        | Effect::Motion(_)
        | Effect::Plane(_)
        | Effect::Distance(_)
        | Effect::StrokeCheck(_)
        | Effect::FeedMode(_)
        | Effect::Unit(_)
        | Effect::Cutter(_)
        | Effect::Length(_)
        | Effect::Cycle(_)
        | Effect::ReturnTo(_)
        | Effect::SpindleMode(_)
        | Effect::Work(_)
        | Effect::NumberedWork(_)
        | Effect::Cutting(_)
        | Effect::Polar(_)
        | Effect::LookAhead
        | Effect::NoEffect
        | Effect::Smoothness => None,
    })
}

/// The alarm of a G code that isn't executed.
pub(super) fn not_simulated(code: u32, help: &str) -> Alarm {
    Alarm::NotSimulated { what: format!("G{} ({help})", spelled(code)) }
}
