//! Checks a block of a canned cycle: its axis, words, repeats and end; G70 to G72 of a Haas repeat it in a pattern.
use super::cycle_expansion::{CyclePlan, has_too_many_pecks};
use super::functions::ExecResult;
use super::linear_motion::Endpoint;
use super::move_repeats::MOST_REPEATS;
use super::notes::Note;
use super::plan::BlockPlan;
use super::planner::Planner;
use super::state::{CycleLevel, PeckSchedule, RigidTapping, State};
use gcode_lang::alarm::{Alarm, DigitLimit};
use gcode_lang::control::Dialect;
use gcode_lang::motion::{AxisIndex, Position};
use gcode_lang::program::code_facts::Letters;
use gcode_lang::program::cycles::{Cycle, CycleStep};
use gcode_lang::program::g_codes::{HolePattern, spelled};
use gcode_lang::program::modes::{Distance, FeedMode, Plane, Polar, ReturnTo};
use gcode_lang::units::Deg;

/// Holes round the current position, or on a straight line from it.
#[derive(Clone, Copy, Debug)]
pub(super) struct BoltHolePattern {
    count: u32,
    /// From the current position to the first hole, mm, and how much more to each next one.
    radius: f64,
    radius_step: f64,
    /// Degrees from X+ to the first hole, and from hole to hole.
    start: f64,
    angle_step: f64,
}

