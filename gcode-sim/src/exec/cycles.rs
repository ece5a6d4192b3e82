//! Expands a drilling cycle's row into moves, hole by hole.
use super::Core;
use super::eval::{Checked, at};
use super::notes::Note;
use super::patterns::Pattern;
use super::pecks::{PECKS, pecks};
use super::plan::Plan;
use super::state::{Level, PolarPoint, State};
use super::words::Given;
use crate::alarm::Alarm;
use crate::motion::{Axis, EventKind, Position, Spindle, StopKind};
use crate::program::cycles::{Cycle, Step};
use crate::program::modes::{Distance, Plane, Polar, ReturnTo};
use crate::source::Span;
use crate::units::{Deg, MmPerMin, Rpm, Seconds};

/// A drilling block, checked: telling it can't fail.
#[derive(Clone, Debug)]
pub(super) struct Drill {
    cycle: &'static Cycle,
    /// Where the block begins; after it the plan's state stands where it ends.
    from: State,
    /// The first hole, as programmed, and from hole to hole.
    hole: Position,
    step: Position,
    circle: Option<Circle>,
    pattern: Option<Pattern>,
    repeats: u32,
    axis: Axis,
    shift: (Axis, f64),
    rate: MmPerMin,
    /// Seconds.
    dwell: f64,
    /// What G51 makes of a millimetre along the drilling axis; Q, 5114 and 5115 are not scaled.
    stretch: f64,
}

/// Holes that K repeats in polar coordinates.
#[derive(Clone, Copy, Debug)]
struct Circle {
    plane: (Axis, Axis),
    first: PolarPoint,
    /// Degrees from hole to hole.
    turn: f64,
}

impl Core {
    /// Whether a block drills: it names an axis or R.
    pub(super) fn drills(&self, given: &Given) -> bool {
        given.has(b'R') || self.names_axis(given)
    }

    /// Z; with FXY 5101#0 the plane's normal or the axis beside it that the block names, which stays the same until
    /// G80.
    pub(super) fn drilling_axis(&self, given: &Given, state: &State) -> Result<Axis, Alarm> {
        let find = |letter: u8| {
            let missing = Alarm::ImproperAddress { letter: char::from(letter) };
            self.settings.axes.find(letter).ok_or(missing)
        };
        if !self.settings.drills_by_plane {
            return find(b'Z');
        }
        let along = match state.modal.plane {
            Plane::Xy => b"ZW",
            Plane::Zx => b"YV",
            Plane::Yz => b"XU",
        };
        let mut named = along.iter().filter(|letter| given.has(**letter));
        match (state.drilling.axis, named.next(), named.next()) {
            (_, Some(_), Some(_)) => Err(Alarm::DrillingAxis),
            (None, named, None) => find(*named.unwrap_or(&along[0])),
            (Some(axis), named, None) => {
                let letter = self.settings.axes.letter(axis) as u8;
                let same = along.contains(&letter) && named.is_none_or(|named| *named == letter);
                if same { Ok(axis) } else { Err(Alarm::DrillingAxis) }
            }
            (_, None, Some(_)) => Err(Alarm::DrillingAxis),
        }
    }

