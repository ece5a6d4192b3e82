//! Moves of a symbolic run: end points and feeds that depend on the ranges, with the alarms that they can raise.
use super::super::control::Control;
use super::super::coordinates;
use super::super::functions::ExecResult;
use super::super::outcome::Outcome;
use super::super::plan::BlockPlan;
use super::super::registers::Registers;
use super::super::state::is_circular;
use super::super::words::{BlockWords, WordNumber};
use super::SymbolicRun;
use super::oracle::{Halt, Oracle, Symbolic};
use super::statements::Place;
use super::term::{Term, TermOperation, Terms, Test, UNFOLLOWED};
use super::words::BlockTerms;
use gcode_lang::alarm::{Alarm, DigitLimit};
use gcode_lang::motion::AxisIndex;
use gcode_lang::program::g_codes::{Effect, GCodeRow, OneShot};
use gcode_lang::program::modes::{CutterSide, Distance, FeedMode, Motion, Polar};
use gcode_lang::program::{Library, Words};
use gcode_lang::source::Span;
use gcode_lang::syntax::ast::{Function, Relation};
use gcode_lang::units::POWERS;

/// Largest number of increments in a word (PS0003).
const MAX_INCREMENTS: f64 = 999_999_999.0;

/// Magnitude beyond which a word has too many digits whatever its increment, and below which no product overflows.
const SURELY_TOO_LARGE: f64 = 1e15;

impl Registers {
    /// Returns true if a position, the feed or the spindle speed depends on the ranges.
    pub(super) fn has_terms_in_state(&self) -> bool {
        let state = &self.state;
        let positions = [&state.programmed_position, &state.machine_position];
        positions.iter().any(|position| position.0.iter().any(|at| at.is_nan()))
            || state.cycle.levels().iter().any(|level| level.is_nan())
            || state.modal_words.f.is_nan()
            || state.modal_words.s.is_nan()
    }

    /// Stops following the positions that depend on the ranges, after a change of their coordinate system.
    pub(super) fn forget_shifted_positions(&mut self) {
        for axis in 0..self.state.programmed_position.0.len() {
            let state = &mut self.state;
            if state.programmed_position[axis].is_nan() || state.machine_position[axis].is_nan() {
                (state.programmed_position[axis], state.machine_position[axis]) = (UNFOLLOWED, UNFOLLOWED);
            }
        }
        if self.state.cycle.initial.is_nan() {
            self.state.cycle.initial = UNFOLLOWED;
        }
    }
}

/// End of one axis of a move.
#[derive(Clone, Copy)]
pub(super) struct AxisEnd {
    pub(super) axis: AxisIndex,
    pub(super) programmed: Option<Term>,
    pub(super) machine: Option<Term>,
}

impl SymbolicRun {
    /// Executes a block whose axis words, feed or speed, or the position before it, depend on the ranges.
    pub(super) fn move_by_terms<T: Terms>(
        &mut self,
        words: &Words,
        terms: &BlockTerms,
        number: Option<u32>,
        place: Place,
        oracle: &mut Oracle<'_, T>,
        library: &mut impl Library,
    ) -> Symbolic<Option<Outcome>> {
        // The radius of an arc is checked with the terms.
        let mut result = self.plan_with_tolerance(words, f64::INFINITY);
        if self.control.plan.state.moves_on_arc() && !self.is_arc_of_terms(terms) {
            result =
                self.plan_with_tolerance(words, self.control.executor.registers.data.settings.arc_tolerance);
        }
        let Control { executor, plan, block_words, .. } = &mut self.control;
        let registers = &executor.registers;
        let mut block = MoveBlock { registers, plan, words: block_words, terms, oracle, span: place.span };
        // A plan that a known word refuses ends early: what its codes need is checked first.
        block.check_codes()?;
        if let Err(alarm) = result {
            return Err(block.refused(alarm.into()));
        }
        let ends = block.ends()?;
        let pecks = block.uncounted_pecks();
        let plan = &mut self.control.plan;
        for end in &ends {
            let stored = |term: Option<Term>| term.map_or(UNFOLLOWED, Term::stored);
            plan.state.programmed_position[end.axis] = stored(end.programmed);
            plan.state.machine_position[end.axis] = stored(end.machine);
        }
        if let Some(feed) = terms.feed {
            plan.state.modal_words.f = feed.stored();
        }
        if let Some(speed) = terms.speed {
            plan.state.modal_words.s = speed.stored();
        }
        plan.state.modal_words.n = number.unwrap_or(plan.state.modal_words.n);
        let moves = plan.commands_axes;
        let had_terms = self.control.executor.registers.has_terms_in_state();
        let shifts = had_terms && self.control.block_words.has_non_motion_code(shifts_coordinates);
        self.control.executor.begin(place);
        let end = self.carry_out(library)?;
        self.control.executor.log.moves += pecks;
        let registers = &mut self.control.executor.registers;
        if moves {
            registers.clock.motion_seconds = UNFOLLOWED;
        }
        if shifts {
            registers.forget_shifted_positions();
        }
        Ok(end)
    }

