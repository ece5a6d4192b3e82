//! Positions of a symbolic run that a program reads: #5001…, #5021… and #5041… after words that depend on the ranges.
use super::super::coordinates;
use super::expression::Evaluation;
use super::oracle::Oracle;
use super::term::{Term, TermOperation, Terms};
use gcode_lang::motion::AxisIndex;
use gcode_lang::syntax::ast::Function;

impl<T: Terms> Oracle<'_, T> {
    /// Returns a coordinate without the rounding errors of sums, as the control rounds it.
    pub(super) fn without_residue(&mut self, term: Term, grid: f64) -> Term {
        let grid = Term::Number(grid);
        let product = self.terms.node(TermOperation::Multiply, [term, grid]);
        let whole = self.terms.node(TermOperation::Function(Function::Round), [product, product]);
        self.terms.node(TermOperation::Divide, [whole, grid])
    }
}

impl<T: Terms> Evaluation<'_, '_, T> {
    /// Returns the term of #5001, #5021 or #5041 and those that follow; `None` if it isn't followed.
    pub(super) fn position(&mut self, number: u32) -> Option<Term> {
        let axis = number.checked_sub(5001)? as AxisIndex % 20;
        let position = match number {
            5001..=5020 if self.shows_programmed_position() => {
                let programmed = &self.registers.state.programmed_position;
                programmed.0.get(axis).copied().and_then(Term::of)
            }
            5021..=5040 => self.tool_centre(axis),
            5041..=5060 => self.work_coordinate(axis),
            _ => None,
        };
        position.map(|position| self.in_program_unit(axis, position))
    }

    /// Returns a position in mm or degrees in the active unit.
    fn in_program_unit(&mut self, axis: AxisIndex, position: Term) -> Term {
        let axes = &self.registers.data.settings.axes;
        if !self.registers.is_inch() || axis >= axes.len() || axes.is_rotary(axis) {
            return position;
        }
        match position {
            Term::Number(value) => Term::Number(value / 25.4),
            Term::Node(_) => self.oracle.terms.node(TermOperation::Divide, [position, Term::Number(25.4)]),
        }
    }

    /// Returns true if #5001… show the programmed position as it is stored.
    fn shows_programmed_position(&self) -> bool {
        let registers = self.registers;
        !registers.data.settings.undocumented.shows_transformed
            && registers.state.end_before_transform.is_none()
    }

    /// Returns the machine position of an axis.
    fn tool_centre(&self, axis: AxisIndex) -> Option<Term> {
        let registers = self.registers;
        let is_plain = registers.state.virtual_plane.is_none()
            && registers.lookahead.machine_offset()[axis] == 0.0
            && !registers.data.settings.rolls_over[axis];
        Term::of(registers.state.machine_position[axis]).filter(|_| is_plain)
    }

    /// Returns the machine position of an axis in the active work coordinates.
    fn work_coordinate(&mut self, axis: AxisIndex) -> Option<Term> {
        let machine = self.tool_centre(axis)?;
        let registers = self.registers;
        let zero = registers.data.zero(&registers.state, axis);
        let shifted = match zero == 0.0 {
            true => machine,
            false => self.oracle.terms.node(TermOperation::Subtract, [machine, Term::Number(zero)]),
        };
        let grid = coordinates::residue_grid(registers.data.settings.increment);
        Some(self.oracle.without_residue(shifted, grid))
    }
}
