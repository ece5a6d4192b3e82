//! A move by the modal codes: the tool length that it takes in, a drilling cycle, or group 01.
use super::checked::{ExecResult, locate};
use super::notes::Note;
use super::plan::BlockPlan;
use super::planner::Planner;
use super::words::{BlockWords, letters};
use gcode_lang::alarm::Alarm;
use gcode_lang::motion::EventKind;
use gcode_lang::program::g_codes::{Effect, GCodeRow};
use gcode_lang::program::modes::{CutterSide, Length, Motion};
use gcode_lang::source::Span;

impl Planner<'_> {
    /// 3. G43, G44, G49 and a new H; whether the offset changed.
    #[inline]
    pub(super) fn plan_length(
        &self,
        block_words: &BlockWords,
        plan: &mut BlockPlan,
        span: Span,
    ) -> ExecResult<bool> {
        let commanded = block_words.has(b'H')
            || block_words.has_non_motion_code(|effect| matches!(effect, Effect::Length(_)));
        if !commanded
            || (plan.state.modal.length == Length::Off && self.registers.state.modal.length == Length::Off)
        {
            return Ok(false);
        }
        self.plan_length_offset(block_words, plan, span)
    }

    #[inline(never)]
    fn plan_length_offset(
        &self,
        block_words: &BlockWords,
        plan: &mut BlockPlan,
        span: Span,
    ) -> ExecResult<bool> {
        let is_compensation_on =
            |row: &&GCodeRow| matches!(row.effect, Effect::Length(Length::Plus | Length::Minus));
        if let Some(row) = block_words.g_codes().find(is_compensation_on)
            && plan.state.codes.h == 0
            && !block_words.has(b'H')
        {
            plan.notes.push(Note::LengthOffsetZero { code: row.code });
        }
        let offset = locate(self.data.length_offset(&plan.state), span)?;
        let (changed, by) = (offset != plan.state.length_offset, plan.state.length_compensation());
        if changed || by != self.registers.state.length_compensation() {
            plan.push_event(EventKind::ToolLength { offset, compensation: by });
        }
        plan.state.length_offset = offset;
        Ok(changed)
    }

    /// 4. A move by the modal codes: a drilling cycle, or group 01.
    pub(super) fn plan_motion(
        &self,
        block_words: &BlockWords,
        plan: &mut BlockPlan,
        has_new_length: bool,
        span: Span,
    ) -> ExecResult<()> {
        if let Some(cycle) = plan.state.modal.cycle {
            if self.is_drilling_block(block_words) {
                return self.plan_cycle(plan, block_words, cycle, None, span);
            }
            // P and Q are stored by blocks that drill only.
            if block_words.has_any(b"PQ") {
                block_words.mark_read(b"PQ");
                plan.notes.push(Note::CycleDataLost);
            }
            if has_new_length {
                self.data.recompute_position(&mut plan.state);
            }
            return Ok(());
        }
        let motion = plan.state.modal.motion;
        let is_arc = matches!(motion, Motion::Clockwise | Motion::Counterclockwise);
        let names_axis = self.data.names_axis(block_words);
        // A code of group 01 behind that of a cycle: a plain move, the cycle's own words are nothing.
        let overrules_cycle =
            block_words.has_non_motion_code(|effect| matches!(effect, Effect::Cycle(Some(_))));
        if overrules_cycle {
            block_words.mark_read(b"KPQR");
        }
        if !(names_axis || is_arc && block_words.has_any(b"IJKR")) {
            return self.move_by_length_change(block_words, plan, has_new_length, span);
        }
        // Some controls round corners by R or read I J K here; the end of cutter compensation takes a vector.
        let takes_vector =
            block_words.has_non_motion_code(|effect| effect == Effect::Cutter(CutterSide::Off));
        if !(is_arc || takes_vector || overrules_cycle)
            && let Some(letter) = block_words.first_letter_of(letters(b"IJKR"))
        {
            let what = format!("{} in a block with a straight move", char::from(letter));
            return Err(Alarm::NotSimulated { what }.located_at(block_words.span(letter)));
        }
        let endpoint = self.resolve_endpoint(block_words, &mut plan.state)?;
        if motion == Motion::Thread && block_words.has_corner() {
            return Err(Alarm::CornerInThread.located_at(span));
        }
        if motion != Motion::Rapid && block_words.has_corner() {
            plan.corner = self.data.corner_word(block_words, &plan.state)?;
        }
        match motion {
            Motion::Rapid => self.push_rapid(plan, &endpoint.machine),
            Motion::Thread => self.plan_thread(plan, endpoint.machine, block_words, span)?,
            Motion::Linear => locate(self.push_feed(plan, &endpoint.machine, block_words), span)?,
            Motion::Clockwise | Motion::Counterclockwise => {
                self.plan_arc(plan, block_words, &endpoint, span)?
            }
        }
        plan.state.programmed = endpoint.programmed;
        plan.commands_axes = true;
        Ok(())
    }

    /// The tool length changed in a block without an axis: the axis moves by the offset at once, or keeps still.
    fn move_by_length_change(
        &self,
        block_words: &BlockWords,
        plan: &mut BlockPlan,
        has_new_length: bool,
        span: Span,
    ) -> ExecResult<()> {
        if !has_new_length {
            return Ok(());
        }
        if !self.data.settings.undocumented.length_moves_at_once {
            self.data.recompute_position(&mut plan.state);
            return Ok(());
        }
        let to = self.data.to_machine(&plan.state, &plan.state.programmed);
        if plan.state.modal.motion == Motion::Rapid {
            self.push_rapid(plan, &to);
            return Ok(());
        }
        locate(self.push_feed(plan, &to, block_words), span)
    }
}
