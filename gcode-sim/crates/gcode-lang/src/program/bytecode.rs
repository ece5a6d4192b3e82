//! What expressions are to a run: postfix code, so that evaluating one needs neither recursion nor memory of its own.
use super::names::NameRow;
use crate::source::Span;
use crate::syntax::ast::{BinaryOp, Function, Relation};

/// A value: known, one variable, or code to evaluate. The first two are most of what programs contain.
#[derive(Clone, Debug, PartialEq)]
pub enum Operand {
    Number(f64),
    /// `#n` with a literal n.
    Variable {
        slot: Slot,
        span: Span,
    },
    Code(Bytecode),
}

/// A variable whose number is written out, found as far as no setting of the control decides.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Slot {
    /// #1 to #33, #100 to #199 and #500 to #999: what every control lets a program use freely.
    Free(u16),
    /// #0, system variables, and commons that not every control has.
    Other(u32),
}

impl Slot {
    pub fn of(number: u32) -> Self {
        match number {
            1..=33 | 100..=199 | 500..=999 => Self::Free(number as u16),
            _ => Self::Other(number),
        }
    }

    pub fn number(self) -> u32 {
        match self {
            Self::Free(number) => u32::from(number),
            Self::Other(number) => number,
        }
    }
}

/// The variable that an assignment writes.
#[derive(Clone, Debug, PartialEq)]
pub enum AssignmentTarget {
    Slot(Slot),
    /// Its number is computed, or no variable's.
    Computed(Operand),
}

impl AssignmentTarget {
    /// Whether it is the variable of this number, written out.
    pub fn is_variable(&self, number: u32) -> bool {
        *self == Self::Slot(Slot::of(number))
    }
}

/// What computes a value: the last of its instructions gives it.
pub type Bytecode = Box<[Instruction]>;

#[derive(Clone, Debug, PartialEq)]
pub struct Instruction {
    pub operation: Operation,
    pub span: Span,
}

/// Where an operator finds a value that it needs. Most are numbers and variables, which then needn't wait on the stack.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum OperandSource {
    /// A variable of [`Slot::Free`].
    Free(u16),
    Number(f64),
    Computed(ComputedSource),
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ComputedSource {
    /// What the instruction before has given.
    Last,
    /// The last of the values that wait, which it takes away.
    Waiting,
}

/// Gives a value, mostly of the one that the instruction before has given; where that is needed later it waits on a stack.
/// Conditions are numbers here, 0 or 1; the tree keeps them apart. Which one it is stands in a byte of its own, for it is
/// asked at every step.
#[derive(Clone, Debug, PartialEq)]
#[repr(u8)]
pub enum Operation {
    Add([OperandSource; 2]),
    Subtract([OperandSource; 2]),
    Multiply([OperandSource; 2]),
    Divide([OperandSource; 2]),
    Compare(Relation, [OperandSource; 2]),
    Function(Function, OperandSource),
    /// ATAN of two values.
    Atan2([OperandSource; 2]),
    Uncommon(UncommonOp),
}

/// What only some expressions contain.
#[derive(Clone, Debug, PartialEq)]
pub enum UncommonOp {
    Load(OperandSource),
    /// Lets the last value wait for its operator.
    Push,
    /// A variable that may not be read.
    Read(u32),
    /// Takes a variable's number, gives its value.
    LoadIndirect,
    Negate,
    /// The sign between an address and its value: `X-#1`. Unlike a minus in an expression it keeps vacancy.
    NegateWord,
    Plus,
    Bracket,
    /// An operator on whole numbers.
    Whole(BinaryOp, [OperandSource; 2]),
    Power([OperandSource; 2]),
    /// ROUND in a word: to the increment of that address.
    RoundTo(u8),
    /// Of the value that waits and the last one.
    Logic(BinaryOp),
    /// PRM: the number, the bit and the axis, of which the last is the last value and those before it wait.
    Parameter {
        bit: bool,
        axis: bool,
    },
    /// `AXNUM[X]`.
    AxisNumber(u8),
    /// ADP: takes a variable's number, gives its value as if it had been passed with a point.
    AddPoint,
    /// The number of a variable named by SETVN.
    NameNumber(Box<str>),
    /// Takes a suffix, gives the number of the system variable; of `[#_NAME]` without a suffix it takes nothing.
    SystemNumber(NameRow),
}

impl From<UncommonOp> for Operation {
    fn from(rare: UncommonOp) -> Self {
        Self::Uncommon(rare)
    }
}

impl Operation {
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

/// What an expression can need on the stack: five brackets, each with a sum, a product and an index pending.
pub const STACK: usize = 32;
