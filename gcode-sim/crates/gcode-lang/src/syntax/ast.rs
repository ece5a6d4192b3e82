//! Syntax tree: programs, blocks, words and macro statements, each with its span.
//!
//! The tree is not interpreted. A number keeps its decimal point, because the unit of `X1` (1 mm or 0.001 mm)
//! is a setting of the control. An unreadable block keeps its alarm, because a control raises it when it
//! reaches the block.
pub use super::do_line::DoLine;
use crate::alarm::Alarm;
use crate::source::{Span, Spanned};

pub use super::program_name::{Folder, ProgramName, ProgramPath};
pub use super::relation::Relation;

/// One O-program of a file.
#[derive(Clone, Debug, PartialEq)]
pub struct Program {
    /// O number or name.
    pub name: ProgramName,
    /// Span of the O word, or of the first block of a program without one.
    pub span: Span,
    /// Blocks after the O word; words on the line of the O word form the first block.
    pub blocks: Vec<Block>,
}

/// One line of a program.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Block {
    /// Span of the block.
    pub span: Span,
    /// Block skip switch of `/` or `/n` at the start, 1 to 9.
    pub skip: Option<Spanned<u8>>,
    /// Sequence number, `N10`.
    pub number: Option<Spanned<u32>>,
    /// First statement with an abbreviated keyword: `WH[…]DO1`, `GO 5`.
    pub short_word: Option<Span>,
    /// The `;` before the block, if it ends another block of the line.
    pub behind_semicolon: Option<Span>,
    /// Place among the statements of a line with DO.
    pub do_line: DoLine,
    /// Words, statements and inner skips, in the order written.
    pub items: Vec<Item>,
    /// Comments in the order written.
    pub comments: Vec<Comment>,
}

impl Block {
    /// Returns true for a comment or for text that is not meant for a control: no readable word or statement.
    pub fn is_unreadable(&self) -> bool {
        self.items.iter().all(|item| matches!(item, Item::Unreadable(_)))
            && self.number.is_none()
            && self.skip.is_none()
    }
}

/// Component of a block.
///
/// Most components are words, so larger ones are boxed. A control accepts either words or one statement;
/// lowering checks this.
#[derive(Clone, Debug, PartialEq)]
pub enum Item {
    /// Address with its value.
    Word(Word),
    /// Macro statement.
    Statement(Box<Spanned<Statement>>),
    /// `/n` inside a block: the rest of the block is skipped while the switch is on.
    Skip(Spanned<u8>),
    /// Rest of a line that cannot be read.
    Unreadable(Box<Unreadable>),
}

/// Rest of a line, from the word or statement that cannot be read.
#[derive(Clone, Debug, PartialEq)]
pub struct Unreadable {
    /// Alarm raised when the block is reached, at the span where reading failed.
    pub alarm: Spanned<Alarm>,
    /// Span of the text.
    pub span: Span,
    /// Text as written, comments included.
    pub text: Vec<u8>,
}

/// Comment; its bytes are kept in their encoding.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Comment {
    /// Span, brackets included.
    pub span: Span,
    /// Text between the brackets or after the sign.
    pub text: Vec<u8>,
    /// Notation of the comment.
    pub mark: CommentMark,
}

impl Comment {
    /// Returns the text behind a comment inside this one if it has a word: a control ends the comment at its first `)`.
    pub fn word_behind_inner(&self) -> Option<&[u8]> {
        let close =
            self.text.iter().position(|byte| *byte == b')').filter(|_| self.mark == CommentMark::Round)?;
        let behind = self.text[close + 1..].trim_ascii();
        let is_word = |pair: &[u8]| {
            pair[0].is_ascii_alphabetic() && matches!(pair[1], b'0'..=b'9' | b'.' | b'+' | b'-' | b'#' | b'[')
        };
        behind.windows(2).any(is_word).then_some(behind)
    }
}

