//! Text to tree: reading never fails, and nothing but this module knows the parser library.
pub mod ast;
