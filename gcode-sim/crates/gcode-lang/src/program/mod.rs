//! Lowering: tree to operations. Codes are looked up, loops paired, expressions put in postfix order.
//!
//! A [`Program`] is independent of a control's settings. Loading a file finds only the spans of its blocks
//! and its loops (`outline`). A block is lowered when execution reaches it (`blocks`), a block of numbers
//! directly from its text (`numbers`), so a long file needs little more memory than its text.
mod arguments;
mod block_texts;
mod blocks;
mod bytecode;
pub mod code_facts;
pub mod cycles;
mod dialect_syntax;
mod expression;
mod g_code_row;
mod g_code_table;
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
pub use block_texts::BlockTexts;
pub use bytecode::{
    AssignmentTarget, Bytecode, ComputedSource, Instruction, Operand, OperandSource, Operation, STACK, Slot,
    UncommonOp,
};
pub use dialect_syntax::{DialectSyntax, PROGRAM_ZERO_NOTE};
pub use expression::{Expression, parse_target};
pub use memory::{Library, Memory, NoLibrary, ProgramId};
pub use numbers::NumberBlock;
pub use words::{CallCode, CallOp, CallTarget, LoweredWord, WordOperand, WordUse, Words};

use std::ops::Range;
use std::sync::OnceLock;

use self::blocks::Blocks;
use self::loops::Loops;
use crate::alarm::LocatedAlarm;
use crate::source::{Span, Spanned};
use crate::syntax::ast::{self, Folder, PrintKind, ProgramName};

/// Lowers one block outside a program; the loop of a WHILE, DO or END is an alarm.
pub fn lower_tree(block: &ast::Block) -> Op {
    lowering::Lowering::default().lower_block(block, None)
}

/// Index of an operation in its program.
pub type OpIndex = usize;

/// One O-program: the spans of its blocks, and the operations of the blocks lowered so far.
#[derive(Debug)]
pub struct Program {
    /// O number or name.
    pub name: ProgramName,
    /// That of the name: the place of each hole has it.
    label: String,
    /// Folder of a memory dump; `None` in a file without folder lines.
    pub folder: Option<Folder>,
    /// First sequence number other than 0.
    first_number: Option<u32>,
    /// Span from the O word, or the first block, to the end of the last block.
    pub span: Span,
    blocks: Blocks,
    /// Sequence numbers with their blocks, sorted; computed at the first jump.
    numbers: OnceLock<Vec<(u32, u32)>>,
    loops: Loops,
    /// True if `%` or another program follows the last block, or has to: the text has a `%` before.
    pub is_closed: bool,
}

/// One block.
#[derive(Debug, Default)]
pub struct Op {
    /// Number of the block in its program, counted from 1; 0 for an unused slot.
    ordinal: u32,
    /// Span of the block.
    pub span: Span,
    /// Sequence number.
    pub number: Option<u32>,
    body: OpBody,
}

/// Operation of a block with its guards.
#[derive(Debug)]
pub enum OpBody {
    /// Operation without guards, as in most blocks.
    Plain(OpKind),
    /// Operation after a block skip or a dialect check.
    Guarded(Box<GuardedOp>),
}

impl Default for OpBody {
    fn default() -> Self {
        Self::Plain(OpKind::Empty)
    }
}

/// Operation executed only if its guards allow it.
#[derive(Debug)]
pub struct GuardedOp {
    /// Block skip switch at the start of the block.
    pub skip: Option<u8>,
    /// Syntax that some controls refuse, in the order of the checks.
    pub dialect_syntax: Box<[Spanned<DialectSyntax>]>,
    /// Guarded operation.
    pub kind: OpKind,
}

impl Op {
    /// Returns the operation of the block, its guards disregarded.
    pub fn kind(&self) -> &OpKind {
        match &self.body {
            OpBody::Plain(kind) => kind,
            OpBody::Guarded(guarded) => &guarded.kind,
        }
    }

    /// Returns the operation with its guards.
    #[inline(always)]
    pub fn body(&self) -> &OpBody {
        &self.body
    }

    fn guarded_op(&self) -> Option<&GuardedOp> {
        if let OpBody::Guarded(guarded) = &self.body { Some(guarded) } else { None }
    }

    /// Returns the block skip switch at the start of the block.
    pub fn skip(&self) -> Option<u8> {
        self.guarded_op()?.skip
    }

    /// Returns the syntax of the block that some controls refuse.
    pub fn dialect_syntax(&self) -> &[Spanned<DialectSyntax>] {
        self.guarded_op().map_or(&[], |guarded| &guarded.dialect_syntax)
    }
}

