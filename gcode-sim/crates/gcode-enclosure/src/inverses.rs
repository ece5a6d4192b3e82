//! Functions of their inverse functions: the argument, but for the errors of both.
use crate::algebra::{Algebra, MARGIN};
use crate::hull::FUNCTION_ERROR;
use crate::node::{Node, NodeId, Unary};

impl Algebra<'_> {
    /// Returns x and an error for a function of its inverse function: SIN[ASIN[x]], COS[ACOS[x]], TAN[ATAN[x]], EXP[LN[x]],
    /// LN[EXP[x]].
    pub(crate) fn inverse(&self, function: Unary, of: NodeId) -> Option<(NodeId, f64)> {
        let Node::Unary(inner, x) = self.arena.node(of) else { return None };
        if self.arena.widening() > 0.0 || self.is_real() {
            return None;
        }
        let (unit, size) = (FUNCTION_ERROR * MARGIN, (self.hull)(x).magnitude());
        let error = match (function, inner) {
            // As parts of a radian, with an error of one unit in each function: 1.6 of the arc, 1.6 of its degrees, 2.3 of a
            // turn's sum, 6.3 of the radians, 1 of the sine. Together they are less than four of the bound of a function.
            (Unary::Sin, Unary::Asin) | (Unary::Cos, Unary::Acos) => 8.0 * unit,
            // The slope of the tangent is 1 + x², and the angle is off by 90 units of a degree.
            (Unary::Tan, Unary::Atan) if size <= 1e5 => (3.0 * (1.0 + size * size) + 2.0 * size) * unit,
            (Unary::Exp, Unary::Ln) if (self.hull)(x).lo() >= 1e-290 => {
                size * ((self.hull)(of).magnitude() + 1.0) * 1.01 * unit
            }
            (Unary::Ln, Unary::Exp) if size <= 600.0 => (size + 1.0) * 1.01 * unit,
            _ => return None,
        };
        Some((x, error))
    }

    /// Returns x of COS[ASIN[x]] and SIN[ACOS[x]], whose square is 1 − x².
    pub(crate) fn leg(&self, atom: NodeId) -> Option<NodeId> {
        let Node::Unary(function, angle) = self.arena.node(atom) else { return None };
        match (function, self.arena.node(angle)) {
            (Unary::Cos, Node::Unary(Unary::Asin, x)) | (Unary::Sin, Node::Unary(Unary::Acos, x)) => Some(x),
            _ => None,
        }
        .filter(|_| self.arena.widening() == 0.0 && !self.is_real())
    }
}
