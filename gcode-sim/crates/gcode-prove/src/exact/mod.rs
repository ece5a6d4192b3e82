//! Exact forms: the real number that an expression computes but for its rounding errors, and a bound of these.
//!
//! Two formulas for one thing differ by rounding errors alone. In doubles over a box neither ranges nor polynomials of a limited
//! degree see that; here each expression is a sum of products of its inputs and of square roots, with its own error bound, and
//! what is equal cancels (Higham, Accuracy and Stability of Numerical Algorithms, for the bounds).
mod polynomial;

use std::collections::HashMap;

pub use self::polynomial::{Atom, Polynomial};
use self::polynomial::{Lost, Powers};

use gcode_enclosure::{Arena, Binary, Enclosures, Node, NodeId, Unary};

/// Form of a node: the double is `real`·(1 + δ) + ε with |δ| ≤ `relative` and |ε| ≤ `absolute`.
#[derive(Clone, Debug)]
pub struct ExactForm {
    /// Real number.
    pub real: Polynomial,
    /// Bound of the relative error.
    pub relative: f64,
    /// Bound of the absolute error.
    pub absolute: f64,
}

/// Rounding of one operation, and a margin for the arithmetic of bounds.
const ROUNDING: f64 = f64::EPSILON * 0.500_001;

/// Bound of what an operation loses to underflow.
const UNDERFLOW: f64 = 5e-324;

/// Smallest magnitude at which an operation surely loses nothing to underflow.
const NORMAL: f64 = 1e-290;

/// Margin for the rounding of a bound's own arithmetic.
const MARGIN: f64 = 1.0 + 1e-9;

/// Largest number of products in a sum.
const MAX_TERMS: usize = 64;

/// Exact forms of nodes over one box.
#[derive(Debug)]
pub struct ExactForms<'a> {
    arena: &'a Arena,
    enclosures: &'a mut Enclosures,
    forms: HashMap<NodeId, ExactForm>,
    /// Radicands of the roots; none is negative.
    roots: Vec<Polynomial>,
}

impl<'a> ExactForms<'a> {
    /// Returns the forms over the box of enclosures, under their conditions.
    pub fn new(arena: &'a Arena, enclosures: &'a mut Enclosures) -> Self {
        Self { arena, enclosures, forms: HashMap::new(), roots: Vec::new() }
    }

    /// Returns the form of a node.
    pub fn form(&mut self, node: NodeId) -> ExactForm {
        if let Some(form) = self.forms.get(&node) {
            return form.clone();
        }
        let form = self.compute(node);
        let form = form.filter(|form| {
            form.real.terms.len() <= MAX_TERMS && form.relative < 1e-3 && form.absolute < f64::INFINITY
        });
        let form = form.unwrap_or_else(|| exact(Polynomial::atom(Atom::Node(node))));
        self.forms.insert(node, form.clone());
        form
    }

    /// Returns the bound of a double's distance from its real number.
    pub fn error(&mut self, node: NodeId) -> f64 {
        let form = self.form(node);
        let magnitude = self.enclosures.enclose(self.arena, node).magnitude() + form.absolute;
        (magnitude * form.relative / (1.0 - form.relative) + form.absolute) * MARGIN
    }

    /// Returns the least and the largest magnitude of a node's doubles.
    pub fn magnitudes(&mut self, node: NodeId) -> (f64, f64) {
        let range = self.enclosures.enclose(self.arena, node);
        (range.mignitude(), range.magnitude())
    }

    /// Returns the form of an operation; `None` if it is taken as an atom.
    fn compute(&mut self, node: NodeId) -> Option<ExactForm> {
        match self.arena.node(node) {
            Node::Constant(value) => Some(exact(Polynomial::constant(value))),
            Node::Input(_) => None,
            Node::Unary(Unary::Neg, x) => {
                let x = self.form(x);
                Some(ExactForm { real: x.real.negated(), ..x })
            }
            Node::Unary(Unary::Abs, x) => {
                let range = self.enclosures.enclose(self.arena, x);
                let form = self.form(x);
                if range.lo() >= 0.0 {
                    Some(form)
                } else if range.hi() <= 0.0 {
                    Some(ExactForm { real: form.real.negated(), ..form })
                } else {
                    None
                }
            }
            Node::Unary(Unary::Round, x) => {
                let form = self.form(x);
                Some(ExactForm { absolute: (form.absolute + 0.5) * MARGIN, ..form })
            }
            Node::Unary(Unary::Sqrt, x) => self.root(x),
            Node::Unary(..) => None,
            Node::Binary(Binary::Add, a, b) => self.sum(a, b, false),
            Node::Binary(Binary::Sub, a, b) => self.sum(a, b, true),
            Node::Binary(Binary::Mul, a, b) => self.product(a, b),
            Node::Binary(Binary::Div, a, b) => self.quotient(a, b),
            Node::Binary(..) => None,
        }
    }

