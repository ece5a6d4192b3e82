//! Algebra of computed values: a node as a polynomial of the computed values of atoms, with a bound of all roundings between.
//!
//! An atom is an input or the result of an operation that is no sum and no product. Identities hold between computed values
//! up to their roundings: the square of a root is its argument, SIN² is 1 − COS², a quotient times its divisor is its
//! dividend. Two formulas of one quantity differ by what is left of the polynomial, mostly 0, and by the roundings. Where a
//! root's argument goes to 0 that says more than the root's own error: no root is taken of a rounding.
use std::collections::HashMap;
use std::rc::Rc;

use crate::arena::Arena;
use crate::hull::{FUNCTION_ERROR, SINE_ERROR};
use crate::interval::{Interval, add_up};
use crate::model::{HALF_ULP, is_power_of_two};
use crate::node::{Binary, Node, NodeId, Semantics, Unary};
use crate::polynomial::{Monomial, Polynomial, constant_of, merged};
use crate::real_values::RealValues;

/// Largest number of monomials.
pub(crate) const MAX_TERMS: usize = 48;
/// Largest number of nodes that are looked at.
pub(crate) const MAX_NODES: usize = 120;
/// Bound of what an operation loses to underflow.
pub(crate) const LOST: f64 = 1e-300;
/// Margin for the arithmetic of a bound.
pub(crate) const MARGIN: f64 = 1.0 + 1e-9;

/// Algebra over the ranges of nodes.
///
/// Of computed values, or of real ones: then identities hold exactly, but for those of computed angles.
pub(crate) struct Algebra<'a> {
    pub(crate) arena: &'a Arena,
    pub(crate) hull: &'a dyn Fn(NodeId) -> Interval,
    reals: Option<&'a RealValues>,
    known: HashMap<NodeId, Option<Rc<Polynomial>>>,
}

/// Range that stands for every range where only the form of an identity is asked.
const ANY: Interval = Interval::of_ends(1.0, 2.0);

/// Returns true if a sum or a difference is a constant as far as the algebra sees: an identity of two formulas.
pub(crate) fn is_identity(arena: &Arena, node: NodeId) -> bool {
    let mut algebra = Algebra::new(arena, &|_| ANY);
    algebra.difference_of(node).is_some_and(|(polynomial, size)| polynomial.is_constant(size))
}

/// Returns a range of the computed value of an identity.
pub(crate) fn range_of(arena: &Arena, node: NodeId, hull: &dyn Fn(NodeId) -> Interval) -> Option<Interval> {
    let mut algebra = Algebra::new(arena, hull);
    let polynomial = algebra.node(node)?;
    let plain = algebra.bound(&polynomial);
    let simplified = algebra.quotients_removed(&polynomial).map(|(bound, _)| bound);
    let squares = algebra.by_squares(node).map(|(bound, _)| bound);
    let all = [plain, simplified, squares, real_range_of(arena, node, hull)].into_iter().flatten();
    all.reduce(Interval::intersect)
}

/// Returns a range of the computed value of an identity by the real one: what is left of it, and all roundings.
fn real_range_of(arena: &Arena, node: NodeId, hull: &dyn Fn(NodeId) -> Interval) -> Option<Interval> {
    if arena.widening() > 0.0 {
        return None;
    }
    let reals = RealValues::of(arena, &[node], hull)?;
    let range = |node: NodeId| reals.range(arena, node);
    let mut algebra = Algebra::of_reals(arena, &range, &reals);
    let polynomial = algebra.node(node)?;
    let error = reals.error(node);
    let range = algebra.bound(&polynomial).filter(|_| error.is_finite())?;
    Some(range.widened(error))
}

impl<'a> Algebra<'a> {
    fn new(arena: &'a Arena, hull: &'a dyn Fn(NodeId) -> Interval) -> Self {
        Self { arena, hull, reals: None, known: HashMap::new() }
    }

    /// Returns the algebra of real values, whose ranges are given.
    pub(crate) fn of_reals(
        arena: &'a Arena,
        range: &'a dyn Fn(NodeId) -> Interval,
        reals: &'a RealValues,
    ) -> Self {
        Self { arena, hull: range, reals: Some(reals), known: HashMap::new() }
    }

    /// Returns true for an algebra of real values.
    pub(crate) fn is_real(&self) -> bool {
        self.reals.is_some()
    }

    /// Returns an error of computed values; those of real ones have none.
    pub(crate) fn of_computed(&self, error: f64) -> f64 {
        if self.is_real() { 0.0 } else { error }
    }

