//! Proofs of relations by the structure of expressions.
//!
//! An operation that rounds correctly is monotone: from a ≥ c ≥ 0 follows a·a ≥ c·c in doubles, whatever is rounded. A
//! difference of doubles is 0 only if they are equal, and has the sign of the real one. No rule here uses a function of
//! `libm`, whose roundings aren't monotone.
use std::cell::Cell;

use crate::arena::Arena;
use crate::interval::Interval;
use crate::node::{Binary, Condition, Node, NodeId, Relation, Unary};

/// A number whose square doesn't underflow: the root of its square is the number itself (Boldo, Stupid is as stupid
/// does: taking the square root of the square of a floating-point number).
pub(crate) const SQUARABLE: f64 = 1e-150;
/// A number whose square doesn't overflow.
pub(crate) const MAX_SQUARABLE: f64 = 1e150;

/// Largest depth of a proof.
const DEPTH: u32 = 6;
/// Largest number of steps.
const STEPS: u32 = 4000;

/// Proves relations between nodes from their ranges, their structure and the conditions of a path.
pub(crate) struct Prover<'a> {
    pub(crate) arena: &'a Arena,
    pub(crate) hull: &'a dyn Fn(NodeId) -> Interval,
    conditions: &'a [Condition],
    steps: Cell<u32>,
    /// Operations round as doubles do; otherwise their results are off, and only the order of the conditions holds.
    pub(crate) is_exact: bool,
}

impl<'a> Prover<'a> {
    pub(crate) fn new(
        arena: &'a Arena,
        hull: &'a dyn Fn(NodeId) -> Interval,
        conditions: &'a [Condition],
    ) -> Self {
        Self { arena, hull, conditions, steps: Cell::new(0), is_exact: arena.widening() == 0.0 }
    }

    /// Decides a relation; `None` without a proof.
    pub(crate) fn decide(&self, relation: Relation, a: NodeId, b: NodeId) -> Option<bool> {
        match relation {
            Relation::Ge if self.ge(a, b, DEPTH) => Some(true),
            Relation::Ge if self.gt(b, a, DEPTH) => Some(false),
            Relation::Gt if self.gt(a, b, DEPTH) => Some(true),
            Relation::Gt if self.ge(b, a, DEPTH) => Some(false),
            Relation::Eq if self.ne(a, b, DEPTH) => Some(false),
            Relation::Eq if self.ge(a, b, DEPTH) && self.ge(b, a, DEPTH) => Some(true),
            Relation::Ge | Relation::Gt | Relation::Eq => None,
            Relation::Le | Relation::Lt => self.decide(relation.swapped(), b, a),
            Relation::Ne => self.decide(Relation::Eq, a, b).map(|is_equal| !is_equal),
        }
    }

    /// Returns the depth below, unless the proof has become too long.
    pub(crate) fn deeper(&self, depth: u32) -> Option<u32> {
        self.steps.set(self.steps.get() + 1);
        depth.checked_sub(1).filter(|_| self.steps.get() < STEPS)
    }

    pub(crate) fn range(&self, node: NodeId) -> Interval {
        (self.hull)(node)
    }

    /// Returns true if the range of a node says x ≥ 0.
    fn is_positive(&self, x: NodeId, depth: u32) -> bool {
        self.range(x).lo() >= 0.0 || self.ge(x, Arena::ZERO, depth)
    }

    /// Returns true if x ≤ 0.
    fn is_negative(&self, x: NodeId, depth: u32) -> bool {
        self.range(x).hi() <= 0.0 || self.ge(Arena::ZERO, x, depth)
    }

    /// Returns true if x and y have one sign, or are 0.
    fn have_one_sign(&self, x: NodeId, y: NodeId, depth: u32) -> bool {
        x == y
            || self.is_positive(x, depth) && self.is_positive(y, depth)
            || self.is_negative(x, depth) && self.is_negative(y, depth)
    }

