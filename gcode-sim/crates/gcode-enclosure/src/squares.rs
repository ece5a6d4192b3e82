//! Proofs with squares: of quarters, and of numbers whose squares are in order.
use crate::node::{Binary, Node, NodeId};
use crate::proof::{MAX_SQUARABLE, Prover, SQUARABLE};

impl Prover<'_> {
    /// Proves a·a ≥ c·c/4: 2·a is exact, and its square that of a × 4; so for 16 and 4, and for c·c·0.25.
    pub(crate) fn ge_scaled_square(&self, a: NodeId, y: NodeId, depth: u32) -> bool {
        let Node::Binary(operator, left, right) = self.arena.node(y) else { return false };
        let (square, factor) = match operator {
            Binary::Div => (left, self.arena.as_constant(right)),
            _ if self.arena.as_constant(left).is_some() => {
                (right, self.arena.as_constant(left).map(|factor| 1.0 / factor))
            }
            _ => (left, self.arena.as_constant(right).map(|factor| 1.0 / factor)),
        };
        let root = match factor {
            Some(4.0) => 2.0,
            Some(16.0) => 4.0,
            Some(64.0) => 8.0,
            _ => return false,
        };
        let Node::Binary(Binary::Mul, c, d) = self.arena.node(square) else { return false };
        if c != d || self.range(a).mignitude() < SQUARABLE || self.range(a).magnitude() > MAX_SQUARABLE {
            return false;
        }
        // The multiple of a, or the part of c, of those that the program computes.
        let scaled = |operator, x: NodeId, by: f64| {
            let by = self.arena.find_constant(by)?;
            match operator {
                Binary::Mul => self.arena.find_binary(operator, x.min(by), x.max(by)),
                _ => self.arena.find_binary(operator, x, by),
            }
        };
        let doubled = (root == 2.0).then(|| self.arena.find_binary(Binary::Add, a, a)).flatten();
        let multiples = [scaled(Binary::Mul, a, root), scaled(Binary::Div, a, 1.0 / root), doubled];
        let parts = [scaled(Binary::Div, c, root), scaled(Binary::Mul, c, 1.0 / root)];
        multiples.into_iter().flatten().any(|multiple| self.abs_ge(multiple, c, depth))
            || self.range(c).mignitude() >= SQUARABLE
                && parts.into_iter().flatten().any(|part| self.abs_ge(a, part, depth))
    }

    /// Returns true if a condition says that the square of a is at least that of b: then |a| ≥ |b|, since the squares of two
    /// doubles differ by more than the unit in their last place.
    pub(crate) fn has_larger_square(&self, a: NodeId, b: NodeId) -> bool {
        let (Some(of_a), Some(of_b)) = (self.arena.find_square(a), self.arena.find_square(b)) else {
            return false;
        };
        self.is_exact
            && (self.range(a).mignitude() >= SQUARABLE || self.range(b).mignitude() >= SQUARABLE)
            && self.range(a).magnitude().max(self.range(b).magnitude()) <= MAX_SQUARABLE
            && self.facts().any(|(greater, less, _)| (greater, less) == (of_a, of_b))
    }
}