/// Notation of a comment.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CommentMark {
    /// `(TEXT)`.
    Round,
    /// `(TEXT` up to the end of the line.
    Unclosed,
    /// `; TEXT`.
    Semicolon,
    /// `// TEXT`.
    Slashes,
}

/// Letter of a word whose axis is known only at run time.
pub const AX: u8 = b'@';

/// Address with its value: `X10.`, `X-#1`, `F[#7/3.]`, `,R10.`.
#[derive(Clone, Debug, PartialEq)]
pub struct Word {
    /// Letter of the word.
    pub address: Address,
    /// Axis number of `AX[1]=10.`; the letter is [`AX`].
    pub axis: Option<Box<Expr>>,
    /// Value as written.
    pub value: WordValue,
    /// Span of the word.
    pub span: Span,
}

/// Letter of a word, with or without a comma.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Address {
    /// `A` to `Z` in upper case, or [`AX`].
    pub letter: u8,
    /// True for `,R` and `,C`: corner rounding and chamfer.
    pub comma: bool,
}

/// Value of a word.
#[derive(Clone, Debug, PartialEq)]
pub enum WordValue {
    /// Number.
    Literal(Decimal),
    /// `#1`, `[…]`, or a negation of either for `-#1` and `-[…]`.
    ///
    /// The bracket is kept as [`ExprKind::Bracket`].
    Expr(Box<Expr>),
    /// Program name of `G65 P<NAME>` or `M98 <NAME>`.
    Name(String),
}

/// Number as written: `-12.50` has digits 1250, decimal places 2 and is negative.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Decimal {
    /// True after a minus sign; separate from the digits, so that -0 prints as written.
    pub negative: bool,
    /// All digits as one whole number.
    pub digits: u64,
    /// Number of digits after the decimal point; `None` without a point.
    pub places: Option<u8>,
}

impl Decimal {
    /// Returns the value that the digits spell, with or without a point.
    pub fn value(self) -> f64 {
        const POWERS: [f64; 20] = [
            1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15, 1e16, 1e17,
            1e18, 1e19,
        ];
        let places = usize::from(self.places.unwrap_or(0)).min(POWERS.len() - 1);
        let magnitude = self.digits as f64 / POWERS[places];
        if self.negative { -magnitude } else { magnitude }
    }
}

/// Expression with its span.
#[derive(Clone, Debug, PartialEq)]
pub struct Expr {
    /// Expression.
    pub kind: ExprKind,
    /// Span of the expression.
    pub span: Span,
}

/// Direct parts of an expression, borrowed as its kind is; `$borrow` borrows a part that may be missing.
macro_rules! operands {
    ($kind:expr, $borrow:ident) => {{
        let (first, second, third) = match $kind {
            ExprKind::Literal(_) | ExprKind::AxisNumber(_) => (None, None, None),
            ExprKind::Named(name) => (name.index.$borrow(), None, None),
            ExprKind::Variable(part)
            | ExprKind::Negate(part)
            | ExprKind::Plus(part)
            | ExprKind::Bracket(part)
            | ExprKind::Call(_, CallForm::One(part)) => (Some(part), None, None),
            ExprKind::Binary(_, left, right)
            | ExprKind::Call(_, CallForm::Slash(left, right) | CallForm::Comma(left, right)) => {
                (Some(left), Some(right), None)
            }
            ExprKind::Parameter { number, bit, axis } => (Some(number), bit.$borrow(), axis.$borrow()),
        };
        [first, second, third].into_iter().flatten()
    }};
}

impl Expr {
    /// Iterates over the direct parts in the order written: operands, arguments, the number of a variable.
    pub fn operands(&self) -> impl Iterator<Item = &Self> {
        operands!(&self.kind, as_ref).map(|part| &**part)
    }

    /// Iterates over the direct parts as [`Self::operands`] does.
    pub(super) fn operands_mut(&mut self) -> impl Iterator<Item = &mut Self> {
        operands!(&mut self.kind, as_mut).map(|part| &mut **part)
    }
}

