//! Follows the tool on the part: events to holes, flutes and readings, and these to a verdict.
pub mod budget;
pub mod findings;
pub mod flutes;
pub mod holes;
pub mod machine;
pub mod stylus;
pub mod verify;
