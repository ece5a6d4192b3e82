//! Macro statements: assignment, GOTO, IF, WHILE, DO, END, and the output statements.
use super::ast::{BinaryOp, Condition, Expr, PrintKind, PrintPart, Statement};
use super::expr::{condition, expr, starts_with, target};
use super::number::integer;
use super::token::{Input, Line, Read, fail, other, shown, spaces};
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

/// Statement words, and how many of their letters are enough.
const KEYWORDS: [(&[u8], usize, Keyword); 11] = [
    (b"IF", 2, Keyword::If),
    (b"WHILE", 2, Keyword::While),
    (b"GOTO", 2, Keyword::Goto),
    (b"DO", 2, Keyword::Do),
    (b"END", 2, Keyword::End),
    (b"THEN", 2, Keyword::Then),
    (b"SETVN", 5, Keyword::SetNames),
    (b"DPRNT", 2, Keyword::Decimal),
    (b"BPRNT", 2, Keyword::Binary),
    (b"POPEN", 2, Keyword::Open),
    (b"PCLOS", 2, Keyword::Close),
];

/// The statement word that the input begins with; what is left stands after it.
pub(super) fn keyword(input: Input<'_>) -> Option<(Input<'_>, Keyword)> {
    let length = input.iter().take_while(|b| b.is_ascii_alphabetic()).count();
    if length < 2 {
        return None;
    }
    let (word, rest) = input.split_at(length);
    let fits = |(text, least, _): &&(&[u8], usize, Keyword)| length >= *least && starts_with(text, word);
    KEYWORDS.iter().find(fits).map(|(_, _, keyword)| (rest, *keyword))
}

