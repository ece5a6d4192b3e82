//! Proofs of relations with small multiples: from b ≥ a and c ≥ a follows a + b + c ≥ 3·a in doubles.
use crate::node::{Binary, Node, NodeId};
use crate::proof::Prover;

impl Prover<'_> {
    /// Proves x ≥ k·a as the control computes the product, for k of 1, 2 and 3.
    ///
    /// a + a is 2·a without a rounding, and 2·a + a rounds as 3·a does: from b ≥ 2·a and c ≥ a follows b + c ≥ 3·a.
    pub(crate) fn ge_multiple(&self, x: NodeId, k: u32, a: NodeId, depth: u32) -> bool {
        let Some(depth) = self.deeper(depth) else { return false };
        match (k, self.arena.node(x)) {
            (1, _) => self.ge(x, a, depth),
            (2 | 3, Node::Binary(Binary::Add, b, c)) => {
                let parts = |b, c| self.ge_multiple(b, k - 1, a, depth) && self.ge(c, a, depth);
                parts(b, c) || parts(c, b)
            }
            (2 | 3, Node::Binary(Binary::Mul, b, c)) => {
                let of =
                    |factor, b| self.arena.as_constant(factor) == Some(f64::from(k)) && self.ge(b, a, depth);
                of(b, c) || of(c, b)
            }
            _ => false,
        }
    }

    /// Proves x ≤ k·a, as [`Prover::ge_multiple`].
    pub(crate) fn le_multiple(&self, x: NodeId, k: u32, a: NodeId, depth: u32) -> bool {
        let Some(depth) = self.deeper(depth) else { return false };
        match (k, self.arena.node(x)) {
            (1, _) => self.ge(a, x, depth),
            (2 | 3, Node::Binary(Binary::Add, b, c)) => {
                let parts = |b, c| self.le_multiple(b, k - 1, a, depth) && self.ge(a, c, depth);
                parts(b, c) || parts(c, b)
            }
            _ => false,
        }
    }

    /// Proves x ≥ c/d for d of 2: from 2·x ≥ c, as the double of x is exact.
    pub(crate) fn ge_half(&self, x: NodeId, c: NodeId, d: NodeId, depth: u32) -> bool {
        self.arena.as_constant(d) == Some(2.0)
            && (self.le_multiple(c, 2, x, depth)
                || self.arena.find_double(x).is_some_and(|double| self.ge(double, c, depth)))
    }

    /// Returns the number and the node of a product by 2 or 3.
    pub(crate) fn multiple(&self, x: NodeId) -> Option<(u32, NodeId)> {
        let Node::Binary(Binary::Mul, a, b) = self.arena.node(x) else { return None };
        let of = |factor: NodeId, x| match self.arena.as_constant(factor) {
            Some(2.0) => Some((2, x)),
            Some(3.0) => Some((3, x)),
            _ => None,
        };
        of(a, b).or_else(|| of(b, a))
    }

    /// Proves a + b ≥ 0: a sum of doubles has the sign of the real one.
    pub(crate) fn is_sum_positive(&self, a: NodeId, b: NodeId, depth: u32) -> bool {
        let [minus_a, minus_b] = [a, b].map(|node| self.opposite(node));
        minus_b.is_some_and(|minus_b| self.ge(a, minus_b, depth))
            || minus_a.is_some_and(|minus_a| self.ge(b, minus_a, depth))
    }
}
