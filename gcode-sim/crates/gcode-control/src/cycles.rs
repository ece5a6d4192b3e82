//! Checks a drilling block: its axis, its words, its repeats, and where it ends.
use super::checked::{ExecResult, locate};
use super::cycle_expansion::{BoltHolePattern, CyclePlan, PolarRepeats};
use super::notes::Note;
use super::pecks::has_too_many_pecks;
use super::plan::BlockPlan;
use super::planner::Planner;
use super::state::{CycleLevel, PeckSchedule, State};
use super::words::BlockWords;
use gcode_lang::alarm::Alarm;
use gcode_lang::motion::{AxisIndex, Position};
use gcode_lang::program::cycles::{Cycle, CycleStep};
use gcode_lang::program::modes::{Distance, Plane, Polar, ReturnTo};
use gcode_lang::source::Span;

impl Planner<'_> {
    /// Whether a block drills: it names an axis or R.
    pub(super) fn is_drilling_block(&self, block_words: &BlockWords) -> bool {
        block_words.has(b'R') || self.data.names_axis(block_words)
    }

    /// Z; with FXY 5101#0 the plane's normal or the axis beside it that the block names, which stays the same until
    /// G80.
    pub(super) fn drilling_axis(&self, block_words: &BlockWords, state: &State) -> Result<AxisIndex, Alarm> {
        let find = |letter: u8| {
            let missing = Alarm::ImproperAddress { letter: char::from(letter) };
            self.data.settings.axes.find(letter).ok_or(missing)
        };
        if !self.data.settings.drills_by_plane {
            return find(b'Z');
        }
        let letters = match state.modal.plane {
            Plane::Xy => b"ZW",
            Plane::Zx => b"YV",
            Plane::Yz => b"XU",
        };
        let mut named = letters.iter().filter(|letter| block_words.has(**letter));
        match (state.cycle.axis, named.next(), named.next()) {
            (_, Some(_), Some(_)) => Err(Alarm::DrillingAxis),
            (None, named, None) => find(*named.unwrap_or(&letters[0])),
            (Some(axis), named, None) => {
                let letter = self.data.settings.axes.letter(axis) as u8;
                let same = letters.contains(&letter) && named.is_none_or(|named| *named == letter);
                if same { Ok(axis) } else { Err(Alarm::DrillingAxis) }
            }
            (_, None, Some(_)) => Err(Alarm::DrillingAxis),
        }
    }

    /// Checks a drilling block and works out where it ends.
    pub(super) fn plan_cycle(
        &self,
        plan: &mut BlockPlan,
        block_words: &BlockWords,
        cycle: &'static Cycle,
        pattern: Option<BoltHolePattern>,
        span: Span,
    ) -> ExecResult<()> {
        let axis = locate(self.drilling_axis(block_words, &plan.state), span)?;
        let stretch = locate(stretch_along(plan, cycle, axis), span)?;
        let repeats = self.cycle_repeats(block_words, pattern)?;
        let incremental = plan.state.modal.distance == Distance::Incremental;
        let from = *plan.state;
        // The block's own depth words are not a move.
        let mut endpoint = self.resolve_endpoint(block_words, &mut plan.state)?.programmed;
        endpoint[axis] = from.programmed[axis];
        plan.state.set_work_zero_unknown(axis, from.work_zero_unknown >> axis & 1 == 1);
        self.read_cycle_words(plan, block_words, axis, incremental)?;
        let data = &plan.state.cycle;
        for (level, letter) in [(data.r, 'R'), (data.z, self.data.settings.axes.letter(axis))] {
            if !level.is_commanded {
                plan.notes.push(Note::CycleLevelMissing { letter });
            }
        }
        if !self.data.settings.drills_by_plane && plan.state.modal.plane != Plane::Xy {
            plan.notes.push(Note::DrillsAlongZ { code: plan.state.modal.plane.code() });
        }
        if cycle.needs_q {
            self.check_peck_words(plan, block_words, pattern, span)?;
        }
        let (rate, _) = locate(self.data.path_time(&plan.state, 1.0, block_words.has(b'F')), span)?;
        plan.commands_axes = true;
        if cycle.needs_q && has_too_many_pecks(&plan.state.cycle.unscaled(stretch), repeats) {
            let what = "more than a million pecks in one block".into();
            return Err(Alarm::NotSimulated { what }.located_at(span));
        }
        let is_rollover_word = |(axis, letter): (AxisIndex, char)| {
            self.data.settings.rolls_over[axis] && block_words.has(letter as u8)
        };
        if incremental && self.data.settings.axes.iter().any(is_rollover_word) {
            let what = "a drilling cycle with an incremental axis that rolls over".into();
            return Err(Alarm::NotSimulated { what }.located_at(span));
        }
        if repeats == 0 && !self.data.settings.undocumented.k0_positions {
            plan.notes.push(Note::CycleRepeatsZero);
            return Ok(());
        }
        let mut step = Position::default();
        if incremental {
            for (place, _) in self.data.settings.axes.iter() {
                step[place] = endpoint[place] - from.programmed[place];
            }
        }
        let first = self.data.plane_axes(plan.state.modal.plane).map_or(0, |(first, _)| first);
        let shift = plan.state.cycle.q.unwrap_or(0.0).abs();
        let polar_repeats = self.polar_repeats(plan, block_words, incremental, repeats)?;
        let cycle_plan = CyclePlan {
            cycle,
            start_state: State { machine: from.machine, ..*plan.state },
            first_hole: endpoint,
            hole_step: step,
            polar_repeats,
            pattern,
            repeats: repeats.max(1),
            axis,
            shift: (if first == axis { self.other_axis(axis) } else { first }, shift),
            rate,
            dwell: plan.state.cycle.p,
            stretch,
        };
        plan.state.programmed = cycle_plan.last_hole(self.data);
        if repeats == 0 {
            // Positions only.
            let mut to = self.data.to_machine(&plan.state, &plan.state.programmed);
            to[axis] = from.machine[axis];
            plan.state.machine = from.machine;
            self.push_rapid(plan, &to);
            return Ok(());
        }
        let data = &plan.state.cycle;
        let (level, unplaced) = if plan.state.modal.return_to == ReturnTo::R && cycle.starts_at_r {
            (data.r_level(), data.is_r_unknown())
        } else {
            (data.initial, data.is_initial_unknown)
        };
        plan.state.set_work_zero_unknown(axis, unplaced);
        plan.state.programmed[axis] = level;
        plan.state.machine = self.data.to_machine(&plan.state, &plan.state.programmed);
        plan.cycle_plan = Some(cycle_plan);
        Ok(())
    }

    fn cycle_repeats(&self, block_words: &BlockWords, pattern: Option<BoltHolePattern>) -> ExecResult<u32> {
        let letter = self.data.settings.cycle_repeat_letter;
        let repeats = match pattern {
            Some(pattern) => pattern.count,
            None => block_words.count(letter)?.unwrap_or(1),
        };
        if repeats > 9999 {
            Err(Alarm::TooManyDigits.located_at(block_words.span(letter)))
        } else {
            Ok(repeats)
        }
    }

    /// A cycle with pecks needs their depth.
    fn check_peck_words(
        &self,
        plan: &mut BlockPlan,
        block_words: &BlockWords,
        pattern: Option<BoltHolePattern>,
        span: Span,
    ) -> ExecResult<()> {
        if self.data.settings.has_shrinking_pecks && pattern.is_none() {
            self.read_peck_schedule(plan, block_words, span)?;
        }
        let data = &plan.state.cycle;
        let none = data.pecks.is_none() && data.q.is_none_or(|q| q == 0.0);
        if none { Err(Alarm::NoPeckDepth.located_at(span)) } else { Ok(()) }
    }

    /// How the holes of a block with K follow one another in polar coordinates; the next block's angle counts from the
    /// last of them.
    fn polar_repeats(
        &self,
        plan: &mut BlockPlan,
        block_words: &BlockWords,
        incremental: bool,
        repeats: u32,
    ) -> ExecResult<Option<PolarRepeats>> {
        let state = &mut plan.state;
        let Ok(plane) = self.data.plane_axes(state.modal.plane) else { return Ok(None) };
        if state.modal.polar == Polar::Off || !incremental {
            return Ok(None);
        }
        let angle_step =
            self.data.angle(block_words, self.data.settings.axes.letter(plane.1) as u8)?.unwrap_or(0.0);
        let first = state.polar;
        state.polar.angle += f64::from(repeats.max(1) - 1) * angle_step;
        Ok(Some(PolarRepeats { plane, first, angle_step }))
    }

    fn other_axis(&self, axis: AxisIndex) -> AxisIndex {
        self.data.settings.axes.find(b'X').filter(|x| *x != axis).unwrap_or_default()
    }

    /// The depth, R, P and Q stay in force from hole to hole.
    fn read_cycle_words(
        &self,
        plan: &mut BlockPlan,
        block_words: &BlockWords,
        axis: AxisIndex,
        incremental: bool,
    ) -> ExecResult<()> {
        let state = &plan.state;
        let mut data = state.cycle;
        if let Some(value) = self.data.dimension(block_words, b'R', state)? {
            data.r = CycleLevel { value, is_incremental: incremental, is_commanded: true };
        }
        if let Some(value) =
            self.data.dimension(block_words, self.data.settings.axes.letter(axis) as u8, state)?
        {
            data.z = CycleLevel { value, is_incremental: incremental, is_commanded: true };
        }
        if let Some(value) = self.data.dimension(block_words, b'Q', state)? {
            // Its sign is ignored.
            data.q = Some(value.abs());
        }
        if let Some(seconds) = self.data.dwell_seconds(block_words)? {
            data.p = seconds;
        }
        plan.state.cycle = data;
        Ok(())
    }
}

