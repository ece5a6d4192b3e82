//! NC text: numbers, blocks and programs in characters that every control can display.
pub mod block;
pub mod number;
pub mod program;
pub mod text;
