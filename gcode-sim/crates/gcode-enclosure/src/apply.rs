//! Single operations on numbers, for callers that compute many points.
use crate::arena::Arena;
use crate::node::{Binary, Unary};
use crate::values;

impl Arena {
    /// Returns the value of a function as the control computes it; NaN where it raises an alarm.
    #[inline]
    pub fn apply_unary(&self, function: Unary, x: f64) -> f64 {
        values::unary(function, x, self.semantics()).unwrap_or(f64::NAN)
    }

    /// Returns the value of an operator as the control computes it; NaN where it raises an alarm.
    #[inline]
    pub fn apply_binary(&self, operator: Binary, a: f64, b: f64) -> f64 {
        values::binary(operator, a, b, self.semantics()).unwrap_or(f64::NAN)
    }
}
