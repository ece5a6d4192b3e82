//! Sines and cosines of sums of angles, by those of the parts.
use gcode_lang::units::Deg;

use crate::algebra::{Algebra, MARGIN};
use crate::hull::SINE_ERROR;
use crate::node::{Binary, Node, NodeId, Unary};
use crate::polynomial::{Monomial, Polynomial, merged};

/// Largest angle whose parts are told apart, in degrees.
const MAX_ANGLE: f64 = 1e6;

impl Algebra<'_> {
    /// Returns SIN or COS of a sum or a difference of angles; `None` unless the arena has both functions of both parts.
    ///
    /// Of a number, both are known.
    pub(crate) fn of_angle_sum(&self, function: Unary, x: NodeId) -> Option<Polynomial> {
        let (a, b, sign) = match self.arena.node(x) {
            Node::Binary(Binary::Add, a, b) => (a, b, 1.0),
            Node::Binary(Binary::Sub, a, b) => (a, b, -1.0),
            _ => return None,
        };
        let ([sine_a, cosine_a], [sine_b, cosine_b]) = (self.directions(a)?, self.directions(b)?);
        let products = match function {
            Unary::Sin => [(sine_a, cosine_b, 1.0), (cosine_a, sine_b, sign)],
            _ => [(cosine_a, cosine_b, 1.0), (sine_a, sine_b, -sign)],
        };
        let size = |node: NodeId| (self.hull)(node).magnitude();
        let (of_sum, of_parts) = (size(x), size(a) + size(b));
        if of_sum.max(of_parts) > MAX_ANGLE {
            return None;
        }
        // The conversion of each angle, the rounding of the sum, and five functions of which each is 1 at most.
        let radians = (1.5 * of_sum + of_parts) * f64::EPSILON * 0.017_454;
        // Real functions of both parts have no error, but a number's are computed.
        let is_exact = self.is_real() && [a, b].iter().all(|part| self.arena.as_constant(*part).is_none());
        let of_functions = if is_exact { 0.0 } else { 6.0 * SINE_ERROR };
        let mut sum = Polynomial { error: (radians + of_functions) * MARGIN, ..Polynomial::default() };
        for ((left, x), (right, y), sign) in products {
            // A coefficient that is the product of two numbers is rounded.
            let coefficient = x * y * sign;
            sum.error += f64::EPSILON;
            *sum.terms.entry(merged(&left, &right)?).or_insert(0.0) += coefficient;
        }
        sum.terms.retain(|_, coefficient| *coefficient != 0.0);
        Some(sum)
    }

    /// Returns SIN and COS of an angle as an atom or a number.
    fn directions(&self, angle: NodeId) -> Option<[(Monomial, f64); 2]> {
        if let Some(angle) = self.arena.as_constant(angle) {
            return Some([Deg(angle).sin(), Deg(angle).cos()].map(|value| (Monomial::new(), value)));
        }
        let find = |function| Some((vec![(self.arena.find_unary(function, angle)?, 1)], 1.0));
        Some([find(Unary::Sin)?, find(Unary::Cos)?])
    }

    /// Returns the node of which another is the double, without a rounding.
    pub(crate) fn half_of(&self, x: NodeId) -> Option<NodeId> {
        let of_product = match self.arena.node(x) {
            Node::Binary(Binary::Mul, a, b) if self.arena.as_constant(a) == Some(2.0) => Some(b),
            Node::Binary(Binary::Mul, a, b) if self.arena.as_constant(b) == Some(2.0) => Some(a),
            Node::Binary(Binary::Add, a, b) if a == b => Some(a),
            _ => None,
        };
        of_product.or_else(|| self.arena.find_half(x))
    }
}