    /// Returns true for a node that stands for its computed value among real ones.
    pub(crate) fn is_opaque(&self, node: NodeId) -> bool {
        self.reals.is_some_and(|reals| reals.is_computed(node))
    }

    /// Returns what is left of an identity, and the size of the coefficients before.
    fn difference_of(&mut self, node: NodeId) -> Option<(Polynomial, f64)> {
        let size = |algebra: &mut Self| match algebra.arena.node(node) {
            Node::Binary(_, a, b) => {
                let (a, b) = (algebra.node(a)?, algebra.node(b)?);
                Some((a.largest().max(b.largest()), a.terms.len() + b.terms.len()))
            }
            _ => None,
        };
        let (size, count) = size(self)?;
        if count < 2 {
            return None;
        }
        let polynomial = self.node(node)?;
        if polynomial.is_constant(size) {
            return Some(((*polynomial).clone(), size));
        }
        if let Some((_, rest)) = self.quotients_removed(&polynomial)
            && rest.is_constant(size)
        {
            return Some((rest, size));
        }
        self.by_squares(node).map(|(_, rest)| (rest, size))
    }

    fn magnitude(&self, monomial: &Monomial) -> f64 {
        monomial.iter().fold(1.0, |product, (atom, power)| {
            (0..*power).fold(product, |product, _| product * (self.hull)(*atom).magnitude() * MARGIN)
        })
    }

    /// Returns a bound of the magnitude of a polynomial's part without and with its constant; its error is apart.
    fn norms(&self, polynomial: &Polynomial) -> (f64, f64) {
        let others = polynomial.terms.iter().filter(|(monomial, _)| !monomial.is_empty());
        let others =
            others.map(|(monomial, value)| value.abs() * self.magnitude(monomial)).sum::<f64>() * MARGIN;
        (others, add_up(others, constant_of(polynomial).abs()))
    }

    pub(crate) fn norm(&self, polynomial: &Polynomial) -> f64 {
        self.norms(polynomial).1
    }

    /// Returns a range of a value by its polynomial: around the constant.
    fn bound(&self, polynomial: &Polynomial) -> Option<Interval> {
        let around = add_up((self.norms(polynomial).0 + polynomial.error) * MARGIN, LOST);
        around.is_finite().then(|| Interval::point(constant_of(polynomial)).widened(around))
    }

    /// Returns a bound of an error of a node's operation that is a part of the result.
    fn rounding(&self, node: NodeId, relative: f64) -> f64 {
        self.of_computed((self.hull)(node).magnitude() * (relative * MARGIN + self.arena.widening()) + LOST)
    }

    /// Returns a bound of one rounding of a node's operation: half of the distance between the largest results.
    pub(crate) fn half_unit(&self, node: NodeId) -> f64 {
        let size = (self.hull)(node).magnitude();
        let half = (size.next_up() - size) / 2.0;
        self.of_computed(half + size * self.arena.widening() * MARGIN + LOST)
    }

    /// Returns the polynomial of a node.
    pub(crate) fn node(&mut self, node: NodeId) -> Option<Rc<Polynomial>> {
        if let Some(known) = self.known.get(&node) {
            return known.clone();
        }
        if self.known.len() >= MAX_NODES {
            return None;
        }
        self.known.insert(node, None);
        let found = self.compute(node).filter(|found| found.error.is_finite()).map(Rc::new);
        self.known.insert(node, found.clone());
        found
    }

    fn compute(&mut self, node: NodeId) -> Option<Polynomial> {
        match self.arena.node(node) {
            Node::Constant(value) => Some(Polynomial::constant(value)),
            _ if self.is_opaque(node) => Some(Polynomial::atom(node)),
            Node::Input(_) => Some(Polynomial::atom(node)),
            Node::Unary(Unary::Neg, x) => {
                let x = self.node(x)?;
                Some(self.scaled(&x, -1.0))
            }
            Node::Unary(Unary::Abs, x) if (self.hull)(x).lo() >= 0.0 => Some((*self.node(x)?).clone()),
            Node::Unary(Unary::Abs, x) if (self.hull)(x).hi() <= 0.0 => {
                let x = self.node(x)?;
                Some(self.scaled(&x, -1.0))
            }
            Node::Unary(function, x) => match self.inverse(function, x) {
                Some((inner, error)) => {
                    let mut inner = (*self.node(inner)?).clone();
                    inner.error = add_up(inner.error, error);
                    Some(inner)
                }
                None => Some(self.function(node, function, x)),
            },
            Node::Binary(operator, a, b) => self.operation(node, operator, a, b),
        }
    }

