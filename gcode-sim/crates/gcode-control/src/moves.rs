//! Moves by the modal codes: end points of axis words, the tool length, straight moves and threads.
use super::functions::ExecResult;
use super::kinematics::remove_noise;
use super::linear_motion::Endpoint;
use super::notes::Note;
use super::plan::BlockPlan;
use super::planner::Planner;
use super::state::State;
use super::words::WordNumber;
use gcode_lang::alarm::Alarm;
use gcode_lang::motion::{EventKind, MAX_AXES, Position, SpindleDirection};
use gcode_lang::program::code_facts::Letters;
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
            |row: &&GCodeRow| matches!(row.effect, Effect::Length(length) if length != Length::Off);
        self.cancel_length_offset(plan);
        if let Some(row) = self.words.g_codes().find(is_compensation_on)
            && plan.state.modal_words.h == 0
            && !self.words.has(b'H')
        {
            plan.notes.push(Note::LengthOffsetZero(row.code));
        }
        plan.state.is_length_cancelled = false;
        let (offset, wear) = self.locate(self.data.length_offset(&plan.state))?;
        let changed = offset != plan.state.length_offset;
        let has_other_source = wear != plan.state.length_wear
            || plan.state.length_compensation() != self.registers.state.length_compensation();
        (plan.state.length_offset, plan.state.length_wear) = (offset, wear);
        // A repeated offset is emitted too: its block decides on the cuts behind it.
        let is_repeated = plan.state.length_compensation().number().is_some();
        if changed || has_other_source || is_repeated {
            plan.push_event(self.data.length_event(&plan.state));
        }
        let (before, now) = (self.registers.state.controls_tip(), plan.state.controls_tip());
        if before && !now && plan.state.transform.is_identity() {
            plan.state.transform.unknown_centre = 0;
        }
        if now && self.data.settings.kinematics.is_none() {
            let code = plan.state.modal.length.code();
            self.lose_position(plan, code, false);
        }
        if before || now {
            // The tool stays: tool centre point control starts and ends without a move.
            self.data.recompute_position(&mut plan.state);
            return Ok(false);
        }
        Ok(changed)
    }

    /// 4. Plans a move by the modal codes: a canned cycle, or group 01.
    pub(super) fn plan_motion(&self, plan: &mut BlockPlan, has_new_length: bool) -> ExecResult<()> {
        self.check_turned(plan)?;
        if let Some(cycle) = plan.state.modal.cycle {
            // A block drills if it names an axis or R.
            if self.words.has(b'R') || self.names_axis() {
                return self.plan_cycle(plan, cycle, None);
            }
            // Only blocks that drill store P and Q; a P may be the number of a work coordinate system.
            if self.words.has_unread(b"PQ") {
                self.words.mark_read(Letters::of(b"PQ"));
                plan.notes.push(Note::CycleDataLost);
            }
            if has_new_length {
                self.data.recompute_position(&mut plan.state);
            }
            return Ok(());
        }
        if plan.state.virtual_plane.is_some() && self.names_axis() {
            self.check_motion_in_virtual_plane(&plan.state)?;
        }
        let motion = plan.state.modal.motion;
        let is_arc = matches!(motion, Motion::Clockwise | Motion::Counterclockwise);
        let names_axis = self.names_axis();
        // A code of group 01 after that of a cycle: a plain move, the words of the cycle have no effect.
        let overrules_cycle =
            self.words.has_non_motion_code(|effect| matches!(effect, Effect::Cycle(Some(_))));
        if overrules_cycle {
            self.words.mark_read(Letters::of(b"KPQR"));
        }
        let points_tool = self.points_tool(&plan.state);
        if !(names_axis || points_tool || is_arc && self.words.has_any(b"IJKR")) {
            return self.move_by_length_change(plan, has_new_length);
        }
        // Some controls round corners by R or read I J K here; the end of cutter compensation takes a vector.
        let takes_vector = self.words.has_non_motion_code(|effect| effect == Effect::Cutter(CutterSide::Off));
        if !(is_arc || takes_vector || overrules_cycle || points_tool)
            && let Some(letter) = self.words.first_present(Letters::of(b"IJKR").bits())
        {
            if plan.state.modal.cutter != CutterSide::Off {
                let what = format!("{} in a block with a straight move and compensation", char::from(letter));
                return Err(Alarm::NotSimulated { what }.located_at(self.words.span(letter)));
            }
            self.words.mark_read(Letters::of(b"IJKR"));
            plan.notes.push(Note::WordIgnored(char::from(letter)));
        }
        if self.words.has(b'L') {
            self.plan_repeated_moves(plan)?;
        }
        let mut endpoint = self.resolve_endpoint(plan)?;
        if points_tool {
            self.point_tool(&plan.state, &mut endpoint)?;
        }
        if motion == Motion::Thread && self.words.corner.is_some() {
            return Err(Alarm::CornerInThread.located_at(self.block));
        }
        if motion != Motion::Rapid && self.words.corner.is_some() {
            plan.corner = self.corner_word(&plan.state)?;
        }
        match motion {
            Motion::Rapid | Motion::Linear if plan.state.controls_tip() => {
                self.push_tip_path(plan, &endpoint, None)?
            }
            Motion::Rapid => self.push_rapid(plan, &endpoint.machine),
            Motion::Thread => self.plan_thread(plan, endpoint.machine)?,
            Motion::Linear => self.locate(self.push_feed(plan, &endpoint.machine))?,
            Motion::Clockwise | Motion::Counterclockwise => self.plan_arc(plan, &endpoint)?,
        }
        plan.state.programmed_position = endpoint.programmed;
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
        let to = self.data.to_machine(&plan.state, &plan.state.programmed_position);
        if plan.state.modal.motion == Motion::Rapid {
            self.push_rapid(plan, &to);
            return Ok(());
        }
        self.locate(self.push_feed(plan, &to))
    }

    /// Returns the end point of the block's axis words, from the position in the plan, and plans the event of the axes that
    /// are unknown there.
    pub(super) fn resolve_endpoint(&self, plan: &mut BlockPlan) -> ExecResult<Endpoint> {
        let endpoint = self.compute_endpoint(&mut plan.state)?;
        self.push_unknown_axes(plan);
        Ok(endpoint)
    }

    /// Returns the end point as [`Planner::resolve_endpoint`], without the event of the axes that are unknown there.
    pub(super) fn compute_endpoint(&self, state: &mut State) -> ExecResult<Endpoint> {
        let State { programmed_position: programmed, machine_position: machine, unknown, .. } = *state;
        let mut endpoint = Endpoint { programmed, machine, unknown };
        let basis = self.data.coordinate_basis(state);
        self.resolve_axes(state, &basis, &mut endpoint)?;
        state.unknown = endpoint.unknown;
        if state.modal.polar == Polar::On {
            self.resolve_polar(state, &mut endpoint.programmed)?;
        }
        if state.end_before_transform.is_some()
            && state.alignment().is_none()
            && state.modal.distance == Distance::Absolute
        {
            self.note_axes_left_out(state);
        }
        let machine = self.data.to_machine(state, &endpoint.programmed);
        let rolled_machine = std::mem::replace(&mut endpoint.machine, machine);
        for axis in
            self.data.settings.rollover_axes().filter(|axis| self.words.has(self.data.axis_letter(*axis)))
        {
            if state.is_virtual(axis) {
                continue;
            }
            endpoint.machine[axis] = rolled_machine[axis];
        }
        match state.transform.is_identity() {
            true => self.keep_fine_positions(state, &mut endpoint.machine),
            false => self.check_plane(state)?,
        }
        if endpoint.machine.0.iter().any(|at| at.abs() > basis.max_coordinate) {
            self.check_coordinate_range(&endpoint.machine, basis.max_coordinate)?;
        }
        Ok(endpoint)
    }

    /// Leaves axes where kinematics has put them, finer than the increment: one that the block doesn't name stays, and one in G91
    /// moves by its word.
    #[inline]
    fn keep_fine_positions(&self, state: &State, end: &mut Position) {
        let is_fine = |axis: &usize| {
            let at = state.machine_position[*axis];
            self.data.remove_residue(at) != at
        };
        if state.is_turned() || !(0..self.data.settings.axes.len()).any(|axis| is_fine(&axis)) {
            return;
        }
        let start = self.data.to_machine(state, &state.programmed_position);
        let is_incremental = state.modal.distance == Distance::Incremental;
        for axis in (0..self.data.settings.axes.len()).filter(is_fine) {
            let residue = state.machine_position[axis] - start[axis];
            let is_kept = is_incremental || !self.names(axis);
            if is_kept && self.data.remove_residue(residue) == 0.0 {
                end[axis] = remove_noise(end[axis] + residue);
            }
        }
    }

    /// Raises the alarm of a move while a plane is incomplete.
    fn check_plane(&self, state: &State) -> ExecResult<()> {
        if state.transform.plane_entry.is_some() {
            let what = "a move before the last block of a plane by points or vectors";
            return Err(Alarm::PlaneFormat(what).located_at(self.block));
        }
        Ok(())
    }

    /// Notes an axis that the block doesn't name, if a change of the transform has changed its coordinate.
    #[cold]
    fn note_axes_left_out(&self, state: &State) {
        let plane = self.data.plane_axes(state.modal.plane).ok();
        // Where all transforms have ended, a block of other axes moves none of the plane.
        if state.transform.is_identity()
            && plane.is_some_and(|(first, second)| !self.names(first) && !self.names(second))
        {
            return;
        }
        let end = self.data.move_end(state);
        let is_left_out = |axis| !self.names(axis) && end[axis] != state.programmed_position[axis];
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
        let from = &plan.state.machine_position;
        if to != from {
            plan.push_move(EventKind::Rapid { to: *to }, self.data.rapid_seconds(from, to));
        } else {
            plan.repeat_unknown_axes();
        }
    }

    /// Emits a straight cut; an alarm without a feed, even if the cut has no length.
    pub(super) fn push_feed(&self, plan: &mut BlockPlan, to: &Position) -> Result<(), Alarm> {
        let from = &plan.state.machine_position;
        let (rate, seconds) = self.data.feed_seconds(&plan.state, from, to, self.words.has(b'F'))?;
        if to != from {
            plan.push_move(EventKind::Feed { to: *to, rate }, seconds);
        } else {
            plan.repeat_unknown_axes();
        }
        Ok(())
    }

    /// G33: F is the lead along the axis with the longest path, in every feed mode; Q, the start angle, has no effect.
    pub(super) fn plan_thread(&self, plan: &mut BlockPlan, to: Position) -> ExecResult<()> {
        self.words.mark_read(Letters::of(b"Q"));
        if let Some((WordNumber::Literal(lead), _)) = self.words.get(b'F')
            && lead.places.is_none()
        {
            let what = "F without a decimal point (its unit differs between controls) in G33".into();
            return Err(Alarm::NotSimulated { what }.located_at(self.words.span(b'F')));
        }
        let turning = plan.state.spindle != SpindleDirection::Off && plan.state.modal_words.s > 0.0;
        if !turning {
            return Err(self.not_simulated("G33 with the spindle stopped (a control waits for it)"));
        }
        let lead = plan.state.modal_words.f * if plan.state.modal.unit == Unit::Inch { 25.4 } else { 1.0 };
        if lead <= 0.0 {
            return Err(Alarm::FeedZero.located_at(self.block));
        }
        let from = plan.state.machine_position;
        if to == from {
            return Ok(());
        }
        let distance = |axis: usize| (to[axis] - from[axis]).abs();
        let longest = (0..MAX_AXES).map(distance).fold(0.0, f64::max);
        let length = (0..MAX_AXES).map(|axis| distance(axis) * distance(axis)).sum::<f64>().sqrt();
        let minutes = longest / (lead * plan.state.modal_words.s);
        let rate = MmPerMin(length / minutes);
        plan.push_move(EventKind::Feed { to, rate }, minutes * 60.0);
        Ok(())
    }
}
