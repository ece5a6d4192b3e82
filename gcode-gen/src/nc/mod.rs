//! NC text: numbers, blocks and programs, with nothing in them that a control would not display.
pub mod block;
pub mod number;
pub mod program;
pub mod text;
