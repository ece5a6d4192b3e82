//! Tree to operations: codes looked up, loops paired, sequence numbers found, expressions in postfix order.
//!
//! A [`Program`] is what will run. Nothing here depends on a control's settings. When a file is loaded only the places of
//! its blocks and its loops are found (`outline`); a block is lowered when the run gets there (`blocks`), one of numbers
//! straight from its text (`numbers`), so that a long file takes little more memory than its text.
mod arguments;
mod blocks;
mod bytecode;
pub mod cycles;
mod dialect_syntax;
pub mod g_codes;
mod loops;
mod lowering;
pub mod m_codes;
mod memory;
pub mod modes;
pub mod names;
mod numbers;
mod outline;
mod words;

pub use arguments::{ArgumentLocals, argument_letter};
pub use bytecode::{
    AssignmentTarget, Bytecode, ComputedSource, Instruction, Operand, OperandSource, Operation, STACK, Slot,
    UncommonOp,
};
pub use dialect_syntax::DialectSyntax;
pub use memory::{Library, Memory, NoLibrary, ProgramId};
pub use words::{CallCode, CallOp, CallTarget, LoweredWord, WordOperand, Words};

use std::sync::OnceLock;

use self::blocks::Blocks;
use self::loops::Loops;
use crate::alarm::LocatedAlarm;
use crate::source::{Span, Spanned};
use crate::syntax::ast::{PrintKind, ProgramName};

/// The place of an operation in its program.
pub type OpIndex = usize;

/// One O-program: where its blocks are, and the operations of those that were asked for.
#[derive(Debug)]
pub struct Program {
    pub name: ProgramName,
    number: Option<u32>,
    /// The first sequence number that isn't 0.
    first_number: Option<u32>,
    /// From the O word, or the first block, to the end of the last block.
    pub span: Span,
    blocks: Blocks,
    /// Sequence numbers with their blocks, by number, then by place; looked for when the first jump asks.
    numbers: OnceLock<Vec<(u32, u32)>>,
    loops: Loops,
    /// Whether `%` or another program stands behind its last block.
    pub is_closed: bool,
}

/// One block.
#[derive(Debug, Default)]
pub struct Op {
    /// Which of its program's blocks it is, counted from 1; 0 while it is none.
    ordinal: u32,
    pub span: Span,
    pub number: Option<u32>,
    body: OpBody,
}

/// What a block does, and what is asked before.
#[derive(Debug)]
pub enum OpBody {
    /// Nothing is, as of most.
    Plain(OpKind),
    Guarded(Box<GuardedOp>),
}

impl Default for OpBody {
    fn default() -> Self {
        Self::Plain(OpKind::Empty)
    }
}

/// What a block does that is asked something first.
#[derive(Debug)]
pub struct GuardedOp {
    /// The block skip switch at its start.
    pub skip: Option<u8>,
    /// What is written in it that not every control takes, in the order it is held against the settings.
    pub dialect_syntax: Box<[Spanned<DialectSyntax>]>,
    pub kind: OpKind,
}

impl Op {
    /// What the block does, once nothing is asked any more.
    pub fn kind(&self) -> &OpKind {
        match &self.body {
            OpBody::Plain(kind) => kind,
            OpBody::Guarded(asked) => &asked.kind,
        }
    }

    #[inline(always)]
    pub fn body(&self) -> &OpBody {
        &self.body
    }

    fn guarded_op(&self) -> Option<&GuardedOp> {
        if let OpBody::Guarded(asked) = &self.body { Some(asked) } else { None }
    }

    /// The block skip switch at its start.
    pub fn skip(&self) -> Option<u8> {
        self.guarded_op()?.skip
    }

    /// What is written in it that not every control takes.
    pub fn dialect_syntax(&self) -> &[Spanned<DialectSyntax>] {
        self.guarded_op().map_or(&[], |asked| &asked.dialect_syntax)
    }
}

/// What a block does. Which of these it is stands in a byte of its own, for it is asked at every block.
#[derive(Debug, Default)]
#[repr(u8)]
pub enum OpKind {
    /// A block without words: an empty line, a comment, a sequence number alone.
    #[default]
    Empty,
    Words(Words),
    Statement(Statement),
    /// A block of one [`Statement::Assign`]: who asks for statements has to ask for it as well.
    AssignFree(Assign),
    /// `IF[…]` before words or a statement, with THEN or without.
    If {
        condition: Bytecode,
        then: Box<Self>,
    },
    /// The control stops here if it gets here.
    Alarm(LocatedAlarm),
}

