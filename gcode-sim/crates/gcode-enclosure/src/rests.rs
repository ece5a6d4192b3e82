//! Rests of polynomials as variables: what the polynomial of a node leaves out stays the same wherever the node is used.
//!
//! In a loop that converges, as Newton's, a value is used several times in each turn. Were its rest a number, it would be
//! added for each use, and grow by a factor each turn; as a variable it cancels as the value itself does.
use std::sync::Arc;

use crate::arena::Arena;
use crate::basis::MAX_VARIABLES;
use crate::enclosures::Enclosures;
use crate::interval::{Interval, add_up};
use crate::model::Model;
use crate::node::NodeId;

/// Largest number of rests that are variables at a time; the oldest becomes a rest again.
const MAX_RESTS: usize = 2;

/// Part of a value's magnitude below which its rest is that of a few roundings.
const SMALL: f64 = 1e-10;

impl Enclosures {
    /// Returns the model of a node with a variable for its rest, if the node is used more than once.
    pub(crate) fn with_own_rest(
        &mut self,
        arena: &Arena,
        node: NodeId,
        mut model: Model,
        hull: Interval,
    ) -> Model {
        if !arena.is_used_again(node) || model.rest <= SMALL * hull.magnitude() {
            return model;
        }
        let variable = if self.rests.len() < MAX_RESTS {
            if self.next_variable >= MAX_VARIABLES {
                return model;
            }
            self.sources.push(node);
            self.next_variable += 1;
            self.basis.make_heavy(self.next_variable - 1);
            self.next_variable - 1
        } else {
            let Some(oldest) = self.rests.pop_front() else { return model };
            self.take_back(oldest, &mut model);
            let first = self.next_variable - self.sources.len();
            self.sources[oldest - first] = node;
            oldest
        };
        self.rests.push_back(variable);
        model.terms.push((self.basis.variable(variable), model.rest));
        model.terms.sort_by_key(|(monomial, _)| *monomial);
        model.rest = 0.0;
        model
    }

    /// Puts a variable back into the rests of all models that have it, so that it can stand for another one.
    fn take_back(&mut self, variable: usize, model: &mut Model) {
        self.take_back_from(variable, model);
        for index in 0..self.forms.len() {
            let has_variable = |model: &Model| {
                model.terms.iter().any(|(monomial, _)| self.basis.exponent(*monomial, variable) > 0)
            };
            let of_form = self.forms[index].as_ref().and_then(|form| form.model.as_ref());
            if !of_form.is_some_and(has_variable) {
                continue;
            }
            let Some(mut form) = self.forms[index].take() else { continue };
            if let Some(model) = &mut Arc::make_mut(&mut form).model {
                self.take_back_from(variable, model);
            }
            self.forms[index] = Some(form);
        }
    }

    fn take_back_from(&self, variable: usize, model: &mut Model) {
        let mut lost = 0.0;
        // Every monomial lies in [−1, 1].
        model.terms.retain(|(monomial, value)| {
            let is_lost = self.basis.exponent(*monomial, variable) > 0;
            lost = if is_lost { add_up(lost, value.abs()) } else { lost };
            !is_lost
        });
        model.widen(lost);
    }
}