    /// Returns true if x and y have opposite signs, or are 0.
    fn have_opposite_signs(&self, x: NodeId, y: NodeId, depth: u32) -> bool {
        self.is_positive(x, depth) && self.is_negative(y, depth)
            || self.is_negative(x, depth) && self.is_positive(y, depth)
    }

    /// Returns the conditions as pairs x ≥ y; true for x > y.
    pub(crate) fn facts(&self) -> impl Iterator<Item = (NodeId, NodeId, bool)> {
        self.conditions.iter().flat_map(|&Condition { relation, left, right }| {
            let forwards = match relation {
                Relation::Ge | Relation::Eq => Some((left, right, false)),
                Relation::Gt => Some((left, right, true)),
                Relation::Le | Relation::Lt | Relation::Ne => None,
            };
            let backwards = match relation {
                Relation::Le | Relation::Eq => Some((right, left, false)),
                Relation::Lt => Some((right, left, true)),
                Relation::Ge | Relation::Gt | Relation::Ne => None,
            };
            forwards.into_iter().chain(backwards)
        })
    }

    /// Proves x ≥ y.
    pub(crate) fn ge(&self, x: NodeId, y: NodeId, depth: u32) -> bool {
        if x == y || self.range(x).lo() >= self.range(y).hi() {
            return true;
        }
        let Some(depth) = self.deeper(depth) else { return false };
        let by_fact = |(greater, less, _): (NodeId, NodeId, bool)| {
            greater == x && (less == y || self.ge(less, y, depth)) || less == y && self.ge(x, greater, depth)
        };
        if self.facts().any(by_fact) {
            return true;
        }
        if !self.is_exact {
            return self.has_sign_of_difference(x, y, |a, b| self.ge(a, b, depth));
        }
        self.multiple(y).is_some_and(|(k, a)| self.ge_multiple(x, k, a, depth))
            || self.multiple(x).is_some_and(|(k, a)| self.le_multiple(y, k, a, depth))
            || self.ge_by_left(x, y, depth)
            || self.ge_by_right(x, y, depth)
    }

    /// Returns true if x is a − b, y is 0 and `relation` holds of a and b, or the same of y.
    fn has_sign_of_difference(
        &self,
        x: NodeId,
        y: NodeId,
        relation: impl Fn(NodeId, NodeId) -> bool,
    ) -> bool {
        match (self.arena.node(x), self.arena.node(y)) {
            (Node::Binary(Binary::Sub, a, b), _) if y == Arena::ZERO => relation(a, b),
            (_, Node::Binary(Binary::Sub, a, b)) if x == Arena::ZERO => relation(b, a),
            _ => false,
        }
    }