    fn operation(&mut self, node: NodeId, operator: Binary, a: NodeId, b: NodeId) -> Option<Polynomial> {
        let constant = self.arena.as_constant(b);
        let mut result = match (operator, constant) {
            (Binary::Add, _) => {
                let (a, b) = (self.node(a)?, self.node(b)?);
                self.sum(&a, &b)
            }
            (Binary::Sub, _) => {
                let (a, b) = (self.node(a)?, self.node(b)?);
                let minus = self.scaled(&b, -1.0);
                self.sum(&a, &minus)
            }
            (Binary::Mul, _) => {
                let (a, b) = (self.node(a)?, self.node(b)?);
                self.product(&a, &b)?
            }
            (Binary::Div, Some(divisor)) if is_power_of_two(divisor) => {
                let a = self.node(a)?;
                self.scaled(&a, 1.0 / divisor)
            }
            (Binary::Pow, Some(2.0)) => {
                let a = self.node(a)?;
                let mut square = self.product(&a, &a)?;
                square.error = add_up(square.error, self.rounding(node, FUNCTION_ERROR));
                square
            }
            (Binary::Atan, _) => return self.direction(a, b).or_else(|| Some(Polynomial::atom(node))),
            _ => return Some(Polynomial::atom(node)),
        };
        result.error = add_up(result.error, self.half_unit(node));
        (result.terms.len() <= MAX_TERMS).then_some(result)
    }

    /// Returns ATAN of r·SIN[t] and r·COS[t]: t, where t has one turn and r is positive.
    fn direction(&mut self, y: NodeId, x: NodeId) -> Option<Polynomial> {
        let ((radius, angle), of_x) = (self.polar(y, Unary::Sin)?, self.polar(x, Unary::Cos)?);
        let turn = match self.arena.semantics().returns_signed_angles {
            true => Interval::new(-180.0, 180.0),
            false => Interval::new(0.0, 360.0),
        };
        let range = (self.hull)(angle);
        // An angle below 0 has a turn more; nearer to a whole turn, its sine may be rounded to the other sign.
        let is_below = turn.lo() == 0.0 && range.lo() >= -359.99 && range.hi() <= -1e-200;
        // Neither coordinate underflows or overflows, but that of an angle below any rounding.
        let is_moderate =
            |radius: NodeId| (self.hull)(radius).lo() >= 1e-10 && (self.hull)(radius).hi() <= 1e100;
        if (radius, angle) != of_x
            || range.intersect(turn) != range && !is_below
            || !radius.is_none_or(is_moderate)
            || self.arena.widening() > 0.0
        {
            return None;
        }
        let mut direction = (*self.node(angle)?).clone();
        if is_below {
            direction = self.sum(&direction, &Polynomial::constant(360.0));
        }
        // Together: the conversion of at most 360°, two functions and two products as parts of a radian, the arc tangent
        // and its conversion of at most 180°, the sum with a turn.
        direction.error = add_up(direction.error, 6000.0 * f64::EPSILON);
        Some(direction)
    }

    /// Returns r and t of r·f[t]; no r where it is 1.
    fn polar(&self, node: NodeId, function: Unary) -> Option<(Option<NodeId>, NodeId)> {
        let angle_of = |node: NodeId| match self.arena.node(node) {
            Node::Unary(own, angle) if own == function => Some(angle),
            _ => None,
        };
        if let Some(angle) = angle_of(node) {
            return Some((None, angle));
        }
        let Node::Binary(Binary::Mul, a, b) = self.arena.node(node) else { return None };
        let of_left = angle_of(a).map(|angle| (Some(b), angle));
        of_left.or_else(|| angle_of(b).map(|angle| (Some(a), angle)))
    }

