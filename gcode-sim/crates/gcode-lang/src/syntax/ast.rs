//! What stands in the file: programs, blocks, words and macro statements, each with its place.
//!
//! Nothing is interpreted here. A number keeps its point, because whether `X1` is 1 mm or 0.001 mm is a setting
//! of the control; a block that can't be read keeps its alarm, because a control raises it when it gets there.
use crate::alarm::Alarm;
use crate::source::{Span, Spanned};

/// One O-program of a file.
#[derive(Clone, Debug, PartialEq)]
pub struct Program {
    pub name: ProgramName,
    /// The place of the O word, or of the first block where there is none.
    pub span: Span,
    /// The blocks after the O word; words on the line of the O word are the first block.
    pub blocks: Vec<Block>,
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ProgramName {
    /// `O0001`, `:0007`; also `<O0123>`.
    Number(u32),
    /// `<BRACKET-OP1>`.
    Name(String),
    /// A main program without an O word.
    Unnamed,
}

impl ProgramName {
    /// As a control shows it: `O8101`, `<BRACKET-OP1>`; `MAIN` where there is none.
    pub fn label(&self) -> String {
        match self {
            Self::Number(number) => format!("O{number:04}"),
            Self::Name(name) => format!("<{name}>"),
            Self::Unnamed => "MAIN".into(),
        }
    }
}

impl ProgramName {
    /// The program that `<text>` names: O and a number is that number.
    pub fn of(text: String) -> Self {
        let digits = text.strip_prefix('O').filter(|digits| digits.bytes().all(|b| b.is_ascii_digit()));
        match digits.and_then(|digits| digits.parse().ok()) {
            Some(number @ 1..=99_999_999) => Self::Number(number),
            _ => Self::Name(text),
        }
    }
}

/// One line.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Block {
    pub span: Span,
    /// `/` or `/n` at the start: the switch, 1 to 9.
    pub skip: Option<Spanned<u8>>,
    /// `N10`.
    pub number: Option<Spanned<u32>>,
    /// The first statement with a word cut short: `WH[…]DO1`, `GO 5`.
    pub short_word: Option<Span>,
    pub items: Vec<Item>,
    /// Comments in the order they stand in.
    pub comments: Vec<Comment>,
}

/// What a block is made of. Most are words, so what is larger lies apart. A control takes either words or one statement; that is checked when it is lowered.
#[derive(Clone, Debug, PartialEq)]
pub enum Item {
    Word(Word),
    Statement(Box<Spanned<Statement>>),
    /// `/n` inside a block: the rest is skipped when the switch is on.
    Skip(Spanned<u8>),
    /// The rest of the line can't be read.
    Unreadable(Box<Unreadable>),
}

/// The rest of a line from the word or statement that can't be read.
#[derive(Clone, Debug, PartialEq)]
pub struct Unreadable {
    /// Raised if the block is reached; its place is where reading failed.
    pub alarm: Spanned<Alarm>,
    pub span: Span,
    /// As written, comments included.
    pub text: Vec<u8>,
}

/// A comment: its bytes, whatever their encoding.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Comment {
    /// Brackets included.
    pub span: Span,
    /// What stands between the brackets or after the sign.
    pub text: Vec<u8>,
    pub mark: CommentMark,
}

/// What makes a comment one.
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

/// Stands for the letter of an axis that only a run knows.
pub const AX: u8 = b'@';

/// An address and its value: `X10.`, `X-#1`, `F[#7/3.]`, `,R10.`
#[derive(Clone, Debug, PartialEq)]
pub struct Word {
    pub address: Address,
    /// `AX[1]=10.`: the axis by its number; the letter is [`AX`].
    pub axis: Option<Box<Expr>>,
    pub value: WordValue,
    pub span: Span,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Address {
    /// `A` to `Z`, upper case, or [`AX`].
    pub letter: u8,
    /// `,R` and `,C`: corner rounding and chamfer.
    pub comma: bool,
}

#[derive(Clone, Debug, PartialEq)]
pub enum WordValue {
    Literal(Decimal),
    /// `#1`, `[…]`, and `-#1`, `-[…]` as a negation of it. The bracket itself is kept as [`ExprKind::Bracket`].
    Expr(Box<Expr>),
    /// `G65 P<NAME>` or `M98 <NAME>`.
    Name(String),
}

/// A literal as written: `-12.50` is digits 1250, places 2, negative.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Decimal {
    /// A minus sign stands before it; kept apart, so that -0 prints as written.
    pub negative: bool,
    pub digits: u64,
    /// Digits behind the point; `None` where there is no point.
    pub places: Option<u8>,
}