    /// Proves x ≥ y by the operation of x.
    fn ge_by_left(&self, x: NodeId, y: NodeId, depth: u32) -> bool {
        let other = self.arena.node(y);
        if let Some(part) = self.arena.positive_part(x) {
            return self.is_negative(y, depth) || self.ge(part, y, depth);
        }
        let is_below_zero = || self.is_negative(y, depth);
        match self.arena.node(x) {
            Node::Constant(_) | Node::Input(_) => false,
            Node::Unary(function, a) => match (function, other) {
                (Unary::Neg, Node::Unary(Unary::Neg, c)) => self.ge(c, a, depth),
                (Unary::Neg, _) => self.opposite(y).is_some_and(|opposite| self.ge(opposite, a, depth)),
                (Unary::Abs, Node::Unary(Unary::Abs, c)) if self.abs_ge(a, c, depth) => true,
                (Unary::Abs, Node::Unary(Unary::Neg, c)) if a == c => true,
                (Unary::Abs, _) => is_below_zero() || self.ge(a, y, depth) || self.abs_ge(a, y, depth),
                (Unary::Sqrt, Node::Unary(Unary::Sqrt, c)) if self.ge(a, c, depth) => true,
                (Unary::Sqrt, _) if y == Arena::ONE && self.ge(a, y, depth) => true,
                (Unary::Sqrt, _) => is_below_zero() || self.root_ge(x, a, y, depth),
                (Unary::Fix | Unary::Fup | Unary::Round, Node::Unary(same, c)) if same == function => {
                    self.ge(a, c, depth)
                }
                (Unary::Fix | Unary::Fup | Unary::Round, _) => {
                    let is_outward = match function {
                        Unary::Fup => self.is_positive(a, depth),
                        Unary::Fix => self.is_negative(a, depth),
                        _ => false,
                    };
                    (is_outward || self.arena.is_whole(y)) && self.ge(a, y, depth)
                }
                _ => false,
            },
            Node::Binary(operator, a, b) => match (operator, other) {
                (Binary::Add, Node::Binary(Binary::Add, c, d))
                    if self.ge(a, c, depth) && self.ge(b, d, depth)
                        || self.ge(a, d, depth) && self.ge(b, c, depth) =>
                {
                    true
                }
                (Binary::Add, _) => {
                    self.is_positive(b, depth) && self.ge(a, y, depth)
                        || self.is_positive(a, depth) && self.ge(b, y, depth)
                        || y == Arena::ZERO && self.is_sum_positive(a, b, depth)
                }
                (Binary::Sub, Node::Binary(Binary::Sub, c, d))
                    if self.ge(a, c, depth) && self.ge(d, b, depth) =>
                {
                    true
                }
                (Binary::Sub, _) => {
                    self.ge(a, b, depth) && is_below_zero()
                        || self.is_negative(b, depth) && self.ge(a, y, depth)
                }
                (Binary::Mul, Node::Binary(Binary::Mul, c, d)) if self.product_ge([a, b], [c, d], depth) => {
                    true
                }
                (Binary::Mul, Node::Binary(Binary::Div | Binary::Mul, ..))
                    if a == b && self.ge_scaled_square(a, y, depth) =>
                {
                    true
                }
                (Binary::Mul, _) => {
                    let grows = |a: NodeId, b: NodeId| {
                        self.ge(b, Arena::ONE, depth) && self.is_positive(a, depth) && self.ge(a, y, depth)
                    };
                    is_below_zero() && self.have_one_sign(a, b, depth) || grows(a, b) || grows(b, a)
                }
                (Binary::Div, Node::Binary(Binary::Div, c, d)) if self.quotient_ge([a, b], [c, d], depth) => {
                    true
                }
                (Binary::Div, _)
                    if self.arena.as_constant(b) == Some(2.0) && self.ge_multiple(a, 2, y, depth) =>
                {
                    true
                }
                (Binary::Div, _) => {
                    y == Arena::ONE && self.gt(b, Arena::ZERO, depth) && self.ge(a, b, depth)
                        || y == Arena::MINUS_ONE && self.abs_ge(b, a, depth)
                        || is_below_zero() && self.have_one_sign(a, b, depth)
                }
                _ => false,
            },
        }
    }

