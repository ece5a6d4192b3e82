//! Taylor models: a polynomial and the bound of everything that it leaves out.
use crate::basis::Basis;
use crate::interval::{Interval, add_up, mul_up};

/// A polynomial of the variables of a box and a bound of the distance from it.
///
/// The value of a node at a point of the box is the polynomial there, ± `rest`. Coefficients are doubles; what their
/// arithmetic rounds away is part of `rest`.
#[derive(Clone, Debug)]
pub(crate) struct Model {
    /// Coefficients by monomial, in the order of the monomials.
    pub(crate) terms: Vec<(u32, f64)>,
    pub(crate) rest: f64,
}

/// Bound of the relative rounding error of one operation.
pub(crate) const HALF_ULP: f64 = f64::EPSILON / 2.0;
/// Bound of the relative error of a sum of magnitudes, of fewer than 10^6 terms.
const SUM_MARGIN: f64 = 1.0 + 1e-9;
/// Largest number of terms of a factor, unless the other one has few.
const MAX_TERMS: usize = 160;
/// Bound of what products lose to underflow in one operation of models.
const LOST: f64 = 1e-300;

impl Model {
    pub(crate) fn constant(value: f64) -> Self {
        let terms = if value == 0.0 { Vec::new() } else { vec![(0, value)] };
        Self { terms, rest: 0.0 }
    }

    /// Returns the model of a number between two others, without a relation to the variables.
    pub(crate) fn of_interval(range: Interval) -> Self {
        let middle = range.midpoint();
        let mut model = Self::constant(middle);
        model.rest = (range.hi() - middle).next_up().max((middle - range.lo()).next_up());
        if range.as_point().is_some() {
            model.rest = 0.0;
        }
        model
    }

    /// Returns the model of a variable between two numbers.
    pub(crate) fn of_variable(basis: &mut Basis, variable: usize, range: Interval) -> Self {
        let of_interval = Self::of_interval(range);
        let mut terms = of_interval.terms;
        terms.push((basis.variable(variable), of_interval.rest));
        Self { terms, rest: 0.0 }
    }

    pub(crate) fn is_finite(&self) -> bool {
        // A sum of the magnitudes leaves room for those of products.
        self.norm() < 1e150 && self.rest < 1e150
    }

    /// Returns the constant coefficient.
    pub(crate) fn centre(&self) -> f64 {
        self.terms.first().filter(|(monomial, _)| *monomial == 0).map_or(0.0, |(_, value)| *value)
    }

    /// Returns true for a polynomial without a variable.
    pub(crate) fn is_constant(&self) -> bool {
        self.terms.iter().all(|(monomial, _)| *monomial == 0)
    }

    /// Returns a bound of the polynomial's magnitude: the sum of its coefficients' magnitudes.
    pub(crate) fn norm(&self) -> f64 {
        self.terms.iter().map(|(_, value)| value.abs()).sum::<f64>() * SUM_MARGIN
    }

    /// Returns a range of the value, term by term.
    pub(crate) fn bound(&self, basis: &Basis) -> Interval {
        let (mut below, mut above) = (0.0_f64, 0.0_f64);
        for &(monomial, value) in &self.terms {
            if monomial == 0 {
            } else if !basis.is_even(monomial) {
                below += value.abs();
                above += value.abs();
            } else if value > 0.0 {
                above += value;
            } else {
                below -= value;
            }
        }
        let centre = self.centre();
        let around = |by: f64| add_up((by + self.rest) * SUM_MARGIN, LOST);
        Interval::new((centre - around(below)).next_down(), (centre + around(above)).next_up())
    }

    /// Widens the rest.
    pub(crate) fn widen(&mut self, by: f64) {
        self.rest = add_up(self.rest, by);
    }

    pub(crate) fn neg(&self) -> Self {
        let terms = self.terms.iter().map(|&(monomial, value)| (monomial, -value)).collect();
        Self { terms, rest: self.rest }
    }