/// `#n=value`; the input begins with `#` or with a name in brackets.
pub(super) fn assignment(line: Line, input: Input<'_>) -> Read<'_, Statement> {
    let (rest, target) = target(line, input)?;
    let at = spaces(rest);
    let Some((b'=', after)) = at.split_first() else { return fail(at, Alarm::MissingEquals) };
    let (rest, value) = wanted(expr(line, after, 0), after)?;
    Ok((not_followed_by_bracket(rest)?.0, Statement::Assign { target, value }))
}

/// A `]` too many tells that an opening one is missing.
fn not_followed_by_bracket(rest: Input<'_>) -> Read<'_, ()> {
    match spaces(rest).first() {
        Some(b']') => fail(spaces(rest), Alarm::MissingOpenBracket),
        Some(b'[' | b'=' | b'*' | b'+' | b'-') => {
            fail(spaces(rest), Alarm::Expression { text: shown(spaces(rest)) })
        }
        _ => Ok((rest, ())),
    }
}

fn wanted<'a, T>(read: Read<'a, T>, at: Input<'a>) -> Read<'a, T> {
    match read {
        Err(nom::Err::Error(_)) => fail(spaces(at), Alarm::Expression { text: shown(spaces(at)) }),
        read => read,
    }
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

fn goto(line: Line, rest: Input<'_>) -> Read<'_, Expr> {
    let (rest, to) = match expr(line, rest, 0) {
        Err(nom::Err::Error(_)) => {
            return fail(rest, Alarm::MacroFormat { what: "GOTO needs a sequence number".into() });
        }
        read => read?,
    };
    Ok((not_followed_by_bracket(rest)?.0, to))
}

/// `[c1]`, and `[c1]AND[c2]` as some programs write it without the outer brackets.
fn conditions<'a>(line: Line, rest: Input<'a>, alarm: &Alarm) -> Read<'a, Condition> {
    let one = |input: Input<'a>| match condition(line, input) {
        Err(nom::Err::Error(_)) => fail(spaces(input), alarm.clone()),
        read => read,
    };
    let (mut rest, mut found) = one(rest)?;
    loop {
        let at = spaces(rest);
        let words: [(&[u8], BinaryOp); 3] =
            [(b"AND", BinaryOp::And), (b"OR", BinaryOp::Or), (b"XOR", BinaryOp::Xor)];
        let Some((text, op)) = words.into_iter().find(|(text, _)| starts_with(at, text)) else {
            return Ok((rest, found));
        };
        let (after, right) = one(&at[text.len()..])?;
        let bracketed = |c| Box::new(Condition::Bracket(Box::new(c)));
        found = Condition::Logic(op, bracketed(found), bracketed(right));
        rest = after;
    }
}

fn if_statement(line: Line, rest: Input<'_>) -> Read<'_, Statement> {
    let (rest, condition) = conditions(line, rest, &Alarm::IfFormat)?;
    let at = spaces(rest);
    match keyword(at) {
        Some((after, Keyword::Goto)) => {
            let (rest, to) = goto(line, after)?;
            Ok((rest, Statement::IfGoto { condition, to }))
        }
        Some((after, Keyword::Then)) => {
            let at = spaces(after);
            let (rest, then) = match keyword(at) {
                Some((after, Keyword::Goto)) => statement(line, after, Keyword::Goto)?,
                None if at.first() == Some(&b'#') || at.first() == Some(&b'[') => assignment(line, at)?,
                _ => return fail(at, Alarm::IfFormat),
            };
            Ok((rest, Statement::IfThen { condition, then: Box::new(then) }))
        }
        _ => fail(at, Alarm::IfFormat),
    }
}

fn while_statement(line: Line, rest: Input<'_>) -> Read<'_, Statement> {
    let (rest, condition) = conditions(line, rest, &Alarm::WhileFormat)?;
    let at = spaces(rest);
    match keyword(at) {
        Some((after, Keyword::Do)) => {
            let (rest, number) = loop_number(line, after)?;
            Ok((rest, Statement::While { condition, number }))
        }
        _ => fail(at, Alarm::WhileFormat),
    }
}

fn loop_number(line: Line, rest: Input<'_>) -> Read<'_, Spanned<i64>> {
    let at = spaces(rest);
    match integer(at) {
        Ok((rest, number)) => Ok((rest, line.spanned(number as i64, at, rest))),
        Err(nom::Err::Error(_)) => {
            fail(at, Alarm::MacroFormat { what: "DO and END need the loop's number, 1, 2 or 3".into() })
        }
        Err(error) => Err(error),
    }
}

/// `SETVN 510[TOOL_NO, WORK]`.
fn set_names(line: Line, rest: Input<'_>) -> Read<'_, Statement> {
    let what = || Alarm::MacroFormat { what: "write SETVN 510[NAME,NAME]".into() };
    let (rest, first) = match expr(line, spaces(rest), 0) {
        Err(nom::Err::Error(_)) => return fail(rest, what()),
        read => read?,
    };
    let at = spaces(rest);
    let Some((b'[', inside)) = at.split_first() else { return fail(at, what()) };
    let Some(end) = inside.iter().position(|b| *b == b']') else {
        return fail(at, Alarm::MissingCloseBracket);
    };
    let text = String::from_utf8_lossy(&inside[..end]).to_ascii_uppercase();
    let names = text.split(',').map(|name| name.trim().to_owned()).collect();
    Ok((&inside[end + 1..], Statement::SetNames { first, names }))
}

/// `DPRNT[TEXT#1[44]*#[#2][30]]`.
fn print(line: Line, rest: Input<'_>, kind: PrintKind) -> Read<'_, Statement> {
    let at = spaces(rest);
    let Some((b'[', mut rest)) = at.split_first() else { return other(at) };
    let mut parts = Vec::new();
    let mut text = Vec::new();
    loop {
        match rest.first() {
            None => return fail(rest, Alarm::MissingCloseBracket),
            Some(b']') => {
                push_text(&mut parts, &mut text);
                return Ok((&rest[1..], Statement::Print { kind, parts }));
            }
            Some(b'#') => {
                push_text(&mut parts, &mut text);
                let (after, variable) = target(line, rest)?;
                let bracket = spaces(after);
                let Some((b'[', inside)) = bracket.split_first() else {
                    return fail(
                        bracket,
                        Alarm::MacroFormat { what: "a variable in DPRNT needs its digits: #1[44]".into() },
                    );
                };
                let digits = inside.iter().take_while(|b| b.is_ascii_digit()).count();
                let format = String::from_utf8_lossy(&inside[..digits]).into_owned();
                let Some((b']', after)) = inside[digits..].split_first() else {
                    return fail(&inside[digits..], Alarm::MissingCloseBracket);
                };
                parts.push(PrintPart::Value { variable, format });
                rest = after;
            }
            Some(byte) => {
                text.push(*byte);
                rest = &rest[1..];
            }
        }
    }
}

fn push_text(parts: &mut Vec<PrintPart>, text: &mut Vec<u8>) {
    if !text.is_empty() {
        parts.push(PrintPart::Text(String::from_utf8_lossy(text).into_owned()));
        text.clear();
    }
}