impl Planner<'_> {
    /// Returns the drilling axis: Z; with FXY 5101#0 the normal of the plane or the axis parallel to it that the block names,
    /// the same until G80.
    pub(super) fn drilling_axis(&self, state: &State) -> Result<AxisIndex, Alarm> {
        let find = |letter| self.data.axis_with_letter(letter);
        if !self.data.settings.drills_by_plane {
            return find(b'Z');
        }
        let letters = match state.modal.plane {
            Plane::Xy => b"ZW",
            Plane::Zx => b"YV",
            Plane::Yz => b"XU",
        };
        let mut named = letters.iter().filter(|letter| self.words.has(**letter));
        match (state.cycle.axis, named.next(), named.next()) {
            (_, Some(_), Some(_)) => Err(Alarm::DrillingAxis),
            (None, named, None) => find(*named.unwrap_or(&letters[0])),
            (Some(axis), named, None) => {
                let letter = self.data.axis_letter(axis);
                let same = letters.contains(&letter) && named.is_none_or(|named| *named == letter);
                if same { Ok(axis) } else { Err(Alarm::DrillingAxis) }
            }
            (_, None, Some(_)) => Err(Alarm::DrillingAxis),
        }
    }

    /// Checks a block of a canned cycle and computes its end.
    pub(super) fn plan_cycle(
        &self,
        plan: &mut BlockPlan,
        cycle: &'static Cycle,
        pattern: Option<BoltHolePattern>,
    ) -> ExecResult<()> {
        // Whether F is the time of each stroke or of the cycle, or is refused, manuals don't say.
        if plan.state.modal.feed_mode == FeedMode::InverseTime {
            return Err(self.code_in_mode(spelled(cycle.code), ("G93", "G94")));
        }
        let axis = self.locate(self.drilling_axis(&plan.state))?;
        let scale_factor = self.locate(scale_factor_along(plan, cycle, axis))?;
        let repeats = self.cycle_repeats(pattern)?;
        let is_incremental = plan.state.modal.distance == Distance::Incremental;
        let from = *plan.state;
        // The depth is no move.
        let Endpoint { programmed: mut endpoint, machine: end_on_machine, .. } =
            self.compute_endpoint(&mut plan.state)?;
        // The holes count on from the start without a wrap, so that each rotation keeps its direction and its length.
        for turning in self.data.settings.rollover_axes() {
            endpoint[turning] = from.programmed_position[turning]
                + (end_on_machine[turning] - from.machine_position[turning]);
        }
        endpoint[axis] = from.programmed_position[axis];
        plan.state.unknown = plan.state.unknown.with_axes_of(1 << axis, from.unknown);
        self.read_cycle_words(plan, axis, is_incremental)?;
        self.note_cycle(plan, axis);
        if cycle.needs_q {
            self.check_peck_words(plan, pattern)?;
        }
        let (rate, _) = self.locate(self.data.path_time(&plan.state, 1.0, self.words.has(b'F')))?;
        if cycle.taps() && self.checks_rigid_tapping(&plan.state) {
            if plan.state.modal_words.s == 0.0 {
                return Err(Alarm::NoSpeedInRigidTapping.located_at(self.block));
            }
            if plan.state.rigid_tapping == (RigidTapping::Possible { has_moved: true }) {
                return Err(Alarm::MoveBeforeRigidTapping.located_at(self.block));
            }
        }
        plan.commands_axes = true;
        if cycle.needs_q && has_too_many_pecks(&plan.state.cycle.with_unscaled_pecks(scale_factor), repeats) {
            return Err(self.not_simulated("more than a million pecks in one block"));
        }
        if repeats == 0 && !self.data.settings.undocumented.k0_positions {
            // Without a position in the block there is nothing in which controls differ.
            let is_position = |(other, letter): (AxisIndex, u8)| other != axis && self.words.has(letter);
            if self.data.settings.axes.letters().any(is_position) {
                plan.notes.push(Note::CycleRepeatsZero);
            }
            plan.state.unknown = from.unknown;
            return Ok(());
        }
        let (first, second) = self.data.active_plane(&plan.state).unwrap_or((0, 1));
        let other = self.data.settings.axes.find(b'X').filter(|x| *x != axis).unwrap_or_default();
        let shift = plan.state.cycle.q.unwrap_or(0.0).abs();
        let start_state = State { machine_position: from.machine_position, ..*plan.state };
        let holes = match pattern {
            Some(pattern) => self.pattern_holes(&endpoint, pattern),
            None => {
                self.repeated_holes(&mut plan.state, &from.programmed_position, endpoint, repeats.max(1))?
            }
        };
        plan.state.programmed_position = holes.last().copied().unwrap_or(endpoint);
        if repeats == 0 {
            // K0 of some controls: a position only.
            let mut to = self.data.cycle_point(&start_state, &plan.state.programmed_position);
            to = start_state.at_level_of(axis, to, &from.machine_position);
            self.wrap_position(&mut plan.state);
            plan.state.machine_position = from.machine_position;
            self.push_unknown_axes(plan);
            self.push_rapid(plan, &to);
            return Ok(());
        }
        self.move_to_return_level(&mut plan.state, cycle, axis);
        plan.state.machine_position = self.data.cycle_point(&start_state, &plan.state.programmed_position);
        self.wrap_position(&mut plan.state);
        plan.cycle_plan = Some(CyclePlan {
            cycle,
            start_state,
            holes,
            axis,
            bore_shift: match plan.state.cycle.shift {
                Some([along_first, along_second]) => [(first, along_first), (second, along_second)],
                None => [(if first == axis { other } else { first }, shift), (second, 0.0)],
            },
            rate,
            dwell: plan.state.cycle.p,
            scale_factor,
        });
        Ok(())
    }

    /// Notes a cycle without R or depth, and one that drills along Z while another plane is active.
    fn note_cycle(&self, plan: &mut BlockPlan, axis: AxisIndex) {
        let data = &plan.state.cycle;
        for (level, letter) in [(data.r, 'R'), (data.z, self.data.settings.axes.letter(axis))] {
            if !level.is_commanded {
                plan.notes.push(Note::CycleLevelMissing(letter));
            }
        }
        let shifts = plan.state.modal.cycle.is_some_and(|cycle| cycle.steps.contains(&CycleStep::Shift));
        let by_q = [data.q.unwrap_or(0.0), 0.0];
        if shifts && data.shift.unwrap_or(by_q) == [0.0; 2] {
            plan.notes.push(Note::CycleShiftZero);
        }
        if !self.data.settings.drills_by_plane && plan.state.modal.plane != Plane::Xy {
            plan.notes.push(Note::DrillsAlongZ(plan.state.modal.plane.code()));
        }
    }

    /// Sets the position to the R point level or the initial level, where the cycle ends.
    fn move_to_return_level(&self, state: &mut State, cycle: &Cycle, axis: AxisIndex) {
        let data = &state.cycle;
        let (level, unknown) = if state.modal.return_to == ReturnTo::R && cycle.rapids_to_r_first {
            (data.r_level(), data.r_unknown(state.unknown_after_absolute(axis)))
        } else {
            (data.initial, data.initial_unknown)
        };
        state.unknown = state.unknown.with_axes_of(1 << axis, unknown);
        state.programmed_position[axis] = level;
    }

    /// Wraps the axes that roll over.
    fn wrap_position(&self, state: &mut State) {
        for axis in self.data.settings.rollover_axes() {
            state.programmed_position[axis] = self.data.wrap_angle(axis, state.programmed_position[axis]);
        }
    }

    fn cycle_repeats(&self, pattern: Option<BoltHolePattern>) -> ExecResult<u32> {
        let letter = self.data.settings.cycle_repeat_letter;
        let repeats = match pattern {
            Some(pattern) => pattern.count,
            None => self.words.count(letter)?.unwrap_or(1),
        };
        if repeats > MOST_REPEATS {
            return Err(Alarm::TooManyDigits(DigitLimit::Written(4)).located_at(self.words.span(letter)));
        }
        Ok(repeats)
    }

    /// Raises the alarm of a cycle with pecks whose depth isn't commanded.
    fn check_peck_words(&self, plan: &mut BlockPlan, pattern: Option<BoltHolePattern>) -> ExecResult<()> {
        if self.data.settings.has_shrinking_pecks && pattern.is_none() {
            self.read_peck_schedule(plan)?;
        }
        let data = &plan.state.cycle;
        let none = data.pecks.is_none() && data.q.is_none_or(|q| q == 0.0);
        if none { Err(Alarm::NoPeckDepth.located_at(self.block)) } else { Ok(()) }
    }

    /// Returns the holes of a block that K repeats; the angle of the next block in G16 counts from the last hole.
    fn repeated_holes(
        &self,
        state: &mut State,
        start: &Position,
        first: Position,
        repeats: u32,
    ) -> ExecResult<Vec<Position>> {
        let mut holes = vec![first];
        let is_incremental = state.modal.distance == Distance::Incremental;
        let plane = self.data.active_plane(state);
        let polar_plane = plane.ok().filter(|_| state.modal.polar == Polar::On && is_incremental);
        let angle_step = match polar_plane {
            Some(plane) => self.angle(self.data.axis_letter(plane.1))?.unwrap_or(0.0),
            None => 0.0,
        };
        let first_angle = state.polar.angle;
        for repeat in (1..repeats).map(f64::from) {
            let mut hole = first;
            for axis in 0..self.data.settings.axes.len() {
                let step = if is_incremental { first[axis] - start[axis] } else { 0.0 };
                // An axis that stands keeps its angle, which G53.1 doesn't round.
                if step != 0.0 {
                    hole[axis] = self.data.remove_residue(first[axis] + repeat * step);
                }
            }
            if let Some(plane) = polar_plane {
                let last = holes[holes.len() - 1];
                (hole[plane.0], hole[plane.1]) = (last[plane.0], last[plane.1]);
                state.polar.angle = first_angle + repeat * angle_step;
                self.data.polar_point(state, plane, &mut hole);
            }
            holes.push(hole);
        }
        Ok(holes)
    }

    fn pattern_holes(&self, centre: &Position, pattern: BoltHolePattern) -> Vec<Position> {
        let hole = |index: u32| {
            let angle = Deg(pattern.start + f64::from(index) * pattern.angle_step);
            let radius = pattern.radius + f64::from(index) * pattern.radius_step;
            let mut hole = *centre;
            hole[0] = self.data.remove_residue(centre[0] + radius * angle.cos());
            hole[1] = self.data.remove_residue(centre[1] + radius * angle.sin());
            hole
        };
        (0..pattern.count).map(hole).collect()
    }

    /// Reads the depth, R, P and Q, which stay in force from hole to hole.
    fn read_cycle_words(
        &self,
        plan: &mut BlockPlan,
        axis: AxisIndex,
        is_incremental: bool,
    ) -> ExecResult<()> {
        let state = &plan.state;
        let mut data = state.cycle;
        if let Some(value) = self.dimension(b'R', state)? {
            data.r = CycleLevel { value, is_incremental, is_commanded: true };
        }
        if let Some(value) = self.dimension(self.data.axis_letter(axis), state)? {
            data.z = CycleLevel { value, is_incremental, is_commanded: true };
        }
        // J of a Haas: a faster retract.
        if self.data.settings.codes == Dialect::HaasNgc && state.modal.cycle.is_some_and(Cycle::taps) {
            self.words.mark_read(Letters::of(b"J"));
        }
        if let Some(value) = self.dimension(b'Q', state)? {
            data.q = Some(value.abs());
            data.shift = None;
        }
        let shifts = state.modal.cycle.is_some_and(|cycle| cycle.steps.contains(&CycleStep::Shift));
        if self.data.settings.codes == Dialect::HaasNgc && shifts && self.words.has_any(b"IJ") {
            if self.words.has(b'Q') || state.modal.plane != Plane::Xy {
                return Err(self.not_simulated("G76 and G77 with I, J and Q, or outside plane G17"));
            }
            let [i, j] = [self.dimension(b'I', state)?, self.dimension(b'J', state)?];
            data.shift = Some([i.unwrap_or(0.0), j.unwrap_or(0.0)]);
        }
        if let Some(seconds) = self.dwell_seconds()? {
            data.p = seconds;
        }
        plan.state.cycle = data;
        Ok(())
    }
}

