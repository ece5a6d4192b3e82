//! Joins of runs that continue alike: one state for the values that the variables have in any of them.
use super::super::executor::Executor;
use super::super::variables::Value;
use super::term::Term;
use super::{Snapshot, SymbolicRun};
use gcode_lang::program::{OpIndex, ProgramId};

impl SymbolicRun {
    /// Returns the number of callers, the program and its next block.
    pub fn position(&self) -> (usize, ProgramId, OpIndex) {
        let flow = &self.control.executor.flow;
        (flow.callers.len(), flow.frame.program, flow.frame.next)
    }
}

impl Snapshot {
    /// Returns true if the same blocks follow two states and they differ in variables alone.
    ///
    /// Positions that depend on the ranges equal no others.
    pub fn continues_like(&self, other: &Self) -> bool {
        let (these, those) = (&self.0.registers, &other.0.registers);
        let counts_passes = these.data.settings.main_program_cycles.is_some();
        self.0.flow.continues_like(&other.0.flow, counts_passes)
            && these.continues_like_but_for_variables(those)
    }

    /// Returns the state of several that continue alike.
    ///
    /// `join` gives the value of a variable from its slot and its values in each state; it is asked where these differ or
    /// depend on the ranges. The state has executed as many blocks as the longest of them. `None` if a variable is vacant in
    /// some states alone, or isn't followed, or `join` gives no value.
    pub fn joined(states: &[&Self], join: &mut impl FnMut(usize, &[Term]) -> Option<Term>) -> Option<Self> {
        let (first, others) = states.split_first()?;
        let others: Vec<_> = others.iter().map(|state| &state.0.registers.variables).collect();
        let variables =
            first.0.registers.variables.joined(&others, &mut |slot: usize, values: &[Value]| {
                let terms = values.iter().map(|value| value.as_number().and_then(Term::of));
                let terms: Option<Vec<_>> = terms.collect();
                join(slot, &terms?).map(|term| Value::Number(term.stored()))
            })?;
        let mut executor: Executor = (*first.0).clone();
        executor.registers.variables = variables;
        let logs = || states.iter().map(|state| &state.0.log);
        executor.log.blocks = logs().map(|log| log.blocks).max()?;
        executor.log.moves = logs().map(|log| log.moves).max()?;
        Some(Self(Box::new(executor)))
    }
}