    /// Checks a drilling block and works out where it ends.
    pub(super) fn prepare_drill(
        &self,
        plan: &mut Plan,
        given: &Given,
        cycle: &'static Cycle,
        pattern: Option<Pattern>,
        span: Span,
    ) -> Checked<()> {
        let axis = at(self.drilling_axis(given, &plan.state), span)?;
        let stretch = plan.state.transform.scaling.map_or(1.0, |s| s.factor[axis]);
        let turned = stretch < 0.0 || plan.state.transform.mirrored >> axis & 1 == 1;
        // Of cycles with a shift the manual says that G51 leaves them out, not how far.
        let shifts = stretch != 1.0 && cycle.steps.contains(&Step::Shift);
        if plan.state.transform.tilt.is_some() || turned || shifts {
            let what =
                "a drilling cycle whose axis is tilted or mirrored, or one with a shift that is scaled"
                    .into();
            return Err(Alarm::NotSimulated { what }.at(span));
        }
        let letter = self.settings.cycle_repeats;
        let repeats = match pattern {
            Some(pattern) => pattern.count,
            None => given.count(letter)?.unwrap_or(1),
        };
        if repeats > 9999 {
            return Err(Alarm::TooManyDigits.at(given.span(letter)));
        }
        let incremental = plan.state.modal.distance == Distance::Incremental;
        let from = plan.state;
        // The block's own depth words are not a move.
        let mut goal = self.goal(given, &mut plan.state)?.programmed;
        goal[axis] = from.programmed[axis];
        self.drilling_words(plan, given, axis, incremental)?;
        if cycle.needs_q {
            if self.settings.shrinking_pecks && pattern.is_none() {
                self.shrinking_pecks(plan, given, span)?;
            }
            let data = &plan.state.drilling;
            if data.pecks.is_none() && data.q.is_none_or(|q| q == 0.0) {
                return Err(Alarm::NoPeckDepth.at(span));
            }
        }
        let (rate, _) = at(self.time_along(&plan.state, 1.0, 1.0, 0.0, given.has(b'F')), span)?;
        plan.moved = true;
        let data = plan.state.drilling.unscaled(stretch);
        let pecks = pecks(data.r_level(), data.z_level(), &data);
        if cycle.needs_q && pecks * f64::from(repeats.max(1)) > PECKS {
            return Err(
                Alarm::NotSimulated { what: "more than a million pecks in one block".into() }.at(span)
            );
        }
        let turned = |(axis, letter): (Axis, char)| self.settings.roll_over[axis] && given.has(letter as u8);
        if incremental && self.settings.axes.iter().any(turned) {
            let what = "a drilling cycle with an incremental axis that rolls over".into();
            return Err(Alarm::NotSimulated { what }.at(span));
        }
        if repeats == 0 && !self.settings.unsure.k0_positions {
            plan.note = Some(Note::NoRepeats);
            return Ok(());
        }
        let mut step = Position::default();
        if incremental {
            for (place, _) in self.settings.axes.iter() {
                step[place] = goal[place] - from.programmed[place];
            }
        }
        let first = self.plane_axes(plan.state.modal.plane).map_or(0, |(first, _)| first);
        let shift = plan.state.drilling.q.unwrap_or(0.0).abs();
        let circle = self.circle(plan, given, incremental, repeats)?;
        let drill = Drill {
            cycle,
            from: State { machine: from.machine, ..plan.state },
            hole: goal,
            step,
            circle,
            pattern,
            repeats: repeats.max(1),
            axis,
            shift: (if first == axis { self.other_axis(axis) } else { first }, shift),
            rate,
            dwell: plan.state.drilling.p,
            stretch,
        };
        let last = drill.last(self);
        let level = if plan.state.modal.return_to == ReturnTo::R && cycle.starts_at_r {
            plan.state.drilling.r_level()
        } else {
            plan.state.drilling.initial
        };
        let drills = repeats > 0;
        plan.state.programmed = last;
        if drills {
            plan.state.programmed[axis] = level;
        }
        let machine = self.to_machine(&plan.state, plan.state.programmed);
        if drills {
            plan.drill = Some(drill);
            plan.state.machine = machine;
        } else {
            let mut to = machine;
            to[axis] = from.machine[axis];
            plan.state.machine = from.machine;
            self.rapid(plan, to);
        }
        Ok(())
    }

    /// How the holes of a block with K follow one another in polar coordinates; the next block's angle counts from the
    /// last of them.
    fn circle(
        &self,
        plan: &mut Plan,
        given: &Given,
        incremental: bool,
        repeats: u32,
    ) -> Checked<Option<Circle>> {
        let state = &mut plan.state;
        let Ok(plane) = self.plane_axes(state.modal.plane) else { return Ok(None) };
        if state.modal.polar == Polar::Off || !incremental {
            return Ok(None);
        }
        let turn = self.angle(given, self.settings.axes.letter(plane.1) as u8)?.unwrap_or(0.0);
        let first = state.polar;
        state.polar.angle += f64::from(repeats.max(1) - 1) * turn;
        Ok(Some(Circle { plane, first, turn }))
    }

