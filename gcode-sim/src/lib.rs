//! Reads a Fanuc Custom Macro B program, executes it as the control would, follows the tool on the part,
//! and compares the holes it makes with a reference that knows nothing of NC code.
pub mod report;

pub mod schema;

pub mod cli;
