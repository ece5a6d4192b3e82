//! Reader of macro statements: assignment, GOTO, IF, WHILE, DO, END.
use super::ast::{Condition, Expr, PrintKind, Statement};
use super::expr::{condition, expr, require_value, variable};
use super::number::integer;
use super::output::{print, set_names};
use super::token::{
    Input, LineInput, ReadResult, comment_before, fail, is_space, letters, next, no_expression, no_match,
    require, round_brackets, sign, spaces,
};
use crate::alarm::Alarm;
use crate::source::Spanned;

/// Keyword of a statement.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Keyword {
    If,
    While,
    Goto,
    Do,
    End,
    Then,
    SetNames,
    Decimal,
    Binary,
    Open,
    Close,
}

/// Keywords of statements. The first two letters suffice (WH, GO, EN …); they are unique.
const KEYWORDS: [(&str, Keyword); 11] = [
    ("IF", Keyword::If),
    ("GOTO", Keyword::Goto),
    ("WHILE", Keyword::While),
    ("DO", Keyword::Do),
    ("END", Keyword::End),
    ("THEN", Keyword::Then),
    ("SETVN", Keyword::SetNames),
    ("DPRNT", Keyword::Decimal),
    ("BPRNT", Keyword::Binary),
    ("POPEN", Keyword::Open),
    ("PCLOS", Keyword::Close),
];

/// Keyword at the start of an input.
pub(super) struct StatementStart<'a> {
    /// Input after the keyword.
    pub rest: Input<'a>,
    pub keyword: Keyword,
    /// True if the keyword is abbreviated.
    pub is_short: bool,
}

/// Reads the keyword at the start of the input; `None` if there is none.
///
/// A word never has two consecutive letters, so the second byte decides for most blocks.
#[inline]
pub(super) fn keyword(input: Input<'_>) -> Option<StatementStart<'_>> {
    let (_, after) = input.split_first()?;
    if let [b'0'..=b'9' | b'-' | b'.' | b'#' | b'[', ..] = after {
        return None;
    }
    let second = after.iter().find(|b| !is_space(**b))?;
    if second.is_ascii_alphabetic() { written_keyword(input) } else { None }
}

fn written_keyword(input: Input<'_>) -> Option<StatementStart<'_>> {
    KEYWORDS.iter().find_map(|(text, keyword)| {
        let (rest, count) = letters(input, text);
        (count >= 2).then_some(StatementStart { rest, keyword: *keyword, is_short: count < text.len() })
    })
}

/// Reads a statement after its keyword; the flag is true if one of its keywords is abbreviated.
pub(super) fn statement<'a>(
    line: LineInput,
    start: &StatementStart<'a>,
) -> ReadResult<'a, (Statement, bool)> {
    let &StatementStart { rest, keyword, is_short: short } = start;
    let (rest, (statement, inside)) = match keyword {
        Keyword::If => if_statement(line, rest)?,
        Keyword::While => while_statement(line, rest)?,
        Keyword::Goto => whole_words(goto(line, rest)?, Statement::Goto),
        Keyword::Do => whole_words(loop_number(line, rest)?, Statement::Do),
        Keyword::End => whole_words(loop_number(line, rest)?, Statement::End),
        Keyword::Then => return fail(rest, Alarm::IfFormat),
        Keyword::SetNames => whole_words(set_names(line, rest)?, |names| names),
        Keyword::Decimal => whole_words(print(line, rest, PrintKind::Decimal)?, |print| print),
        Keyword::Binary => whole_words(print(line, rest, PrintKind::Binary)?, |print| print),
        // `PC LOS`: letters after an abbreviated keyword may belong to it.
        Keyword::Open | Keyword::Close if short && begins_with_letter(rest) => return no_match(rest),
        Keyword::Open => (rest, (Statement::OpenOutput, false)),
        Keyword::Close => (rest, (Statement::CloseOutput, false)),
    };
    Ok((rest, (statement, short || inside)))
}

fn begins_with_letter(input: Input<'_>) -> bool {
    next(input).is_some_and(|(byte, _)| byte.is_ascii_alphabetic())
}

/// Builds a statement from its only part, without further keywords.
fn whole_words<'a, T>(
    (rest, part): (Input<'a>, T),
    of: impl FnOnce(T) -> Statement,
) -> (Input<'a>, (Statement, bool)) {
    (rest, (of(part), false))
}