    /// Proves x ≥ y by the operation of y.
    fn ge_by_right(&self, x: NodeId, y: NodeId, depth: u32) -> bool {
        let is_above_zero = || self.is_positive(x, depth);
        if let Some(part) = self.arena.positive_part(y) {
            return is_above_zero() && self.ge(x, part, depth);
        }
        match self.arena.node(y) {
            Node::Constant(_) | Node::Input(_) => false,
            Node::Unary(function, c) => match function {
                Unary::Neg => self.opposite(x).is_some_and(|opposite| self.ge(c, opposite, depth)),
                Unary::Abs => is_above_zero() && self.abs_ge(x, c, depth),
                Unary::Sqrt if x == Arena::ONE => self.ge(x, c, depth),
                // The root of a square that doesn't underflow is the number.
                Unary::Sqrt => {
                    self.range(x).lo() >= SQUARABLE
                        && self.range(x).hi() <= MAX_SQUARABLE
                        && self.arena.find_square(x).is_some_and(|square| self.ge(square, c, depth))
                }
                Unary::Fix | Unary::Fup | Unary::Round => {
                    let is_inward = match function {
                        Unary::Fix => self.is_positive(c, depth),
                        Unary::Fup => self.is_negative(c, depth),
                        _ => false,
                    };
                    (is_inward || self.arena.is_whole(x)) && self.ge(x, c, depth)
                }
                _ => false,
            },
            Node::Binary(operator, c, d) => match operator {
                Binary::Add => {
                    self.ge(x, c, depth) && self.is_negative(d, depth)
                        || self.ge(x, d, depth) && self.is_negative(c, depth)
                }
                Binary::Sub => {
                    self.ge(x, c, depth) && self.is_positive(d, depth)
                        || self.ge(d, c, depth) && is_above_zero()
                }
                Binary::Mul => {
                    let shrinks = |c: NodeId, d: NodeId| {
                        self.range(d).magnitude() <= 1.0 && is_above_zero() && self.abs_ge(x, c, depth)
                    };
                    self.have_opposite_signs(c, d, depth) && is_above_zero()
                        || shrinks(c, d)
                        || shrinks(d, c)
                        || x == Arena::ONE && self.abs_ge(x, c, depth) && (c == d || self.abs_ge(x, d, depth))
                }
                Binary::Div if self.ge_half(x, c, d, depth) => true,
                Binary::Div => {
                    x == Arena::ONE
                        && (self.gt(d, Arena::ZERO, depth) && self.ge(d, c, depth)
                            || self.abs_ge(d, c, depth))
                        || self.have_opposite_signs(c, d, depth) && is_above_zero()
                        || self.range(d).mignitude() >= 1.0 && is_above_zero() && self.abs_ge(x, c, depth)
                }
                _ => false,
            },
        }
    }

    /// Returns the node of the opposite number, of those that the arena has.
    pub(crate) fn opposite(&self, x: NodeId) -> Option<NodeId> {
        match self.arena.node(x) {
            Node::Unary(Unary::Neg, inner) => Some(inner),
            _ if x == Arena::ZERO => Some(x),
            _ if x == Arena::ONE => Some(Arena::MINUS_ONE),
            _ if x == Arena::MINUS_ONE => Some(Arena::ONE),
            _ => self.arena.find_unary(Unary::Neg, x),
        }
    }

    /// Proves a·b ≥ c·d.
    fn product_ge(&self, [a, b]: [NodeId; 2], [c, d]: [NodeId; 2], depth: u32) -> bool {
        if a == b && c == d {
            return self.abs_ge(a, c, depth);
        }
        let of_common = |common: NodeId, b: NodeId, d: NodeId| {
            self.is_positive(common, depth) && self.ge(b, d, depth)
                || self.is_negative(common, depth) && self.ge(d, b, depth)
        };
        // a·b ≥ c·b ≥ c·d.
        let ordered = |a: NodeId, b: NodeId, c: NodeId, d: NodeId| {
            if a == c {
                return of_common(a, b, d);
            }
            if b == d {
                return of_common(b, a, c);
            }
            self.is_positive(b, depth)
                && self.is_positive(c, depth)
                && self.ge(a, c, depth)
                && self.ge(b, d, depth)
        };
        ordered(a, b, c, d) || ordered(a, b, d, c)
    }

    /// Proves a/b ≥ c/d.
    fn quotient_ge(&self, [a, b]: [NodeId; 2], [c, d]: [NodeId; 2], depth: u32) -> bool {
        if b == d {
            return self.gt(b, Arena::ZERO, depth) && self.ge(a, c, depth)
                || self.gt(Arena::ZERO, b, depth) && self.ge(c, a, depth);
        }
        // a/b ≥ c/b ≥ c/d.
        self.gt(b, Arena::ZERO, depth)
            && self.is_positive(c, depth)
            && self.ge(a, c, depth)
            && self.ge(d, b, depth)
    }

