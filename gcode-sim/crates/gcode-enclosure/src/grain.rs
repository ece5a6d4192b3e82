//! Grains: the power of two of which every value of a node is a multiple, by its range and its structure.
//!
//! A difference of doubles that isn't 0 is at least a grain: 1/[#1 − #2] stays below a bound where #1 and #2 differ.
use crate::arena::Arena;
use crate::enclosures::Enclosures;
use crate::interval::Interval;
use crate::node::{Binary, Node, NodeId, Unary};
use crate::proof::Prover;

/// Least positive double.
const LEAST: f64 = f64::from_bits(1);

/// Largest depth of sums that are looked through.
const DEPTH: u32 = 6;

impl Arena {
    /// Returns a power of two of which every value of a node in its range is a multiple.
    pub(crate) fn grain(&self, node: NodeId, hull: &dyn Fn(NodeId) -> Interval) -> f64 {
        self.grain_of(node, hull, DEPTH)
    }

    fn grain_of(&self, node: NodeId, hull: &dyn Fn(NodeId) -> Interval, depth: u32) -> f64 {
        let by_range = unit_in_last_place(hull(node).mignitude());
        if self.is_whole(node) {
            return by_range.max(1.0);
        }
        let Some(depth) = depth.checked_sub(1) else { return by_range };
        let by_structure = match self.node(node) {
            // A sum of multiples is one, and rounding to a coarser grid keeps it.
            Node::Binary(Binary::Add | Binary::Sub, a, b) => {
                self.grain_of(a, hull, depth).min(self.grain_of(b, hull, depth))
            }
            Node::Unary(Unary::Neg | Unary::Abs, x) => self.grain_of(x, hull, depth),
            Node::Constant(value) => return lowest_bit(value),
            _ => LEAST,
        };
        by_range.max(by_structure)
    }
}

/// Returns the grid of doubles of at least this magnitude.
fn unit_in_last_place(magnitude: f64) -> f64 {
    match magnitude.to_bits() >> 52 {
        // Below the normal doubles the grid is that of the least one.
        0 => LEAST,
        exponent @ 1..=52 => f64::from_bits(1 << (exponent - 1)),
        exponent => f64::from_bits((exponent - 52) << 52),
    }
}

/// Returns the largest power of two of which a number is a multiple; of 0, any.
fn lowest_bit(value: f64) -> f64 {
    let bits = value.to_bits();
    let (exponent, fraction) = (bits >> 52 & 0x7FF, bits & ((1 << 52) - 1));
    if value == 0.0 {
        return f64::MAX;
    }
    if exponent == 0 {
        return f64::from_bits(1 << fraction.trailing_zeros());
    }
    // The zeros at the end of the 53 binary digits.
    let zeros = if fraction == 0 { 52 } else { fraction.trailing_zeros() };
    unit_in_last_place(value.abs()) * (1_u64 << zeros) as f64
}

impl Enclosures {
    /// Returns a positive number that the magnitude of a divisor isn't below on this path; 0 without one.
    pub(crate) fn least_magnitude(&self, arena: &Arena, node: NodeId) -> f64 {
        let hulls = |node: NodeId| match self.forms.get(node.index()) {
            Some(Some(form)) => form.hull,
            _ => Interval::ALL,
        };
        let least = hulls(node).mignitude();
        if least > 0.0 || hulls(node).is_empty() {
            return least;
        }
        let prover = Prover::new(arena, &hulls, &self.conditions);
        if !prover.is_nonzero(node) {
            return 0.0;
        }
        let reversed = match arena.node(node) {
            Node::Binary(Binary::Sub, a, b) => arena.find_binary(Binary::Sub, b, a),
            _ => None,
        };
        let magnitude = |node: NodeId| {
            arena.find_unary(Unary::Abs, node).map_or(0.0, |magnitude| hulls(magnitude).mignitude())
        };
        let by_condition = magnitude(node).max(reversed.map_or(0.0, magnitude));
        // Other arithmetic has another grid.
        let by_grain = if arena.widening() > 0.0 { 0.0 } else { arena.grain(node, &hulls) };
        by_condition.max(by_grain).min(f64::MAX)
    }
}

impl Prover<'_> {
    /// Returns true if a product or a quotient of numbers that aren't 0 can be 0: only of small ones, or by a large one.
    pub(crate) fn can_underflow(&self, operator: Binary, a: NodeId, b: NodeId) -> bool {
        let least = |x: NodeId| self.range(x).mignitude().max(self.arena.grain(x, self.hull));
        let result = match operator {
            Binary::Div => least(a) / self.range(b).magnitude(),
            _ => least(a) * least(b),
        };
        // Not a number where nothing is known of a range.
        result.is_nan() || result <= 0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_grain_divides_every_double_of_a_range() {
        assert_eq!(unit_in_last_place(1.0), f64::EPSILON);
        assert_eq!(unit_in_last_place(3.9), 2.0 * f64::EPSILON);
        assert_eq!(unit_in_last_place(0.0), LEAST);
        // 2^-1022 is the least normal double: its grid is that of the least double.
        assert_eq!(unit_in_last_place(f64::MIN_POSITIVE), LEAST);
        assert_eq!(unit_in_last_place(f64::MIN_POSITIVE * 2.0), 2.0 * LEAST);
        assert_eq!((lowest_bit(1.0) <= 1.0, lowest_bit(0.75)), (true, 0.25));
        assert_eq!(lowest_bit(-6.0), 2.0);
        assert_eq!(lowest_bit(LEAST), LEAST);
    }

    #[test]
    fn a_difference_of_unequal_numbers_has_a_least_magnitude() {
        use crate::node::{Condition, Relation};
        use crate::{Domain, Enclosures};
        let mut arena = Arena::default();
        let (x, y) = (arena.input(0), arena.input(1));
        let difference = arena.binary(Binary::Sub, x, y);
        let quotient = arena.binary(Binary::Div, Arena::ONE, difference);
        let mut path = Enclosures::new(Domain::new(vec![Interval::new(1.0, 10.0); 2]));
        assert!(!path.alarms(&arena, quotient).is_empty());
        assert!(path.assume(&arena, Condition::new(Relation::Ne, x, y)));
        assert!(path.alarms(&arena, quotient).is_empty());
        let mut path = Enclosures::new(Domain::new(vec![Interval::new(1.0, 10.0); 2]));
        assert!(path.assume(&arena, Condition::new(Relation::Ne, x, y)));
        // Doubles from 1 to 10 are multiples of 2^-52, and 1.0 and its neighbour are that far apart.
        assert_eq!(path.enclose(&arena, quotient).hi(), 4_503_599_627_370_496.0);
        assert_eq!(path.enclose(&arena, quotient).lo(), -(4_503_599_627_370_496.0));
    }

    #[test]
    fn a_difference_near_zero_has_none_that_helps() {
        use crate::node::{Condition, Relation};
        use crate::{Domain, Enclosures};
        let mut arena = Arena::default();
        let (x, y) = (arena.input(0), arena.input(1));
        let difference = arena.binary(Binary::Sub, x, y);
        let quotient = arena.binary(Binary::Div, Arena::ONE, difference);
        let mut path = Enclosures::new(Domain::new(vec![Interval::new(0.0, 10.0); 2]));
        assert!(path.assume(&arena, Condition::new(Relation::Ne, x, y)));
        let alarms = path.alarms(&arena, quotient);
        // 1/5e-324 overflows.
        assert_eq!(alarms.len(), 1);
        assert_eq!(alarms[0].kind, crate::AlarmKind::Overflow);
    }
}
