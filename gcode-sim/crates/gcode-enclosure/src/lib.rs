//! Sound enclosures of what a control computes, over boxes of its arguments.
//!
//! In goes an expression in an [`Arena`] and a [`Domain`]. Out come ranges that have every double the interpreter can
//! compute, decisions of conditions, and the alarms that an operation can raise.
#![warn(missing_docs)]

mod alarms;
mod apply;
mod approximation;
mod arena;
mod basis;
mod bounds;
mod contraction;
mod decisions;
mod domain;
mod elementary;
mod enclosures;
mod factors;
mod form;
mod hull;
mod interval;
mod model;
mod node;
mod polynomial_range;
mod proof;
mod rounding;
#[cfg(test)]
mod tests;
mod values;

pub use alarms::PossibleAlarm;
pub use arena::Arena;
pub use bounds::{Bounds, BoundsSearch, bounds};
pub use domain::Domain;
pub use enclosures::Enclosures;
pub use interval::Interval;
pub use node::{AlarmKind, Binary, Condition, Node, NodeId, Relation, Semantics, Unary};
