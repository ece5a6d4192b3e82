//! Certificates of inequalities: a lower bound of a polynomial of real values, by forms that show its sign.
//!
//! A sum of squares is 0 or more, a root is, and a product of conditions of the path is. For A ≥ 0 follows A ≥ B from
//! A² ≥ B², in which roots are squared. So Cauchy's inequality and that of the triangle hold without a division of the
//! box; what the computed sides are off is added.
use crate::algebra::{Algebra, MAX_NODES};
use crate::arena::Arena;
use crate::enclosures::Enclosures;
use crate::interval::{Interval, add_down, add_up, mul_up};
use crate::node::{Binary, Condition, Node, NodeId, Relation, Unary};
use crate::polynomial::{Monomial, Polynomial};
use crate::real_values::RealValues;

/// Largest number of forms in one another.
const MAX_DEPTH: u32 = 5;
/// Largest number of forms that are tried for one inequality.
const MAX_STEPS: u32 = 24;
/// Largest magnitude of an atom and of a coefficient: no product of them overflows.
const MAX_ATOM: f64 = 1e15;
/// Largest number of conditions of the path that are used.
const MAX_CONDITIONS: usize = 6;

/// A polynomial with a lower bound, by a condition of the path.
pub(crate) struct Fact {
    pub(crate) polynomial: Polynomial,
    pub(crate) least: f64,
}

/// Search for the lower bound of a polynomial of real values.
pub(crate) struct Certifier<'a> {
    pub(crate) algebra: Algebra<'a>,
    pub(crate) facts: Vec<Fact>,
    steps: u32,
}

impl Enclosures {
    /// Decides an inequality by a certificate of the real sides, and how far the computed ones are off.
    pub(crate) fn decide_by_certificate(
        &mut self,
        arena: &Arena,
        relation: Relation,
        left: NodeId,
        right: NodeId,
    ) -> Option<bool> {
        // Side a is at least side b where the condition is `of_greater`.
        let (a, b, of_greater) = match relation {
            Relation::Ge | Relation::Gt => (left, right, true),
            Relation::Le | Relation::Lt => (right, left, true),
            Relation::Eq | Relation::Ne => return None,
        };
        let is_strict = matches!(relation, Relation::Gt | Relation::Lt);
        if arena.widening() > 0.0 || arena.cone(&[a, b]).len() > MAX_NODES {
            return None;
        }
        let mut conditions: Vec<_> = self.conditions.iter().rev().take(MAX_CONDITIONS).copied().collect();
        let sides = conditions.iter().flat_map(|condition| [condition.left, condition.right]);
        let mut roots: Vec<_> = [a, b].into_iter().chain(sides).collect();
        if arena.cone(&roots).len() > MAX_NODES {
            conditions.clear();
            roots.truncate(2);
        }
        let hull = |node: NodeId| match self.forms.get(node.index()) {
            Some(Some(form)) => form.hull,
            _ => Interval::ALL,
        };
        let reals = RealValues::of(arena, &roots, &hull)?;
        let range = |node: NodeId| reals.range(arena, node);
        let mut algebra = Algebra::of_reals(arena, &range, &reals);
        let difference = algebra.difference(a, b)?;
        let error = add_up(reals.error(a), reals.error(b));
        let is_linear = |monomial: &Monomial| {
            let is_input =
                |(atom, power): &(NodeId, u32)| *power == 1 && arena.as_input(atom.index()).is_some();
            monomial.is_empty() || monomial.len() == 1 && monomial.iter().all(is_input)
        };
        // A polynomial of one term or of the first degree has its range.
        let terms = difference.terms.keys().filter(|monomial| !monomial.is_empty()).count();
        if !error.is_finite() || terms < 2 || difference.terms.keys().all(is_linear) {
            return None;
        }
        let facts = conditions.iter().flat_map(|condition| facts_of(&mut algebra, &reals, *condition));
        let facts: Vec<_> = facts.collect();
        let mut certifier = Certifier { algebra, facts, steps: 0 };
        let least = certifier.least(&difference, MAX_DEPTH);
        if least > error || least >= error && !is_strict {
            return Some(of_greater);
        }
        certifier.steps = 0;
        let opposite = certifier.algebra.scaled(&difference, -1.0);
        let least = certifier.least(&opposite, MAX_DEPTH);
        // b ≥ a decides a > b, b > a decides a ≥ b.
        (least > error || least >= error && is_strict).then_some(!of_greater)
    }
}