/// A macro statement. Which one it is stands in a byte of its own, as in [`OpKind`].
#[derive(Debug)]
#[repr(u8)]
pub enum Statement {
    /// Any assignment that is no [`Statement::Assign`].
    Assign {
        target: AssignmentTarget,
        target_span: Span,
        value: Operand,
        /// The first comment of the block: the text of `#3000=` and `#3006=`.
        text: Option<Box<[u8]>>,
    },
    /// `#1=1 #2=2`: assignments, one after the other.
    Assignments(Vec<Self>),
    Goto(Spanned<Operand>),
    IfGoto {
        condition: Bytecode,
        to: Spanned<Operand>,
    },
    IfThen {
        condition: Bytecode,
        then: Box<Self>,
    },
    /// `end` is the operation of the END.
    While {
        condition: Bytecode,
        number: u8,
        end: OpIndex,
    },
    Do {
        number: u8,
        end: OpIndex,
    },
    /// `start` is the operation of the WHILE or DO.
    End {
        number: u8,
        start: OpIndex,
    },
    SetNames {
        first: Operand,
        names: Vec<String>,
    },
    Print {
        kind: PrintKind,
        parts: Vec<PrintPart>,
    },
    OpenOutput,
    CloseOutput,
    /// `IF[…]THEN` of something that must not stand there.
    Alarm(LocatedAlarm),
    AssignFree(Assign),
}

/// An assignment of what code gives to a variable of [`Slot::Free`], as most are.
#[derive(Debug)]
pub struct Assign {
    pub variable: u16,
    pub code: Bytecode,
}

#[derive(Debug)]
pub enum PrintPart {
    Text(String),
    Value { value: Operand, whole: u8, decimals: u8 },
}

impl Program {
    /// The O number; of a program without any the first sequence number, which a control takes for it. `None` for a
    /// program with a name.
    pub fn number(&self) -> Option<u32> {
        self.number
    }

    /// The number as #4115 shows it: a program without O has that of its first N; a name has none, 0.
    pub fn shown_number(&self) -> u32 {
        match self.name {
            ProgramName::Number(number) => number,
            ProgramName::Name(_) => 0,
            ProgramName::Unnamed => self.first_number.unwrap_or(0),
        }
    }

    /// The name as a control shows it: `O8101`, `<BRACKET-OP1>`; `MAIN` where there is none.
    pub fn label(&self) -> String {
        self.name.label()
    }

    /// Its operations in order, of a program that `Memory::lowered` gave.
    pub fn ops(&self) -> &[Op] {
        self.blocks.lowered_ops()
    }

    /// Lowers one block, so that it can be executed; `None` behind the last.
    #[inline(always)]
    pub fn lower_block(&mut self, index: OpIndex) -> Option<(&Self, &Op)> {
        if self.blocks.op(index).is_none() {
            self.blocks.lower(index, &self.loops)?;
        }
        let program = &*self;
        program.blocks.op(index).map(|op| (program, op))
    }

    /// An operation that was made ready: see [`Program::ready`].
    pub fn op(&self, index: OpIndex) -> Option<&Op> {
        self.blocks.op(index)
    }

    fn numbers(&self) -> &[(u32, u32)] {
        self.numbers.get_or_init(|| self.blocks.sequence_numbers())
    }

    /// Whether several blocks have this sequence number.
    pub fn is_duplicate_number(&self, number: u32) -> bool {
        let first = self.numbers().partition_point(|entry| *entry < (number, 0));
        self.numbers().get(first + 1).is_some_and(|(n, _)| *n == number)
    }

    /// The number of a loop that `to` lies in and that isn't among those open.
    pub fn loop_entered(&self, to: OpIndex, open: &[Option<(OpIndex, OpIndex)>]) -> Option<u8> {
        self.loops.loop_entered(to, open)
    }

    /// The last block with this sequence number before `from`.
    pub fn find_number_above(&self, number: u32, from: OpIndex) -> Option<OpIndex> {
        let next = self.numbers().partition_point(|entry| *entry < (number, from as u32));
        self.numbers().get(next.checked_sub(1)?).filter(|(n, _)| *n == number).map(|(_, op)| *op as OpIndex)
    }

    /// The block with this sequence number: the next one from `from` on, else the first of the program.
    pub fn find_number(&self, number: u32, from: OpIndex) -> Option<OpIndex> {
        let first = self.numbers().partition_point(|entry| *entry < (number, 0));
        let next = self.numbers().partition_point(|entry| *entry < (number, from as u32));
        let is_it = |index: usize| self.numbers().get(index).filter(|(n, _)| *n == number);
        is_it(next).or_else(|| is_it(first)).map(|(_, op)| *op as OpIndex)
    }
}
