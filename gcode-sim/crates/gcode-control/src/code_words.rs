//! Words with a code in a block: F S T D H, and the letters that have no use there.
use super::checked::ExecResult;
use super::plan::BlockPlan;
use super::planner::Planner;
use super::words::{BlockWords, letters};
use gcode_lang::alarm::Alarm;
use gcode_lang::program::g_codes::Effect;
use gcode_lang::program::modes::{CutterSide, StrokeCheck};
use gcode_lang::source::Span;

impl Planner<'_> {
    /// 1. F S T D H, and the radius that D asks for.
    pub(super) fn plan_coded_words(
        &self,
        block_words: &BlockWords,
        plan: &mut BlockPlan,
        span: Span,
    ) -> ExecResult<()> {
        if let Some(f) = self.data.feed_word(block_words, &plan.state)? {
            plan.state.codes.f = f;
        }
        if let Some(s) = block_words.count(b'S')? {
            plan.state.codes.s = f64::from(s);
        }
        if let Some(t) = block_words.count(b'T')? {
            plan.state.codes.t = t;
        }
        if let Some(d) = block_words.count(b'D')? {
            if d as usize > self.data.settings.tool_offsets {
                return Err(Alarm::OffsetNumber { number: i64::from(d) }.located_at(block_words.span(b'D')));
            }
            plan.state.codes.d = d;
        }
        if let Some(h) = block_words.count(b'H')? {
            if h as usize > self.data.settings.tool_offsets {
                return Err(Alarm::OffsetNumber { number: i64::from(h) }.located_at(block_words.span(b'H')));
            }
            plan.state.codes.h = h;
        }
        self.check_misplaced_words(block_words, plan, span)?;
        let is_compensating = plan.state.modal.cutter != CutterSide::Off;
        let selects_side = || block_words.has_non_motion_code(|effect| matches!(effect, Effect::Cutter(_)));
        if block_words.has(b'D')
            || is_compensating && (self.data.settings.applies_radius_at_once || selects_side())
        {
            plan.state.cutter_radius = self.data.offset_radius(plan.state.codes.d).unwrap_or(0.0);
        }
        Ok(())
    }

    /// Words that need a code which the block doesn't have, or must not stand beside one it has.
    fn check_misplaced_words(
        &self,
        block_words: &BlockWords,
        plan: &BlockPlan,
        span: Span,
    ) -> ExecResult<()> {
        let owned = block_words.letters_of_codes();
        if let Some(letter) = block_words.first_letter_of(letters(b"ENO") & !owned) {
            return Err(
                Alarm::ImproperAddress { letter: char::from(letter) }.located_at(block_words.span(letter))
            );
        }
        if block_words.has_non_motion_code(|effect| effect == Effect::LookAhead)
            && block_words.count(b'P')?.is_none_or(|p| p > 1)
        {
            return Err(Alarm::LookAheadFormat.located_at(span));
        }
        // The axis words behind G22 are limits, no move.
        let has_limits =
            block_words.has_non_motion_code(|effect| effect == Effect::StrokeCheck(StrokeCheck::On));
        if has_limits && (self.data.names_axis(block_words) || block_words.has_any(b"IJK")) {
            return Err(Alarm::NotSimulated { what: "G22 with limits".into() }.located_at(span));
        }
        if block_words.has(b'T') && block_words.g_codes().any(|row| row.facts.words.refuses_tool) {
            return Err(Alarm::TNotAllowed.located_at(block_words.span(b'T')));
        }
        let repeats_cycle =
            self.data.settings.cycle_repeat_letter == b'L' && plan.state.modal.cycle.is_some();
        if block_words.has_letters(letters(b"L") & !owned) && !repeats_cycle {
            return Err(Alarm::ImproperAddress { letter: 'L' }.located_at(block_words.span(b'L')));
        }
        let axes = letters(b"ABCUVWXYZ") & !owned;
        if let Some(letter) = block_words.first_letter_of(axes & !self.data.settings.axes.letter_bits()) {
            return Err(
                Alarm::ImproperAddress { letter: char::from(letter) }.located_at(block_words.span(letter))
            );
        }
        Ok(())
    }
}
