//! Semantic tokens: words by the motion that they make, variables by their scope.
use crate::project::Project;
use crate::text::{FileId, TextRange};

/// Kind of a token.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum TokenKind {
    /// Comment or remark.
    Comment,
    /// Number.
    Number,
    /// Text of DPRNT, or a program name.
    Text,
    /// IF, WHILE, GOTO and the others.
    Keyword,
    /// EQ, AND, MOD, +, =.
    Operator,
    /// SIN, ROUND and the others.
    Function,
    /// #1 to #33.
    LocalVariable,
    /// #100 to #199, #500 to #999 and further commons.
    CommonVariable,
    /// System variable, by number or by name.
    SystemVariable,
    /// N word, and the target of a jump.
    SequenceNumber,
    /// O word, and the P of a call.
    Program,
    /// G00, and axis words that it moves.
    RapidMotion,
    /// G01, and axis words that it moves.
    FeedMotion,
    /// G02 and G03, and axis words that they move.
    ArcMotion,
    /// Canned cycle, and axis words of its holes.
    CycleMotion,
    /// G65, G66, M98, M99 and codes that call programs.
    Call,
    /// Any other G code.
    GCode,
    /// Any other M code.
    MCode,
    /// Any other address: F, S, T and so on.
    Address,
    /// `/` and `%`.
    Mark,
}

impl TokenKind {
    /// All kinds in ascending order.
    pub const ALL: [Self; 20] = [
        Self::Comment,
        Self::Number,
        Self::Text,
        Self::Keyword,
        Self::Operator,
        Self::Function,
        Self::LocalVariable,
        Self::CommonVariable,
        Self::SystemVariable,
        Self::SequenceNumber,
        Self::Program,
        Self::RapidMotion,
        Self::FeedMotion,
        Self::ArcMotion,
        Self::CycleMotion,
        Self::Call,
        Self::GCode,
        Self::MCode,
        Self::Address,
        Self::Mark,
    ];
}

/// Token of a text.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SemanticToken {
    /// Range in one line.
    pub range: TextRange,
    /// Kind.
    pub kind: TokenKind,
    /// True for an assigned variable.
    pub is_written: bool,
    /// True for the sequence number of a block and an O word.
    pub is_declaration: bool,
}

impl Project {
    /// Returns the tokens of the lines of a range, or of the whole file, in order and without overlaps.
    pub fn semantic_tokens(&self, file: FileId, range: Option<TextRange>) -> Vec<SemanticToken> {
        let _ = (file, range);
        Vec::new()
    }
}