impl Decimal {
    /// The number that the digits spell, point or not.
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

/// An expression with its place.
#[derive(Clone, Debug, PartialEq)]
pub struct Expr {
    pub kind: ExprKind,
    pub span: Span,
}

#[derive(Clone, Debug, PartialEq)]
pub enum ExprKind {
    Literal(Decimal),
    /// `#n`, `#[…]`, `#[#…]`: the number is an expression.
    Variable(Box<Expr>),
    /// `[#_ABSMT[1]]`, `[#TOOL_NO]`: a variable by its name.
    Named(Name),
    Negate(Box<Expr>),
    /// A sign `+` before a value.
    Plus(Box<Expr>),
    /// `[…]`: brackets keep vacancy, and a control counts them.
    Bracket(Box<Expr>),
    Binary(BinaryOp, Box<Expr>, Box<Expr>),
    /// `SIN[…]`, `ATAN[a]/[b]`, `ATAN[a,b]`, `POW[a,b]`.
    Call(Function, CallForm),
    /// `PRM[n]`, `PRM[n,bit]`, `PRM[n]/[axis]`, `PRM[n,bit]/[axis]`.
    Parameter {
        number: Box<Expr>,
        bit: Option<Box<Expr>>,
        axis: Option<Box<Expr>>,
    },
    /// `AXNUM[X]`: the number of an axis by its letter.
    AxisNumber(u8),
}

#[derive(Clone, Debug, PartialEq)]
pub struct Name {
    pub text: String,
    pub index: Option<Box<Expr>>,
}

#[derive(Clone, Debug, PartialEq)]
pub enum CallForm {
    One(Box<Expr>),
    /// `ATAN[a]/[b]`.
    Slash(Box<Expr>, Box<Expr>),
    /// `ATAN[a,b]`, `POW[a,b]`.
    Comma(Box<Expr>, Box<Expr>),
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BinaryOp {
    Add,
    Sub,
    Mul,
    Div,
    Mod,
    And,
    Or,
    Xor,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Function {
    Sin,
    Cos,
    Tan,
    Asin,
    Acos,
    Atan,
    Sqrt,
    Abs,
    Round,
    Fix,
    Fup,
    Ln,
    Exp,
    Pow,
    Bin,
    Bcd,
    Adp,
}

/// What stands in the brackets of IF and WHILE. A condition is not a number, and a number is not a condition.
#[derive(Clone, Debug, PartialEq)]
pub enum Condition {
    Compare {
        left: Expr,
        relation: Relation,
        spelling: OperatorSpelling,
        right: Expr,
        span: Span,
    },
    /// `[c1] AND [c2]`; [`BinaryOp::And`], [`BinaryOp::Or`] or [`BinaryOp::Xor`].
    Logic(BinaryOp, OperatorSpelling, Box<Condition>, Box<Condition>),
    Bracket(Box<Condition>),
}

/// How an operator of a condition is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OperatorSpelling {
    /// `EQ`, `AND`: what every control takes.
    Letters,
    /// `=`, `&`.
    Sign,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Relation {
    Eq,
    Ne,
    Gt,
    Ge,
    Lt,
    Le,
}

/// A macro statement.
#[derive(Clone, Debug, PartialEq)]
pub enum Statement {
    /// `#n=value`; `#3000=1(TEXT)` finds its text among the block's comments.
    Assign {
        target: Expr,
        value: Expr,
    },
    Goto(Expr),
    IfGoto {
        condition: Condition,
        to: Expr,
    },
    /// `IF[…]THEN statement`.
    IfThen {
        condition: Condition,
        then: Box<Statement>,
    },
    /// `IF[…]` or `IF[…]THEN` before words, or `IF[…]` before an assignment: the block's other items are what it
    /// decides about.
    If {
        condition: Condition,
        has_then: bool,
    },
    While {
        condition: Condition,
        number: Spanned<i64>,
    },
    Do(Spanned<i64>),
    End(Spanned<i64>),
    /// `SETVN 510[TOOL_NO, WORK]`.
    SetNames {
        first: Expr,
        names: Vec<String>,
    },
    /// `DPRNT[TEXT#1[44]*]`.
    Print {
        kind: PrintKind,
        parts: Vec<PrintPart>,
    },
    OpenOutput,
    CloseOutput,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PrintKind {
    /// DPRNT: text, each variable with digits before and after the point.
    Decimal,
    /// BPRNT: binary, each variable with its digits after the point.
    Binary,
}

#[derive(Clone, Debug, PartialEq)]
pub enum PrintPart {
    Text(String),
    Value { variable: Expr, format: String },
}
