//! Quotients in polynomials of values, and differences by those of their squares.
use std::collections::BTreeMap;

use crate::algebra::{Algebra, LOST, MARGIN};
use crate::interval::{Interval, add_up};
use crate::model::HALF_ULP;
use crate::node::{Binary, Node, NodeId};
use crate::polynomial::{Monomial, Polynomial};

impl Algebra<'_> {
    /// Returns a range of a value whose quotients are multiplied by their divisors, and the polynomial without them.
    pub(crate) fn quotients_removed(&mut self, polynomial: &Polynomial) -> Option<(Interval, Polynomial)> {
        let (rest, weight) = self.without_quotients(polynomial)?;
        let least = weight.mignitude();
        if least <= LOST {
            return None;
        }
        let bound = (self.norm(&rest) + rest.error) * MARGIN / least * MARGIN;
        let bound = add_up(bound, LOST);
        bound.is_finite().then(|| (Interval::new(-bound, bound), rest))
    }

    /// Returns a polynomial × the divisors of its quotients, and the range of their product.
    pub(crate) fn without_quotients(&mut self, polynomial: &Polynomial) -> Option<(Polynomial, Interval)> {
        let mut rest = polynomial.clone();
        let mut weight = Interval::point(1.0);
        for _ in 0..6 {
            let is_quotient = |atom: &NodeId| {
                matches!(self.arena.node(*atom), Node::Binary(Binary::Div, ..)) && !self.is_opaque(*atom)
            };
            let quotients = rest.terms.keys().flatten().map(|(atom, _)| *atom).filter(is_quotient);
            let Some(quotient) = quotients.max() else { break };
            let Node::Binary(Binary::Div, a, b) = self.arena.node(quotient) else { break };
            let power_of = |monomial: &Monomial| {
                monomial.iter().find(|(atom, _)| *atom == quotient).map_or(0, |(_, power)| *power)
            };
            let most = rest.terms.keys().map(power_of).max().unwrap_or(0);
            if most > 4 {
                return None;
            }
            let (mut dividend, divisor) = ((*self.node(a)?).clone(), self.node(b)?);
            // The quotient × its divisor is the dividend, but for a rounding.
            let rounding = (self.hull)(a).magnitude() * (HALF_ULP + self.arena.widening()) * MARGIN;
            let rounding = self.of_computed(rounding + (self.hull)(b).magnitude() * LOST + LOST);
            dividend.error = add_up(dividend.error, rounding);
            let mut next = Polynomial::default();
            let of_divisor = (self.hull)(b);
            for (monomial, value) in rest.terms.clone() {
                let power = power_of(&monomial);
                let others = monomial.into_iter().filter(|(atom, _)| *atom != quotient).collect();
                let mut part = Polynomial { terms: BTreeMap::from([(others, value)]), error: 0.0 };
                for _ in 0..power {
                    part = self.product(&part, &dividend)?;
                }
                for _ in power..most {
                    part = self.product(&part, &divisor)?;
                }
                next = self.sum(&next, &part);
            }
            let mut of_error = rest.error;
            for _ in 0..most {
                of_error *= of_divisor.magnitude() * MARGIN;
            }
            let magnitudes = Interval::new(of_divisor.mignitude(), of_divisor.magnitude());
            for factor in std::iter::repeat_n(of_divisor, most as usize % 2)
                .chain(std::iter::repeat_n(magnitudes, (most / 2 * 2) as usize))
            {
                weight = weight.times(factor);
            }
            next.error = add_up(next.error, of_error);
            rest = self.reduced(next)?;
        }
        Some((rest, weight))
    }

    /// Returns a range of a − b for a and b of 0 or more by the difference of their squares: |a − b| = |a² − b²|/(a + b), and
    /// at most √|a² − b²|. Returns what is left of the squares too, if that is a constant.
    pub(crate) fn by_squares(&mut self, node: NodeId) -> Option<(Interval, Polynomial)> {
        let Node::Binary(Binary::Sub, a, b) = self.arena.node(node) else { return None };
        let (of_a, of_b) = ((self.hull)(a), (self.hull)(b));
        if of_a.lo() < 0.0 || of_b.lo() < 0.0 {
            return None;
        }
        let (x, y) = (self.node(a)?, self.node(b)?);
        let (left, right) = (self.product(&x, &x)?, self.product(&y, &y)?);
        let size = left.largest().max(right.largest());
        let minus = self.scaled(&right, -1.0);
        let squares = self.sum(&left, &minus);
        let (range, rest) = self.quotients_removed(&squares)?;
        if !rest.is_constant(size) {
            return None;
        }
        let squares = range.magnitude();
        let by_sum = match of_a.lo() + of_b.lo() {
            sum if sum > 0.0 => squares / sum * MARGIN,
            _ => f64::INFINITY,
        };
        let bound = squares.sqrt().next_up().min(by_sum);
        // The computed difference is rounded too.
        let bound = add_up(bound, self.half_unit(node));
        bound.is_finite().then(|| (Interval::new(-bound, bound), rest))
    }
}
