//! Arcs of a symbolic run: centres and radii that depend on the ranges, with the alarms that they can raise.
use super::super::arcs::centre_letters;
use super::super::data::ControlData;
use super::super::state::State;
use super::SymbolicRun;
use super::moves::{AxisEnd, MoveBlock};
use super::oracle::{Halt, Symbolic};
use super::term::{Term, TermOperation, Terms, Test};
use super::words::BlockTerms;
use gcode_lang::alarm::Alarm;
use gcode_lang::motion::AxisIndex;
use gcode_lang::program::modes::FeedMode;
use gcode_lang::syntax::ast::{Function, Relation};

/// Part of the largest coordinate that bounds the rounding errors of a radius many times over.
const ROUNDING: f64 = 1e-14;

/// Largest coordinate at which the centre by R is equally far from both ends within the control's own margin.
const LARGEST_BY_RADIUS: f64 = 1e4;

impl State {
    /// Returns both axes of an arc's plane.
    fn arc_plane(&self, data: &ControlData) -> Option<(AxisIndex, AxisIndex)> {
        data.active_plane(self).ok()
    }
}

/// Circle of an arc, as terms.
pub(super) struct CircleTerms {
    plane: (AxisIndex, AxisIndex),
    /// Programmed centre and radius; `None` for an arc by R.
    centre: Option<((Term, Term), Term)>,
}

impl SymbolicRun {
    /// Returns true if the planned arc's start, end or centre depends on the ranges.
    pub(super) fn is_arc_of_terms(&self, terms: &BlockTerms) -> bool {
        let (registers, state) = (&self.control.executor.registers, &self.control.plan.state);
        let Some((first, second)) = state.arc_plane(&registers.data) else { return true };
        let axes = &registers.data.settings.axes;
        let depends = |axis: AxisIndex| {
            registers.state.programmed_position[axis].is_nan()
                || registers.state.machine_position[axis].is_nan()
                || terms.axes.iter().any(|(letter, _)| *letter == axes.letter(axis) as u8)
        };
        !terms.lengths.is_empty() || depends(first) || depends(second)
    }
}

impl<T: Terms> MoveBlock<'_, '_, T> {
    /// Returns true for a block that takes I, J, K, R or Q that depend on the ranges: an arc, or a cycle.
    pub(super) fn takes_lengths(&self) -> bool {
        let is_cycle = self.plan.state.modal.cycle.is_some();
        let of_arc = || self.terms.lengths.iter().all(|(letter, _)| *letter != b'Q');
        self.commands_move() && (is_cycle || self.plan.state.moves_on_arc() && of_arc())
    }

