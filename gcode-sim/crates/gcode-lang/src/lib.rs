//! Reads Fanuc Custom Macro B: text to blocks, blocks to operations; alarms, settings and the seam to the machine.
#![warn(missing_docs)]
pub mod alarm;
pub mod control;
pub mod diag;
pub mod motion;
pub mod program;
pub mod source;
pub mod syntax;
pub mod units;