/// Returns what a condition says of real values.
fn facts_of(algebra: &mut Algebra<'_>, reals: &RealValues, condition: Condition) -> Vec<Fact> {
    let Condition { relation, left, right } = condition;
    let sides = match relation {
        Relation::Ge | Relation::Gt => vec![(left, right)],
        Relation::Le | Relation::Lt => vec![(right, left)],
        Relation::Eq => vec![(left, right), (right, left)],
        Relation::Ne => Vec::new(),
    };
    let mut facts = Vec::new();
    for (greater, less) in sides {
        let least = -add_up(reals.error(greater), reals.error(less));
        let Some(polynomial) = algebra.difference(greater, less).filter(|_| least.is_finite()) else {
            continue;
        };
        for polynomial in without_magnitudes(algebra, polynomial) {
            facts.push(Fact { polynomial, least });
        }
    }
    facts
}

/// Returns a polynomial with y and with −y for each −|y|, both of which are at least as large.
fn without_magnitudes(algebra: &mut Algebra<'_>, polynomial: Polynomial) -> Vec<Polynomial> {
    let magnitude = polynomial.terms.iter().find_map(|(monomial, value)| match monomial.as_slice() {
        &[(atom, 1)] if *value < 0.0 && !algebra.is_opaque(atom) => match algebra.arena.node(atom) {
            Node::Unary(Unary::Abs, of) => Some((monomial.clone(), *value, of)),
            _ => None,
        },
        _ => None,
    });
    let Some((monomial, value, of)) = magnitude else { return vec![polynomial] };
    let Some(of) = algebra.node(of) else { return vec![polynomial] };
    let mut rest = polynomial;
    rest.terms.remove(&monomial);
    [value, -value].map(|factor| algebra.sum(&rest, &algebra.scaled(&of, factor))).into()
}

impl Algebra<'_> {
    /// Returns the polynomial of a − b.
    fn difference(&mut self, a: NodeId, b: NodeId) -> Option<Polynomial> {
        let (a, b) = (self.node(a)?, self.node(b)?);
        let minus = self.scaled(&b, -1.0);
        Some(self.sum(&a, &minus))
    }

    /// Returns the range of a term.
    pub(crate) fn term_range(&self, monomial: &Monomial, value: f64) -> Interval {
        let mut range = Interval::point(value);
        for (atom, power) in monomial {
            let of_atom = (self.hull)(*atom);
            let square = Interval::new(of_atom.mignitude(), of_atom.magnitude());
            let square = square.times(square);
            for _ in 0..power / 2 {
                range = range.times(square);
            }
            if power % 2 == 1 {
                range = range.times(of_atom);
            }
        }
        range
    }

    /// Returns the bounds of a polynomial by the ranges of its terms; infinite ones where numbers are too large.
    pub(crate) fn bounds_of_terms(&self, polynomial: &Polynomial) -> (f64, f64) {
        let (mut lo, mut hi) = (-polynomial.error, polynomial.error);
        let is_moderate = |atom: NodeId| (self.hull)(atom).magnitude() <= MAX_ATOM;
        for (monomial, value) in &polynomial.terms {
            if value.abs() > MAX_ATOM || !monomial.iter().all(|(atom, _)| is_moderate(*atom)) {
                return (f64::NEG_INFINITY, f64::INFINITY);
            }
            let range = self.term_range(monomial, *value);
            (lo, hi) = (add_down(lo, range.lo()), add_up(hi, range.hi()));
        }
        (lo, hi)
    }
}

