//! Reader: text to tree. Reading never fails, and only this module uses the parser library.
//!
//! A file is read line by line ([`FileItems`]). The comments of a line are found and blanked (`comment`),
//! then its block is read (`block`): words (`word`, `numbers`) and statements (`statement`, `output`), which
//! contain expressions (`expr`) and numbers (`number`). Unreadable text stays in its block
//! together with its alarm.
pub mod ast;
mod block;
mod comment;
mod do_line;
mod expr;
mod file;
mod file_items;
mod lines;
mod number;
mod numbers;
mod output;
mod print;
mod program_name;
#[cfg(test)]
mod property_tests;
mod read_blocks;
mod relation;
mod shift;
mod statement;
mod token;
mod word;

pub(crate) use file::{BlockOutline, ProgramParts, outline, sequence_number_at};
pub use file::{block_at, parse};
pub use file_items::{FileItem, FileItems};
pub(crate) use file_items::{end_without_spaces, without_trailer};
pub use lines::{LineItem, first_line, line_items};
pub(crate) use numbers::{NumberWord, NumberWords};
pub use print::{print, print_decimal};
pub use read_blocks::{BlockMarks, KnownBlocks, ReadBlocks};
