//! Polynomials of the computed values of nodes, by monomial, with the bound of what they leave out.
use std::collections::BTreeMap;

use crate::node::NodeId;

/// Product of powers of atoms, in their order.
pub(crate) type Monomial = Vec<(NodeId, u32)>;

/// Largest total degree.
const MAX_DEGREE: u32 = 16;
/// Part of the largest coefficient below which one is a rounding.
const NEGLIGIBLE: f64 = 1e-12;

/// Polynomial of atoms; the value is within `error` of it.
#[derive(Clone, Debug, Default)]
pub(crate) struct Polynomial {
    pub(crate) terms: BTreeMap<Monomial, f64>,
    pub(crate) error: f64,
}

impl Polynomial {
    pub(crate) fn constant(value: f64) -> Self {
        let mut polynomial = Self::default();
        if value != 0.0 {
            polynomial.terms.insert(Vec::new(), value);
        }
        polynomial
    }

    pub(crate) fn atom(node: NodeId) -> Self {
        Self { terms: BTreeMap::from([(vec![(node, 1)], 1.0)]), error: 0.0 }
    }

    /// Returns true for a polynomial without atoms but for roundings of its coefficients.
    pub(crate) fn is_constant(&self, size: f64) -> bool {
        self.terms.iter().all(|(monomial, value)| monomial.is_empty() || value.abs() <= size * NEGLIGIBLE)
    }

    /// Returns true for a polynomial of roundings of coefficients alone.
    pub(crate) fn is_negligible(&self, size: f64) -> bool {
        self.terms.values().all(|value| value.abs() <= size * NEGLIGIBLE)
    }

    pub(crate) fn largest(&self) -> f64 {
        self.terms.values().fold(0.0, |most, value| f64::max(most, value.abs()))
    }
}

/// Returns the constant of a polynomial.
pub(crate) fn constant_of(polynomial: &Polynomial) -> f64 {
    polynomial.terms.get(&Vec::new()).copied().unwrap_or(0.0)
}

/// Returns the product of two monomials; `None` beyond the largest degree.
pub(crate) fn merged(a: &Monomial, b: &Monomial) -> Option<Monomial> {
    let mut product = a.clone();
    for &(atom, power) in b {
        match product.iter_mut().find(|(known, _)| *known == atom) {
            Some((_, known)) => *known += power,
            None => product.push((atom, power)),
        }
    }
    product.sort_unstable();
    let degree: u32 = product.iter().map(|(_, power)| power).sum();
    (degree <= MAX_DEGREE).then_some(product)
}