/// Operation of a block.
///
/// The discriminant has a byte of its own, because it is read for every block.
#[derive(Debug, Default)]
#[repr(u8)]
pub enum OpKind {
    /// Block without words: an empty line, a comment, a sequence number alone.
    #[default]
    Empty,
    /// Words: codes, moves, calls.
    Words(Words),
    /// Macro statement, except a single [`Statement::AssignDirect`].
    Statement(Statement),
    /// A block that is one [`Statement::AssignDirect`]. Code that matches statements must match this variant
    /// too.
    AssignDirect(Assign),
    /// `IF[…]`, with or without THEN, before words or an assignment.
    If {
        /// Condition.
        condition: Bytecode,
        /// Conditional operation.
        then: Box<Self>,
    },
    /// Alarm raised when the block is reached.
    Alarm(LocatedAlarm),
}

impl OpKind {
    /// Returns the words of a block, those behind `IF[…]` too; `None` for a block without words.
    pub fn words(&self) -> Option<&Words> {
        match self {
            Self::Words(words) => Some(words),
            Self::If { then, .. } => then.words(),
            Self::Empty | Self::Statement(_) | Self::AssignDirect(_) | Self::Alarm(_) => None,
        }
    }
}

/// Macro statement. The discriminant has a byte of its own, as in [`OpKind`].
#[derive(Debug)]
#[repr(u8)]
pub enum Statement {
    /// Assignment that is not an [`Statement::AssignDirect`].
    Assign {
        /// Assigned variable.
        target: AssignmentTarget,
        /// Span of the variable.
        target_span: Span,
        /// Value.
        value: Operand,
        /// Comment after the statement: the text of `#3000=` and `#3006=`.
        text: Option<Box<[u8]>>,
    },
    /// Assignments of one block in order, `#1=1 #2=2`; a GOTO may follow them.
    Assignments(Vec<Self>),
    /// `GOTO n`.
    Goto(Spanned<Operand>),
    /// `IF[…]GOTO n`.
    IfGoto {
        /// Condition of the jump.
        condition: Bytecode,
        /// Sequence number of the target.
        to: Spanned<Operand>,
    },
    /// `IF[…]THEN statement`.
    IfThen {
        /// Condition of the statement.
        condition: Bytecode,
        /// Conditional statement.
        then: Box<Self>,
    },
    /// `WHILE[…]DOn`.
    While {
        /// Condition of the next iteration.
        condition: Bytecode,
        /// Loop number.
        number: u8,
        /// Operation of the END.
        end: OpIndex,
    },
    /// `DOn`.
    Do {
        /// Loop number.
        number: u8,
        /// Operation of the END.
        end: OpIndex,
    },
    /// `ENDn`.
    End {
        /// Loop number.
        number: u8,
        /// Operation of the WHILE or DO.
        start: OpIndex,
    },
    /// `SETVN`.
    SetNames {
        /// Number of the first variable.
        first: Operand,
        /// Names of consecutive variables.
        names: Vec<String>,
    },
    /// `DPRNT` or `BPRNT`.
    Print {
        /// Output format.
        kind: PrintKind,
        /// Texts and values in the order printed.
        parts: Vec<PrintPart>,
    },
    /// `POPEN`.
    OpenOutput,
    /// `PCLOS`.
    CloseOutput,
    /// Invalid statement after `IF[…]THEN`; raises its alarm if the condition is true.
    Alarm(LocatedAlarm),
    /// Assignment of computed code to a local or common variable that is stored directly.
    AssignDirect(Assign),
}

/// Assignment of computed code to a variable of [`Slot::Free`], the most common kind.
#[derive(Debug)]
pub struct Assign {
    /// Number of the variable.
    pub variable: u16,
    /// Code that computes the value.
    pub code: Bytecode,
}

/// Part of a print statement.
#[derive(Debug)]
pub enum PrintPart {
    /// Literal text.
    Text(String),
    /// Value with its format.
    Value {
        /// Printed value.
        value: Operand,
        /// Digits before the decimal point; 0 for BPRNT.
        whole: u8,
        /// Digits after the decimal point.
        decimals: u8,
    },
}

impl Program {
    /// Returns the O number; for a program without O word, the first sequence number, as a control does.
    ///
    /// `None` for a program with a name.
    pub fn number(&self) -> Option<u32> {
        match self.name {
            ProgramName::Number(number) => Some(number),
            ProgramName::Name(_) => None,
            ProgramName::Unnamed => self.first_number,
        }
    }

    /// Returns the number that #4115 reads: the O number, the first N of a program without O, 0 for a named
    /// program.
    pub fn number_or_zero(&self) -> u32 {
        self.number().unwrap_or(0)
    }

    /// Returns the label that a control displays: `O8101`, `<BRACKET-OP1>`; `MAIN` for an unnamed program.
    pub fn label(&self) -> String {
        self.label.clone()
    }

    /// Returns the label with the folder, if the program is in one: `//CNC_MEM/USER/PATH1/O0001`.
    pub fn path(&self) -> String {
        let folder = self.folder.as_ref().map_or_else(String::new, ToString::to_string);
        folder + &self.label()
    }