    /// Returns a function of one value: an atom, or what an identity says with another atom of the arena.
    fn function(&self, node: NodeId, function: Unary, x: NodeId) -> Polynomial {
        let atom = Polynomial::atom(node);
        let find = |function, x| self.arena.find_unary(function, x);
        let terms = |terms: &[(&[(NodeId, u32)], f64)], error: f64| Polynomial {
            terms: terms.iter().map(|(monomial, value)| (monomial.to_vec(), *value)).collect(),
            error,
        };
        let Semantics { returns_signed_angles, .. } = self.arena.semantics();
        let unit = FUNCTION_ERROR * MARGIN + self.arena.widening();
        match function {
            // Both functions and both conversions, of 90° and 180° at most.
            Unary::Acos if returns_signed_angles || (self.hull)(x).lo() >= 0.0 => {
                match find(Unary::Asin, x) {
                    Some(sine) => terms(&[(&[(sine, 1)], -1.0), (&[], 90.0)], 600.0 * unit),
                    None => atom,
                }
            }
            Unary::Ln if self.arena.widening() == 0.0 => {
                // The product is rounded, and all three logarithms.
                let (parts, sign) = match self.arena.node(x) {
                    Node::Binary(Binary::Mul, a, b) => ([a, b], 1.0),
                    Node::Binary(Binary::Div, a, b) => ([a, b], -1.0),
                    _ => return atom,
                };
                let [Some(first), Some(second)] = parts.map(|part| find(Unary::Ln, part)) else {
                    return atom;
                };
                let size = [node, first, second].map(|node| (self.hull)(node).magnitude());
                // A logarithm of the arena may be one of a way where the part is positive.
                let is_positive = parts.iter().all(|part| (self.hull)(*part).lo() > 0.0);
                if first == second || !is_positive || (self.hull)(x).lo() < 1e-290 {
                    return atom;
                }
                let error = (size.iter().sum::<f64>() + 2.0) * unit * MARGIN;
                terms(&[(&[(first, 1)], 1.0), (&[(second, 1)], sign)], error)
            }
            Unary::Exp if self.arena.widening() == 0.0 => {
                // The sum is rounded, and all three powers.
                let Node::Binary(Binary::Add, a, b) = self.arena.node(x) else { return atom };
                let (Some(first), Some(second)) = (find(function, a), find(function, b)) else { return atom };
                let moved = (self.hull)(x).magnitude() * HALF_ULP;
                let size = (self.hull)(node).magnitude();
                let least = [node, first, second].map(|node| (self.hull)(node).lo());
                if first == second || moved > 1e-3 || least.iter().any(|least| *least < 1e-290) {
                    return atom;
                }
                let both = [first.min(second), first.max(second)].map(|power| (power, 1));
                terms(&[(&both, 1.0)], size * (3.01 * unit + 1.01 * moved) * 1.01)
            }
            Unary::Sin | Unary::Cos if self.arena.widening() == 0.0 => {
                let Some(half) = self.half_of(x) else {
                    return self.of_angle_sum(function, x).unwrap_or(atom);
                };
                let (sine, cosine) = (find(Unary::Sin, half), find(Unary::Cos, half));
                // That of the double angle, and of a product that is counted twice: both angles convert alike.
                let error = if self.is_real() { LOST } else { 6.0 * SINE_ERROR * MARGIN };
                match (function, sine, cosine) {
                    (Unary::Cos, Some(sine), _) => terms(&[(&[], 1.0), (&[(sine, 2)], -2.0)], error),
                    (Unary::Cos, None, Some(cosine)) => terms(&[(&[], -1.0), (&[(cosine, 2)], 2.0)], error),
                    (Unary::Sin, Some(sine), Some(cosine)) => {
                        let both =
                            if sine < cosine { [(sine, 1), (cosine, 1)] } else { [(cosine, 1), (sine, 1)] };
                        terms(&[(&both, 2.0)], error)
                    }
                    _ => atom,
                }
            }
            _ => atom,
        }
    }

    /// Returns a polynomial × a number.
    pub(crate) fn scaled(&self, polynomial: &Polynomial, factor: f64) -> Polynomial {
        let mut scaled =
            Polynomial { error: polynomial.error * factor.abs() * MARGIN, ..Polynomial::default() };
        for (monomial, value) in &polynomial.terms {
            self.add_term(&mut scaled, monomial.clone(), *value, factor);
        }
        scaled
    }

    /// Adds a × b × a monomial; what the coefficient rounds away is part of the error.
    pub(crate) fn add_term(&self, to: &mut Polynomial, monomial: Monomial, a: f64, b: f64) {
        let product = a * b;
        let known = to.terms.get(&monomial).copied().unwrap_or(0.0);
        let sum = known + product;
        // What a product and a sum of doubles lose are doubles, unless the product is near the least one.
        let of_product = libm::fma(a, b, -product).abs() + if product.abs() > 1e-290 { 0.0 } else { LOST };
        let back = sum - known;
        let of_sum = (known - (sum - back)).abs() + (product - back).abs();
        let lost = of_product + of_sum;
        if lost > 0.0 {
            to.error = add_up(to.error, lost * self.magnitude(&monomial) * MARGIN);
        }
        if sum == 0.0 {
            to.terms.remove(&monomial);
        } else {
            to.terms.insert(monomial, sum);
        }
    }

