//! Sums of products of atoms, with whole exponents.
use std::collections::BTreeMap;

use gcode_enclosure::NodeId;

/// Quantity that isn't taken apart.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Atom {
    /// Double of a node.
    Node(NodeId),
    /// Square root of a polynomial, by its index in the list of roots.
    Root(usize),
}

/// Product of powers of atoms, in the order of the atoms; no exponent is 0.
pub(super) type Powers = Vec<(Atom, i32)>;

/// Sum of products of atoms, each with a factor; exponents may be negative.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Polynomial {
    pub(super) terms: BTreeMap<Powers, f64>,
}

/// Parts of a result that the rounding of its factors loses: each product with the bound of what its factor lacks.
pub(super) type Lost = Vec<(Powers, f64)>;

/// Half a unit in the last place of 1, and a margin.
const ROUNDING: f64 = f64::EPSILON * 0.5000001;

impl Polynomial {
    /// Returns the polynomial of a number.
    pub fn constant(value: f64) -> Self {
        let mut terms = BTreeMap::new();
        if value != 0.0 {
            terms.insert(Powers::new(), value);
        }
        Self { terms }
    }

    /// Returns the polynomial of an atom.
    pub fn atom(atom: Atom) -> Self {
        Self { terms: BTreeMap::from([(vec![(atom, 1)], 1.0)]) }
    }

    /// Returns true for 0.
    pub fn is_zero(&self) -> bool {
        self.terms.is_empty()
    }

    /// Returns the number, if no atom is in it.
    pub fn as_constant(&self) -> Option<f64> {
        match self.terms.len() {
            0 => Some(0.0),
            1 => self.terms.get(&Powers::new()).copied(),
            _ => None,
        }
    }

    /// Returns the only product and its factor.
    pub fn only_term(&self) -> Option<(&Powers, f64)> {
        let mut terms = self.terms.iter();
        let (powers, factor) = terms.next()?;
        terms.next().is_none().then_some((powers, *factor))
    }

    /// Returns the node that this is.
    pub fn as_node(&self) -> Option<NodeId> {
        match self.only_term() {
            Some((powers, 1.0)) => match powers.as_slice() {
                [(Atom::Node(node), 1)] => Some(*node),
                _ => None,
            },
            _ => None,
        }
    }

    /// Returns the opposite.
    pub(super) fn negated(&self) -> Self {
        Self { terms: self.terms.iter().map(|(powers, factor)| (powers.clone(), -factor)).collect() }
    }

    /// Returns the sum.
    pub(super) fn plus(&self, other: &Self, lost: &mut Lost) -> Self {
        let mut sum = self.clone();
        for (powers, factor) in &other.terms {
            sum.add(powers.clone(), *factor, lost);
        }
        sum
    }

    pub(super) fn add(&mut self, powers: Powers, factor: f64, lost: &mut Lost) {
        let before = self.terms.get(&powers).copied().unwrap_or_default();
        let after = before + factor;
        // The rounding error of a sum is a double: without it the sum is exact.
        let part = after - before;
        if (before - (after - part)) + (factor - part) != 0.0 {
            lost.push((powers.clone(), after.abs() * ROUNDING));
        }
        if after == 0.0 {
            self.terms.remove(&powers)
        } else {
            self.terms.insert(powers, after)
        };
    }

    /// Returns the product, without the reduction of roots.
    pub(super) fn times(&self, other: &Self, lost: &mut Lost) -> Self {
        let mut product = Self::default();
        for (left, a) in &self.terms {
            for (right, b) in &other.terms {
                let (powers, factor) = (merged(left, right), a * b);
                if libm::fma(*a, *b, -factor) != 0.0 || factor.abs() < 1e-200 {
                    lost.push((powers.clone(), factor.abs() * ROUNDING + f64::MIN_POSITIVE));
                }
                product.add(powers, factor, lost);
            }
        }
        product
    }

    /// Returns the quotient by a product of atoms.
    pub(super) fn over(&self, powers: &Powers, divisor: f64, lost: &mut Lost) -> Self {
        let inverse: Powers = powers.iter().map(|(atom, exponent)| (*atom, -exponent)).collect();
        let mut quotient = Self::default();
        for (left, a) in &self.terms {
            let (powers, factor) = (merged(left, &inverse), a / divisor);
            if libm::fma(factor, divisor, -a) != 0.0 || factor.abs() < 1e-200 {
                lost.push((powers.clone(), factor.abs() * ROUNDING + f64::MIN_POSITIVE));
            }
            quotient.add(powers, factor, lost);
        }
        quotient
    }
}

/// Returns the product of two products.
fn merged(left: &Powers, right: &Powers) -> Powers {
    let mut powers: BTreeMap<Atom, i32> = left.iter().copied().collect();
    for (atom, exponent) in right {
        *powers.entry(*atom).or_default() += exponent;
    }
    powers.into_iter().filter(|(_, exponent)| *exponent != 0).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn root(index: usize) -> Polynomial {
        Polynomial::atom(Atom::Root(index))
    }

    #[test]
    fn equal_products_cancel_exactly() {
        let mut lost = Lost::new();
        let (a, b) = (root(0), root(1));
        // (a − b)·(a + b) = a² − b².
        let product = a.plus(&b.negated(), &mut lost).times(&a.plus(&b, &mut lost), &mut lost);
        let squares = a.times(&a, &mut lost).plus(&b.times(&b, &mut lost).negated(), &mut lost);
        assert!(product.plus(&squares.negated(), &mut lost).is_zero());
        assert!(lost.is_empty(), "{lost:?}");
        let quotient = product.over(&vec![(Atom::Root(0), 1)], 2.0, &mut lost);
        assert_eq!(quotient.terms[&vec![(Atom::Root(0), 1)]], 0.5);
        assert_eq!(quotient.terms[&vec![(Atom::Root(0), -1), (Atom::Root(1), 2)]], -0.5);
    }

    #[test]
    fn a_factor_that_is_rounded_is_reported() {
        let mut lost = Lost::new();
        let tenth = Polynomial::constant(0.1);
        let product = tenth.times(&tenth, &mut lost);
        assert_eq!(product.as_constant(), Some(0.1 * 0.1));
        assert!(lost.len() == 1 && lost[0].1 < 2e-18, "{lost:?}");
        let third = Polynomial::constant(1.0).over(&Powers::new(), 3.0, &mut lost);
        assert_eq!((third.as_constant(), lost.len()), (Some(1.0 / 3.0), 2));
        Polynomial::constant(1e16).plus(&Polynomial::constant(1.0), &mut lost);
        assert_eq!(lost.len(), 3, "1e16 + 1 is no double");
    }
}
