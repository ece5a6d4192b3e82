//! Syntax that only some controls accept, recorded at lowering and checked against the settings at run time.
use crate::alarm::Alarm;
use crate::control::{Dialect, Settings};

use super::g_codes;

/// Message and help on a program O0 where it is accepted.
pub const PROGRAM_ZERO_NOTE: (&str, &str) = (
    "O0 is no program number: a control refuses it (PS0074) unless the operator gives another one when it is read",
    "write O1 to O99999999",
);

/// Syntax element that some controls refuse.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DialectSyntax {
    /// Letters in lower case.
    LowerCase,
    /// Comment without its closing bracket.
    UnclosedComment,
    /// Comment inside a comment, with a word behind it.
    NestedComment,
    /// Abbreviated keyword: `WH[…]DO1`, `GO 5`.
    ShortWord,
    /// Relation signs in a condition: `=`, `<>`, `<`, `&`.
    RelationSigns,
    /// Several assignments in a block: `#1=1 #2=2`.
    SeveralAssignments,
    /// GOTO behind an assignment in a block: `#1=1 GOTO 5`.
    GotoAfterAssignment,
    /// Statements behind DO in its line, each a block of its own.
    StatementsBehindDo,
    /// A block behind another one and `;` in its line.
    BlockAfterSemicolon,
    /// `IF[…]` before words or an assignment, without THEN.
    PlainIf,
    /// `IF[…]THEN` before words.
    ThenWords,
    /// `IF[…]THEN GOTO 5`.
    ThenGoto,
    /// POW, MOD or ATAN with a comma.
    NewFunction(&'static str),
    /// FUP, LN and other functions outside the basic set.
    MoreFunction(&'static str),
    /// `<NAME>`, SETVN, `[#NAME]`, PRM and the like.
    NewWord(&'static str),
    /// G code × 10 that lowering interprets as a call.
    GCodeCall(u32),
    /// `#30057.21=1`: an item or bit is written, or the variable with the rounded number.
    FractionalNumber,
    /// `IF[#1]`, `WHILE[#1]DO1`: a value as a condition.
    ValueCondition {
        /// True for WHILE.
        of_loop: bool,
    },
    /// Modal codes before G65, G66 or G66.1.
    CodesBeforeCall,
    /// Call of a file by its path, `M98 (Memory/O00002.nc)`.
    PathOfCall,
    /// Program number 0.
    ProgramZero,
}

impl DialectSyntax {
    /// Returns true if a control with these settings accepts the syntax.
    pub fn is_accepted(self, settings: &Settings) -> bool {
        let undocumented = &settings.undocumented;
        match self {
            Self::LowerCase => undocumented.reads_lower_case,
            Self::UnclosedComment | Self::NestedComment => true,
            Self::ShortWord => undocumented.allows_short_words,
            Self::RelationSigns => undocumented.allows_relation_signs,
            Self::SeveralAssignments => undocumented.allows_several_assignments,
            Self::GotoAfterAssignment => undocumented.allows_goto_after_assignment,
            Self::StatementsBehindDo => settings.reads_statements_behind_do,
            Self::BlockAfterSemicolon => undocumented.semicolon_ends_block,
            Self::PlainIf => settings.allows_plain_if,
            Self::ThenWords => settings.then_takes_words,
            Self::ThenGoto => undocumented.then_takes_goto,
            Self::NewFunction(_) => undocumented.has_new_functions,
            Self::MoreFunction(_) => settings.has_extended_functions,
            Self::NewWord(_) => settings.has_named_variables,
            Self::GCodeCall(code) => g_codes::find(code).row_for(settings.codes).is_some(),
            Self::FractionalNumber => !settings.has_variable_bits,
            Self::ValueCondition { .. } => settings.allows_value_conditions,
            Self::CodesBeforeCall => undocumented.allows_codes_before_call,
            Self::PathOfCall => settings.codes == Dialect::HaasNgc,
            Self::ProgramZero => undocumented.reads_program_zero,
        }
    }

    /// Returns the alarm of a control that refuses the syntax.
    pub fn alarm(self) -> Alarm {
        match self {
            Self::LowerCase => Alarm::LowerCase,
            Self::UnclosedComment => Alarm::NotSimulated { what: "a comment without `)`".into() },
            Self::NestedComment => Alarm::NotSimulated { what: "a comment inside a comment".into() },
            Self::ShortWord => Alarm::ShortWord,
            Self::RelationSigns => Alarm::RelationSymbol,
            Self::SeveralAssignments => Alarm::MacroFormat { what: "two assignments in one block".into() },
            Self::GotoAfterAssignment => {
                Alarm::MacroFormat { what: "GOTO behind an assignment in one block".into() }
            }
            Self::StatementsBehindDo => {
                Alarm::MacroFormat { what: "a statement behind DO in one block".into() }
            }
            Self::BlockAfterSemicolon => Alarm::TwoBlocksInOneLine,
            Self::PlainIf => Alarm::IfFormat,
            Self::ThenWords => Alarm::ThenWords,
            Self::ThenGoto => Alarm::ThenGoto,
            Self::NewFunction(name) | Self::MoreFunction(name) => Alarm::Expression { text: name.into() },
            Self::NewWord(word) => Alarm::NotAWord { text: word.into() },
            Self::GCodeCall(code) => g_codes::improper(code),
            Self::FractionalNumber => Alarm::NotSimulated { what: "writing #n.m".into() },
            Self::ValueCondition { of_loop: false } => Alarm::IfFormat,
            Self::ValueCondition { of_loop: true } => Alarm::WhileFormat,
            Self::ProgramZero => Alarm::ProgramNumber,
            Self::PathOfCall => Alarm::ProgramNotNamed,
            Self::CodesBeforeCall => Alarm::MacroFormat { what: "words before the macro call".into() },
        }
    }
}