/// What G51 makes of a millimetre along the drilling axis; an alarm for what isn't simulated.
fn stretch_along(plan: &BlockPlan, cycle: &Cycle, axis: AxisIndex) -> Result<f64, Alarm> {
    let transform = &plan.state.transform;
    let stretch = transform.scaling.map_or(1.0, |s| s.factor[axis]);
    let is_mirrored = stretch < 0.0 || transform.mirrored_axes >> axis & 1 == 1;
    // Of cycles with a shift the manual says that G51 leaves them out, not how far.
    let has_scaled_shift = stretch != 1.0 && cycle.steps.contains(&CycleStep::Shift);
    if transform.tilt.is_some() || is_mirrored || has_scaled_shift {
        let what = "a drilling cycle whose axis is tilted or mirrored, or one with a shift that is scaled";
        return Err(Alarm::NotSimulated { what: what.into() });
    }
    Ok(stretch)
}

impl Planner<'_> {
    /// G73 and G83 of a Haas: the first peck is I, each next one J less, none less than K.
    pub(super) fn read_peck_schedule(
        &self,
        plan: &mut BlockPlan,
        block_words: &BlockWords,
        span: Span,
    ) -> ExecResult<()> {
        let state = &plan.state;
        let first = self.data.dimension(block_words, b'I', state)?;
        let decrement = self.data.dimension(block_words, b'J', state)?;
        let minimum = self.data.dimension(block_words, b'K', state)?;
        let pecks = match (first, decrement, minimum) {
            (None, None, None) => return Ok(()),
            (Some(first), None, None) => PeckSchedule { first, decrement: 0.0, minimum: first },
            (Some(first), Some(less), Some(least)) => PeckSchedule { first, decrement: less, minimum: least },
            _ => {
                let what = "I, J and K of G73 and G83 in part, or K with Q".into();
                return Err(Alarm::NotSimulated { what }.located_at(span));
            }
        };
        if block_words.has(b'Q') {
            return Err(Alarm::NotSimulated { what: "G73 and G83 with I and Q".into() }.located_at(span));
        }
        if pecks.first <= 0.0 || pecks.decrement < 0.0 || pecks.minimum <= 0.0 || pecks.minimum > pecks.first
        {
            return Err(Alarm::NoPeckDepth.located_at(span));
        }
        plan.state.cycle.pecks = Some(pecks);
        Ok(())
    }
}
