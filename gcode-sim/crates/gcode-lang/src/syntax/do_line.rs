//! Lines of several macro statements that DO begins.
use crate::source::Span;

/// Place of a block in a line of several macro statements that DO begins: `WHILE[#1GT0]DO1 #1=#1-1 END1`. Each statement is a
/// block.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum DoLine {
    /// The line is another one.
    #[default]
    No,
    /// The block ends with DO, and the statement of this span stands behind it.
    Begins(Span),
    /// The block stands behind DO.
    Behind,
}
