//! Macro statements of a symbolic run: assignments, branches and loops.
use super::super::evaluation::RoundingTarget;
use super::super::executor::Executor;
use super::super::functions::{integer, locate};
use super::super::loop_detection::LoopDetector;
use super::super::variables::{Accumulator, Value, VariableClass};
use super::expression::Evaluation;
use super::oracle::{Halt, Oracle, Symbolic};
use super::term::{SymbolicValue, Term, Terms, Test};
use gcode_lang::alarm::Alarm;
use gcode_lang::program::{Assign, AssignmentTarget, OpIndex, Operand, PrintPart, Program, Slot, Statement};
use gcode_lang::source::{Span, Spanned};
use gcode_lang::syntax::ast::Relation;

/// Block that is executed.
#[derive(Clone, Copy, Debug)]
pub(super) struct Place {
    pub(super) next: OpIndex,
    pub(super) span: Span,
}

impl Executor {
    /// Counts a block as begun.
    pub(super) fn begin(&mut self, place: Place) {
        self.log.blocks += 1;
        self.flow.frame.next = place.next + 1;
        self.flow.block = place.span;
    }

    pub(super) fn assign_direct<T: Terms>(
        &mut self,
        assign: &Assign,
        place: Place,
        oracle: &mut Oracle<'_, T>,
    ) -> Symbolic<()> {
        let value = self.value(&assign.code, oracle)?;
        self.begin(place);
        self.registers.variables.set_direct(assign.variable, Accumulator::from(value));
        Ok(())
    }

    /// Returns the value of code as a control stores it.
    fn value<T: Terms>(
        &self,
        code: &[gcode_lang::program::Instruction],
        oracle: &mut Oracle<'_, T>,
    ) -> Symbolic<Value> {
        let value = Evaluation::new(&self.registers, oracle).run_code(code, RoundingTarget::Increment)?;
        stored(value, oracle)
    }

    /// Executes one statement; the frame already points to the next block.
    pub(super) fn follow_statement<T: Terms>(
        &mut self,
        program: &Program,
        statement: &Statement,
        loop_detector: &mut LoopDetector,
        oracle: &mut Oracle<'_, T>,
    ) -> Symbolic<()> {
        let next = self.flow.frame.next;
        match statement {
            Statement::AssignDirect(assign) => {
                let value = self.value(&assign.code, oracle)?;
                self.registers.variables.set_direct(assign.variable, Accumulator::from(value));
            }
            Statement::Assign { target, target_span, value, text } => {
                let slot = match target {
                    AssignmentTarget::Slot(slot) => *slot,
                    AssignmentTarget::Computed(number) => {
                        let mut evaluation = Evaluation::new(&self.registers, oracle);
                        let number = evaluation.operand(number)?;
                        Slot::of(evaluation.variable_number(number, *target_span)?)
                    }
                };
                let value = Evaluation::new(&self.registers, oracle).operand(value)?;
                let value = stored(value, oracle)?;
                self.write_term(slot, value, text.as_deref(), *target_span, oracle)?;
            }
            Statement::Assignments(all) => {
                return all
                    .iter()
                    .try_for_each(|one| self.follow_statement(program, one, loop_detector, oracle));
            }
            Statement::Goto(to) => self.follow_goto(program, to, oracle)?,
            Statement::IfGoto { condition, to } => {
                if Evaluation::new(&self.registers, oracle).is_true(condition)? {
                    self.follow_goto(program, to, oracle)?;
                }
            }
            Statement::IfThen { condition, then } => {
                if Evaluation::new(&self.registers, oracle).is_true(condition)? {
                    return self.follow_statement(program, then, loop_detector, oracle);
                }
            }
            Statement::While { condition, number, end } => {
                let is_true = Evaluation::new(&self.registers, oracle).is_true(condition)?;
                self.begin_iteration(*number, *end, is_true);
            }
            Statement::Do { number, end } => self.begin_iteration(*number, *end, true),
            Statement::End { number, start } => {
                self.end_iteration(*number, *start)?;
                loop_detector.record_jump(self);
                return Ok(());
            }
            Statement::SetNames { first, .. } => {
                self.check_known(std::slice::from_ref(first), "SETVN", oracle)?;
                self.execute_statement_out_of_line(program, statement, loop_detector, &mut ())?;
            }
            Statement::Print { parts, .. } => {
                let values = parts.iter().filter_map(|part| match part {
                    PrintPart::Value { value, .. } => Some(value),
                    PrintPart::Text(_) => None,
                });
                self.check_known(values, "a printed number", oracle)?;
                self.execute_statement_out_of_line(program, statement, loop_detector, &mut ())?;
            }
            Statement::OpenOutput | Statement::CloseOutput | Statement::Alarm(_) => {
                self.execute_statement_out_of_line(program, statement, loop_detector, &mut ())?;
            }
        }
        if self.flow.frame.next < next {
            loop_detector.record_jump(self);
        }
        Ok(())
    }

