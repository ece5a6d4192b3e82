//! Nodes: what an expression computes, and the relations between two.
pub use gcode_lang::syntax::ast::Relation;

/// A node of an [`Arena`](crate::Arena).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct NodeId(pub(crate) u32);

impl NodeId {
    /// Returns the place of the node in its arena; operands stand before what is computed of them.
    pub fn index(self) -> usize {
        self.0 as usize
    }
}

/// A function of one value.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Unary {
    /// The opposite number.
    Neg,
    /// ABS.
    Abs,
    /// SQRT.
    Sqrt,
    /// SIN of degrees.
    Sin,
    /// COS of degrees.
    Cos,
    /// TAN of degrees.
    Tan,
    /// ASIN in degrees.
    Asin,
    /// ACOS in degrees.
    Acos,
    /// ATAN of one value, −90° to 90°.
    Atan,
    /// EXP.
    Exp,
    /// LN.
    Ln,
    /// FIX: towards 0 to a whole number.
    Fix,
    /// FUP: away from 0 to a whole number.
    Fup,
    /// ROUND: to the nearest whole number, halves away from 0.
    Round,
    /// BIN.
    Bin,
    /// BCD.
    Bcd,
    /// A number below 1e-8 becomes 0: setting MFZ after SIN, COS and TAN.
    Residue,
}

/// An operator or a function of two values.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Binary {
    /// The sum.
    Add,
    /// The difference.
    Sub,
    /// The product.
    Mul,
    /// The quotient.
    Div,
    /// MOD of the rounded values; the remainder has the sign of the dividend.
    Mod,
    /// AND of 32 bits.
    And,
    /// OR of 32 bits.
    Or,
    /// XOR of 32 bits.
    Xor,
    /// POW.
    Pow,
    /// ATAN of two values, y and x, in degrees.
    Atan,
    /// 1 if the relation holds, otherwise 0.
    Compare(Relation),
}

/// A node's content.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Node {
    /// A number.
    Constant(f64),
    /// The input of this index in the domain.
    Input(usize),
    /// A function of one value.
    Unary(Unary, NodeId),
    /// An operator or a function of two values.
    Binary(Binary, NodeId, NodeId),
}

/// A relation between two nodes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Condition {
    /// The relation.
    pub relation: Relation,
    /// Its left side.
    pub left: NodeId,
    /// Its right side.
    pub right: NodeId,
}

impl Condition {
    /// Returns the condition of a relation and its sides.
    pub fn new(relation: Relation, left: NodeId, right: NodeId) -> Self {
        Self { relation, left, right }
    }

    /// Returns the condition that holds exactly where this one doesn't.
    pub fn negated(self) -> Self {
        Self { relation: self.relation.negated(), ..self }
    }
}

/// Settings of the control that decide what a function computes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Semantics {
    /// NAT: ASIN from −90° to 90° and ATAN of two values from −180° to 180° instead of 0° to 360°.
    pub returns_signed_angles: bool,
    /// MFZ: SIN, COS and TAN below 1e-8 become 0.
    pub zeroes_residues: bool,
    /// TAN of 90° raises an alarm.
    pub tan_90_alarms: bool,
    /// ATAN of two zeros raises an alarm.
    pub atan_of_zeros_alarms: bool,
    /// AND, OR and XOR of a negative number raise an alarm.
    pub negative_bits_alarm: bool,
}

/// A reason why an operation has no value.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum AlarmKind {
    /// An argument outside the function's domain, or a function's result that a double can't hold: PS0119.
    OutOfRange,
    /// A divisor of 0, or 0 to a negative power: PS0112.
    DivideByZero,
    /// A result of an operator that a double can't hold: PS0111.
    Overflow,
    /// An operand of AND, OR or XOR beyond 32 bits: PS0110.
    IntegerOverflow,
}