    pub(crate) fn sum(&self, a: &Polynomial, b: &Polynomial) -> Polynomial {
        let mut sum = a.clone();
        sum.error = add_up(sum.error, b.error);
        for (monomial, value) in &b.terms {
            self.add_term(&mut sum, monomial.clone(), *value, 1.0);
        }
        sum
    }

    /// Returns the product, in which squares of roots, sines and magnitudes are replaced.
    pub(crate) fn product(&mut self, a: &Polynomial, b: &Polynomial) -> Option<Polynomial> {
        if a.terms.len() * b.terms.len() > MAX_TERMS * 4 {
            return None;
        }
        let (of_a, of_b) = (self.norm(a), self.norm(b));
        let error = (of_a * b.error + of_b * a.error + a.error * b.error) * MARGIN;
        let mut product = Polynomial { error, ..Polynomial::default() };
        for (left, x) in &a.terms {
            for (right, y) in &b.terms {
                self.add_term(&mut product, merged(left, right)?, *x, *y);
            }
        }
        self.reduced(product)
    }

    /// Replaces squares by what identities say.
    pub(crate) fn reduced(&mut self, mut polynomial: Polynomial) -> Option<Polynomial> {
        for _ in 0..200 {
            let found = polynomial.terms.iter().find_map(|(monomial, value)| {
                let atom = monomial.iter().find(|(atom, power)| *power >= 2 && self.has_square(*atom))?;
                Some((monomial.clone(), *value, atom.0))
            });
            let Some((monomial, value, atom)) = found else {
                return (polynomial.terms.len() <= MAX_TERMS).then_some(polynomial);
            };
            polynomial.terms.remove(&monomial);
            let rest: Monomial = monomial
                .iter()
                .map(|(other, power)| (*other, if *other == atom { power - 2 } else { *power }))
                .filter(|(_, power)| *power > 0)
                .collect();
            let square = self.square_of(atom)?;
            polynomial.error =
                add_up(polynomial.error, square.error * value.abs() * self.magnitude(&rest) * MARGIN);
            for (other, factor) in &square.terms {
                self.add_term(&mut polynomial, merged(&rest, other)?, value, *factor);
            }
        }
        None
    }

    fn has_square(&self, atom: NodeId) -> bool {
        match self.arena.node(atom) {
            _ if self.is_opaque(atom) => false,
            Node::Unary(Unary::Sqrt | Unary::Abs, _) => true,
            Node::Unary(Unary::Sin | Unary::Cos, _) if self.leg(atom).is_some() => true,
            Node::Unary(Unary::Sin, x) => self.arena.find_unary(Unary::Cos, x).is_some(),
            _ => false,
        }
    }

    /// Returns the square of an atom's computed value.
    fn square_of(&mut self, atom: NodeId) -> Option<Polynomial> {
        let widening = self.arena.widening();
        match self.arena.node(atom) {
            Node::Unary(Unary::Sqrt, x) => {
                let mut square = (*self.node(x)?).clone();
                // (√x·(1 + e))² − x = x·(2·e + e²).
                let relative = 2.0 * (HALF_ULP + widening) * (1.0 + 1e-3);
                let rounding = (self.hull)(x).magnitude() * relative * MARGIN + LOST;
                square.error = add_up(square.error, self.of_computed(rounding));
                Some(square)
            }
            Node::Unary(Unary::Abs, x) => {
                let x = self.node(x)?;
                self.product(&x, &x)
            }
            Node::Unary(Unary::Sin | Unary::Cos, _) if self.leg(atom).is_some() => {
                let leg = self.leg(atom)?;
                let x = self.node(leg)?;
                let minus = self.product(&x, &x).map(|square| self.scaled(&square, -1.0))?;
                let mut square = self.sum(&Polynomial::constant(1.0), &minus);
                // Twice the error of SIN[ASIN[x]].
                square.error = add_up(square.error, 25.0 * FUNCTION_ERROR);
                Some(square)
            }
            Node::Unary(Unary::Sin, x) => {
                let cosine = self.node(self.arena.find_unary(Unary::Cos, x)?)?;
                let minus = self.product(&cosine, &cosine).map(|square| self.scaled(&square, -1.0))?;
                let mut square = self.sum(&Polynomial::constant(1.0), &minus);
                square.error = add_up(square.error, self.of_computed(2.1 * (SINE_ERROR + widening)));
                Some(square)
            }
            _ => None,
        }
    }
}
