//! Job files and the nominal part: surfaces, holes, flutes, patterns, gauge blocks.
pub mod clusters;
pub mod gauge;
pub mod job;
pub mod part;
pub mod point_tree;
pub mod reader;
