//! Bounds of polynomials by conditions of the path: multiples of a condition's difference, and products with it.
//!
//! From y ≥ x follows f(y) ≥ f(x) for a rising f: f(y) − f(x) is the product of y − x and a polynomial that is positive,
//! but for what the models leave out. Near y = x no range of f(y) − f(x) says so.
use crate::enclosures::Enclosures;
use crate::interval::{add_down, mul_up};
use crate::model::Model;

/// Largest number of conditions in one product.
pub(crate) const MAX_FACTORS: u32 = 2;

impl Enclosures {
    /// Returns a lower bound of a model: that of the model less multiples of facts, which are 0 or more, or of the product
    /// of a fact and a polynomial.
    pub(crate) fn lower_bound(&mut self, model: &Model, bound: f64, facts: &[Model], factors: u32) -> f64 {
        let (whole, mut best, mut model) = (model, bound, model.clone());
        for fact in facts {
            // A multiple that cancels a linear term.
            let linear = (0..self.next_variable).filter_map(|variable| {
                let term = |model: &Model| {
                    let mut terms = model.terms.iter();
                    terms
                        .find(|(monomial, _)| self.basis.is_variable(*monomial, variable))
                        .map(|(_, value)| *value)
                };
                Some(term(&model)? / term(fact)?).filter(|factor| *factor > 0.0 && factor.is_finite())
            });
            let mut better = None;
            for factor in linear {
                let rest = model.sub(&fact.scale(factor));
                let lo = rest.range(&self.basis).lo();
                if lo > best && rest.is_finite() {
                    best = lo;
                    better = Some(rest);
                }
            }
            model = better.unwrap_or(model);
        }
        let Some(factors) = factors.checked_sub(1) else { return best };
        for place in 0..facts.len() {
            if best >= 0.0 {
                break;
            }
            let product = self.bound_of_product(whole, best, &facts[place], facts, factors);
            best = product.map_or(best, |bound| best.max(bound));
        }
        best
    }

    /// Returns a lower bound above the best one of a model as a fact × a polynomial + a rest without one of the fact's
    /// variables.
    fn bound_of_product(
        &mut self,
        model: &Model,
        best: f64,
        fact: &Model,
        facts: &[Model],
        factors: u32,
    ) -> Option<f64> {
        let (variable, slope) = self.linear_variable(fact)?;
        let factor = Model { terms: fact.terms.clone(), rest: 0.0 };
        // One that no value of the box is near the limit of says nothing.
        if factor.bound(&self.basis).lo() > fact.rest {
            return None;
        }
        let power_of = |enclosures: &Self, monomial: u32| enclosures.basis.exponent(monomial, variable);
        let degree = model.terms.iter().map(|(monomial, _)| power_of(self, *monomial)).max()?;
        // The rest is what the model differs by from the product, whatever the quotient is: models bound its roundings.
        let (mut quotient, mut rest) = (Model::constant(0.0), model.clone());
        for power in (1..=degree).rev() {
            let highest: Vec<_> = rest
                .terms
                .iter()
                .copied()
                .filter(|(monomial, _)| power_of(self, *monomial) == power)
                .collect();
            let mut terms: Vec<_> = highest
                .into_iter()
                .map(|(monomial, value)| (self.basis.divided(monomial, variable), value / slope))
                .collect();
            terms.sort_by_key(|(monomial, _)| *monomial);
            let part = Model { terms, rest: 0.0 };
            rest = rest.sub(&part.mul(&factor, &mut self.basis));
            quotient.terms.extend(part.terms);
        }
        quotient.terms.sort_by_key(|(monomial, _)| *monomial);
        let is_divided = !quotient.terms.is_empty() && rest.bound(&self.basis).lo() > best;
        if !is_divided || !quotient.is_finite() || !rest.is_finite() {
            return None;
        }
        // The fact's polynomial is at least −rest, as the fact is 0 or more.
        let most = factor.range(&self.basis).hi().max(0.0);
        let of_quotient = quotient.range(&self.basis);
        let least = self.lower_bound(&quotient, of_quotient.lo(), facts, factors);
        let product =
            -mul_up(fact.rest, of_quotient.hi().max(0.0)).max(mul_up(most.max(fact.rest), (-least).max(0.0)));
        Some(add_down(product, rest.range(&self.basis).lo()))
    }

    /// Returns a variable that a model has alone in one linear term, with its coefficient: that with the largest.
    fn linear_variable(&self, model: &Model) -> Option<(usize, f64)> {
        let alone = (0..self.next_variable).filter_map(|variable| {
            let mut with =
                model.terms.iter().filter(|(monomial, _)| self.basis.exponent(*monomial, variable) > 0);
            let &(monomial, value) = with.next()?;
            let is_alone = with.next().is_none() && self.basis.is_variable(monomial, variable);
            is_alone.then_some((variable, value))
        });
        alone.max_by(|(_, a), (_, b)| a.abs().total_cmp(&b.abs()))
    }
}