/// Returns the scale factor of G51 along the drilling axis; an alarm for a combination that isn't simulated.
fn scale_factor_along(plan: &BlockPlan, cycle: &Cycle, axis: AxisIndex) -> Result<f64, Alarm> {
    let transform = &plan.state.transform;
    let scale_factor = transform.scaling.map_or(1.0, |s| s.factor[axis]);
    let is_mirrored = scale_factor < 0.0 || transform.mirrored_axes >> axis & 1 == 1;
    // G51 excepts cycles with a shift; the manual doesn't say how far.
    let has_scaled_shift = scale_factor != 1.0 && cycle.steps.contains(&CycleStep::Shift);
    if is_mirrored || has_scaled_shift {
        let what = "a canned cycle whose axis is mirrored, or one with a shift that is scaled";
        return Err(Alarm::NotSimulated { what: what.into() });
    }
    Ok(scale_factor)
}

impl Planner<'_> {
    /// Reads the pecks of G73 and G83 of a Haas: the first is I, each next one J less, none less than K.
    fn read_peck_schedule(&self, plan: &mut BlockPlan) -> ExecResult<()> {
        let state = &plan.state;
        let first = self.dimension(b'I', state)?;
        let decrement = self.dimension(b'J', state)?;
        let minimum = self.dimension(b'K', state)?;
        if let (None, None, Some(depth), true) = (first, decrement, minimum, self.words.has(b'Q'))
            && state.modal.cycle.is_some_and(|cycle| cycle.steps.contains(&CycleStep::HighSpeedPeck))
        {
            if depth <= 0.0 {
                return Err(Alarm::NoPeckDepth.located_at(self.block));
            }
            plan.state.cycle.depth_to_retract = Some(depth);
            return Ok(());
        }
        let pecks = match (first, decrement, minimum) {
            (None, None, None) => return Ok(()),
            (Some(first), None, None) => PeckSchedule { first, decrement: 0.0, minimum: first },
            (Some(first), Some(decrement), Some(minimum)) => PeckSchedule { first, decrement, minimum },
            _ => return Err(self.not_simulated("I, J and K of G73 and G83 in part, or K with Q")),
        };
        if self.words.has(b'Q') {
            return Err(self.not_simulated("G73 and G83 with I and Q"));
        }
        if pecks.first <= 0.0 || pecks.decrement < 0.0 || pecks.minimum <= 0.0 || pecks.minimum > pecks.first
        {
            return Err(Alarm::NoPeckDepth.located_at(self.block));
        }
        plan.state.cycle.pecks = Some(pecks);
        Ok(())
    }

    /// Plans the cycle in force at holes round a centre, which itself isn't drilled, or on a line (Haas Mill Operator's Manual,
    /// G70 to G72). I is the radius or the distance between holes, J the angle of the first hole or of the line, L their
    /// number, K the angle between holes on an arc.
    pub(super) fn plan_bolt_holes(&self, holes: HolePattern, plan: &mut BlockPlan) -> ExecResult<()> {
        let code = match holes {
            HolePattern::Circle => "G70",
            HolePattern::Arc => "G71",
            HolePattern::Line => "G72",
        };
        let Some(cycle) = plan.state.modal.cycle else {
            return Err(Alarm::NoCycle(code).located_at(self.block));
        };
        if plan.state.modal.plane != Plane::Xy {
            return Err(self.not_simulated(format!("{code} outside plane G17")));
        }
        let missing = |letter| Alarm::MissingWord { code, letter }.located_at(self.block);
        let radius = self.dimension(b'I', &plan.state)?.ok_or_else(|| missing('I'))?;
        let start = match (self.angle(b'J')?, holes) {
            (Some(angle), _) => angle,
            // A line along X+.
            (None, HolePattern::Line) => 0.0,
            (None, _) => return Err(missing('J')),
        };
        let count = self.words.count(b'L')?.filter(|count| *count > 0).ok_or_else(|| missing('L'))?;
        let angle_step = match holes {
            // A negative radius means clockwise.
            HolePattern::Circle => (360.0 / f64::from(count)).copysign(radius),
            HolePattern::Arc => self.angle(b'K')?.ok_or_else(|| missing('K'))?,
            HolePattern::Line => 0.0,
        };
        if radius == 0.0 || radius < 0.0 && holes != HolePattern::Circle {
            let function = format!("I of {code}");
            return Err(Alarm::OutOfRange { function, value: radius }.located_at(self.block));
        }
        let (first, radius_step) = match holes {
            HolePattern::Circle | HolePattern::Arc => (radius.abs(), 0.0),
            HolePattern::Line if self.data.settings.undocumented.line_starts_here => (0.0, radius),
            HolePattern::Line => (radius, radius),
        };
        let pattern = BoltHolePattern { count, radius: first, radius_step, start, angle_step };
        self.plan_cycle(plan, cycle, Some(pattern))
    }
}
