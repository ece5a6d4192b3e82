//! Emits parametric macro programs: the control computes the geometry, the generator orders the calls.
//!
//! A family turns a job into a [`package::Package`]; [`check`] runs it as the control would and verifies the
//! holes against the job's geometry; `report` formats the result, and `cli` writes the files if the verdict
//! is a pass. A module uses only those listed above it.
pub mod nc;

pub mod package;

pub mod order;

pub mod families;

pub mod check;

pub mod sheet;

pub mod report;

pub mod cli;