    /// Returns the circle of an arc, after the alarms of its centre and radius; `None` for another block.
    pub(super) fn arc_words(&mut self, ends: &[AxisEnd]) -> Symbolic<Option<CircleTerms>> {
        let state = &self.plan.state;
        if !state.moves_on_arc() || !self.words.has_any(b"IJKR") {
            return Ok(None);
        }
        let data = &self.registers.data;
        let plane = state.arc_plane(data).ok_or_else(|| Halt::unfollowed("the plane of an arc"))?;
        if data.settings.rolls_over[plane.0] || data.settings.rolls_over[plane.1] {
            return Err(Halt::unfollowed("an arc of an axis that rolls over"));
        }
        let start = [plane.0, plane.1].map(|axis| Term::of(self.registers.state.programmed_position[axis]));
        let end = [plane.0, plane.1]
            .map(|axis| ends.iter().find(|end| end.axis == axis).and_then(|end| end.programmed));
        let ([Some(x), Some(y)], [Some(end_x), Some(end_y)]) = (start, end) else {
            return Err(Halt::unfollowed("an arc from or to a position that isn't followed"));
        };
        let travel =
            (self.node(TermOperation::Subtract, end_x, x), self.node(TermOperation::Subtract, end_y, y));
        if self.words.has(b'R') {
            self.check_radius([x, y, end_x, end_y], travel)?;
            return Ok(Some(CircleTerms { plane, centre: None }));
        }
        let [first, second, stray] = centre_letters(self.plan.state.modal.plane);
        let zero = Term::Number(0.0);
        if let Some(stray_length) = self.arc_length(stray)?
            && self.ask_ne(stray_length, zero)?
        {
            return self.alarm(Alarm::PlaneSelect, stray);
        }
        let (i, j) = (self.arc_length(first)?, self.arc_length(second)?);
        let (i, j) = (i.unwrap_or(zero), j.unwrap_or(zero));
        if !self.ask_ne(i, zero)? && !self.ask_ne(j, zero)? {
            return Err(Alarm::NoRadiusOrCentre.located_at(self.span).into());
        }
        let radius = self.hypotenuse((i, j));
        // From the end to the centre.
        let back = (
            self.node(TermOperation::Subtract, travel.0, i),
            self.node(TermOperation::Subtract, travel.1, j),
        );
        let is_circle = (end_x, end_y) == (x, y);
        if !is_circle {
            let end_radius = self.hypotenuse(back);
            let difference = self.node(TermOperation::Subtract, radius, end_radius);
            let difference = self.node(TermOperation::Function(Function::Abs), difference, difference);
            let margin = self.margin(&[x, y, end_x, end_y, i, j]);
            let tolerance = self.registers.data.settings.arc_tolerance;
            if self.exceeds(difference, tolerance + 1e-9, margin)? {
                let (start, end) =
                    (self.oracle.terms.bounds(radius).1, self.oracle.terms.bounds(end_radius).1);
                let alarm = Alarm::RadiusTolerance { start, end, tolerance };
                return Err(alarm.located_at(self.span).into());
            }
        }
        let centre = (self.node(TermOperation::Add, x, i), self.node(TermOperation::Add, y, j));
        Ok(Some(CircleTerms { plane, centre: Some((centre, radius)) }))
    }

    /// Returns I, J or K.
    fn arc_length(&mut self, letter: u8) -> Symbolic<Option<Term>> {
        if !self.words.has(letter) {
            return Ok(None);
        }
        match self.length(letter)? {
            Some(term) => Ok(Some(term)),
            None => self.known_length(letter).map(Some),
        }
    }

    /// Raises the alarms of an arc by R.
    fn check_radius(&mut self, points: [Term; 4], travel: (Term, Term)) -> Symbolic<()> {
        let zero = Term::Number(0.0);
        if !self.ask_ne(travel.0, zero)? && !self.ask_ne(travel.1, zero)? {
            return Err(Halt::unfollowed("an arc by R that ends at its start"));
        }
        let radius = match self.length(b'R')? {
            Some(term) => term,
            None => self.known_length(b'R')?,
        };
        let magnitude = self.node(TermOperation::Function(Function::Abs), radius, radius);
        let chord = self.hypotenuse(travel);
        let small = |block: &mut Self| {
            let [radius, chord] = [magnitude, chord].map(|term| block.oracle.terms.bounds(term).1);
            block.alarm(Alarm::RadiusTooSmall { radius, half_chord: chord / 2.0 }, b'R')
        };
        if !self.ask_ne(radius, zero)? {
            return small(self);
        }
        let [a, b, c, d] = points;
        let margin = self.margin(&[a, b, c, d, radius]);
        let settings = &self.registers.data.settings;
        let (tolerance, alarms) = (settings.arc_tolerance, settings.undocumented.small_radius_alarms);
        let half = self.node(TermOperation::Divide, chord, Term::Number(2.0));
        let short = self.node(TermOperation::Subtract, half, magnitude);
        if !alarms {
            let is_short = self.exceeds(short, 0.0, margin)?;
            return if is_short {
                Err(Halt::unfollowed("an arc by a short R"))
            } else {
                self.check_known_feed()
            };
        }
        if self.exceeds(short, tolerance, margin)? {
            return small(self);
        }
        // Both ends are on the circle but for rounding, or half the missing length off it.
        let largest = self.largest(&[a, b, c, d, radius]);
        if largest > LARGEST_BY_RADIUS {
            return Err(Halt::unfollowed("an arc by R with large coordinates"));
        }
        self.check_known_feed()
    }

