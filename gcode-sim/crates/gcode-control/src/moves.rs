//! A move by the modal codes: the tool length that it takes in, a drilling cycle, or group 01.
use super::Executor;
use super::eval::{Checked, at};
use super::notes::Note;
use super::plan::BlockPlan;
use super::words::{BlockWords, letters};
use gcode_lang::alarm::Alarm;
use gcode_lang::motion::EventKind;
use gcode_lang::program::codes::{Effect, GCodeRow};
use gcode_lang::program::modes::{CutterSide, Length, Motion};
use gcode_lang::source::Span;

impl Executor {
    /// 3. G43, G44, G49 and a new H; whether the offset changed.
    #[inline]
    pub(super) fn length(&self, given: &BlockWords, plan: &mut BlockPlan, span: Span) -> Checked<bool> {
        let commanded =
            given.has(b'H') || given.has_code_beyond_moves(|effect| matches!(effect, Effect::Length(_)));
        if !commanded || (plan.state.modal.length == Length::Off && self.state.modal.length == Length::Off) {
            return Ok(false);
        }
        self.lengthen(given, plan, span)
    }

    #[inline(never)]
    fn lengthen(&self, given: &BlockWords, plan: &mut BlockPlan, span: Span) -> Checked<bool> {
        let on = |row: &&GCodeRow| matches!(row.effect, Effect::Length(Length::Plus | Length::Minus));
        if let Some(row) = given.g_codes().find(on)
            && plan.state.codes.h == 0
            && !given.has(b'H')
        {
            plan.notes.push(Note::LengthOffsetZero { code: row.code });
        }
        let offset = at(self.length_offset(&plan.state), span)?;
        let (changed, by) = (offset != plan.state.length, plan.state.lengthening());
        if changed || by != self.state.lengthening() {
            plan.push_event(EventKind::ToolLength { offset, by });
        }
        plan.state.length = offset;
        Ok(changed)
    }

    /// 4. A move by the modal codes: a drilling cycle, or group 01.
    pub(super) fn motion(
        &self,
        given: &BlockWords,
        plan: &mut BlockPlan,
        lengthened: bool,
        span: Span,
    ) -> Checked<()> {
        if let Some(cycle) = plan.state.modal.cycle {
            if self.drills(given) {
                return self.prepare_drill(plan, given, cycle, None, span);
            }
            // P and Q are stored by blocks that drill only.
            if given.has_any(b"PQ") {
                given.accept(b"PQ");
                plan.notes.push(Note::CycleDataLost);
            }
            if lengthened {
                self.recompute(&mut plan.state);
            }
            return Ok(());
        }
        let motion = plan.state.modal.motion;
        let arcs = matches!(motion, Motion::Clockwise | Motion::Counterclockwise);
        let named = self.names_axis(given);
        // A code of group 01 behind that of a cycle: a plain move, the cycle's own words are nothing.
        let overruled = given.has_code_beyond_moves(|effect| matches!(effect, Effect::Cycle(Some(_))));
        if overruled {
            given.accept(b"KPQR");
        }
        if !(named || arcs && given.has_any(b"IJKR")) {
            return self.settle(given, plan, lengthened, span);
        }
        // Some controls round corners by R or read I J K here; the end of cutter compensation takes a vector.
        let vector = given.has_code_beyond_moves(|effect| effect == Effect::Cutter(CutterSide::Off));
        if !(arcs || vector || overruled)
            && let Some(letter) = given.first_of(letters(b"IJKR"))
        {
            let what = format!("{} in a block with a straight move", char::from(letter));
            return Err(Alarm::NotSimulated { what }.at(given.span(letter)));
        }
        let goal = self.goal(given, &mut plan.state)?;
        if motion == Motion::Thread && given.has_corner() {
            return Err(Alarm::CornerInThread.at(span));
        }
        if motion != Motion::Rapid && given.has_corner() {
            plan.corner = self.corner_word(given, &plan.state)?;
        }
        match motion {
            Motion::Rapid => self.rapid(plan, &goal.machine),
            Motion::Thread => self.thread(plan, goal.machine, given, span)?,
            Motion::Linear => at(self.feed(plan, &goal.machine, given), span)?,
            Motion::Clockwise | Motion::Counterclockwise => self.arc(plan, given, &goal, span)?,
        }
        plan.state.programmed = goal.programmed;
        plan.commands_axes = true;
        Ok(())
    }

    /// The tool length changed in a block without an axis: the axis moves by the offset at once, or keeps still.
    fn settle(&self, given: &BlockWords, plan: &mut BlockPlan, lengthened: bool, span: Span) -> Checked<()> {
        if !lengthened {
            return Ok(());
        }
        if !self.settings.unsure.length_moves_at_once {
            self.recompute(&mut plan.state);
            return Ok(());
        }
        let to = self.to_machine(&plan.state, &plan.state.programmed);
        if plan.state.modal.motion == Motion::Rapid {
            self.rapid(plan, &to);
            return Ok(());
        }
        at(self.feed(plan, &to, given), span)
    }
}