    /// Plans a block with a tolerance of the radius of arcs, and without stroke limits: these are checked at the ends that depend
    /// on the ranges.
    fn plan_with_tolerance(&mut self, words: &Words, tolerance: f64) -> ExecResult<()> {
        let Control { executor, plan, block_words, .. } = &mut self.control;
        plan.reset(&executor.registers.state);
        let settings = &mut executor.registers.data.settings;
        let (limits, own) = (settings.stroke_limits.take(), settings.arc_tolerance);
        settings.arc_tolerance = tolerance;
        let result = executor.plan_words(words, block_words, plan);
        let settings = &mut executor.registers.data.settings;
        (settings.stroke_limits, settings.arc_tolerance) = (limits, own);
        result
    }
}

/// Returns true for a code after which the same position has other coordinates.
fn shifts_coordinates(effect: Effect) -> bool {
    matches!(effect, Effect::Work(_) | Effect::NumberedWork(_) | Effect::AdditionalWork | Effect::Length(_))
}

/// Block that is planned, with its terms.
pub(super) struct MoveBlock<'a, 'o, T> {
    pub(super) registers: &'a Registers,
    pub(super) plan: &'a mut BlockPlan,
    pub(super) words: &'a BlockWords,
    pub(super) terms: &'a BlockTerms,
    pub(super) oracle: &'a mut Oracle<'o, T>,
    pub(super) span: Span,
}

