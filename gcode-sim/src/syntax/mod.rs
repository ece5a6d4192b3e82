//! Text to tree: reading never fails, and nothing but this module knows the parser library.
pub mod ast;
mod block;
mod expr;
mod file;
mod number;
mod statement;
mod token;

pub use file::{Piece, Pieces, parse};
