//! AND, OR and XOR of whole numbers that depend on the ranges, with the alarms of the control.
use super::expression::Evaluation;
use super::oracle::Symbolic;
use super::term::{Term, TermOperation, Terms, Test};
use gcode_lang::alarm::Alarm;
use gcode_lang::source::Span;
use gcode_lang::syntax::ast::{BinaryOp, Relation};

/// Largest number of values of an operand that are ways of their own.
const MAX_WAYS: f64 = 64.0;

/// Largest number of 32 bits.
const MAX_BITS: f64 = u32::MAX as f64;

impl<T: Terms> Evaluation<'_, '_, T> {
    /// Computes AND, OR or XOR: of few values exactly, each on a way of its own, else within the bounds of their bits.
    pub(super) fn bitwise(&mut self, op: BinaryOp, left: Term, right: Term, span: Span) -> Symbolic<Term> {
        let (left, right) = (self.rounded(left)?, self.rounded(right)?);
        let mut width = |term: Term| {
            let (low, high) = self.oracle.terms.bounds(term);
            high - low
        };
        if width(left) <= MAX_WAYS && width(right) <= MAX_WAYS {
            let (left, right) = (self.oracle.pin(left)?, self.oracle.pin(right)?);
            return self.combine(op, Term::Number(left), Term::Number(right), span);
        }
        self.check_bits(left, span)?;
        self.check_bits(right, span)?;
        Ok(self.oracle.terms.node(TermOperation::Bits(op), [left, right]))
    }

    /// Raises the alarms of an operand that isn't a number of 32 bits.
    fn check_bits(&mut self, whole: Term, span: Span) -> Symbolic<()> {
        let is = |relation, limit| Test::Compare(relation, whole, Term::Number(limit));
        let (low, high) = self.oracle.terms.bounds(whole);
        if self.registers.data.settings.undocumented.negative_bits_alarm
            && self.oracle.ask(is(Relation::Lt, 0.0))?
        {
            let function = "AND, OR, XOR".into();
            return Err(Alarm::OutOfRange { function, value: low.min(high) }.located_at(span).into());
        }
        if self.oracle.ask(is(Relation::Lt, f64::from(i32::MIN)))?
            || self.oracle.ask(is(Relation::Gt, MAX_BITS))?
        {
            return Err(Alarm::IntegerOverflow.located_at(span).into());
        }
        Ok(())
    }
}
