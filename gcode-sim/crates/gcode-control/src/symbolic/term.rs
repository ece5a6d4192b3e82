//! Numbers of a symbolic run, and their form in the variables of a control.
//!
//! A node is stored as a NaN with its index in the payload. A control never computes a NaN, so none is mistaken for a
//! number; calls and returns copy it with its bits.
use super::super::variables::Value;
use gcode_lang::syntax::ast::{BinaryOp, Function, Relation};

/// Number of a symbolic run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Term {
    /// Known number.
    Number(f64),
    /// Node of the caller's terms, which depends on the ranges.
    Node(u32),
}

/// Upper half of a stored node; the lower half is its index.
const NODE: u64 = 0x7FFC_5E00;

/// Number that depends on the ranges and isn't followed.
pub(super) const UNFOLLOWED: f64 = f64::from_bits(0x7FFC_5F00_0000_0000);

impl Term {
    /// Returns the term as a control stores it.
    pub(super) fn stored(self) -> f64 {
        match self {
            Self::Number(number) => number,
            Self::Node(node) => f64::from_bits(NODE << 32 | u64::from(node)),
        }
    }

    /// Returns the term of a stored number; `None` if it isn't followed.
    pub(super) fn of(stored: f64) -> Option<Self> {
        if !stored.is_nan() {
            return Some(Self::Number(stored));
        }
        let bits = stored.to_bits();
        (bits >> 32 == NODE).then_some(Self::Node(bits as u32))
    }

    /// Returns the number, if it is known.
    pub fn number(self) -> Option<f64> {
        match self {
            Self::Number(number) => Some(number),
            Self::Node(_) => None,
        }
    }
}

/// Operation of a node: the double that the control computes, with its settings for angles and residues.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum TermOperation {
    /// Sum of both operands.
    Add,
    /// Difference.
    Subtract,
    /// Product.
    Multiply,
    /// Quotient.
    Divide,
    /// Remainder of the quotient of two whole numbers, with the sign of the dividend.
    Remainder,
    /// AND, OR or XOR of two whole numbers of 32 bits.
    Bits(BinaryOp),
    /// Power.
    Power,
    /// ATAN of two values: the first is along y, the second along x.
    Direction,
    /// Negation of the first operand; the second has no meaning here and below.
    Negate,
    /// Function of one argument inside its domain.
    Function(Function),
    /// First operand × scale to the nearest whole number, as the control rounds a word.
    Scaled(f64),
}

/// Question that decides how a run continues.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Test {
    /// Comparison of two terms.
    Compare(Relation, Term, Term),
    /// The term is a double: its operation has not overflowed.
    Finite(Term),
}

/// Builder of nodes.
pub trait Terms {
    /// Returns the node of an operation; at least one operand is a node.
    fn node(&mut self, operation: TermOperation, operands: [Term; 2]) -> Term;

    /// Returns bounds of a term over all ranges.
    fn bounds(&mut self, term: Term) -> (f64, f64);

    /// Returns the answer to a question, if it is the same over all ranges.
    fn answer(&mut self, test: &Test) -> Option<bool>;
}

/// Condition whose comparisons aren't answered yet.
#[derive(Clone, Debug, PartialEq)]
pub enum Formula {
    /// Known answer.
    Known(bool),
    /// Comparison.
    Compare(Relation, Term, Term),
    /// AND, OR or XOR.
    Logic(BinaryOp, Box<Self>, Box<Self>),
}

/// Value of an expression.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum SymbolicValue {
    Vacant,
    Term(Term),
    Truth(Formula),
}

impl SymbolicValue {
    /// Returns the value of a stored variable; `None` if it isn't followed.
    pub(super) fn of(value: Value) -> Option<Self> {
        match value {
            Value::Vacant => Some(Self::Vacant),
            Value::Number(stored) => Term::of(stored).map(Self::Term),
        }
    }

    /// Returns the value as a control stores it; `None` for a condition.
    pub(super) fn stored(&self) -> Option<Value> {
        match self {
            Self::Vacant => Some(Value::Vacant),
            Self::Term(term) => Some(Value::Number(term.stored())),
            Self::Truth(_) => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_stored_node_keeps_its_index_and_is_no_number() {
        for node in [0, 1, 0xFFFF_FFFF] {
            let stored = Term::Node(node).stored();
            assert!(stored.is_nan());
            assert_eq!(Term::of(stored), Some(Term::Node(node)));
        }
        assert_eq!(Term::of(UNFOLLOWED), None);
        assert_eq!(Term::of(f64::NAN), None, "a NaN that a computation leaves isn't a node");
        assert_eq!(Term::of(-0.5), Some(Term::Number(-0.5)));
    }
}
