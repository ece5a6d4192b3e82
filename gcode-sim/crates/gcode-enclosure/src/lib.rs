//! Sound enclosures of what a control computes, over boxes of its arguments.
//!
//! In goes an expression in an [`Arena`] and a [`Domain`]. Out come ranges that have every double the interpreter can
//! compute, decisions of conditions, and the alarms that an operation can raise.
#![warn(missing_docs)]

mod alarms;
mod arena;
mod domain;
mod enclosures;
mod hull;
mod interval;
mod node;
mod values;

pub use alarms::PossibleAlarm;
pub use arena::Arena;
pub use domain::Domain;
pub use enclosures::Enclosures;
pub use interval::Interval;
pub use node::{AlarmKind, Binary, Condition, Node, NodeId, Relation, Semantics, Unary};
