//! Ratios of values between which a condition of the path stands: from 0 ≤ r ≤ 0.999·a follows r·r/[a·a] ≤ 0.998001.
use crate::arena::Arena;
use crate::enclosures::Enclosures;
use crate::interval::Interval;
use crate::node::{Binary, Condition, Node, NodeId, Relation};

/// Largest magnitude of a factor, and its reciprocal the least of a divisor, for which nothing overflows or underflows.
const MOST: f64 = 1e10;

/// Twice the largest power of a ratio.
const MAX_HALVES: i32 = 8;

impl Enclosures {
    /// Returns the range of a node that is a power of a ratio, as far as the conditions of the path limit the ratio.
    pub(crate) fn with_ratio(&self, arena: &Arena, node: NodeId, range: Interval) -> Interval {
        if self.conditions.is_empty()
            || arena.widening() > 0.0
            || !matches!(arena.node(node), Node::Binary(..))
        {
            return range;
        }
        let factors = arena.factors(node);
        let &[(a, of_a), (b, of_b)] = factors.powers.as_slice() else { return range };
        if of_a != -of_b || !factors.used.iter().all(|(factor, _)| self.is_moderate(*factor)) {
            return range;
        }
        let (dividend, divisor, halves) = if of_a > 0 { (a, b, of_a) } else { (b, a, of_b) };
        if halves > MAX_HALVES {
            return range;
        }
        let (low, high) = self.ratio(arena, dividend, divisor);
        // Powers of a smaller ratio may underflow.
        let low = if low < 1e-20 { 0.0 } else { low };
        let power = |ratio: f64| libm::pow(ratio, f64::from(halves) / 2.0);
        // A rounding of each operation, those of the condition and of the power.
        let margin = f64::from(factors.roundings + 16) * f64::EPSILON * f64::from(halves + 1);
        let (low, high) = (power(low) * (1.0 - margin), power(high) * (1.0 + margin));
        let ends = [low * factors.constant, high * factors.constant];
        let [low, high] = if factors.constant < 0.0 { [ends[1], ends[0]] } else { ends };
        if low.is_nan() || high.is_nan() { range } else { range.intersect(Interval::new(low, high)) }
    }

    fn is_moderate(&self, node: NodeId) -> bool {
        let hull =
            self.forms.get(node.index()).and_then(Option::as_ref).map_or(Interval::ALL, |form| form.hull);
        hull.lo() >= 0.0 && hull.magnitude() <= MOST
    }

    /// Returns the limits that the conditions set to a/b, for a ≥ 0 and b of at least 1/[`MOST`].
    fn ratio(&self, arena: &Arena, a: NodeId, b: NodeId) -> (f64, f64) {
        let (mut low, mut high) = (0.0_f64, f64::INFINITY);
        if self.hull(b).lo() < 1.0 / MOST {
            return (low, high);
        }
        for &Condition { relation, left, right } in &self.conditions {
            for (x, y, relation) in [(left, right, relation), (right, left, relation.swapped())] {
                // x against y, where one is a and the other k·b.
                let (Some(of_x), Some(of_y)) = (multiple(arena, x, a), multiple(arena, y, b)) else {
                    continue;
                };
                if of_x <= 0.0 || of_y <= 0.0 {
                    continue;
                }
                let limit = of_y / of_x;
                match relation {
                    Relation::Le | Relation::Lt => high = high.min(limit),
                    Relation::Ge | Relation::Gt => low = low.max(limit),
                    Relation::Eq => (low, high) = (low.max(limit), high.min(limit)),
                    Relation::Ne => {}
                }
            }
        }
        (low, high)
    }
}

/// Returns the number by which a node is multiplied in another one.
fn multiple(arena: &Arena, x: NodeId, of: NodeId) -> Option<f64> {
    if x == of {
        return Some(1.0);
    }
    match arena.node(x) {
        Node::Binary(Binary::Mul, a, b) if a == of => arena.as_constant(b),
        Node::Binary(Binary::Mul, a, b) if b == of => arena.as_constant(a),
        Node::Binary(Binary::Div, a, b) if a == of => arena.as_constant(b).map(|divisor| 1.0 / divisor),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Domain;

    #[test]
    fn a_condition_limits_the_square_of_a_ratio() {
        let mut arena = Arena::default();
        let (a, r) = (arena.input(0), arena.input(1));
        let (aa, rr) = (arena.binary(Binary::Mul, a, a), arena.binary(Binary::Mul, r, r));
        let ratio = arena.binary(Binary::Div, rr, aa);
        let limit = arena.constant(0.999);
        let most = arena.binary(Binary::Mul, limit, a);
        let mut path =
            Enclosures::new(Domain::new(vec![Interval::new(500.0, 2000.0), Interval::new(0.0, 2000.0)]));
        assert!(path.assume(&arena, Condition::new(Relation::Le, r, most)));
        let range = path.enclose(&arena, ratio);
        // 0.999² = 0.998001.
        assert!(range.hi() >= 0.998_001 && range.hi() < 0.998_001_000_1, "{range:?}");
        assert_eq!(range.lo(), 0.0);
        // The values of r = 0.999·a lie inside.
        for a in [500.0, 777.7, 1234.567, 2000.0] {
            let value = arena.evaluate(ratio, &[a, 0.999 * a]).unwrap();
            assert!(range.contains(value), "{value}");
        }
    }

    #[test]
    fn a_negative_value_has_no_limit() {
        let mut arena = Arena::default();
        let (a, r) = (arena.input(0), arena.input(1));
        let ratio = arena.binary(Binary::Div, r, a);
        let mut path = Enclosures::new(Domain::new(vec![Interval::new(1.0, 2.0), Interval::new(-10.0, 2.0)]));
        assert!(path.assume(&arena, Condition::new(Relation::Le, r, a)));
        assert!(path.enclose(&arena, ratio).lo() <= -10.0);
    }
}
