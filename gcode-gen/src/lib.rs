//! Emits parametric macro programs: the control itself computes the geometry, the generator only orders the calls.
//!
//! A family turns a job into a [`package::Package`]; [`check`] runs it as the control would and holds the holes
//! against the job's geometry; `report` says what came of it, `cli` writes the files if that is a pass. A module uses only those listed above it.
pub mod nc;

pub mod package;

pub mod order;

pub mod families;

pub mod check;

pub mod sheet;

pub mod report;

pub mod cli;