    fn sum(&mut self, a: NodeId, b: NodeId, is_difference: bool) -> Option<ExactForm> {
        let (left, right) = (self.form(a), self.form(b));
        if self.arena.as_constant(b) == Some(0.0) {
            return Some(left);
        }
        let (of_left, of_right) =
            (self.enclosures.enclose(self.arena, a), self.enclosures.enclose(self.arena, b));
        let mut lost = Lost::new();
        let second = if is_difference { right.real.negated() } else { right.real.clone() };
        let real = left.real.plus(&second, &mut lost);
        let lost = self.lost(&lost);
        let is_exact = |form: &ExactForm| form.relative == 0.0 && form.absolute == 0.0;
        let have_one_sign = match is_difference {
            false => {
                of_left.lo() >= 0.0 && of_right.lo() >= 0.0 || of_left.hi() <= 0.0 && of_right.hi() <= 0.0
            }
            true => {
                of_left.lo() >= 0.0 && of_right.hi() <= 0.0 || of_left.hi() <= 0.0 && of_right.lo() >= 0.0
            }
        };
        if is_exact(&left) && is_exact(&right) && lost == 0.0 {
            if !is_difference && left.real == right.real {
                // Twice a double is a double.
                return Some(exact(real));
            }
            return Some(ExactForm { real, relative: ROUNDING, absolute: 0.0 });
        }
        // Without absolute errors the real numbers have the signs of the doubles.
        if have_one_sign && left.absolute == 0.0 && right.absolute == 0.0 && lost == 0.0 {
            let relative = left.relative.max(right.relative);
            return Some(ExactForm { real, relative: (relative + ROUNDING) * MARGIN, absolute: 0.0 });
        }
        let error = |form: &ExactForm, magnitude: f64| {
            (magnitude + form.absolute) * form.relative / (1.0 - form.relative) + form.absolute
        };
        let absolute = error(&left, of_left.magnitude()) + error(&right, of_right.magnitude()) + lost;
        Some(ExactForm { real, relative: ROUNDING, absolute: absolute * (1.0 + f64::EPSILON) * MARGIN })
    }

    fn product(&mut self, a: NodeId, b: NodeId) -> Option<ExactForm> {
        for (factor, other) in [(a, b), (b, a)] {
            // The correction of halves in the rounding of a word.
            if let Some(value) = self.arena.as_constant(factor)
                && (value - 1.0).abs() < 1e-14
            {
                let form = self.form(other);
                let relative = (form.relative + (value - 1.0).abs() + ROUNDING) * (1.0 + 1e-3);
                let absolute = form.absolute * (1.0 + 1e-13) + UNDERFLOW;
                return Some(ExactForm { relative, absolute, ..form });
            }
        }
        let (left, right) = (self.form(a), self.form(b));
        let mut lost = Lost::new();
        let product = left.real.times(&right.real, &mut lost);
        let real = self.reduced(product, &mut lost)?;
        let lost = self.lost(&lost);
        let magnitudes = [a, b].map(|node| self.enclosures.enclose(self.arena, node).magnitude());
        let of_left = (magnitudes[0] + left.absolute) * (1.0 + 2.0 * left.relative);
        let of_right = (magnitudes[1] + right.absolute) * (1.0 + 2.0 * right.relative);
        let is_scaled = |node: NodeId| {
            self.arena.as_constant(node).is_some_and(|value| value.abs() >= 1.0 && is_power_of_two(value))
        };
        let relative = if is_scaled(a) || is_scaled(b) { 0.0 } else { ROUNDING };
        let relative = grown(left.relative + right.relative + relative);
        let cross = of_left * right.absolute + of_right * left.absolute + left.absolute * right.absolute;
        let underflow =
            if self.least_magnitude(a) * self.least_magnitude(b) >= NORMAL { 0.0 } else { UNDERFLOW };
        Some(ExactForm { real, relative, absolute: cross * MARGIN + 1.01 * lost + underflow })
    }