    /// Raises the alarm of an arc by R without a feed: the plan has no move where the numbers in the place of terms end at the
    /// start, and doesn't look at the feed then.
    fn check_known_feed(&self) -> Symbolic<()> {
        let state = &self.plan.state;
        if state.modal.feed_mode != FeedMode::PerMinute {
            return Err(Halt::unfollowed("an arc by R in G93 or G95"));
        }
        if self.terms.feed.is_none() && state.modal_words.f <= 0.0 {
            return Err(Alarm::ArcFeedZero.located_at(self.span).into());
        }
        Ok(())
    }

    /// Returns a known length of the block.
    fn known_length(&self, letter: u8) -> Symbolic<Term> {
        let data = &self.registers.data;
        let measure = data.measure(self.plan.state.modal.unit);
        let (raw, span) = self.words.values[usize::from(letter - b'A')];
        let value = data.dimension_of(&raw, letter, &measure);
        Ok(Term::Number(value.map_err(|alarm| alarm.located_at(span))?))
    }

    fn ask_ne(&mut self, left: Term, right: Term) -> Symbolic<bool> {
        match (left, right) {
            (Term::Number(left), Term::Number(right)) => Ok(left != right),
            _ => self.oracle.ask(Test::Compare(Relation::Ne, left, right)),
        }
    }

    /// Returns whether a term that the control computes in another order exceeds a limit; near it that isn't followed.
    fn exceeds(&mut self, term: Term, limit: f64, margin: f64) -> Symbolic<bool> {
        let mut ask = |relation, limit| match term {
            Term::Number(number) if relation == Relation::Lt => Ok(number < limit),
            Term::Number(number) => Ok(number > limit),
            Term::Node(_) => self.oracle.ask(Test::Compare(relation, term, Term::Number(limit))),
        };
        if ask(Relation::Lt, limit - margin)? {
            return Ok(false);
        }
        if ask(Relation::Gt, limit + margin)? {
            return Ok(true);
        }
        Err(Halt::unfollowed("an arc at the limit of its radius"))
    }

    fn hypotenuse(&mut self, (x, y): (Term, Term)) -> Term {
        let [xx, yy] = [x, y].map(|side| self.node(TermOperation::Multiply, side, side));
        let sum = self.node(TermOperation::Add, xx, yy);
        self.node(TermOperation::Function(Function::Sqrt), sum, sum)
    }

    /// Returns a bound of the magnitudes of terms.
    fn largest(&mut self, terms: &[Term]) -> f64 {
        let magnitude = |term: &Term| match *term {
            Term::Number(number) => number.abs(),
            Term::Node(_) => {
                let (low, high) = self.oracle.terms.bounds(*term);
                low.abs().max(high.abs())
            }
        };
        terms.iter().map(magnitude).fold(0.0, f64::max)
    }

    /// Returns a margin for the roundings of lengths computed of terms.
    fn margin(&mut self, terms: &[Term]) -> f64 {
        (1.0 + self.largest(terms)) * ROUNDING
    }

    /// Stored stroke check of an arc: followed where its whole circle is inside.
    pub(super) fn check_stroke_of_arc(&mut self, arc: Option<CircleTerms>) -> Symbolic<()> {
        let (Some(arc), Some(stroke)) = (arc, self.registers.data.settings.stroke_limits) else {
            return Ok(());
        };
        let near = || Halt::unfollowed("an arc near the end of the stroke");
        let (centre, radius) = arc.centre.ok_or_else(near)?;
        for (axis, centre) in [(arc.plane.0, centre.0), (arc.plane.1, centre.1)] {
            let shift =
                self.registers.data.zero(&self.plan.state, axis) + self.plan.state.length_offset[axis];
            let margin = 100.0 * self.margin(&[centre, radius, Term::Number(shift)]);
            let [low, high] = [TermOperation::Subtract, TermOperation::Add]
                .map(|operation| self.node(operation, centre, radius));
            let ends = [
                (low, Relation::Gt, stroke.min[axis].map(|limit| limit - shift + margin)),
                (high, Relation::Lt, stroke.max[axis].map(|limit| limit - shift - margin)),
            ];
            for (end, relation, limit) in ends {
                let Some(limit) = limit else { continue };
                if !self.oracle.ask(Test::Compare(relation, end, Term::Number(limit)))? {
                    return Err(near());
                }
            }
        }
        Ok(())
    }
}