    /// Proves that a root √a is at least |y|: a is at least the square of y.
    fn root_ge(&self, root: NodeId, a: NodeId, y: NodeId, depth: u32) -> bool {
        let base = match self.arena.node(y) {
            Node::Unary(Unary::Abs | Unary::Neg, inner) => inner,
            _ => y,
        };
        let is_squarable = self.range(base).mignitude() >= SQUARABLE || self.range(root).lo() >= SQUARABLE;
        let is_squarable = is_squarable && self.range(base).magnitude() <= MAX_SQUARABLE;
        is_squarable && self.arena.find_square(base).is_some_and(|square| self.ge(a, square, depth))
    }

    /// Proves |a| ≥ |b|.
    pub(crate) fn abs_ge(&self, a: NodeId, b: NodeId, depth: u32) -> bool {
        if a == b || self.range(a).mignitude() >= self.range(b).magnitude() || self.has_larger_square(a, b) {
            return true;
        }
        let Some(depth) = self.deeper(depth) else { return false };
        if let Node::Unary(Unary::Neg | Unary::Abs, inner) = self.arena.node(a) {
            return self.abs_ge(inner, b, depth);
        }
        match self.arena.node(b) {
            Node::Unary(Unary::Neg | Unary::Abs, inner) => return self.abs_ge(a, inner, depth),
            Node::Binary(Binary::Mul, c, d) => {
                let is_shrinking = |d: NodeId| self.range(d).magnitude() <= 1.0;
                if is_shrinking(d) && self.abs_ge(a, c, depth) || is_shrinking(c) && self.abs_ge(a, d, depth)
                {
                    return true;
                }
            }
            Node::Binary(Binary::Div, c, d)
                if self.range(d).mignitude() >= 1.0 && self.abs_ge(a, c, depth) =>
            {
                return true;
            }
            _ => {}
        }
        let magnitude = |x: NodeId| {
            let absolute = self.arena.find_unary(Unary::Abs, x);
            absolute.or_else(|| match x {
                _ if self.is_positive(x, depth) => Some(x),
                _ if self.is_negative(x, depth) => self.opposite(x),
                _ => None,
            })
        };
        if let (Some(a), Some(b)) = (magnitude(a), magnitude(b))
            && self.ge(a, b, depth)
        {
            return true;
        }
        if self.is_negative(a, depth) && self.is_negative(b, depth) && self.ge(b, a, depth) {
            return true;
        }
        // A root against a leg.
        if let Node::Unary(Unary::Sqrt, square) = self.arena.node(a)
            && self.root_ge(a, square, b, depth)
        {
            return true;
        }
        // −a ≤ b ≤ a.
        self.is_positive(a, depth)
            && self.ge(a, b, depth)
            && (self.is_positive(b, depth)
                || self.opposite(b).is_some_and(|minus_b| self.ge(a, minus_b, depth))
                || self.opposite(a).is_some_and(|minus_a| self.ge(b, minus_a, depth)))
    }