/// Variants of an expression.
#[derive(Clone, Debug, PartialEq)]
pub enum ExprKind {
    /// Number.
    Literal(Decimal),
    /// Variable by its number, itself an expression: `#n`, `#[…]`, `#[#…]`.
    Variable(Box<Expr>),
    /// Variable by its name: `[#_ABSMT[1]]`, `[#TOOL_NO]`.
    Named(Name),
    /// Value with a minus sign.
    Negate(Box<Expr>),
    /// Value with a plus sign.
    Plus(Box<Expr>),
    /// Value in brackets; they keep vacancy and count towards the nesting limit.
    Bracket(Box<Expr>),
    /// Operator with its two operands.
    Binary(BinaryOp, Box<Expr>, Box<Expr>),
    /// Function call: `SIN[…]`, `ATAN[a]/[b]`, `ATAN[a,b]`, `POW[a,b]`.
    Call(Function, CallForm),
    /// Parameter: `PRM[n]`, `PRM[n,bit]`, `PRM[n]/[axis]`, `PRM[n,bit]/[axis]`.
    Parameter {
        /// Parameter number.
        number: Box<Expr>,
        /// Bit number.
        bit: Option<Box<Expr>>,
        /// Axis number.
        axis: Option<Box<Expr>>,
    },
    /// `AXNUM[X]`: axis number of a letter.
    AxisNumber(u8),
}

/// Name of a variable, with its suffix.
#[derive(Clone, Debug, PartialEq)]
pub struct Name {
    /// Name without `#`, in upper case.
    pub text: String,
    /// Suffix in brackets.
    pub index: Option<Box<Expr>>,
}

/// Notation of a function's arguments.
#[derive(Clone, Debug, PartialEq)]
pub enum CallForm {
    /// `SIN[a]`.
    One(Box<Expr>),
    /// `ATAN[a]/[b]`.
    Slash(Box<Expr>, Box<Expr>),
    /// `ATAN[a,b]`, `POW[a,b]`.
    Comma(Box<Expr>, Box<Expr>),
}

/// Operator between two numbers or two conditions.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BinaryOp {
    /// `+`.
    Add,
    /// `-`.
    Sub,
    /// `*`.
    Mul,
    /// `/`.
    Div,
    /// `MOD`: remainder.
    Mod,
    /// `AND` of bits or conditions.
    And,
    /// `OR` of bits or conditions.
    Or,
    /// `XOR` of bits or conditions.
    Xor,
}

/// Function of an expression.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Function {
    /// Sine of degrees.
    Sin,
    /// Cosine of degrees.
    Cos,
    /// Tangent of degrees.
    Tan,
    /// Arc sine in degrees.
    Asin,
    /// Arc cosine in degrees.
    Acos,
    /// Arc tangent in degrees, of one value or of two.
    Atan,
    /// Square root.
    Sqrt,
    /// Absolute value.
    Abs,
    /// Rounding, to the nearest whole number or to the increment of an address.
    Round,
    /// Rounding towards zero.
    Fix,
    /// Rounding away from zero.
    Fup,
    /// Natural logarithm.
    Ln,
    /// Exponential function.
    Exp,
    /// Power, of two arguments.
    Pow,
    /// Conversion from binary-coded decimal.
    Bin,
    /// Conversion to binary-coded decimal.
    Bcd,
    /// Argument with a decimal point added.
    Adp,
}