    fn quotient(&mut self, a: NodeId, b: NodeId) -> Option<ExactForm> {
        let (left, right) = (self.form(a), self.form(b));
        let (powers, divisor) = right.real.only_term()?;
        let mut lost = Lost::new();
        let real = left.real.over(powers, divisor, &mut lost);
        let real = self.reduced(real, &mut lost)?;
        let lost = self.lost(&lost);
        let of_divisor = self.enclosures.enclose(self.arena, b);
        // A divisor of 0 has raised an alarm.
        let least = of_divisor.mignitude().max(self.least_magnitude(b)) * (1.0 - 1e-12);
        let mut of_right = right.relative;
        if right.absolute > 0.0 {
            of_right += 1.01 * right.absolute / (of_divisor.mignitude() - right.absolute).max(0.0);
        }
        let is_halved = self.arena.as_constant(b).is_some_and(is_power_of_two);
        let relative = grown(left.relative + of_right + if is_halved { 0.0 } else { ROUNDING });
        let absolute = if left.absolute == 0.0 { 0.0 } else { left.absolute / least };
        let underflow =
            if self.least_magnitude(a) / of_divisor.magnitude() >= NORMAL { 0.0 } else { UNDERFLOW };
        (of_right < 0.01).then_some(ExactForm {
            real,
            relative,
            absolute: absolute * MARGIN + 1.02 * lost + underflow,
        })
    }

    fn root(&mut self, x: NodeId) -> Option<ExactForm> {
        let form = self.form(x);
        // With a relative error alone the real number has the sign of the double, whose root has raised no alarm.
        let (relative, absolute) = if form.absolute == 0.0 {
            (form.relative / 2.0 / (1.0 - form.relative) + ROUNDING, 0.0)
        } else {
            let least =
                self.enclosures.enclose(self.arena, x).mignitude() * (1.0 - form.relative) - form.absolute;
            if least <= 0.0 {
                return None;
            }
            (form.relative + ROUNDING, 1.01 * form.absolute / libm::sqrt(least))
        };
        let real = self.root_of(form.real);
        Some(ExactForm { real, relative: grown(relative), absolute })
    }

    /// Returns the root of a polynomial that isn't negative.
    fn root_of(&mut self, radicand: Polynomial) -> Polynomial {
        if let Some((powers, factor)) = radicand.only_term()
            && powers.iter().all(|(atom, exponent)| exponent % 2 == 0 && self.is_positive(*atom))
        {
            let root = libm::sqrt(factor);
            if root * root == factor && libm::fma(root, root, -factor) == 0.0 {
                let halves: Powers = powers.iter().map(|(atom, exponent)| (*atom, exponent / 2)).collect();
                return Polynomial { terms: [(halves, root)].into() };
            }
        }
        let known = self.roots.iter().position(|root| *root == radicand);
        let index = known.unwrap_or_else(|| {
            self.roots.push(radicand);
            self.roots.len() - 1
        });
        Polynomial::atom(Atom::Root(index))
    }

    /// Replaces squares of roots by their radicands.
    fn reduced(&self, mut polynomial: Polynomial, lost: &mut Lost) -> Option<Polynomial> {
        for _ in 0..64 {
            let is_square = |(atom, exponent): &(Atom, i32)| matches!(atom, Atom::Root(_)) && *exponent >= 2;
            let found = polynomial.terms.keys().find(|powers| powers.iter().any(is_square)).cloned();
            let Some(powers) = found else { return Some(polynomial) };
            let factor = polynomial.terms.remove(&powers)?;
            let place = powers.iter().position(is_square)?;
            let Atom::Root(root) = powers[place].0 else { return None };
            let mut rest = powers.clone();
            rest[place].1 -= 2;
            rest.retain(|(_, exponent)| *exponent != 0);
            let rest = Polynomial { terms: [(rest, factor)].into() };
            let replaced = rest.times(&self.roots[root], lost);
            polynomial = polynomial.plus(&replaced, lost);
            if polynomial.terms.len() > MAX_TERMS {
                return None;
            }
        }
        None
    }

