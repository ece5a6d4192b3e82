//! Moves by the modal codes: where axis words lead, the tool length, a drilling cycle or group 01.
use super::checked::ExecResult;
use super::linear_motion::Endpoint;
use super::notes::Note;
use super::plan::BlockPlan;
use super::planner::Planner;
use super::state::State;
use super::words::{WordNumber, letters};
use gcode_lang::alarm::Alarm;
use gcode_lang::motion::{EventKind, MAX_AXES, Position, SpindleDirection};
use gcode_lang::program::g_codes::{Effect, GCodeRow};
use gcode_lang::program::modes::{CutterSide, Distance, Length, Motion, Polar, Unit};
use gcode_lang::units::MmPerMin;

impl Planner<'_> {
    /// 3. Plans G43, G44, G49 and a new H; returns true if the offset has changed.
    #[inline]
    pub(super) fn plan_length(&self, plan: &mut BlockPlan) -> ExecResult<bool> {
        let commanded = self.words.has(b'H')
            || self.words.has_non_motion_code(|effect| matches!(effect, Effect::Length(_)));
        if !commanded
            || (plan.state.modal.length == Length::Off && self.registers.state.modal.length == Length::Off)
        {
            return Ok(false);
        }
        self.plan_length_offset(plan)
    }

    #[inline(never)]
    fn plan_length_offset(&self, plan: &mut BlockPlan) -> ExecResult<bool> {
        let is_compensation_on =
            |row: &&GCodeRow| matches!(row.effect, Effect::Length(Length::Plus | Length::Minus));
        if let Some(row) = self.words.g_codes().find(is_compensation_on)
            && plan.state.codes.h == 0
            && !self.words.has(b'H')
        {
            plan.notes.push(Note::LengthOffsetZero(row.code));
        }
        let offset = self.locate(self.data.length_offset(&plan.state))?;
        let (changed, by) = (offset != plan.state.length_offset, plan.state.length_compensation());
        if changed || by != self.registers.state.length_compensation() {
            plan.push_event(EventKind::ToolLength { offset, compensation: by });
        }
        plan.state.length_offset = offset;
        Ok(changed)
    }

    /// 4. Plans a move by the modal codes: a drilling cycle, or group 01.
    pub(super) fn plan_motion(&self, plan: &mut BlockPlan, has_new_length: bool) -> ExecResult<()> {
        if let Some(cycle) = plan.state.modal.cycle {
            if self.is_drilling_block() {
                return self.plan_cycle(plan, cycle, None);
            }
            // Only blocks that drill store P and Q.
            if self.words.has_any(b"PQ") {
                self.words.mark_read(b"PQ");
                plan.notes.push(Note::CycleDataLost);
            }
            if has_new_length {
                self.data.recompute_position(&mut plan.state);
            }
            return Ok(());
        }
        let motion = plan.state.modal.motion;
        let is_arc = matches!(motion, Motion::Clockwise | Motion::Counterclockwise);
        let names_axis = self.names_axis();
        // A code of group 01 after that of a cycle: a plain move, the words of the cycle have no effect.
        let overrules_cycle =
            self.words.has_non_motion_code(|effect| matches!(effect, Effect::Cycle(Some(_))));
        if overrules_cycle {
            self.words.mark_read(b"KPQR");
        }
        if !(names_axis || is_arc && self.words.has_any(b"IJKR")) {
            return self.move_by_length_change(plan, has_new_length);
        }
        // Some controls round corners by R or read I J K here; the end of cutter compensation takes a vector.
        let takes_vector = self.words.has_non_motion_code(|effect| effect == Effect::Cutter(CutterSide::Off));
        if !(is_arc || takes_vector || overrules_cycle)
            && let Some(letter) = self.words.first_letter_of(letters(b"IJKR"))
        {
            let what = format!("{} in a block with a straight move", char::from(letter));
            return Err(Alarm::NotSimulated { what }.located_at(self.words.span(letter)));
        }
        let endpoint = self.resolve_endpoint(&mut plan.state)?;
        if motion == Motion::Thread && self.words.has_corner() {
            return Err(Alarm::CornerInThread.located_at(self.block));
        }
        if motion != Motion::Rapid && self.words.has_corner() {
            plan.corner = self.corner_word(&plan.state)?;
        }
        match motion {
            Motion::Rapid => self.push_rapid(plan, &endpoint.machine),
            Motion::Thread => self.plan_thread(plan, endpoint.machine)?,
            Motion::Linear => self.locate(self.push_feed(plan, &endpoint.machine))?,
            Motion::Clockwise | Motion::Counterclockwise => self.plan_arc(plan, &endpoint)?,
        }
        plan.state.programmed = endpoint.programmed;
        plan.commands_axes = true;
        Ok(())
    }

    /// Plans a new tool length in a block without an axis: the axis moves by the offset at once, or not at all.
    fn move_by_length_change(&self, plan: &mut BlockPlan, has_new_length: bool) -> ExecResult<()> {
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
        self.locate(self.push_feed(plan, &to))
    }

    /// Returns the end point of the block's axis words, from the position in `state`.
    pub(super) fn resolve_endpoint(&self, state: &mut State) -> ExecResult<Endpoint> {
        let mut endpoint = Endpoint::at_current_position(state);
        let basis = self.data.coordinate_basis(state);
        self.resolve_axes(state, &basis, &mut endpoint)?;
        state.work_zero_unknown = endpoint.work_zero_unknown;
        if state.modal.polar == Polar::On {
            self.resolve_polar(state, &mut endpoint.programmed)?;
        }
        if state.last_end_point.is_some() && state.modal.distance == Distance::Absolute {
            self.note_axes_left_out(state);
        }
        let machine = self.data.to_machine(state, &endpoint.programmed);
        let rolled_machine = std::mem::replace(&mut endpoint.machine, machine);
        for axis in
            self.data.settings.rollover_axes().filter(|axis| self.words.has(self.data.axis_letter(*axis)))
        {
            endpoint.machine[axis] = rolled_machine[axis];
        }
        if endpoint.machine.0.iter().any(|at| at.abs() > basis.max_coordinate) {
            self.check_coordinate_range(&endpoint.machine, basis.max_coordinate)?;
        }
        Ok(endpoint)
    }

    /// Notes an axis that the block doesn't name, if a change of the transform has changed its coordinate.
    #[cold]
    fn note_axes_left_out(&self, state: &State) {
        let end = self.data.move_end(state);
        let is_left_out = |axis| !self.names(axis) && end[axis] != state.programmed[axis];
        if (0..self.data.settings.axes.len()).any(is_left_out) {
            self.registers.block_effects.record_note(Note::AxisLeftOut);
        }
    }

    /// Raises the alarm of an axis beyond the largest coordinate; an axis that rolls over has none.
    #[cold]
    fn check_coordinate_range(&self, machine: &Position, most: f64) -> ExecResult<()> {
        for (axis, letter) in self.data.settings.axes.iter() {
            if machine[axis].abs() > most && !self.data.settings.rolls_over[axis] {
                let alarm = Alarm::PositionOverflow { letter, value: machine[axis] };
                let word = self.names(axis).then(|| self.words.span(letter as u8));
                return Err(alarm.located_at(word.unwrap_or(self.block)));
            }
        }
        Ok(())
    }

    /// Emits a rapid to a point in machine coordinates, unless the tool is there.
    pub(super) fn push_rapid(&self, plan: &mut BlockPlan, to: &Position) {
        let from = &plan.state.machine;
        if to != from {
            plan.push_move(EventKind::Rapid { to: *to }, self.data.rapid_seconds(from, to));
        }
    }

    /// Emits a straight cut; an alarm without a feed, even if the cut has no length.
    pub(super) fn push_feed(&self, plan: &mut BlockPlan, to: &Position) -> Result<(), Alarm> {
        let from = &plan.state.machine;
        let (rate, seconds) = self.data.feed_seconds(&plan.state, from, to, self.words.has(b'F'))?;
        if to != from {
            plan.push_move(EventKind::Feed { to: *to, rate }, seconds);
        }
        Ok(())
    }

    /// G33: F is the lead along the axis with the longest path, in every feed mode; Q, the start angle, has no effect.
    pub(super) fn plan_thread(&self, plan: &mut BlockPlan, to: Position) -> ExecResult<()> {
        self.words.mark_read(b"Q");
        if let Some((WordNumber::Literal(lead), _)) = self.words.get(b'F')
            && lead.places.is_none()
        {
            let what = "F without a decimal point (its unit differs between controls) in G33".into();
            return Err(Alarm::NotSimulated { what }.located_at(self.words.span(b'F')));
        }
        let turning = plan.state.spindle != SpindleDirection::Off && plan.state.codes.s > 0.0;
        if !turning {
            return Err(self.not_simulated("G33 with the spindle stopped (a control waits for it)"));
        }
        let lead = plan.state.codes.f * if plan.state.modal.unit == Unit::Inch { 25.4 } else { 1.0 };
        if lead <= 0.0 {
            return Err(Alarm::FeedZero.located_at(self.block));
        }
        let from = plan.state.machine;
        if to == from {
            return Ok(());
        }
        let distance = |axis: usize| (to[axis] - from[axis]).abs();
        let longest = (0..MAX_AXES).map(distance).fold(0.0, f64::max);
        let length = (0..MAX_AXES).map(|axis| distance(axis) * distance(axis)).sum::<f64>().sqrt();
        let minutes = longest / (lead * plan.state.codes.s);
        let rate = MmPerMin(length / minutes);
        plan.push_move(EventKind::Feed { to, rate }, minutes * 60.0);
        Ok(())
    }
}
