//! Canned cycles of a symbolic run: levels and holes that depend on the ranges, where the cycle ends, and its alarms.
use super::super::cycle_expansion::MAX_PECKS;
use super::super::plan::BlockPlan;
use super::super::state::{CycleLevel, CycleState};
use super::moves::{AxisEnd, MoveBlock};
use super::oracle::{Halt, Symbolic};
use super::term::{Term, TermOperation, Terms, Test};
use gcode_lang::alarm::Alarm;
use gcode_lang::motion::AxisIndex;
use gcode_lang::program::cycles::CycleStep;
use gcode_lang::program::modes::{Distance, ReturnTo};
use gcode_lang::syntax::ast::{Function, Relation};

/// Largest number of moves of one peck.
const MOVES_PER_PECK: u64 = 3;

impl CycleState {
    /// Returns the levels and the peck, which may depend on the ranges.
    pub(super) fn levels(&self) -> [f64; 4] {
        [self.initial, self.r.value, self.z.value, self.q.unwrap_or(0.0)]
    }
}

/// Levels of a cycle in programmed coordinates, as terms.
pub(super) struct CycleTerms {
    axis: AxisIndex,
    initial: Term,
    r: Term,
    z: Term,
    /// Depth of a peck, of a cycle with pecks.
    peck: Option<Term>,
}

impl<T: Terms> MoveBlock<'_, '_, T> {
    /// Returns true if no level of the cycle depends on the ranges, nor where its axis is.
    pub(super) fn has_known_levels(&self) -> bool {
        let state = &self.plan.state;
        let Some(axis) = self.plan.cycle_plan.as_ref().map(|cycle| cycle.axis).or(state.cycle.axis) else {
            return false;
        };
        let letter = self.registers.data.settings.axes.letter(axis) as u8;
        let before = &self.registers.state;
        self.terms.axes.iter().all(|(named, _)| *named != letter)
            && self.terms.lengths.is_empty()
            && !before.programmed_position[axis].is_nan()
            && !before.machine_position[axis].is_nan()
            && state.cycle.levels().iter().all(|level| !level.is_nan())
    }

    /// Returns true for a cycle whose end and alarms are followed.
    pub(super) fn is_followed_cycle(&self) -> bool {
        let (state, settings) = (&self.plan.state, &self.registers.data.settings);
        let Some(cycle) = state.modal.cycle else { return false };
        let has_limits = settings.stroke_limits.is_some();
        // K of a cycle is a number of holes; I and J shift or shorten.
        !self.terms.lengths.iter().any(|(letter, _)| matches!(letter, b'I' | b'J' | b'K'))
            && state.cycle.pecks.is_none()
            && state.cycle.depth_to_retract.is_none()
            && !(cycle.taps() && (self.terms.speed.is_some() || state.modal_words.s.is_nan()))
            && !(has_limits && cycle.steps.contains(&CycleStep::Shift))
            && !(has_limits && cycle.needs_q && settings.g83_above_r != 0.0)
            && cycle.rapids_to_r_first
    }

    /// Returns the levels of a cycle, after the alarms of their words; `None` for another block.
    pub(super) fn cycle_words(&mut self) -> Symbolic<Option<CycleTerms>> {
        let state = &self.plan.state;
        let Some(cycle) = state.modal.cycle.filter(|_| self.commands_move()) else { return Ok(None) };
        let Some(axis) = self.plan.cycle_plan.as_ref().map(|plan| plan.axis) else {
            return Err(Halt::unfollowed("a canned cycle without a hole"));
        };
        let letter = self.registers.data.settings.axes.letter(axis) as u8;
        let words = [self.length(b'R')?, self.length(letter)?, self.length(b'Q')?];
        let magnitude = TermOperation::Function(Function::Abs);
        let [r, z, q] = words;
        let q = q.map(|q| self.node(magnitude, q, q));
        let stored = &mut self.plan.state.cycle;
        for (level, word) in [(&mut stored.r.value, r), (&mut stored.z.value, z)] {
            *level = word.map_or(*level, Term::stored);
        }
        stored.q = q.map(Term::stored).or(stored.q);
        let CycleState { initial, r, z, q, .. } = *stored;
        let known = |level: f64| Term::of(level).ok_or_else(|| Halt::unfollowed("a canned cycle"));
        let initial = known(initial)?;
        let r = self.level(r, initial)?;
        let z = self.level(z, r)?;
        let peck = match (cycle.needs_q, q) {
            (true, Some(q)) => Some(known(q)?),
            _ => None,
        };
        if let Some(peck @ Term::Node(_)) = peck
            && self.oracle.ask(Test::Compare(Relation::Eq, peck, Term::Number(0.0)))?
        {
            return Err(Alarm::NoPeckDepth.located_at(self.span).into());
        }
        Ok(Some(CycleTerms { axis, initial, r, z, peck }))
    }

    /// Returns a length of the block that depends on the ranges.
    pub(super) fn length(&mut self, letter: u8) -> Symbolic<Option<Term>> {
        let all = self.terms.lengths.iter().chain(&self.terms.axes);
        let term = all.copied().find_map(|(named, term)| (named == letter).then_some(term));
        term.map(|term| self.dimension(term, letter)).transpose()
    }