    /// Returns the real sum of products of polynomials, each with a factor.
    pub fn combine(&mut self, parts: &[(f64, &[&Polynomial])]) -> Option<(Polynomial, f64)> {
        let mut lost = Lost::new();
        let mut sum = Polynomial::default();
        for (factor, factors) in parts {
            let mut product = Polynomial::constant(*factor);
            for factor in *factors {
                product = self.reduced(product.times(factor, &mut lost), &mut lost)?;
            }
            sum = sum.plus(&product, &mut lost);
        }
        let lost = self.lost(&lost);
        lost.is_finite().then_some((sum, lost))
    }

    /// Returns the inverse of a product of atoms.
    pub fn inverse(&self, polynomial: &Polynomial) -> Option<Polynomial> {
        let (powers, factor) = polynomial.only_term()?;
        (factor == 1.0).then(|| Polynomial::constant(1.0).over(powers, 1.0, &mut Lost::new()))
    }

    /// Returns true if no factor and no atom of a polynomial can be negative.
    pub fn is_nonnegative(&mut self, polynomial: &Polynomial) -> bool {
        let terms: Vec<_> =
            polynomial.terms.iter().map(|(powers, factor)| (powers.clone(), *factor)).collect();
        terms.iter().all(|(powers, factor)| {
            *factor >= 0.0
                && powers.iter().all(|(atom, exponent)| exponent % 2 == 0 || self.is_positive(*atom))
        })
    }

    /// Returns true if an atom isn't negative.
    fn is_positive(&mut self, atom: Atom) -> bool {
        match atom {
            Atom::Node(node) => self.enclosures.enclose(self.arena, node).lo() >= 0.0,
            Atom::Root(_) => true,
        }
    }

    /// Returns a bound of a polynomial's magnitude; infinite without one.
    pub fn magnitude(&mut self, polynomial: &Polynomial) -> f64 {
        let terms: Vec<_> =
            polynomial.terms.iter().map(|(powers, factor)| (powers.clone(), *factor)).collect();
        self.lost(&terms.into_iter().map(|(powers, factor)| (powers, factor.abs())).collect())
    }

    /// Returns a bound below a polynomial; of a magnitude it uses that it isn't below its argument, of either sign.
    pub fn least(&mut self, polynomial: &Polynomial) -> f64 {
        let mut least = self.least_by_terms(polynomial);
        for (powers, factor) in polynomial.terms.clone() {
            let [(Atom::Node(node), 1)] = powers.as_slice() else { continue };
            let Node::Unary(Unary::Abs, argument) = self.arena.node(*node) else { continue };
            if factor <= 0.0 {
                continue;
            }
            let mut rest = polynomial.clone();
            rest.terms.remove(&powers);
            let (argument, error) = (self.form(argument).real, self.error(argument));
            for sign in [factor, -factor] {
                let mut lost = Lost::new();
                let scaled = argument.times(&Polynomial::constant(sign), &mut lost);
                let other = rest.plus(&scaled, &mut lost);
                let lost = self.lost(&lost);
                least = least.max(self.least_by_terms(&other) - (lost + factor * error) * MARGIN);
            }
        }
        least
    }

    /// Returns the sum of bounds below each product.
    fn least_by_terms(&mut self, polynomial: &Polynomial) -> f64 {
        let (mut sum, mut magnitude) = (0.0, 0.0);
        for (powers, factor) in &polynomial.terms {
            let (mut low, mut high) = (1.0, 1.0);
            for (atom, exponent) in powers {
                let (from, to) = match atom {
                    Atom::Node(node) => {
                        let range = self.enclosures.enclose(self.arena, *node);
                        (range.lo(), range.hi())
                    }
                    Atom::Root(root) => {
                        let radicand = self.roots[*root].clone();
                        (0.0, libm::sqrt(self.magnitude(&radicand)) * MARGIN)
                    }
                };
                if *exponent < 0 && from <= 0.0 {
                    return f64::NEG_INFINITY;
                }
                for _ in 0..exponent.abs() {
                    let (from, to) = if *exponent < 0 { (1.0 / to, 1.0 / from) } else { (from, to) };
                    let ends: [f64; 4] = [low * from, low * to, high * from, high * to];
                    low = ends.into_iter().fold(f64::INFINITY, f64::min);
                    high = ends.into_iter().fold(f64::NEG_INFINITY, f64::max);
                }
            }
            let end = if *factor >= 0.0 { low * factor } else { high * factor };
            sum += end;
            magnitude += end.abs();
        }
        let least = sum - magnitude * (MARGIN - 1.0);
        if least.is_nan() { f64::NEG_INFINITY } else { least }
    }