impl Certifier<'_> {
    /// Returns a lower bound of a polynomial.
    pub(crate) fn least(&mut self, polynomial: &Polynomial, depth: u32) -> f64 {
        let plain = self.algebra.bounds_of_terms(polynomial).0;
        self.steps += 1;
        let Some(depth) = depth.checked_sub(1).filter(|_| plain < 0.0 && self.steps < MAX_STEPS) else {
            return plain;
        };
        let without_quotients = self.by_quotients(polynomial, depth);
        if let Some(bound) = without_quotients {
            return plain.max(bound);
        }
        let mut best = plain;
        let forms = [Self::by_squares, Self::by_facts, Self::by_roots];
        for form in forms {
            if best < 0.0 {
                best = form(self, polynomial, depth).map_or(best, |bound| best.max(bound));
            }
        }
        best
    }

    /// Returns the bound of a polynomial with quotients by that of its product with the divisors.
    fn by_quotients(&mut self, polynomial: &Polynomial, depth: u32) -> Option<f64> {
        let is_quotient = |(atom, _): &(NodeId, u32)| {
            matches!(self.algebra.arena.node(*atom), Node::Binary(Binary::Div, ..))
                && !self.algebra.is_opaque(*atom)
        };
        if !polynomial.terms.keys().flatten().any(is_quotient) {
            return None;
        }
        let (rest, weight) = self.algebra.without_quotients(polynomial)?;
        if weight.magnitude() > MAX_ATOM * MAX_ATOM {
            return None;
        }
        let (rest, weight) = match (weight.lo() > 0.0, weight.hi() < 0.0) {
            (true, _) => (rest, weight),
            (_, true) => (self.algebra.scaled(&rest, -1.0), weight.times(Interval::point(-1.0))),
            _ => return None,
        };
        let least = self.least(&rest, depth);
        let divisor = if least < 0.0 { weight.lo() } else { weight.hi() };
        Some((least / divisor).next_down())
    }

    fn by_squares(&mut self, polynomial: &Polynomial, _: u32) -> Option<f64> {
        let rest = self.algebra.without_squares(polynomial)?;
        Some(self.algebra.bounds_of_terms(&rest).0)
    }

    /// Returns the bound of A − B, where A has the terms that are 0 or more, by that of A² − B².
    fn by_roots(&mut self, polynomial: &Polynomial, depth: u32) -> Option<f64> {
        let has_root = |monomial: &Monomial| {
            monomial.iter().any(|(atom, power)| {
                let is_root =
                    matches!(self.algebra.arena.node(*atom), Node::Unary(Unary::Sqrt | Unary::Abs, _));
                is_root && !self.algebra.is_opaque(*atom) && power % 2 == 1
            })
        };
        if !polynomial.terms.keys().any(&has_root) {
            return None;
        }
        // A has the terms with roots; or all, or all but the number.
        let part = |is_part: &dyn Fn(&Monomial) -> bool| {
            let of_part = |(monomial, value): &(&Monomial, &f64)| {
                is_part(monomial) && self.algebra.term_range(monomial, **value).lo() >= 0.0
            };
            let terms = polynomial.terms.iter().filter(of_part);
            let terms = terms.map(|(monomial, value)| (monomial.clone(), *value));
            Polynomial { terms: terms.collect(), error: 0.0 }
        };
        let parts = [part(&has_root), part(&|monomial| !monomial.is_empty()), part(&|_| true)];
        let mut best: Option<f64> = None;
        for (place, part) in parts.iter().enumerate() {
            let is_known = parts[..place].iter().any(|known| known.terms == part.terms);
            if part.terms.is_empty() || is_known || best.is_some_and(|best| best >= 0.0) {
                continue;
            }
            let bound = self.by_squared_sides(polynomial, part, depth);
            best = bound.into_iter().chain(best).reduce(f64::max);
        }
        best
    }

    /// Returns the bound of a polynomial A − B for A ≥ 0.
    ///
    /// If B > A, then 0 < (B − A)² ≤ (B − A)·(A + B) = B² − A². A number of the polynomial that belongs to neither side is
    /// added behind.
    fn by_squared_sides(&mut self, polynomial: &Polynomial, a: &Polynomial, depth: u32) -> Option<f64> {
        let number = match a.terms.contains_key(&Monomial::new()) {
            true => 0.0,
            false => polynomial.terms.get(&Monomial::new()).copied().unwrap_or(0.0).max(0.0),
        };
        let mut b = self.algebra.scaled(polynomial, -1.0);
        b.error = 0.0;
        if number > 0.0 {
            b.terms.remove(&Monomial::new());
        }
        for monomial in a.terms.keys() {
            b.terms.remove(monomial);
        }
        let (of_a, of_b) = (self.algebra.product(a, a)?, self.algebra.product(&b, &b)?);
        let minus = self.algebra.scaled(&of_b, -1.0);
        let squares = self.algebra.sum(&of_a, &minus);
        let least = self.least(&squares, depth);
        let (low, high) = self.algebra.bounds_of_terms(a);
        let least = if least >= 0.0 {
            let sum = mul_up(2.0, high);
            if sum > 0.0 { (least / sum).next_down().max(0.0) } else { 0.0 }
        } else {
            let by_sum = if low > 0.0 { (-least / low).next_up() } else { f64::INFINITY };
            -(-least).sqrt().next_up().min(by_sum)
        };
        Some(add_down(add_down(least, number), -polynomial.error))
    }
}