    /// Returns the real sum.
    pub(crate) fn add(&self, other: &Self) -> Self {
        let mut terms = Vec::with_capacity(self.terms.len() + other.terms.len());
        let mut lost = 0.0;
        let (mut left, mut right) = (self.terms.iter().peekable(), other.terms.iter().peekable());
        loop {
            let term = match (left.peek(), right.peek()) {
                (Some(&&(a, x)), Some(&&(b, y))) if a == b => {
                    left.next();
                    right.next();
                    let sum = x + y;
                    lost += sum.abs();
                    (a, sum)
                }
                (Some(&&(a, x)), Some(&&(b, _))) if a < b => {
                    left.next();
                    (a, x)
                }
                (_, Some(&&term)) => {
                    right.next();
                    term
                }
                (Some(&&term), None) => {
                    left.next();
                    term
                }
                (None, None) => break,
            };
            if term.1 != 0.0 {
                terms.push(term);
            }
        }
        // A sum that rounds correctly is off by half a unit in its last place; without underflow.
        let rest = add_up(add_up(self.rest, other.rest), mul_up(lost * SUM_MARGIN, HALF_ULP));
        let is_exact = lost == 0.0 && (self.rest == 0.0 || other.rest == 0.0);
        Self { terms, rest: if is_exact { self.rest.max(other.rest) } else { rest } }
    }

    /// Returns the real difference.
    pub(crate) fn sub(&self, other: &Self) -> Self {
        self.add(&other.neg())
    }

    /// Returns the real product with a number.
    pub(crate) fn scale(&self, factor: f64) -> Self {
        let terms: Vec<_> = self.terms.iter().map(|&(monomial, value)| (monomial, value * factor)).collect();
        let rest = mul_up(self.rest, factor.abs());
        let mut model = Self { terms, rest };
        if !is_power_of_two(factor) {
            model.widen(mul_up(model.norm(), HALF_ULP));
        }
        model.widen(LOST);
        model
    }

    /// Returns the real product.
    pub(crate) fn mul(&self, other: &Self, basis: &mut Basis) -> Self {
        if self.terms.len() * other.terms.len() > MAX_TERMS * MAX_TERMS {
            return self.shortened().mul(&other.shortened(), basis);
        }
        let (short, long) = if self.terms.len() <= other.terms.len() { (self, other) } else { (other, self) };
        let product = basis.multiply(&short.terms, &long.terms);
        let cut = product.odd + (product.positive + product.negative) / 2.0;
        let (norm, other_norm) = (short.norm(), long.norm());
        // A coefficient is a sum of at most as many products as the shorter factor has terms, and of the shift.
        let roundings = (short.terms.len() + 4) as f64;
        let rounded = roundings * HALF_ULP * norm * other_norm + roundings * HALF_ULP * cut;
        let rests = norm * long.rest + other_norm * short.rest + short.rest * long.rest;
        let rest = add_up((cut + rounded + rests) * SUM_MARGIN, LOST);
        Self { terms: product.terms, rest }
    }

    /// Returns the model with the terms that count most; the others are part of the rest.
    fn shortened(&self) -> Self {
        let mut terms = self.terms.clone();
        terms.sort_by(|(_, a), (_, b)| b.abs().total_cmp(&a.abs()));
        let others = terms.split_off(MAX_TERMS.min(terms.len()));
        terms.sort_by_key(|(monomial, _)| *monomial);
        let mut model = Self { terms, rest: self.rest };
        // Every monomial lies in [−1, 1].
        model.widen(others.iter().map(|(_, value)| value.abs()).sum::<f64>() * SUM_MARGIN);
        model
    }

    /// Returns the value of a polynomial of one variable with these coefficients, that of the constant first.
    pub(crate) fn compose(&self, coefficients: &[f64], basis: &mut Basis) -> Self {
        let mut result = Self::constant(0.0);
        for &coefficient in coefficients.iter().rev() {
            result = result.mul(self, basis).add(&Self::constant(coefficient));
        }
        result
    }
}

/// Returns true for a factor that rounds no product.
pub(crate) fn is_power_of_two(factor: f64) -> bool {
    factor.to_bits() & ((1 << 52) - 1) == 0 && factor.is_normal()
}
