//! Bytecode of expressions: postfix instructions, evaluated without recursion and without allocation.
use super::names::NameRow;
use crate::source::Span;
use crate::syntax::ast::{BinaryOp, Function, Relation};

/// Value of an expression: a number, one variable, or code. Most expressions are one of the first two.
#[derive(Clone, Debug, PartialEq)]
pub enum Operand {
    /// Number.
    Number(f64),
    /// `#n` with a literal n.
    Variable {
        /// Variable.
        slot: Slot,
        /// Span of the expression.
        span: Span,
    },
    /// Code that computes the value.
    Code(Bytecode),
}

/// Variable with a literal number, classified as far as no setting decides.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Slot {
    /// #1 to #33, #100 to #199 and #500 to #999: readable and writable on every control.
    Free(u16),
    /// Any other number, whose variable is decided at run time.
    Other(u32),
}

impl Slot {
    /// Classifies a variable number.
    pub fn of(number: u32) -> Self {
        match number {
            1..=33 | 100..=199 | 500..=999 => Self::Free(number as u16),
            _ => Self::Other(number),
        }
    }

    /// Returns the variable number.
    pub fn number(self) -> u32 {
        match self {
            Self::Free(number) => u32::from(number),
            Self::Other(number) => number,
        }
    }
}

/// Variable that an assignment writes.
#[derive(Clone, Debug, PartialEq)]
pub enum AssignmentTarget {
    /// Variable with a literal number.
    Slot(Slot),
    /// Variable whose number is computed or out of range.
    Computed(Operand),
}

impl AssignmentTarget {
    /// Returns true for the literal variable with this number.
    pub fn is_variable(&self, number: u32) -> bool {
        *self == Self::Slot(Slot::of(number))
    }
}

/// Code of an expression; its last instruction leaves the value.
pub type Bytecode = Box<[Instruction]>;

/// Operation with its span.
#[derive(Clone, Debug, PartialEq)]
pub struct Instruction {
    /// Operation.
    pub operation: Operation,
    /// Span of the expression that the operation computes.
    pub span: Span,
}

/// Source of an operand. Most operands are numbers and variables, which need no slot on the stack.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum OperandSource {
    /// Variable of [`Slot::Free`].
    Free(u16),
    /// Number.
    Number(f64),
    /// Computed value.
    Computed(ComputedSource),
}

/// Location of a computed value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ComputedSource {
    /// Result of the preceding instruction.
    Last,
    /// Top of the stack, which is popped.
    Stacked,
}

/// Operation of the bytecode.
///
/// Most operations use the result of the preceding instruction; a result that is needed later is pushed.
/// Conditions are the numbers 0 and 1; the tree keeps them apart. The discriminant has a byte of its own,
/// because it is read at every step.
#[derive(Clone, Debug, PartialEq)]
#[repr(u8)]
pub enum Operation {
    /// Sum.
    Add([OperandSource; 2]),
    /// Difference.
    Subtract([OperandSource; 2]),
    /// Product.
    Multiply([OperandSource; 2]),
    /// Quotient.
    Divide([OperandSource; 2]),
    /// Comparison; leaves 1 if true, 0 otherwise.
    Compare(Relation, [OperandSource; 2]),
    /// Function of one value.
    Function(Function, OperandSource),
    /// ATAN of two values.
    Atan2([OperandSource; 2]),
    /// Operation outside the common path.
    Uncommon(UncommonOp),
}

/// Operation that only some expressions contain.
#[derive(Clone, Debug, PartialEq)]
pub enum UncommonOp {
    /// Loads an operand.
    Load(OperandSource),
    /// Pushes the result of the preceding instruction for a later operator.
    Push,
    /// Reads a variable that may be unreadable.
    Read(u32),
    /// Reads `#n.m`: item m of #n on a control that has such items, otherwise the variable with the rounded number.
    ReadItem {
        /// Variable in front of the point.
        number: u32,
        /// Digits behind the point.
        item: u32,
        /// Variable with the rounded number.
        rounded: u32,
    },
    /// Reads the variable whose number is the last result.
    LoadIndirect,
    /// Changes the sign.
    Negate,
    /// Changes the sign between an address and its value, `X-#1`; unlike a minus in an expression it keeps
    /// vacancy.
    NegateWord,
    /// Brackets around a value that may be vacant; they decide whether vacancy is kept.
    Bracket,
    /// Operator on whole numbers.
    Whole(BinaryOp, [OperandSource; 2]),
    /// POW of two values.
    Power([OperandSource; 2]),
    /// ROUND in a word: rounds to the increment of this address.
    RoundTo(u8),
    /// Combines the top of the stack and the last result, both conditions.
    Logic(BinaryOp),
    /// PRM of number, bit and axis: the last of them is the last result, the others are on the stack.
    Parameter {
        /// True if the stack holds a bit number.
        bit: bool,
        /// True if the stack holds an axis number.
        axis: bool,
    },
    /// `AXNUM[X]`.
    AxisNumber(u8),
    /// ADP: reads the variable whose number is the last result as if it had been passed with a decimal point.
    AddPoint,
    /// Number of a variable named by SETVN.
    NameNumber(Box<str>),
    /// Number of a system variable; its suffix is the last result. Without a suffix, `[#_NAME]`, there is no
    /// operand.
    SystemNumber(NameRow),
}

impl From<UncommonOp> for Operation {
    fn from(uncommon: UncommonOp) -> Self {
        Self::Uncommon(uncommon)
    }
}

impl Operation {
    /// Returns the sources of its operands; empty for an operation on the last result and the stack alone.
    pub fn sources(&self) -> &[OperandSource] {
        match self {
            Self::Add(sources)
            | Self::Subtract(sources)
            | Self::Multiply(sources)
            | Self::Divide(sources)
            | Self::Compare(_, sources)
            | Self::Atan2(sources)
            | Self::Uncommon(UncommonOp::Whole(_, sources) | UncommonOp::Power(sources)) => sources,
            Self::Function(_, source) | Self::Uncommon(UncommonOp::Load(source)) => {
                std::slice::from_ref(source)
            }
            Self::Uncommon(
                UncommonOp::Push
                | UncommonOp::Read(_)
                | UncommonOp::ReadItem { .. }
                | UncommonOp::LoadIndirect
                | UncommonOp::Negate
                | UncommonOp::NegateWord
                | UncommonOp::Bracket
                | UncommonOp::RoundTo(_)
                | UncommonOp::Logic(_)
                | UncommonOp::Parameter { .. }
                | UncommonOp::AxisNumber(_)
                | UncommonOp::AddPoint
                | UncommonOp::NameNumber(_)
                | UncommonOp::SystemNumber(_),
            ) => &[],
        }
    }

    pub(super) fn binary(op: BinaryOp, values: [OperandSource; 2]) -> Self {
        match op {
            BinaryOp::Add => Self::Add(values),
            BinaryOp::Sub => Self::Subtract(values),
            BinaryOp::Mul => Self::Multiply(values),
            BinaryOp::Div => Self::Divide(values),
            BinaryOp::Mod | BinaryOp::And | BinaryOp::Or | BinaryOp::Xor => {
                UncommonOp::Whole(op, values).into()
            }
        }
    }
}

/// Size of the stack: five brackets, each with a sum, a product and an index pending.
pub const STACK: usize = 32;
