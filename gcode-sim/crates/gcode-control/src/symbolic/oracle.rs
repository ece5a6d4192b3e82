//! Answers to the questions of a block: those that hold over all ranges, and those of the way that is followed.
use super::term::{Formula, Term, TermOperation, Terms, Test};
use gcode_lang::alarm::LocatedAlarm;
use gcode_lang::program::Program;
use gcode_lang::syntax::ast::{BinaryOp, Function, Relation};

/// Reason why a block isn't executed.
#[derive(Clone, Debug)]
pub enum Halt {
    /// The block needs the answer to a question.
    Fork(Test),
    /// The block raises an alarm.
    Alarm(LocatedAlarm),
    /// Something depends on the ranges and isn't followed.
    Unfollowed(String),
}

impl Halt {
    pub(super) fn unfollowed(what: impl Into<String>) -> Self {
        Self::Unfollowed(what.into())
    }
}

impl From<LocatedAlarm> for Halt {
    fn from(alarm: LocatedAlarm) -> Self {
        Self::Alarm(alarm)
    }
}

/// Result of a part of a block.
pub(super) type Symbolic<T> = Result<T, Halt>;

/// Largest number of whole numbers that are ways of their own.
const MAX_WHOLE_NUMBERS: f64 = 4096.0;

/// Source of answers for one block.
pub(super) struct Oracle<'o, T> {
    pub(super) terms: &'o mut T,
    /// Answers of the way, in the order of the questions.
    answers: &'o [bool],
}

impl<'o, T: Terms> Oracle<'o, T> {
    pub(super) fn new(terms: &'o mut T, answers: &'o [bool]) -> Self {
        Self { terms, answers }
    }

    /// Returns the number of answers that haven't been used.
    pub(super) fn unused(&self) -> usize {
        self.answers.len()
    }

    /// Returns the answer to a question.
    pub(super) fn ask(&mut self, test: Test) -> Symbolic<bool> {
        if let Some(answer) = self.terms.answer(&test) {
            return Ok(answer);
        }
        let (first, rest) = self.answers.split_first().ok_or(Halt::Fork(test))?;
        self.answers = rest;
        Ok(*first)
    }

    /// Answers a condition; the second part of AND and OR is asked only if it decides.
    pub(super) fn is_true(&mut self, formula: &Formula) -> Symbolic<bool> {
        match formula {
            Formula::Known(answer) => Ok(*answer),
            Formula::Compare(relation, left, right) => self.ask(Test::Compare(*relation, *left, *right)),
            Formula::Logic(op, left, right) => {
                let left = self.is_true(left)?;
                match op {
                    BinaryOp::And if !left => Ok(false),
                    BinaryOp::And => self.is_true(right),
                    BinaryOp::Xor => Ok(left != self.is_true(right)?),
                    _ if left => Ok(true),
                    _ => self.is_true(right),
                }
            }
        }
    }

    /// Returns the whole number nearest to a term.
    pub(super) fn pin(&mut self, term: Term) -> Symbolic<f64> {
        let node = match term {
            Term::Number(number) => return Ok(number),
            node @ Term::Node(_) => self.terms.node(TermOperation::Function(Function::Round), [node, node]),
        };
        let (mut low, mut high) = self.terms.bounds(node);
        let width = high - low;
        if width > MAX_WHOLE_NUMBERS || !width.is_finite() {
            return Err(Halt::unfollowed("a whole number of more than 4096 values"));
        }
        (low, high) = (low.ceil(), high.floor());
        while low < high {
            let middle = ((low + high) / 2.0).floor();
            if self.ask(Test::Compare(Relation::Le, node, Term::Number(middle)))? {
                high = middle;
            } else {
                low = middle + 1.0;
            }
        }
        Ok(low)
    }

    /// Returns a term as a multiple of 1/scale, as the control rounds a word.
    pub(super) fn rounded_to_increment(&mut self, term: Term, scale: f64) -> Symbolic<Term> {
        let whole = self.terms.node(TermOperation::Scaled(scale), [term, term]);
        Ok(self.terms.node(TermOperation::Divide, [whole, Term::Number(scale)]))
    }

    /// Returns the sequence number of a program that a whole number is; `None` if it is none of them.
    pub(super) fn sequence_number(&mut self, program: &Program, whole: Term) -> Symbolic<Option<u32>> {
        let (low, high) = self.terms.bounds(whole);
        let in_bounds = |number: &u32| (low..=high).contains(&f64::from(*number));
        let numbers: Vec<u32> = program.sequence_numbers().filter(in_bounds).collect();
        let mut candidates = &numbers[..];
        while candidates.len() > 1 {
            let (lower, upper) = candidates.split_at(candidates.len() / 2);
            let last = Term::Number(f64::from(lower[lower.len() - 1]));
            candidates = if self.ask(Test::Compare(Relation::Le, whole, last))? { lower } else { upper };
        }
        let Some(number) = candidates.first() else { return Ok(None) };
        let is_it = self.ask(Test::Compare(Relation::Eq, whole, Term::Number(f64::from(*number))))?;
        Ok(is_it.then_some(*number))
    }
}