    /// Returns all operations in order.
    ///
    /// The program must come from [`Memory::lower_program`]; the slice is empty otherwise.
    pub fn ops(&self) -> &[Op] {
        self.blocks.lowered_ops()
    }

    /// Returns the number of blocks.
    pub fn block_count(&self) -> usize {
        self.blocks.len()
    }

    /// Returns the texts of the blocks.
    pub fn block_texts(&self) -> &BlockTexts {
        self.blocks.texts()
    }

    /// Calls `each` with every block in order: its index, and what it reads if it consists of numbers, and one comment at most.
    pub fn visit_number_blocks(&self, each: impl FnMut(OpIndex, Option<NumberBlock<'_>>)) {
        self.blocks.visit_numbers(each);
    }

    /// Returns the program without the marked blocks. A loop whose first or last block is marked is none.
    #[must_use]
    pub fn without(&self, is_left_out: &[bool]) -> Self {
        let mut kept = 0;
        let mut new_index = vec![0];
        new_index.extend(is_left_out.iter().map(|is_left_out| {
            kept += u32::from(!is_left_out);
            kept
        }));
        Self {
            name: self.name.clone(),
            label: self.label.clone(),
            folder: self.folder.clone(),
            blocks: self.blocks.renumbered(&new_index),
            numbers: OnceLock::new(),
            loops: self.loops.renumbered(&new_index),
            ..*self
        }
    }

    /// Returns the program of some consecutive blocks. No loop may lead out of them.
    #[must_use]
    pub fn part(&self, blocks: Range<OpIndex>) -> Self {
        Self {
            name: self.name.clone(),
            label: self.label.clone(),
            folder: self.folder.clone(),
            blocks: self.blocks.part(blocks.clone()),
            numbers: OnceLock::new(),
            loops: self.loops.part(blocks),
            ..*self
        }
    }

    /// Returns true if a loop begins before a block and does not end before it.
    pub fn is_in_loop(&self, block: OpIndex) -> bool {
        self.loops.contain(block)
    }

    /// Lowers one block for execution and returns it; `None` after the last block.
    #[inline(always)]
    pub fn lower_block(&mut self, index: OpIndex) -> Option<(&Self, &Op)> {
        if self.blocks.op(index).is_none() {
            self.blocks.lower(index, &self.loops)?;
        }
        let program = &*self;
        program.blocks.op(index).map(|op| (program, op))
    }

    /// Lowers one block and takes its operation, without its guards.
    fn take_op(&mut self, index: OpIndex) -> Option<OpKind> {
        let Self { blocks, loops, .. } = self;
        blocks.lower(index, loops)?;
        blocks.take(index)
    }

    /// Returns an operation lowered by [`Program::lower_block`]; `None` if it is not, or no longer, lowered.
    pub fn op(&self, index: OpIndex) -> Option<&Op> {
        self.blocks.op(index)
    }

    fn numbers(&self) -> &[(u32, u32)] {
        self.numbers.get_or_init(|| self.blocks.sequence_numbers())
    }

    /// Iterates over the sequence numbers to which a jump can lead, in ascending order, each once.
    pub fn sequence_numbers(&self) -> impl Iterator<Item = u32> + '_ {
        let numbers = self.numbers();
        let is_first = |index: usize| index == 0 || numbers[index - 1].0 != numbers[index].0;
        let first =
            numbers.iter().enumerate().filter(move |(index, (number, _))| *number != 0 && is_first(*index));
        first.map(|(_, (number, _))| *number)
    }

    /// Returns true if several blocks have this sequence number.
    pub fn is_duplicate_number(&self, number: u32) -> bool {
        let first = self.numbers().partition_point(|entry| *entry < (number, 0));
        self.numbers().get(first + 1).is_some_and(|(n, _)| *n == number)
    }

    /// Returns the number of a loop that contains `to` and is not among `open`, the loops that are open.
    pub fn loop_entered(&self, to: OpIndex, open: &[Option<(OpIndex, OpIndex)>]) -> Option<u8> {
        self.loops.loop_entered(to, open)
    }

    /// Returns the last block before `from` with this sequence number.
    pub fn find_number_above(&self, number: u32, from: OpIndex) -> Option<OpIndex> {
        let next = self.numbers().partition_point(|entry| *entry < (number, from as u32));
        self.numbers().get(next.checked_sub(1)?).filter(|(n, _)| *n == number).map(|(_, op)| *op as OpIndex)
    }

    /// Returns the first block from `from` on with this sequence number, otherwise the first of the program.
    pub fn find_number(&self, number: u32, from: OpIndex) -> Option<OpIndex> {
        let first = self.numbers().partition_point(|entry| *entry < (number, 0));
        let next = self.numbers().partition_point(|entry| *entry < (number, from as u32));
        let entry_at = |index: usize| self.numbers().get(index).filter(|(n, _)| *n == number);
        entry_at(next).or_else(|| entry_at(first)).map(|(_, op)| *op as OpIndex)
    }
}
