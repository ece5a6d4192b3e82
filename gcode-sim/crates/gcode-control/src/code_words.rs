//! Words with a code in a block: F S T D H, and the letters that have no use there.
use super::Executor;
use super::evaluation::ExecResult;
use super::patterns::takes_l;
use super::plan::BlockPlan;
use super::words::{BlockWords, letters};
use gcode_lang::alarm::Alarm;
use gcode_lang::program::g_codes::{Effect, OneShot};
use gcode_lang::program::modes::{CutterSide, Scaling, StrokeCheck};
use gcode_lang::source::Span;

impl Executor {
    /// 1. F S T D H, and the radius that D asks for.
    pub(super) fn plan_coded_words(
        &self,
        given: &BlockWords,
        plan: &mut BlockPlan,
        span: Span,
    ) -> ExecResult<()> {
        if let Some(f) = self.feed_word(given, &plan.state)? {
            plan.state.codes.f = f;
        }
        if let Some(s) = given.count(b'S')? {
            plan.state.codes.s = f64::from(s);
        }
        if let Some(t) = given.count(b'T')? {
            plan.state.codes.t = t;
        }
        if let Some(d) = given.count(b'D')? {
            if d as usize > self.settings.tool_offsets {
                return Err(Alarm::OffsetNumber { number: i64::from(d) }.located_at(given.span(b'D')));
            }
            plan.state.codes.d = d;
        }
        if let Some(h) = given.count(b'H')? {
            if h as usize > self.settings.tool_offsets {
                return Err(Alarm::OffsetNumber { number: i64::from(h) }.located_at(given.span(b'H')));
            }
            plan.state.codes.h = h;
        }
        self.check_misplaced_words(given, plan, span)?;
        let compensates = plan.state.modal.cutter != CutterSide::Off;
        let sides = || given.has_non_motion_code(|effect| matches!(effect, Effect::Cutter(_)));
        if given.has(b'D') || compensates && (self.settings.applies_radius_at_once || sides()) {
            plan.state.cutter_radius = self.offset_radius(plan.state.codes.d).unwrap_or(0.0);
        }
        Ok(())
    }

    /// Words that need a code which the block doesn't have, or must not stand beside one it has.
    fn check_misplaced_words(&self, given: &BlockWords, plan: &BlockPlan, span: Span) -> ExecResult<()> {
        let smooth = given.has_non_motion_code(|effect| effect == Effect::Smoothness);
        if let Some(letter) = given.first_letter_of(letters(if smooth { b"NO" } else { b"ENO" })) {
            return Err(Alarm::ImproperAddress { letter: char::from(letter) }.located_at(given.span(letter)));
        }
        if given.has_non_motion_code(|effect| effect == Effect::LookAhead)
            && given.count(b'P')?.is_none_or(|p| p > 1)
        {
            return Err(Alarm::LookAheadFormat.located_at(span));
        }
        // The axis words behind G22 are limits, no move.
        let limits = given.has_non_motion_code(|effect| effect == Effect::StrokeCheck(StrokeCheck::On));
        if limits && (self.names_axis(given) || given.has_any(b"IJK")) {
            return Err(Alarm::NotSimulated { what: "G22 with limits".into() }.located_at(span));
        }
        let keeps_tool = |effect| {
            use OneShot::{DataInput, Dwell};
            matches!(effect, Effect::OneShot(Dwell | DataInput) | Effect::Scaling(Scaling::Off))
        };
        if given.has(b'T') && given.has_non_motion_code(keeps_tool) {
            return Err(Alarm::TNotAllowed.located_at(given.span(b'T')));
        }
        let repeats = || {
            given.g_codes().any(takes_l)
                || self.settings.cycle_repeat_letter == b'L' && plan.state.modal.cycle.is_some()
        };
        if given.has(b'L') && !repeats() {
            return Err(Alarm::ImproperAddress { letter: 'L' }.located_at(given.span(b'L')));
        }
        let dwells = given.has_non_motion_code(|effect| effect == Effect::OneShot(OneShot::Dwell));
        let axes = letters(if dwells { b"ABCVWXYZ" } else { b"ABCUVWXYZ" });
        if let Some(letter) = given.first_letter_of(axes & !self.settings.axes.letter_bits()) {
            return Err(Alarm::ImproperAddress { letter: char::from(letter) }.located_at(given.span(letter)));
        }
        Ok(())
    }
}