/// Reads `#n=value`. The input begins with `#` or with a name in brackets.
pub(super) fn assignment(line: LineInput, input: Input<'_>) -> ReadResult<'_, Statement> {
    let (rest, target) = require(|input| variable(line, input), not_a_word)(input)?;
    let (after, ()) = require(sign(b'='), || Alarm::MissingEquals)(rest)?;
    let (rest, value) = require_value(expr(line, after, 0), after)?;
    let (rest, ()) = check_expression_end(rest)?;
    Ok((rest, Statement::Assign { target, value }))
}

fn not_a_word() -> Alarm {
    Alarm::NotAWord { text: String::new() }
}

/// Rejects text that must not follow an expression; an extra `]` means that an opening one is missing.
fn check_expression_end(rest: Input<'_>) -> ReadResult<'_, ()> {
    match next(rest) {
        Some((b']', _)) => fail(spaces(rest), Alarm::MissingOpenBracket),
        Some((b'[' | b'=' | b'<' | b'>' | b'.' | b'0'..=b'9', _)) => no_expression(spaces(rest)),
        _ => Ok((rest, ())),
    }
}

fn goto(line: LineInput, input: Input<'_>) -> ReadResult<'_, Expr> {
    let what = || Alarm::MacroFormat { what: "GOTO needs a sequence number".into() };
    let (rest, to) = require(|input| expr(line, input, 0), what)(input)?;
    let (rest, ()) = check_expression_end(rest)?;
    Ok((rest, to))
}

fn if_statement(line: LineInput, input: Input<'_>) -> ReadResult<'_, (Statement, bool)> {
    let (rest, condition) = require_condition(line, input, false)?;
    let at = spaces(rest);
    match keyword(at) {
        Some(StatementStart { rest, keyword: Keyword::Goto, is_short: short }) => {
            let (rest, to) = goto(line, rest)?;
            Ok((rest, (Statement::IfGoto { condition, to }, short)))
        }
        Some(StatementStart { rest, keyword: Keyword::Then, is_short: short }) if begins_word(rest) => {
            Ok((rest, (Statement::If { condition, has_then: true }, short)))
        }
        Some(StatementStart { rest, keyword: Keyword::Then, is_short: short }) => {
            let (rest, (then, inside)) = require(|input| then(line, input), || Alarm::IfFormat)(rest)?;
            Ok((rest, (Statement::IfThen { condition, then: Box::new(then) }, short || inside)))
        }
        None if begins_word(at) || matches!(at.first(), Some(b'#')) => {
            Ok((at, (Statement::If { condition, has_then: false }, false)))
        }
        _ => fail(at, Alarm::IfFormat),
    }
}

/// Returns true if the next two characters look like an address and its value.
fn begins_word(input: Input<'_>) -> bool {
    let Some((b'A'..=b'Z' | b'a'..=b'z', after)) = next(input) else { return false };
    matches!(next(after), Some((b'0'..=b'9' | b'#' | b'[' | b'.' | b'-' | b'+', _)))
}

/// Reads the statement after THEN: an assignment, or a GOTO for the controls that accept one.
fn then(line: LineInput, input: Input<'_>) -> ReadResult<'_, (Statement, bool)> {
    let at = spaces(input);
    match at.first() {
        Some(b'#' | b'[') => assignment(line, at).map(|(rest, found)| (rest, (found, false))),
        _ => match keyword(at) {
            Some(begun) if begun.keyword == Keyword::Goto => statement(line, &begun),
            _ => no_match(at),
        },
    }
}

fn while_statement(line: LineInput, input: Input<'_>) -> ReadResult<'_, (Statement, bool)> {
    let (rest, condition) = require_condition(line, input, true)?;
    let at = spaces(rest);
    match keyword(at) {
        Some(StatementStart { rest, keyword: Keyword::Do, .. })
            if matches!(next(rest), Some((b'0'..=b'9', _))) =>
        {
            let (rest, number) = loop_number(line, rest)?;
            Ok((rest, (Statement::While { condition, number }, false)))
        }
        _ => fail(at, Alarm::WhileFormat),
    }
}

/// Reads the condition of IF and WHILE; `IF(…)` has a comment in its place and raises its own alarm.
fn require_condition<'a>(line: LineInput, input: Input<'a>, of_loop: bool) -> ReadResult<'a, Condition> {
    let otherwise = if of_loop { Alarm::WhileFormat } else { Alarm::IfFormat };
    match condition(line, input, of_loop) {
        Err(nom::Err::Error(_)) if comment_before(input) => round_brackets(input, None),
        Err(nom::Err::Error(_)) => fail(spaces(input), otherwise),
        Ok((rest, _)) if matches!(next(rest), Some((b']', _))) => {
            fail(spaces(rest), Alarm::MissingOpenBracket)
        }
        read => read,
    }
}

fn loop_number(line: LineInput, input: Input<'_>) -> ReadResult<'_, Spanned<i64>> {
    let what = || Alarm::MacroFormat { what: "DO and END need the loop's number, 1, 2 or 3".into() };
    let at = spaces(input);
    let (rest, number) = require(integer, what)(at)?;
    Ok((rest, line.spanned(i64::try_from(number).unwrap_or(i64::MAX), at, rest)))
}