    /// Refuses operands that depend on the ranges.
    fn check_known<'v, T: Terms>(
        &self,
        values: impl IntoIterator<Item = &'v Operand>,
        what: &str,
        oracle: &mut Oracle<'_, T>,
    ) -> Symbolic<()> {
        for value in values {
            if let SymbolicValue::Term(Term::Node(_)) =
                Evaluation::new(&self.registers, oracle).operand(value)?
            {
                return Err(Halt::unfollowed(what));
            }
        }
        Ok(())
    }

    fn follow_goto<T: Terms>(
        &mut self,
        program: &Program,
        to: &Spanned<Operand>,
        oracle: &mut Oracle<'_, T>,
    ) -> Symbolic<()> {
        let mut evaluation = Evaluation::new(&self.registers, oracle);
        let value = evaluation.operand(&to.node)?;
        let whole = match value {
            SymbolicValue::Term(node @ Term::Node(_)) => evaluation.rounded(node)?,
            value => {
                let number = stored(value, oracle)?.number();
                return Ok(self.jump_to_number(program, locate(integer(number), to.span)?, to.span)?);
            }
        };
        let is = |relation, limit| Test::Compare(relation, whole, Term::Number(limit));
        let (low, high) = oracle.terms.bounds(whole);
        if oracle.ask(is(Relation::Gt, 999_999_999_999.0))?
            || oracle.ask(is(Relation::Lt, -999_999_999_999.0))?
        {
            return Err(Alarm::IntegerOverflow.located_at(to.span).into());
        }
        let (below, above) =
            (oracle.ask(is(Relation::Lt, 1.0))?, oracle.ask(is(Relation::Gt, 99_999_999.0))?);
        if below || above {
            if self.registers.data.settings.undocumented.minus_searches_up {
                return Err(Halt::unfollowed("a jump to a negative number"));
            }
            let number = (if below { low } else { high }) as i64;
            return Err(Alarm::SequenceNumberRange { number }.located_at(to.span).into());
        }
        // A number that the program lacks raises the alarm of any such number.
        let missing = || (1..).find(|number| program.find_number(*number, 0).is_none()).unwrap_or(99_999_999);
        let number = oracle.sequence_number(program, whole)?.unwrap_or_else(missing);
        Ok(self.jump_to_number(program, i64::from(number), to.span)?)
    }

    /// Writes a variable.
    fn write_term<T: Terms>(
        &mut self,
        slot: Slot,
        value: Value,
        text: Option<&[u8]>,
        span: Span,
        oracle: &mut Oracle<'_, T>,
    ) -> Symbolic<()> {
        let number = slot.number();
        let is_stored = matches!(
            self.registers.variables.classify(number),
            VariableClass::Local(_) | VariableClass::Common(_)
        );
        let value = match value.as_number().map(Term::of) {
            _ if is_stored => value,
            Some(Some(Term::Node(node))) => match number {
                3000 => Value::Number(oracle.pin(Term::Node(node))?),
                // The stop takes no number.
                3006 => Value::Number(1.0),
                _ => return Err(Halt::unfollowed(format!("what #{number} is set to"))),
            },
            Some(None) => return Err(Halt::unfollowed(format!("what #{number} is set to"))),
            _ => value,
        };
        self.write(slot, value, text, span, &mut ())?;
        // Signals, switches, messages and counters shift nothing.
        if !is_stored && !matches!(number, 1000..=1199 | 3000..=3999) {
            self.registers.forget_shifted_positions();
        }
        Ok(())
    }
}

/// Returns a value as a control stores it.
fn stored<T: Terms>(value: SymbolicValue, oracle: &mut Oracle<'_, T>) -> Symbolic<Value> {
    match value {
        SymbolicValue::Truth(formula) => Ok(Value::Number(if oracle.is_true(&formula)? { 1.0 } else { 0.0 })),
        value => value.stored().ok_or_else(|| Halt::unfollowed("a condition as a number")),
    }
}
