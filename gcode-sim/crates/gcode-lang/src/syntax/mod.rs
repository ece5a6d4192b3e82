//! Text to tree: reading never fails, and nothing but this module knows the parser library.
//!
//! A file is read line by line ([`FileItems`]): the line's comments are found and blanked (`comment`), then its
//! block is read (`block`) from words (`word`, `numbers`) and statements (`statement`, `output`), which hold expressions
//! (`expr`, `function`) and numbers (`number`). What can't be read stays in its block as text with its alarm.
pub mod ast;
mod block;
mod comment;
mod digits;
mod dividers;
mod expr;
mod file;
mod file_items;
mod number;
mod numbers;
mod outline;
mod output;
pub mod print;
#[cfg(test)]
mod property_tests;
mod statement;
mod token;
mod word;

pub use file::{ProgramParts, parse};
pub use file_items::{FileItem, FileItems, end_without_spaces, without_trailer};
pub use numbers::{NumberWord, NumberWords};
pub use outline::{BlockOutline, block_at, outline, sequence_number_at};
pub use print::print;