    /// Proves x > y.
    fn gt(&self, x: NodeId, y: NodeId, depth: u32) -> bool {
        if self.range(x).lo() > self.range(y).hi() {
            return true;
        }
        let Some(depth) = self.deeper(depth) else { return false };
        let by_fact = |(greater, less, is_strict): (NodeId, NodeId, bool)| {
            let from_x =
                greater == x && if is_strict { self.ge(less, y, depth) } else { self.gt(less, y, depth) };
            let to_y =
                less == y && if is_strict { self.ge(x, greater, depth) } else { self.gt(x, greater, depth) };
            from_x || to_y
        };
        if self.facts().any(by_fact) || self.is_unequal(x, y) && self.ge(x, y, depth) {
            return true;
        }
        if !self.is_exact {
            return self.has_sign_of_difference(x, y, |a, b| self.gt(a, b, depth));
        }
        match (self.arena.node(x), self.arena.node(y)) {
            (Node::Binary(Binary::Sub, a, b), _) if y == Arena::ZERO => self.gt(a, b, depth),
            (_, Node::Binary(Binary::Sub, c, d)) if x == Arena::ZERO => self.gt(d, c, depth),
            (Node::Binary(Binary::Add, a, b), _) if y == Arena::ZERO => {
                self.gt(a, y, depth) && self.is_positive(b, depth)
                    || self.gt(b, y, depth) && self.is_positive(a, depth)
            }
            (Node::Unary(Unary::Sqrt | Unary::Fup, a), _) if y == Arena::ZERO => self.gt(a, y, depth),
            (Node::Binary(operator @ (Binary::Mul | Binary::Div), a, b), _) if y == Arena::ZERO => {
                let has_one_sign = || {
                    self.gt(a, y, depth) && self.gt(b, y, depth)
                        || self.gt(y, a, depth) && self.gt(y, b, depth)
                };
                !self.can_underflow(operator, a, b) && has_one_sign()
            }
            (Node::Unary(Unary::Abs, a), _) if y == Arena::ZERO => self.ne(a, y, depth),
            (Node::Unary(Unary::Neg, a), _) if y == Arena::ZERO => self.gt(y, a, depth),
            (_, Node::Unary(Unary::Neg, c)) if x == Arena::ZERO => self.gt(c, x, depth),
            (Node::Unary(Unary::Neg, a), Node::Unary(Unary::Neg, c)) => self.gt(c, a, depth),
            _ => false,
        }
    }

    /// Returns true if a condition says that x and y differ.
    fn is_unequal(&self, x: NodeId, y: NodeId) -> bool {
        self.conditions.iter().any(|condition| {
            let sides = (condition.left, condition.right);
            condition.relation == Relation::Ne && (sides == (x, y) || sides == (y, x))
        })
    }

    /// Proves that x isn't 0.
    pub(crate) fn is_nonzero(&self, x: NodeId) -> bool {
        self.ne(x, Arena::ZERO, DEPTH)
    }

    /// Returns true if a condition or the range of its magnitude says that x isn't 0.
    fn is_not_zero(&self, x: NodeId) -> bool {
        let has_magnitude = |x: NodeId| {
            let magnitude = self.arena.find_unary(Unary::Abs, x);
            magnitude.is_some_and(|magnitude| self.range(magnitude).lo() > 0.0)
        };
        let reversed = match self.arena.node(x) {
            Node::Binary(Binary::Sub, a, b) => self.arena.find_binary(Binary::Sub, b, a),
            _ => None,
        };
        self.is_unequal(x, Arena::ZERO)
            || has_magnitude(x)
            || reversed.is_some_and(|x| self.is_unequal(x, Arena::ZERO) || has_magnitude(x))
    }

    /// Proves that x and y differ.
    fn ne(&self, x: NodeId, y: NodeId, depth: u32) -> bool {
        if self.is_unequal(x, y) || self.gt(x, y, depth) || self.gt(y, x, depth) {
            return true;
        }
        let Some(depth) = self.deeper(depth) else { return false };
        let (x, y) = if x == Arena::ZERO { (y, x) } else { (x, y) };
        if y != Arena::ZERO {
            // Of a difference that isn't 0 the sides differ.
            let differ =
                |a, b| self.arena.find_binary(Binary::Sub, a, b).is_some_and(|d| self.is_not_zero(d));
            return differ(x, y) || differ(y, x);
        }
        match self.arena.node(x) {
            _ if self.is_not_zero(x) => true,
            Node::Binary(Binary::Sub, a, b) => self.ne(a, b, depth),
            Node::Unary(Unary::Neg | Unary::Abs | Unary::Sqrt | Unary::Fup, a) => self.ne(a, y, depth),
            Node::Binary(Binary::Mul, a, b) if self.is_exact => {
                !self.can_underflow(Binary::Mul, a, b) && self.ne(a, y, depth) && self.ne(b, y, depth)
            }
            Node::Binary(Binary::Div, a, b) if self.is_exact => {
                !self.can_underflow(Binary::Div, a, b) && self.ne(a, y, depth)
            }
            _ => false,
        }
    }
}