impl<T: Terms> MoveBlock<'_, '_, T> {
    /// Returns the alarm of a block that the control refuses whatever the terms, if they can't raise an earlier one.
    fn refused(&mut self, alarm: Halt) -> Halt {
        let is_small = |term: &Term, oracle: &mut Oracle<'_, T>| {
            let (low, high) = oracle.terms.bounds(*term);
            low > -5e4 && high < 5e4
        };
        if self.has_stand_ins() {
            return Halt::unfollowed("a block with several possible alarms");
        }
        let state = &self.registers.state;
        let is_near = |axis| self.registers.data.zero(state, axis).abs() < 1e4;
        let is_near = (0..self.registers.data.settings.axes.len()).all(is_near);
        let feed_is_legal = self.terms.feed.is_none_or(|feed| self.oracle.terms.bounds(feed).0 > 0.0);
        if is_near && feed_is_legal && self.terms.axes.iter().all(|(_, term)| is_small(term, self.oracle)) {
            return alarm;
        }
        Halt::unfollowed("a block with several possible alarms")
    }

    pub(super) fn names_axis(&self) -> bool {
        self.words.has_letters(self.registers.data.settings.axes.letter_bits())
    }

    /// Returns true if the alarm of a refused plan may be that of a number in the place of a term.
    fn has_stand_ins(&self) -> bool {
        let is_arc = |row: &GCodeRow| matches!(row.effect, Effect::Motion(motion) if is_circular(motion));
        !self.terms.lengths.is_empty()
            || self.plan.state.moves_on_arc()
            || self.words.g_codes().any(is_arc)
            || self.plan.state.modal.cycle.is_some() && !self.has_known_levels()
    }

    /// Returns true if the block moves axes: it names one, or repeats a cycle or an arc.
    pub(super) fn commands_move(&self) -> bool {
        let state = &self.plan.state;
        self.names_axis()
            || state.modal.cycle.is_some() && self.words.has(b'R')
            || state.moves_on_arc() && self.words.has_any(b"IJKR")
    }

    /// Refuses codes and modes in which more than a straight move depends on a position.
    fn check_codes(&self) -> Symbolic<()> {
        let names_axis = self.commands_move();
        let has_terms = self.registers.has_terms_in_state();
        for row in self.words.g_codes() {
            let is_followed = match row.effect {
                Effect::Motion(
                    Motion::Rapid | Motion::Linear | Motion::Clockwise | Motion::Counterclockwise,
                )
                | Effect::Plane(_)
                | Effect::Distance(_)
                | Effect::Unit(_)
                | Effect::FeedMode(_)
                | Effect::Cutter(CutterSide::Off)
                | Effect::Cycle(_)
                | Effect::ReturnTo(_)
                | Effect::SpindleMode(_)
                | Effect::NoEffect
                | Effect::LookAhead
                | Effect::Smoothness
                | Effect::Cutting(_)
                | Effect::Call => true,
                Effect::OneShot(OneShot::Dwell) => self.terms.axes.is_empty(),
                // Only its feed may depend on the ranges.
                Effect::OneShot(OneShot::Skip) => !self.moves_terms(),
                Effect::Motion(_) => !names_axis && !self.words.has_any(b"IJKR"),
                effect => shifts_coordinates(effect) && !(names_axis && has_terms),
            };
            if !is_followed {
                return Err(Halt::unfollowed(format!(
                    "G{}",
                    gcode_lang::program::g_codes::spelled(row.code)
                )));
            }
        }
        let has_limits = self.registers.data.settings.stroke_limits.is_some();
        let state = &self.plan.state;
        let is_thread = state.modal.cycle.is_none() && state.modal.motion == Motion::Thread;
        let refused = [
            (is_thread && names_axis, "a thread"),
            (!self.terms.lengths.is_empty() && !self.takes_lengths(), "I, J, K, R or Q in this block"),
            (state.modal.cycle.is_some() && names_axis && !self.is_followed_cycle(), "a canned cycle"),
            (state.modal.cutter != CutterSide::Off && names_axis, "a move in cutter compensation"),
            (self.plan.corner.is_some(), "a corner"),
            (
                self.plan.uses_lookahead || !self.registers.lookahead.is_idle(),
                "a move that waits for the next",
            ),
            (self.plan.skip_plan.is_some() && (self.moves_terms() || has_limits), "a skip"),
            (names_axis && state.modal.polar == Polar::On, "polar coordinates"),
            (names_axis && state.controls_tip(), "tool centre point control"),
            (names_axis && !state.transform.is_identity(), "mirrored, scaled or rotated coordinates"),
            (names_axis && state.end_before_transform.is_some(), "a move after a change of coordinates"),
            (
                names_axis && (state.virtual_plane.is_some() || state.part_error.is_some()),
                "a virtual plane or a setting error",
            ),
            (names_axis && self.words.has(b'L') && state.modal.cycle.is_none(), "repeated moves"),
            (
                (has_terms || !names_axis) && state.length_offset != self.registers.state.length_offset,
                "a new tool length",
            ),
        ];
        match refused.iter().find(|(is_there, _)| *is_there) {
            Some((_, what)) => Err(Halt::unfollowed(*what)),
            None => Ok(()),
        }
    }

    /// Returns true if an axis word or a position depends on the ranges.
    fn moves_terms(&self) -> bool {
        let state = &self.registers.state;
        let positions = [&state.programmed_position, &state.machine_position];
        !self.terms.axes.is_empty()
            || positions.iter().any(|position| position.0.iter().any(|at| at.is_nan()))
    }

    /// Returns the ends of all axes that depend on the ranges, after the alarms of the block in the control's order.
    fn ends(&mut self) -> Symbolic<Vec<AxisEnd>> {
        let zero = Term::Number(0.0);
        if let Some(feed) = self.terms.feed
            && self.oracle.ask(Test::Compare(Relation::Lt, feed, zero))?
        {
            return self.alarm(Alarm::IllegalMinus { letter: 'F' }, b'F');
        }
        let axes: Vec<_> = self.registers.data.settings.axes.letters().collect();
        let mut ends = Vec::new();
        for (axis, letter) in &axes {
            let is_named = self.plan.skip_plan.is_none() && self.words.has(*letter);
            ends.push(match self.plan.commands_axes && is_named {
                true => self.end(*axis, *letter)?,
                false => self.unchanged(*axis),
            });
        }
        if self.plan.commands_axes {
            self.check_range(&ends, &axes)?;
            let cycle = self.cycle_words()?;
            let arc = self.arc_words(&ends)?;
            self.check_feed(arc.is_some())?;
            match (cycle, arc) {
                (Some(cycle), _) => self.drill(&cycle, &mut ends)?,
                (None, arc) => {
                    self.check_stroke(&ends)?;
                    self.check_stroke_of_arc(arc)?;
                }
            }
        }
        // An end that is known though it is computed of terms, as that of X#1 and X-#1 in G91, isn't the planned one.
        let planned = &self.plan.state;
        let is_planned = |end: &AxisEnd| {
            let is = |term: Option<Term>, at: f64| matches!(term, Some(Term::Number(value)) if value == at);
            is(end.programmed, planned.programmed_position[end.axis])
                && is(end.machine, planned.machine_position[end.axis])
        };
        ends.retain(|end| !is_planned(end));
        Ok(ends)
    }

    pub(super) fn alarm<R>(&self, alarm: Alarm, letter: u8) -> Symbolic<R> {
        let span = if self.words.has(letter) { self.words.span(letter) } else { self.span };
        Err(alarm.located_at(span).into())
    }

    /// Returns the end of an axis that the block doesn't name: where it was, if the control hasn't moved it.
    fn unchanged(&self, axis: AxisIndex) -> AxisEnd {
        let (before, after) = (&self.registers.state, &self.plan.state);
        let end = |before: f64, after: f64| Term::of(if before.is_nan() { before } else { after });
        AxisEnd {
            axis,
            programmed: end(before.programmed_position[axis], after.programmed_position[axis]),
            machine: end(before.machine_position[axis], after.machine_position[axis]),
        }
    }

    /// Returns the end of an axis that the block names.
    fn end(&mut self, axis: AxisIndex, letter: u8) -> Symbolic<AxisEnd> {
        let data = &self.registers.data;
        let term = self.terms.axes.iter().find(|(named, _)| *named == letter).map(|(_, term)| *term);
        let value = match term {
            Some(term) => self.dimension(term, letter)?,
            None => {
                let measure = data.measure(self.plan.state.modal.unit);
                let raw: WordNumber = self.words.values[usize::from(letter - b'A')].0;
                let value = data.dimension_of(&raw, letter, &measure);
                Term::Number(value.map_err(|alarm| alarm.located_at(self.words.span(letter)))?)
            }
        };
        let state = &self.registers.state;
        if data.settings.rolls_over[axis] {
            let is_known = value.number().is_some()
                && !state.programmed_position[axis].is_nan()
                && !state.machine_position[axis].is_nan();
            let known = |at: f64| if is_known { Term::of(at) } else { None };
            let (programmed, machine) =
                (self.plan.state.programmed_position[axis], self.plan.state.machine_position[axis]);
            return Ok(AxisEnd { axis, programmed: known(programmed), machine: known(machine) });
        }
        let programmed = match self.plan.state.modal.distance {
            Distance::Absolute => Some(value),
            Distance::Incremental => {
                let from = Term::of(state.programmed_position[axis]);
                from.map(|from| {
                    let sum = self.node(TermOperation::Add, from, value);
                    self.without_residue(sum)
                })
            }
        };
        let machine = programmed.map(|programmed| self.on_machine(axis, programmed));
        Ok(AxisEnd { axis, programmed, machine })
    }

    /// Returns a programmed coordinate without rounding errors as one of the machine.
    pub(super) fn on_machine(&mut self, axis: AxisIndex, programmed: Term) -> Term {
        let zero = self.registers.data.zero(&self.plan.state, axis);
        let length = self.plan.state.length_offset[axis];
        if zero == 0.0 && length == 0.0 {
            return programmed;
        }
        let shifted = self.node(TermOperation::Add, programmed, Term::Number(zero));
        let machine = self.node(TermOperation::Add, shifted, Term::Number(length));
        self.without_residue(machine)
    }

    /// Returns a word in mm or degrees, a multiple of the increment.
    pub(super) fn dimension(&mut self, term: Term, letter: u8) -> Symbolic<Term> {
        let scale = POWERS[self.registers.data.decimals(letter, self.plan.state.modal.unit)];
        let magnitude = self.node(TermOperation::Function(Function::Abs), term, term);
        if self.oracle.ask(Test::Compare(Relation::Gt, magnitude, Term::Number(SURELY_TOO_LARGE)))? {
            return self.alarm(Alarm::TooManyDigits(DigitLimit::Increments), letter);
        }
        let whole = self.node(TermOperation::Scaled(scale), term, term);
        let magnitude = self.node(TermOperation::Function(Function::Abs), whole, whole);
        if self.oracle.ask(Test::Compare(Relation::Gt, magnitude, Term::Number(MAX_INCREMENTS)))? {
            return self.alarm(Alarm::TooManyDigits(DigitLimit::Increments), letter);
        }
        let length = self.node(TermOperation::Divide, whole, Term::Number(scale));
        if !self.registers.data.measure(self.plan.state.modal.unit).is_inch(letter) {
            return Ok(length);
        }
        let length = self.node(TermOperation::Multiply, length, Term::Number(25.4));
        Ok(self.without_residue(length))
    }

    /// Returns the node of an operation, or its number if the operands are known.
    pub(super) fn node(&mut self, operation: TermOperation, left: Term, right: Term) -> Term {
        if let (Term::Number(left), Term::Number(right)) = (left, right) {
            let known = match operation {
                TermOperation::Add => Some(left + right),
                TermOperation::Subtract => Some(left - right),
                TermOperation::Multiply => Some(left * right),
                TermOperation::Divide => Some(left / right),
                TermOperation::Function(Function::Abs) => Some(left.abs()),
                TermOperation::Function(Function::Sqrt) => Some(left.sqrt()),
                _ => None,
            };
            if let Some(known) = known.filter(|known| known.is_finite()) {
                return Term::Number(known);
            }
        }
        self.oracle.terms.node(operation, [left, right])
    }

    /// Returns a coordinate without the rounding errors of sums.
    pub(super) fn without_residue(&mut self, term: Term) -> Term {
        if let Term::Number(value) = term {
            return Term::Number(self.registers.data.remove_residue(value));
        }
        let grid = coordinates::residue_grid(self.registers.data.settings.increment);
        self.oracle.without_residue(term, grid)
    }

    /// Raises the alarm of an axis beyond the largest coordinate.
    fn check_range(&mut self, ends: &[AxisEnd], axes: &[(AxisIndex, u8)]) -> Symbolic<()> {
        let settings = &self.registers.data.settings;
        let most = MAX_INCREMENTS / settings.increment.per_unit();
        for (end, (axis, letter)) in ends.iter().zip(axes) {
            let Some(machine @ Term::Node(_)) = end.machine else { continue };
            if settings.rolls_over[*axis] {
                continue;
            }
            let magnitude = self.node(TermOperation::Function(Function::Abs), machine, machine);
            if self.oracle.ask(Test::Compare(Relation::Gt, magnitude, Term::Number(most)))? {
                let value = self.oracle.terms.bounds(machine).1;
                return self.alarm(Alarm::PositionOverflow { letter: char::from(*letter), value }, *letter);
            }
        }
        Ok(())
    }

    /// Raises the alarm of a cut without a feed.
    fn check_feed(&mut self, is_arc: bool) -> Symbolic<()> {
        let state = &self.plan.state;
        let feeds = state.modal.motion != Motion::Rapid
            || self.plan.cycle_plan.is_some()
            || self.plan.skip_plan.is_some();
        if !feeds {
            return Ok(());
        }
        let depends = self.terms.feed.is_some() || state.modal_words.f.is_nan();
        let is_per_revolution = state.modal.feed_mode == FeedMode::PerRevolution;
        if is_per_revolution && (depends || self.terms.speed.is_some() || state.modal_words.s.is_nan()) {
            return Err(Halt::unfollowed("a feed in G95"));
        }
        if !depends {
            return Ok(());
        }
        let feed = self.terms.feed.or(Term::of(state.modal_words.f));
        let feed = feed.ok_or_else(|| Halt::unfollowed("the feed"))?;
        if self.oracle.ask(Test::Compare(Relation::Le, feed, Term::Number(0.0)))? {
            let alarm = if is_arc { Alarm::ArcFeedZero } else { Alarm::FeedZero };
            return Err(alarm.located_at(self.span).into());
        }
        Ok(())
    }

    /// Stored stroke check: raises the alarm of an end beyond the limits.
    pub(super) fn check_stroke(&mut self, ends: &[AxisEnd]) -> Symbolic<()> {
        let settings = &self.registers.data.settings;
        let Some(stroke) = settings.stroke_limits else { return Ok(()) };
        let start = &self.registers.state.machine_position;
        let is_outside = |axis: AxisIndex| {
            stroke.max[axis].is_some_and(|max| start[axis] > max)
                || stroke.min[axis].is_some_and(|min| start[axis] < min)
        };
        let starts_outside = (0..settings.axes.len()).any(is_outside);
        for end in ends {
            if settings.rolls_over[end.axis] {
                continue;
            }
            let letter = settings.axes.letter(end.axis);
            let limits = [(stroke.max[end.axis], Relation::Gt), (stroke.min[end.axis], Relation::Lt)];
            for (limit, relation) in limits {
                let Some(limit) = limit else { continue };
                let machine = end.machine.ok_or_else(|| Halt::unfollowed(format!("{letter} of a move")))?;
                if self.oracle.ask(Test::Compare(relation, machine, Term::Number(limit)))? {
                    // The control checks no move whose ends are one point after rounding.
                    if starts_outside {
                        return Err(Halt::unfollowed("a move from a position outside the stroke"));
                    }
                    let (low, high) = self.oracle.terms.bounds(machine);
                    let is_plus = relation == Relation::Gt;
                    let value = if is_plus { high } else { low };
                    let alarm = Alarm::Overtravel { letter, is_plus, value, limit };
                    return Err(alarm.located_at(self.span).into());
                }
            }
        }
        Ok(())
    }
}
