//! Reads a Fanuc Custom Macro B program, executes it as the control would, follows the tool on the part,
//! and holds the holes it makes against a reference that knows nothing of NC code.
//!
//! Text goes in at the top of this list and a verdict comes out at the bottom; a module may use the ones
//! above it and never the ones below. A test holds this order.
pub mod units;

pub mod source;

pub mod motion;

pub mod alarm;

pub mod control;

pub mod syntax;

pub mod program;

pub mod diag;

pub mod contour;

pub mod exec;

pub mod check;

pub mod gauge;

pub mod job;

pub mod part;

pub mod machine;

pub mod holes;

pub mod flutes;

pub mod stylus;

pub mod verify;

pub mod budget;

pub mod picture;

pub mod session;

pub mod changes;

pub mod report;

pub mod schema;

pub mod cli;