    /// Returns a level that counts from another one in G91.
    fn level(&mut self, level: CycleLevel, from: Term) -> Symbolic<Term> {
        let value = Term::of(level.value).ok_or_else(|| Halt::unfollowed("a canned cycle"))?;
        Ok(if level.is_incremental { self.node(TermOperation::Add, from, value) } else { value })
    }

    /// Puts the axes where the cycle ends, after the alarms of its pecks and of the stroke.
    pub(super) fn drill(&mut self, cycle: &CycleTerms, ends: &mut [AxisEnd]) -> Symbolic<()> {
        let holes = self.plan.cycle_plan.as_ref().map_or(1, |plan| plan.holes.len());
        if let Some(pecks @ Term::Node(_)) = self.pecks(cycle) {
            let most = (f64::from(MAX_PECKS) / holes as f64).floor();
            if self.oracle.ask(Test::Compare(Relation::Gt, pecks, Term::Number(most)))? {
                let what = "more than a million pecks in one block".into();
                return Err(Alarm::NotSimulated { what }.located_at(self.span).into());
            }
        }
        let start = self.registers.state.machine_position[cycle.axis];
        if self.registers.data.settings.stroke_limits.is_some() {
            if holes > 1 {
                return Err(Halt::unfollowed("repeated holes within stroke limits"));
            }
            // Each hole is reached at the height of the tool.
            for at in [Term::of(start), Some(self.machine_level(cycle.axis, cycle.r))]
                .into_iter()
                .chain([cycle.z, cycle.initial].map(|level| Some(self.machine_level(cycle.axis, level))))
            {
                let at_level = |end: &AxisEnd| match end.axis == cycle.axis {
                    true => AxisEnd { machine: at, ..*end },
                    false => *end,
                };
                let points: Vec<_> = ends.iter().map(at_level).collect();
                self.check_stroke(&points)?;
            }
        }
        for end in ends.iter_mut() {
            if end.axis == cycle.axis {
                let to_r = self.plan.state.modal.return_to == ReturnTo::R;
                let level = if to_r { cycle.r } else { cycle.initial };
                (end.programmed, end.machine) = (Some(level), Some(self.machine_level(cycle.axis, level)));
            } else if holes > 1 {
                self.repeat(end, holes);
            }
        }
        Ok(())
    }

    /// Moves the end of an axis to the last of several holes.
    fn repeat(&mut self, end: &mut AxisEnd, holes: usize) {
        if self.registers.data.settings.rolls_over[end.axis] {
            let is_known = |at: Option<Term>| at.is_some_and(|at| at.number().is_some());
            if !is_known(end.programmed) || !is_known(end.machine) {
                (end.programmed, end.machine) = (None, None);
            }
            return;
        }
        let start = Term::of(self.registers.state.programmed_position[end.axis]);
        let (Some(first), Some(start)) = (end.programmed, start) else {
            (end.programmed, end.machine) = (None, None);
            return;
        };
        let last = match self.plan.state.modal.distance {
            Distance::Absolute => first,
            Distance::Incremental => {
                let step = self.node(TermOperation::Subtract, first, start);
                let repeats = Term::Number((holes - 1) as f64);
                let travel = self.node(TermOperation::Multiply, repeats, step);
                self.node(TermOperation::Add, first, travel)
            }
        };
        let last = self.without_residue(last);
        (end.programmed, end.machine) = (Some(last), Some(self.on_machine(end.axis, last)));
    }

    /// Returns a level of a cycle in machine coordinates.
    fn machine_level(&mut self, axis: AxisIndex, level: Term) -> Term {
        let level = self.without_residue(level);
        self.on_machine(axis, level)
    }

    /// Returns the number of pecks of a hole before it is rounded up; `None` without pecks.
    fn pecks(&mut self, cycle: &CycleTerms) -> Option<Term> {
        let peck = cycle.peck?;
        let travel = self.node(TermOperation::Subtract, cycle.z, cycle.r);
        let depth = self.node(TermOperation::Function(Function::Abs), travel, travel);
        let count = self.node(TermOperation::Divide, depth, peck);
        Some(self.node(TermOperation::Subtract, count, Term::Number(1e-9)))
    }

    /// Returns the largest number of moves of pecks that the control doesn't count, as their levels depend on the ranges.
    pub(super) fn uncounted_pecks(&mut self) -> u64 {
        let BlockPlan { state, cycle_plan, .. } = &*self.plan;
        let Some(plan) = cycle_plan.as_ref().filter(|plan| plan.cycle.needs_q) else { return 0 };
        if state.cycle.levels().iter().all(|level| !level.is_nan()) {
            return 0;
        }
        let (axis, holes, CycleState { initial, r, z, q, .. }) = (plan.axis, plan.holes.len(), state.cycle);
        let most = u64::from(MAX_PECKS) * MOVES_PER_PECK;
        let (Some(initial), Some(peck)) = (Term::of(initial), q.and_then(Term::of)) else { return most };
        let Ok(r) = self.level(r, initial) else { return most };
        let Ok(z) = self.level(z, r) else { return most };
        match self.pecks(&CycleTerms { axis, initial, r, z, peck: Some(peck) }) {
            Some(pecks @ Term::Node(_)) => {
                let pecks = self.oracle.terms.bounds(pecks).1.max(1.0).ceil();
                most.min(((pecks * holes as f64) as u64).saturating_mul(MOVES_PER_PECK))
            }
            Some(Term::Number(_)) | None => most,
        }
    }
}