/// Condition in the brackets of IF and WHILE.
///
/// A condition is not a number; a number is a condition on some controls, where nothing joins it to others.
#[derive(Clone, Debug, PartialEq)]
pub enum Condition {
    /// Comparison of two values.
    Compare {
        /// Left operand.
        left: Expr,
        /// Relation.
        relation: Relation,
        /// Notation of the relation.
        spelling: OperatorSpelling,
        /// Right operand.
        right: Expr,
        /// Span of the comparison without its brackets.
        span: Span,
    },
    /// `[c1] AND [c2]`, with [`BinaryOp::And`], [`BinaryOp::Or`] or [`BinaryOp::Xor`].
    Logic(BinaryOp, OperatorSpelling, Box<Condition>, Box<Condition>),
    /// Condition in brackets.
    Bracket(Box<Condition>),
    /// `[#1]`: a value in place of the whole condition.
    Value {
        /// Value, without the brackets of the condition.
        value: Expr,
        /// True for WHILE.
        of_loop: bool,
    },
}

/// Notation of an operator in a condition.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OperatorSpelling {
    /// `EQ`, `AND`: accepted by every control.
    Letters,
    /// `=`, `&`.
    Sign,
}

impl BinaryOp {
    /// Operators of a sum with their spellings.
    pub(super) const OF_SUM: [(&'static str, Self); 5] =
        [("+", Self::Add), ("-", Self::Sub), ("|", Self::Or), ("OR", Self::Or), ("XOR", Self::Xor)];
    /// Operators of a product, which bind tighter.
    pub(super) const OF_PRODUCT: [(&'static str, Self); 5] =
        [("*", Self::Mul), ("/", Self::Div), ("&", Self::And), ("AND", Self::And), ("MOD", Self::Mod)];
}

impl Relation {
    /// All relations with their letters and signs; a sign that begins another one follows it.
    pub(super) const SPELLINGS: [(Self, &'static str, &'static str); 6] = [
        (Self::Ne, "NE", "<>"),
        (Self::Ge, "GE", ">="),
        (Self::Le, "LE", "<="),
        (Self::Eq, "EQ", "="),
        (Self::Gt, "GT", ">"),
        (Self::Lt, "LT", "<"),
    ];
}

/// Macro statement.
#[derive(Clone, Debug, PartialEq)]
pub enum Statement {
    /// `#n=value`. The text of `#3000=1(TEXT)` is among the comments of the block.
    Assign {
        /// Assigned variable.
        target: Expr,
        /// Value.
        value: Expr,
    },
    /// `GOTO n`.
    Goto(Expr),
    /// `IF[…]GOTO n`.
    IfGoto {
        /// Condition of the jump.
        condition: Condition,
        /// Sequence number of the target.
        to: Expr,
    },
    /// `IF[…]THEN statement`.
    IfThen {
        /// Condition of the statement.
        condition: Condition,
        /// Conditional statement.
        then: Box<Statement>,
    },
    /// `IF[…]` or `IF[…]THEN` before words, or `IF[…]` before an assignment.
    ///
    /// The condition applies to the other items of the block.
    If {
        /// Condition of the other items.
        condition: Condition,
        /// True if THEN is written.
        has_then: bool,
    },
    /// `WHILE[…]DOn`.
    While {
        /// Condition of the next iteration.
        condition: Condition,
        /// Loop number.
        number: Spanned<i64>,
    },
    /// `DOn`, a loop without condition.
    Do(Spanned<i64>),
    /// `ENDn`.
    End(Spanned<i64>),
    /// `SETVN 510[TOOL_NO, WORK]`: names for consecutive variables.
    SetNames {
        /// Number of the first variable.
        first: Expr,
        /// Names in upper case.
        names: Vec<String>,
    },
    /// `DPRNT[TEXT#1[44]*]` or `BPRNT[…]`.
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
}

/// Output format of a print statement.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PrintKind {
    /// DPRNT: text; each variable with digits before and after the decimal point.
    Decimal,
    /// BPRNT: binary; each variable with its digits after the decimal point.
    Binary,
}

/// Part of a print statement.
#[derive(Clone, Debug, PartialEq)]
pub enum PrintPart {
    /// Literal text.
    Text(String),
    /// Variable with its format.
    Value {
        /// Printed variable.
        variable: Expr,
        /// Digits of the format, as written.
        format: String,
    },
}
