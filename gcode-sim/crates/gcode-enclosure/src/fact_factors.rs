//! Factors of polynomials by conditions of the path: 4·r²·d² − (r² + d² − s²)² is a product of the sides' differences.
use crate::certificate::{Certifier, Fact};
use crate::interval::{add_down, mul_up};
use crate::node::{Node, NodeId};
use crate::polynomial::{Monomial, Polynomial, constant_of};

impl Certifier<'_> {
    /// Returns the bound of a product of a condition's difference and a polynomial of 0 or more.
    pub(crate) fn by_facts(&mut self, polynomial: &Polynomial, depth: u32) -> Option<f64> {
        for place in 0..self.facts.len() {
            let Fact { polynomial: factor, least } = &self.facts[place];
            let number = constant_of(factor);
            let (mut factor, least) = (factor.clone(), add_down(*least - factor.error, -number));
            factor.terms.remove(&Monomial::new());
            factor.error = 0.0;
            let least = least.max(self.algebra.bounds_of_terms(&factor).0);
            let Some((quotient, rest)) = self.divided(polynomial, &factor) else { continue };
            let of_quotient = self.least(&quotient, depth);
            if of_quotient < 0.0 {
                continue;
            }
            let product = match least < 0.0 {
                true => -mul_up(-least, self.algebra.bounds_of_terms(&quotient).1),
                false => (least * of_quotient).next_down(),
            };
            return Some(add_down(product, self.algebra.bounds_of_terms(&rest).0));
        }
        None
    }

    /// Returns the quotient by a polynomial that is linear in an input, and the rest, which has roundings alone.
    fn divided(&mut self, polynomial: &Polynomial, factor: &Polynomial) -> Option<(Polynomial, Polynomial)> {
        let (input, slope) = self.linear_input(factor)?;
        let degree = polynomial.terms.keys().map(|monomial| power_of(monomial, input)).max()?;
        let mut others = factor.clone();
        others.terms.remove(&vec![(input, 1)]);
        let mut quotient = Polynomial::default();
        let mut rest = polynomial.clone();
        for power in (1..=degree).rev() {
            // The terms of the highest power, divided by the linear one.
            let highest = rest.terms.iter().filter(|(monomial, _)| power_of(monomial, input) == power);
            let terms =
                highest.map(|(monomial, value)| (with_power(monomial, input, power - 1), value / slope));
            let part = Polynomial { terms: terms.collect(), error: 0.0 };
            let product = self.algebra.product(&part, factor)?;
            rest = self.algebra.sum(&rest, &self.algebra.scaled(&product, -1.0));
            quotient = self.algebra.sum(&quotient, &part);
        }
        let is_divided = !quotient.terms.is_empty() && rest.is_negligible(polynomial.largest());
        is_divided.then_some((quotient, rest))
    }

    /// Returns an input that a polynomial has once, with a factor of 1 or −1, and the factor.
    fn linear_input(&self, polynomial: &Polynomial) -> Option<(NodeId, f64)> {
        polynomial.terms.iter().find_map(|(monomial, value)| {
            let &[(atom, 1)] = monomial.as_slice() else { return None };
            let is_once = polynomial.terms.keys().filter(|other| power_of(other, atom) > 0).count() == 1;
            let is_input = matches!(self.algebra.arena.node(atom), Node::Input(_));
            (is_input && is_once && value.abs() == 1.0).then_some((atom, *value))
        })
    }
}

/// Returns the power of an atom in a monomial.
fn power_of(monomial: &Monomial, atom: NodeId) -> u32 {
    monomial.iter().find(|(other, _)| *other == atom).map_or(0, |(_, power)| *power)
}

/// Returns a monomial with another power of one of its atoms.
fn with_power(monomial: &Monomial, atom: NodeId, power: u32) -> Monomial {
    let powers = monomial.iter().map(|(other, known)| (*other, if *other == atom { power } else { *known }));
    powers.filter(|(_, power)| *power > 0).collect()
}