    /// Returns the products whose magnitudes are above a limit, and the sum of the magnitudes of the others.
    pub fn without_small(&mut self, polynomial: &Polynomial, limit: f64) -> (Polynomial, f64) {
        let (mut large, mut rest) = (Polynomial::default(), 0.0);
        for (powers, factor) in &polynomial.terms {
            let magnitude = factor.abs() * self.magnitude_of(powers) * MARGIN;
            if magnitude <= limit {
                rest += magnitude;
            } else {
                large.terms.insert(powers.clone(), *factor);
            }
        }
        (large, rest * MARGIN)
    }

    /// Returns the sum of products' magnitudes.
    fn lost(&mut self, lost: &Lost) -> f64 {
        let mut sum = 0.0;
        for (powers, factor) in lost {
            sum += factor * self.magnitude_of(powers);
        }
        if sum.is_nan() { f64::INFINITY } else { sum * MARGIN }
    }

    fn magnitude_of(&mut self, powers: &Powers) -> f64 {
        let mut product = 1.0;
        for (atom, exponent) in powers {
            let (least, most) = match atom {
                Atom::Node(node) => {
                    let range = self.enclosures.enclose(self.arena, *node);
                    (range.mignitude(), range.magnitude())
                }
                Atom::Root(root) => {
                    let radicand = self.roots[*root].clone();
                    (0.0, libm::sqrt(self.magnitude(&radicand)) * MARGIN)
                }
            };
            let base = if *exponent > 0 { most } else { 1.0 / least };
            product *= libm::pow(base, f64::from(exponent.abs())) * MARGIN;
        }
        product
    }

    /// Returns a bound below the magnitude of every double of a node that isn't 0.
    fn least_magnitude(&mut self, node: NodeId) -> f64 {
        let range = self.enclosures.enclose(self.arena, node);
        if range.mignitude() > 0.0 {
            return range.mignitude();
        }
        let least = match self.arena.node(node) {
            // A difference of doubles is a multiple of the last place of the smaller one, or half as large as the larger one.
            Node::Binary(Binary::Add | Binary::Sub, a, b) => {
                let mut of = |node| self.enclosures.enclose(self.arena, node).mignitude();
                of(a).max(of(b)) * f64::EPSILON / 16.0
            }
            Node::Binary(Binary::Mul, a, b) => {
                let least = self.least_magnitude(a) * self.least_magnitude(b) * (1.0 - 1e-12);
                if least >= NORMAL { least } else { UNDERFLOW }
            }
            Node::Binary(Binary::Div, a, b) => {
                let of_divisor = self.enclosures.enclose(self.arena, b).magnitude();
                let least = self.least_magnitude(a) / of_divisor * (1.0 - 1e-12);
                if least >= NORMAL { least } else { UNDERFLOW }
            }
            Node::Unary(Unary::Sqrt, x) => libm::sqrt(self.least_magnitude(x)) * (1.0 - 1e-12),
            Node::Unary(Unary::Neg | Unary::Abs, x) => self.least_magnitude(x),
            _ => UNDERFLOW,
        };
        least.max(UNDERFLOW)
    }
}

fn exact(real: Polynomial) -> ExactForm {
    ExactForm { real, relative: 0.0, absolute: 0.0 }
}

/// Returns the bound of a product's relative error, of the sum of its factors' bounds.
fn grown(sum: f64) -> f64 {
    sum * (1.0 + 3.0 * sum) * MARGIN
}

fn is_power_of_two(value: f64) -> bool {
    value.to_bits() & ((1 << 52) - 1) == 0
}

#[cfg(test)]
mod tests;
