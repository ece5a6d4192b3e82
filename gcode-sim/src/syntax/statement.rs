//! Macro statements: assignment, GOTO, IF, WHILE, DO, END.
use super::ast::{Condition, Expr, PrintKind, Statement};
use super::expr::{condition, expr, variable, wanted};
use super::number::integer;
use super::output::{print, set_names};
use super::token::{
    Input, Line, Read, comment_before, fail, is_space, letters, must, next, no_expression, other,
    round_brackets, sign, spaces,
};
use crate::alarm::Alarm;
use crate::source::Spanned;

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

/// Statement words. Their first two letters are enough (WH, GO, EN …), and no two begin alike.
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

/// The statement word that the input begins with; what is left stands after it. Two letters one after the other are
/// never words, so a single look at the second one settles most blocks.
pub(super) fn keyword(input: Input<'_>) -> Option<(Input<'_>, Keyword)> {
    let (_, after) = input.split_first()?;
    let second = after.iter().find(|b| !is_space(**b))?;
    if !second.is_ascii_alphabetic() {
        return None;
    }
    KEYWORDS.iter().find_map(|(text, keyword)| {
        let (rest, count) = letters(input, text);
        (count >= 2).then_some((rest, *keyword))
    })
}

/// The statement after its keyword.
pub(super) fn statement<'a>(line: Line, rest: Input<'a>, keyword: Keyword) -> Read<'a, Statement> {
    match keyword {
        Keyword::If => if_statement(line, rest),
        Keyword::While => while_statement(line, rest),
        Keyword::Goto => goto(line, rest).map(|(rest, to)| (rest, Statement::Goto(to))),
        Keyword::Do => loop_number(line, rest).map(|(rest, number)| (rest, Statement::Do(number))),
        Keyword::End => loop_number(line, rest).map(|(rest, number)| (rest, Statement::End(number))),
        Keyword::Then => fail(rest, Alarm::IfFormat),
        Keyword::SetNames => set_names(line, rest),
        Keyword::Decimal => print(line, rest, PrintKind::Decimal),
        Keyword::Binary => print(line, rest, PrintKind::Binary),
        Keyword::Open => Ok((rest, Statement::OpenOutput)),
        Keyword::Close => Ok((rest, Statement::CloseOutput)),
    }
}

/// `#n=value`; the input begins with `#` or with a name in brackets.
pub(super) fn assignment(line: Line, input: Input<'_>) -> Read<'_, Statement> {
    let (rest, target) = must(|input| variable(line, input), not_a_word)(input)?;
    let (after, ()) = must(sign(b'='), || Alarm::MissingEquals)(rest)?;
    let (rest, value) = wanted(expr(line, after, 0), after)?;
    let (rest, ()) = whole(rest)?;
    Ok((rest, Statement::Assign { target, value }))
}

fn not_a_word() -> Alarm {
    Alarm::NotAWord { text: String::new() }
}

/// What may not follow an expression: a `]` too many tells that an opening one is missing.
fn whole(rest: Input<'_>) -> Read<'_, ()> {
    match next(rest) {
        Some((b']', _)) => fail(spaces(rest), Alarm::MissingOpenBracket),
        Some((b'[' | b'=' | b'<' | b'>' | b'.' | b'0'..=b'9', _)) => no_expression(spaces(rest)),
        _ => Ok((rest, ())),
    }
}

fn goto(line: Line, input: Input<'_>) -> Read<'_, Expr> {
    let what = || Alarm::MacroFormat { what: "GOTO needs a sequence number".into() };
    let (rest, to) = must(|input| expr(line, input, 0), what)(input)?;
    let (rest, ()) = whole(rest)?;
    Ok((rest, to))
}

fn if_statement(line: Line, input: Input<'_>) -> Read<'_, Statement> {
    let (rest, condition) = wanted_condition(line, input, Alarm::IfFormat)?;
    let at = spaces(rest);
    match keyword(at) {
        Some((after, Keyword::Goto)) => {
            let (rest, to) = goto(line, after)?;
            Ok((rest, Statement::IfGoto { condition, to }))
        }
        Some((after, Keyword::Then)) if begins_word(after) => {
            Ok((after, Statement::If { condition, has_then: true }))
        }
        Some((after, Keyword::Then)) => {
            let (rest, then) = must(|input| then(line, input), || Alarm::IfFormat)(after)?;
            Ok((rest, Statement::IfThen { condition, then: Box::new(then) }))
        }
        None if begins_word(at) || matches!(at.first(), Some(b'#')) => {
            Ok((at, Statement::If { condition, has_then: false }))
        }
        _ => fail(at, Alarm::IfFormat),
    }
}

/// An address and its value, as far as two characters tell.
fn begins_word(input: Input<'_>) -> bool {
    let Some((b'A'..=b'Z' | b'a'..=b'z', after)) = next(input) else { return false };
    matches!(next(after), Some((b'0'..=b'9' | b'#' | b'[' | b'.' | b'-' | b'+', _)))
}

/// One assignment, or a GOTO, which some controls take.
fn then(line: Line, input: Input<'_>) -> Read<'_, Statement> {
    let at = spaces(input);
    match at.first() {
        Some(b'#' | b'[') => assignment(line, at),
        _ => match keyword(at) {
            Some((after, Keyword::Goto)) => statement(line, after, Keyword::Goto),
            _ => other(at),
        },
    }
}

fn while_statement(line: Line, input: Input<'_>) -> Read<'_, Statement> {
    let (rest, condition) = wanted_condition(line, input, Alarm::WhileFormat)?;
    let at = spaces(rest);
    match keyword(at) {
        Some((after, Keyword::Do)) if matches!(next(after), Some((b'0'..=b'9', _))) => {
            let (rest, number) = loop_number(line, after)?;
            Ok((rest, Statement::While { condition, number }))
        }
        _ => fail(at, Alarm::WhileFormat),
    }
}

/// `IF(…)` has a comment where its condition should be.
fn wanted_condition<'a>(line: Line, input: Input<'a>, otherwise: Alarm) -> Read<'a, Condition> {
    match condition(line, input) {
        Err(nom::Err::Error(_)) if comment_before(input) => round_brackets(input, None),
        Err(nom::Err::Error(_)) => fail(spaces(input), otherwise),
        read => read,
    }
}

fn loop_number(line: Line, input: Input<'_>) -> Read<'_, Spanned<i64>> {
    let what = || Alarm::MacroFormat { what: "DO and END need the loop's number, 1, 2 or 3".into() };
    let at = spaces(input);
    let (rest, number) = must(integer, what)(at)?;
    Ok((rest, line.spanned(i64::try_from(number).unwrap_or(i64::MAX), at, rest)))
}
