//! The path to holes, each with its block.
