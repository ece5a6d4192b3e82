//! Entries of an index: what a block says of numbers, variables and calls, twelve bytes each.
use gcode_lang::program::CallCode;
use gcode_lang::syntax::ast::{Folder, ProgramName};
use gcode_lint::CalledProgramName;

use crate::text::TextRange;

/// Kind of an entry, and what its value is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum EntryKind {
    /// `%`.
    Section,
    /// O word; the value is an index in the programs of the chunk.
    Program,
    /// First block of a chunk or a section; the value is 1 if it is readable.
    FirstBlock,
    /// First readable block of a chunk or a section.
    FirstReadable,
    /// `N10`; the value is the number.
    Number,
    /// Sequence number of a GOTO in the same program.
    Goto,
    /// Sequence number in P of M99: in the calling program, or in the main program itself.
    ReturnTo,
    /// Sequence number in Q of M98: in the called program.
    StartAt,
    /// Sequence number of M97 P, or of M98 Q or H without a program: in the same program.
    LocalCall,
    /// GOTO or M97 P whose sequence number is computed.
    ComputedGoto,
    /// M99 P whose sequence number is computed.
    ComputedReturn,
    /// M98 Q whose sequence number is computed.
    ComputedStart,
    /// Code of a call; the value is an index in the calls of the chunk.
    Call,
    /// Read of a variable; the value is its number.
    Read,
    /// Assignment of a variable; the value is its number.
    Write,
    /// Read of a variable whose number is computed.
    ComputedRead,
    /// Assignment of a variable whose number is computed.
    ComputedWrite,
    /// SETVN; the value is the number of the first variable.
    SetNames,
    /// WHILE or DO; the value is the number of the loop.
    LoopBegin,
    /// END; the value is the number of the loop.
    LoopEnd,
    /// Line of comments alone.
    Comment,
    /// G10 L50 or L52: N is a parameter number from here on.
    ParametersBegin,
    /// G11.
    ParametersEnd,
    /// M02 or M30: the value is the code. 99 is an M99.
    End,
    /// Text that cannot be read.
    Unreadable,
}

/// Entry with its range relative to the start of its chunk.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Entry {
    pub start: u32,
    pub length: u16,
    pub kind: EntryKind,
    pub value: u32,
}

/// Program of a chunk.
#[derive(Clone, Debug)]
pub(crate) struct ProgramRecord {
    pub name: ProgramName,
    pub folder: Option<Folder>,
}

/// Call of a chunk, with ranges relative to the start of the chunk.
#[derive(Clone, Debug)]
pub(crate) struct CallRecord {
    /// `None` for a code that calls a program.
    pub kind: Option<CallCode>,
    pub has_own_locals: bool,
    pub is_modal: bool,
    pub target: CalledProgramName,
    /// Word P.
    pub target_range: Option<TextRange>,
    /// Block of the call.
    pub block: TextRange,
    /// Arguments in the order written.
    pub arguments: Box<[ArgumentRecord]>,
}

/// Argument of a call, eight bytes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ArgumentRecord {
    pub letter: u8,
    /// #1 to #33.
    local: u8,
    /// Offset of the letter.
    start: u32,
}

impl ArgumentRecord {
    pub(crate) fn new(letter: u8, local: usize, start: u32) -> Self {
        Self { letter, local: local as u8, start }
    }

    /// Returns the number of the local.
    pub(crate) fn local(self) -> u32 {
        self.local.into()
    }

    /// Returns the range of the letter.
    pub(crate) fn range(self) -> TextRange {
        TextRange::new(self.start, self.start + 1)
    }
}

impl CallRecord {
    /// Moves all ranges.
    pub(crate) fn shift(&mut self, by: u32) {
        self.arguments.iter_mut().for_each(|argument| argument.start += by);
        for range in std::iter::once(&mut self.block).chain(&mut self.target_range) {
            *range = TextRange::new(range.start + by, range.end + by);
        }
    }
}
