//! Functions of terms with their domains: the alarms that the control raises outside them.
use super::super::functions::function_alarm;
use super::expression::Evaluation;
use super::oracle::{Halt, Symbolic};
use super::term::{Term, TermOperation, Terms, Test};
use gcode_lang::source::Span;
use gcode_lang::syntax::ast::{Function, Relation};

impl<T: Terms> Evaluation<'_, '_, T> {
    /// Computes a function of a node.
    pub(super) fn function_of_node(&mut self, name: Function, x: Term, span: Span) -> Symbolic<Term> {
        match name {
            Function::Abs
            | Function::Round
            | Function::Fix
            | Function::Fup
            | Function::Atan
            | Function::Sin
            | Function::Cos => Ok(self.apply(name, x)),
            Function::Sqrt => {
                self.refuse(name, Relation::Lt, x, 0.0, span)?;
                Ok(self.apply(name, x))
            }
            Function::Asin | Function::Acos => {
                self.refuse(name, Relation::Lt, x, -1.0, span)?;
                self.refuse(name, Relation::Gt, x, 1.0, span)?;
                Ok(self.apply(name, x))
            }
            Function::Ln => {
                self.refuse(name, Relation::Le, x, 0.0, span)?;
                Ok(self.apply(name, x))
            }
            Function::Tan if self.registers.data.settings.undocumented.tan_90_alarms => {
                Err(Halt::unfollowed("TAN on a control where TAN[90] is an alarm"))
            }
            Function::Exp | Function::Tan => self.finite(name, x, span),
            Function::Bin | Function::Bcd => {
                let number = self.oracle.pin(x)?;
                let settings = &self.registers.data.settings;
                let value = super::super::functions::function(name, number, settings);
                Ok(Term::Number(super::super::functions::locate(value, span)?))
            }
            Function::Adp | Function::Pow => Err(function_alarm(name, 0.0).located_at(span).into()),
        }
    }

    fn apply(&mut self, name: Function, x: Term) -> Term {
        self.oracle.terms.node(TermOperation::Function(name), [x, x])
    }

    /// Raises the alarm of a function for the arguments that stand in a relation to a limit.
    fn refuse(
        &mut self,
        name: Function,
        relation: Relation,
        x: Term,
        limit: f64,
        span: Span,
    ) -> Symbolic<()> {
        if self.oracle.ask(Test::Compare(relation, x, Term::Number(limit)))? {
            let value = self.oracle.terms.bounds(x).0;
            return Err(function_alarm(name, value).located_at(span).into());
        }
        Ok(())
    }

    /// Computes a function whose result may overflow.
    fn finite(&mut self, name: Function, x: Term, span: Span) -> Symbolic<Term> {
        let value = self.apply(name, x);
        if self.oracle.ask(Test::Finite(value))? {
            return Ok(value);
        }
        Err(function_alarm(name, self.oracle.terms.bounds(x).1).located_at(span).into())
    }
}
