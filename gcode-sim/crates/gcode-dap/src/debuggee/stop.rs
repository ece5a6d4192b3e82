//! What a run tells: lines of output, and why it has stopped.
use super::exceptions::Exception;
use gcode_lang::source::Span;

/// Line of output, with the block that has caused it.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct OutputLine {
    pub(crate) text: String,
    pub(crate) block: Option<Span>,
}

/// End of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum End {
    /// M02, M30, the M99 that ends the run, or the end of the program.
    Program,
    /// An alarm, or a loop that never ends.
    Stopped,
    /// The user has ended it.
    Terminated,
}

/// Reason why a run stands still.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Stop {
    /// The start of the run.
    Entry,
    /// A step is done.
    Step,
    /// A person, M00, M01 or #3006 has stopped the run; the text of the stop, empty of a person's.
    Pause(String),
    /// Breakpoints on the next block, and those on a program that begins with it.
    Breakpoint(Vec<i64>),
    /// Breakpoints on the program that has begun.
    ProgramBreakpoint(Vec<i64>),
    /// Breakpoints on a variable.
    VariableBreakpoint(Vec<i64>),
    Exception(Exception),
    /// A block was chosen as the next one.
    Goto,
    End(End),
}

impl Stop {
    /// Returns the stop at breakpoints on a block and on a program that begins with it; `None` without any.
    pub(super) fn at_breakpoints(lines: Vec<i64>, programs: Vec<i64>) -> Option<Self> {
        match (lines.is_empty(), programs.is_empty()) {
            (true, true) => None,
            (true, false) => Some(Self::ProgramBreakpoint(programs)),
            (false, _) => Some(Self::Breakpoint(lines.into_iter().chain(programs).collect())),
        }
    }
}

/// What a run is to do until it stops.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Goal {
    /// Go on.
    Continue,
    /// Execute one block.
    StepIn,
    /// Execute one block and all that it calls; the depth of calls at its beginning.
    Next { depth: usize },
    /// Leave the program at work; the depth of calls in it.
    StepOut { depth: usize },
    /// Go back to the last place at which the run would stop before this position.
    ReverseContinue { end: u64 },
}