    fn other_axis(&self, axis: Axis) -> Axis {
        self.settings.axes.find(b'X').filter(|x| *x != axis).unwrap_or_default()
    }

    /// The depth, R, P and Q stay in force from hole to hole.
    fn drilling_words(&self, plan: &mut Plan, given: &Given, axis: Axis, incremental: bool) -> Checked<()> {
        let state = &plan.state;
        let mut data = state.drilling;
        if let Some(value) = self.dimension(given, b'R', state)? {
            data.r = Level { value, incremental };
        }
        if let Some(value) = self.dimension(given, self.settings.axes.letter(axis) as u8, state)? {
            data.z = Level { value, incremental };
        }
        if let Some(value) = self.dimension(given, b'Q', state)? {
            // Its sign is ignored.
            data.q = Some(value.abs());
        }
        if let Some(seconds) = self.pause(given)? {
            data.p = seconds;
        }
        plan.state.drilling = data;
        Ok(())
    }

    /// Tells a drilling block move by move.
    pub(super) fn drill(&self, drill: &Drill, tell: &mut impl FnMut(EventKind, f64)) {
        let mut way = Way { core: self, at: drill.from.machine, rate: drill.rate, tell };
        let state = &drill.from;
        let data = &state.drilling;
        let (r, z) = (data.r_level(), data.z_level());
        let mut hole = drill.hole;
        for turn in 0..drill.repeats {
            drill.advance(self, turn, &mut hole);
            let level = |value: f64| {
                let mut point = hole;
                point[drill.axis] = value;
                self.to_machine(state, point)
            };
            let mut over = level(r);
            over[drill.axis] = way.at[drill.axis];
            way.rapid(over);
            if drill.cycle.starts_at_r {
                way.rapid(level(r));
            }
            for step in drill.cycle.steps {
                self.drill_step(*step, drill, &level, (r, z), &mut way);
            }
        }
    }

    fn drill_step<T: FnMut(EventKind, f64)>(
        &self,
        step: Step,
        drill: &Drill,
        level: &impl Fn(f64) -> Position,
        (r, z): (f64, f64),
        way: &mut Way<'_, T>,
    ) {
        let state = &drill.from;
        let initial = state.drilling.initial;
        let to_initial = state.modal.return_to == ReturnTo::Initial;
        let turning = |turning| EventKind::Spindle { turning, speed: Rpm(state.codes.s) };
        match step {
            Step::FeedToBottom => way.feed(level(z)),
            Step::PeckFull => {
                self.peck((r, z), &state.drilling.unscaled(drill.stretch), |last, next, done| {
                    if last != r {
                        let clearance = (self.settings.g83_clearance / drill.stretch).min((r - last).abs());
                        way.rapid(level(last + clearance.copysign(r - z)));
                    }
                    way.feed(level(next));
                    if !done {
                        way.rapid(level(r + self.settings.g83_above_r.copysign(r - z)));
                    }
                });
            }
            Step::PeckShort => {
                let retract = (self.settings.g73_retract / drill.stretch).copysign(r - z);
                self.peck((r, z), &state.drilling.unscaled(drill.stretch), |_, next, done| {
                    way.feed(level(next));
                    if !done {
                        way.rapid(level(next + retract));
                    }
                });
            }
            Step::Dwell => way.dwell(drill.dwell),
            Step::DwellAtR if self.settings.unsure.tap_dwells_at_r => way.dwell(drill.dwell),
            Step::DwellAtR => {}
            Step::FeedToR => way.feed(level(r)),
            Step::RapidBack => way.shifted_to(level(if to_initial { initial } else { r }), drill.axis),
            Step::RapidToInitial if to_initial => way.rapid(level(initial)),
            Step::RapidToInitial => {}
            Step::RapidToInitialAlways => way.shifted_to(level(initial), drill.axis),
            Step::RapidToR => way.shifted_to(level(r), drill.axis),
            Step::Shift => {
                let mut to = way.at;
                to[drill.shift.0] = self.clean(to[drill.shift.0] + drill.shift.1);
                way.rapid(to);
            }
            Step::ShiftBack => {
                let mut to = way.at;
                to[drill.shift.0] = self.clean(to[drill.shift.0] - drill.shift.1);
                way.rapid(to);
            }
            Step::SpindleStop => (way.tell)(turning(Spindle::Off), 0.0),
            Step::SpindleForward => (way.tell)(turning(Spindle::Clockwise), 0.0),
            Step::SpindleReverse => (way.tell)(turning(Spindle::Counterclockwise), 0.0),
            Step::ManualRetract => {
                let stop = EventKind::Stop {
                    kind: StopKind::M00,
                    text: "retract by hand to R".into(),
                    named: Vec::new(),
                };
                (way.tell)(stop, 0.0);
                way.rapid(level(r));
            }
        }
    }
}

impl Drill {
    /// From a hole to the one that K repeats as number `turn`; 0 is the block's own.
    fn advance(&self, core: &Core, turn: u32, hole: &mut Position) {
        if let Some(Pattern { radius, start, turn: angle, .. }) = self.pattern {
            let angle = Deg(start + f64::from(turn) * angle);
            hole[0] = core.clean(self.hole[0] + radius * angle.cos());
            hole[1] = core.clean(self.hole[1] + radius * angle.sin());
            return;
        }
        if turn == 0 {
            return;
        }
        let from = *hole;
        for (place, _) in core.settings.axes.iter() {
            hole[place] = core.clean(self.hole[place] + f64::from(turn) * self.step[place]);
        }
        if let Some(Circle { plane, first, turn: angle }) = self.circle {
            (hole[plane.0], hole[plane.1]) = (from[plane.0], from[plane.1]);
            let here = PolarPoint { angle: first.angle + f64::from(turn) * angle, ..first };
            core.polar_point(&here, plane, hole);
        }
    }

    /// The tool comes from here.
    pub(super) fn begins_at(&mut self, machine: Position) {
        self.from.machine = machine;
    }

    /// Where the last hole is.
    fn last(&self, core: &Core) -> Position {
        let mut hole = self.hole;
        for turn in 0..self.repeats {
            self.advance(core, turn, &mut hole);
        }
        hole
    }
}

/// The tool on its way through a cycle, in machine coordinates.
struct Way<'c, T> {
    core: &'c Core,
    at: Position,
    rate: MmPerMin,
    tell: &'c mut T,
}

impl<T: FnMut(EventKind, f64)> Way<'_, T> {
    fn rapid(&mut self, to: Position) {
        if to != self.at {
            (self.tell)(EventKind::Rapid { to }, self.core.rapid_seconds(&self.at, &to));
            self.at = to;
        }
    }

    /// Along the drilling axis only: the plane keeps its shift.
    fn shifted_to(&mut self, to: Position, axis: Axis) {
        let mut there = self.at;
        there[axis] = to[axis];
        self.rapid(there);
    }

    fn feed(&mut self, to: Position) {
        if to != self.at {
            let squares: f64 = (0..to.0.len()).map(|a| (to[a] - self.at[a]) * (to[a] - self.at[a])).sum();
            (self.tell)(EventKind::Feed { to, rate: self.rate }, squares.sqrt() / self.rate.0 * 60.0);
            self.at = to;
        }
    }

    fn dwell(&mut self, seconds: f64) {
        if seconds > 0.0 {
            (self.tell)(EventKind::Dwell { time: Seconds(seconds) }, seconds);
        }
    }
}
