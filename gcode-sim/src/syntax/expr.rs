//! Expressions and conditions in one pass: brackets, and operators in their three levels.
//!
//! `[…]` may hold a number or a condition, which only its end tells, so both are read as [`Mixed`] and told apart
//! where one of them is wanted. Nothing is read twice.
use nom::Parser;
use nom::branch::alt;
use nom::combinator::value;

use super::ast::{BinaryOp, Condition, Expr, ExprKind, Relation, Written};
use super::function::{call, is_name, named};
use super::number::{EXPRESSION_LIMIT, decimal};
use super::token::{
    Input, Line, Read, comment_before, fail, must, next, no_expression, other, round_brackets, sign, spaces,
    word,
};
use crate::alarm::Alarm;

/// Brackets inside one another, those of functions and of `#[…]` included (manual: at most five).
const DEEPEST: u8 = 5;

/// Operators of one level side by side. No control takes a block this long; the limit keeps the tree shallow.
const MOST_OPERATORS: usize = 100;

enum Mixed {
    Number(Expr),
    Truth(Condition),
}

/// An expression; a condition in its place is an alarm.
pub(super) fn expr(line: Line, input: Input<'_>, depth: u8) -> Read<'_, Expr> {
    let (rest, mixed) = sum(line, input, depth)?;
    number(rest, input, mixed)
}

/// `[c]` of IF and WHILE, or `[c1]AND[c2]` as some programs write `[[c1]AND[c2]]`. The bracket around all of it is
/// not kept.
pub(super) fn condition(line: Line, input: Input<'_>) -> Read<'_, Condition> {
    sign(b'[')(input)?;
    match sum(line, input, 0)? {
        (rest, Mixed::Truth(Condition::Bracket(inner))) => Ok((rest, *inner)),
        (rest, Mixed::Truth(condition)) => Ok((rest, condition)),
        (_, Mixed::Number(_)) => other(input),
    }
}

/// `#n`, `#[…]`, or a variable by its name in brackets: what may stand left of `=`.
pub(super) fn variable(line: Line, input: Input<'_>) -> Read<'_, Expr> {
    let start = spaces(input);
    match start.first() {
        Some(b'#') => numbered(line, start, 0),
        Some(b'[') if is_name(start) => named(line, start, 0),
        _ => other(input),
    }
}

/// One value: a variable or `[…]`, as after an address.
pub(super) fn single(line: Line, input: Input<'_>) -> Read<'_, Expr> {
    let start = spaces(input);
    match start.first() {
        Some(b'[') if !is_name(start) => {
            let (rest, mixed) = bracket(line, start, 0)?;
            number(rest, start, mixed)
        }
        _ => variable(line, start),
    }
}

fn number<'a>(rest: Input<'a>, from: Input<'a>, mixed: Mixed) -> Read<'a, Expr> {
    match mixed {
        Mixed::Number(expr) => Ok((rest, expr)),
        Mixed::Truth(_) => no_expression(spaces(from)),
    }
}

type Operator = for<'a> fn(Input<'a>) -> Option<(Input<'a>, BinaryOp, Written)>;
type Part = for<'a> fn(Line, Input<'a>, u8) -> Read<'a, Mixed>;

/// `+ - OR XOR |`, left to right.
fn sum(line: Line, input: Input<'_>, depth: u8) -> Read<'_, Mixed> {
    let operator: Operator = |input| match next(input)? {
        (b'+', rest) => Some((rest, BinaryOp::Add, Written::Sign)),
        (b'-', rest) => Some((rest, BinaryOp::Sub, Written::Sign)),
        (b'|', rest) => Some((rest, BinaryOp::Or, Written::Sign)),
        (b'O' | b'o', _) => in_letters(input, "OR", BinaryOp::Or),
        (b'X' | b'x', _) => in_letters(input, "XOR", BinaryOp::Xor),
        _ => None,
    };
    chain(line, input, depth, operator, term)
}

/// `* / AND MOD &`, left to right.
fn term(line: Line, input: Input<'_>, depth: u8) -> Read<'_, Mixed> {
    let operator: Operator = |input| match next(input)? {
        (b'*', rest) => Some((rest, BinaryOp::Mul, Written::Sign)),
        (b'/', rest) => Some((rest, BinaryOp::Div, Written::Sign)),
        (b'&', rest) => Some((rest, BinaryOp::And, Written::Sign)),
        (b'A' | b'a', _) => in_letters(input, "AND", BinaryOp::And),
        (b'M' | b'm', _) => in_letters(input, "MOD", BinaryOp::Mod),
        _ => None,
    };
    chain(line, input, depth, operator, signed)
}

fn in_letters<'a>(
    input: Input<'a>,
    text: &'static str,
    op: BinaryOp,
) -> Option<(Input<'a>, BinaryOp, Written)> {
    word(text)(input).ok().map(|(rest, ())| (rest, op, Written::Letters))
}

fn chain<'a>(line: Line, input: Input<'a>, depth: u8, operator: Operator, part: Part) -> Read<'a, Mixed> {
    let start = spaces(input);
    let (mut rest, mut left) = part(line, input, depth)?;
    let mut count = 0;
    while let Some((after, op, written)) = operator(rest) {
        let at = spaces(rest);
        count += 1;
        if count > MOST_OPERATORS {
            let what = format!("an expression of more than {MOST_OPERATORS} operators");
            return fail(at, Alarm::NotSimulated { what });
        }
        let (after, right) = wanted(part(line, after, depth), after)?;
        let bits = matches!(op, BinaryOp::And | BinaryOp::Or | BinaryOp::Xor);
        left = match (left, right) {
            // `&` and `|` join conditions only.
            (Mixed::Number(_), Mixed::Number(_)) if bits && written == Written::Sign => {
                return no_expression(at);
            }
            (Mixed::Number(left), Mixed::Number(right)) => Mixed::Number(Expr {
                kind: ExprKind::Binary(op, Box::new(left), Box::new(right)),
                span: line.span(start, after),
            }),
            (Mixed::Truth(left), Mixed::Truth(right)) if bits => {
                Mixed::Truth(Condition::Logic(op, written, Box::new(left), Box::new(right)))
            }
            _ => return no_expression(at),
        };
        rest = after;
    }
    Ok((rest, left))
}

/// Where a value must follow, round brackets, which are a comment, get an alarm of their own.
pub(super) fn wanted<'a, T>(read: Read<'a, T>, at: Input<'a>) -> Read<'a, T> {
    match read {
        Err(nom::Err::Error(_)) if comment_before(at) => round_brackets(at, None),
        Err(nom::Err::Error(_)) => no_expression(spaces(at)),
        read => read,
    }
}

fn signed(line: Line, input: Input<'_>, depth: u8) -> Read<'_, Mixed> {
    let start = spaces(input);
    let wrap: fn(Box<Expr>) -> ExprKind = match start.first() {
        Some(b'-') => ExprKind::Negate,
        Some(b'+') => ExprKind::Plus,
        _ => return primary(line, input, depth),
    };
    let (rest, mixed) = wanted(primary(line, &start[1..], depth), &start[1..])?;
    let (rest, inner) = number(rest, start, mixed)?;
    Ok((rest, Mixed::Number(Expr { kind: wrap(Box::new(inner)), span: line.span(start, rest) })))
}

fn primary(line: Line, input: Input<'_>, depth: u8) -> Read<'_, Mixed> {
    let start = spaces(input);
    let (rest, expr) = match start.first() {
        Some(b'0'..=b'9' | b'.') => {
            let (rest, number) = decimal(start, false, EXPRESSION_LIMIT)?;
            (rest, Expr { kind: ExprKind::Literal(number), span: line.span(start, rest) })
        }
        Some(b'#') => numbered(line, start, depth)?,
        Some(b'[') if is_name(start) => named(line, start, depth)?,
        Some(b'[') => return bracket(line, start, depth),
        Some(b'A'..=b'Z' | b'a'..=b'z') => call(line, start, depth)?,
        _ => return other(input),
    };
    Ok((rest, Mixed::Number(expr)))
}

/// `[…]` with whatever is in it.
fn bracket(line: Line, input: Input<'_>, depth: u8) -> Read<'_, Mixed> {
    let depth = deeper(input, depth)?;
    let start = &input[1..];
    let (rest, left) = wanted(sum(line, start, depth), start)?;
    let (rest, inside) = match (relation(rest), left) {
        (Ok((after, (relation, written))), Mixed::Number(left)) => {
            let (after, right) = wanted(expr(line, after, depth), after)?;
            let span = line.span(spaces(start), after);
            (after, Mixed::Truth(Condition::Compare { left, relation, written, right, span }))
        }
        (Ok(_), Mixed::Truth(_)) => return no_expression(spaces(rest)),
        (Err(nom::Err::Error(_)), left) => (rest, left),
        (Err(error), _) => return Err(error),
    };
    let (rest, ()) = close(rest)?;
    let inside = match inside {
        Mixed::Number(inner) => {
            Mixed::Number(Expr { kind: ExprKind::Bracket(Box::new(inner)), span: line.span(input, rest) })
        }
        Mixed::Truth(inner) => Mixed::Truth(Condition::Bracket(Box::new(inner))),
    };
    Ok((rest, inside))
}

/// The signs of comparisons, the longer ones first.
const SIGNS: [(&[u8], Relation); 6] = [
    (b"<>", Relation::Ne),
    (b">=", Relation::Ge),
    (b"<=", Relation::Le),
    (b"=", Relation::Eq),
    (b">", Relation::Gt),
    (b"<", Relation::Lt),
];

fn relation(input: Input<'_>) -> Read<'_, (Relation, Written)> {
    let start = spaces(input);
    if let Some((sign, relation)) = SIGNS.iter().find(|(sign, _)| start.starts_with(sign)) {
        let rest = &start[sign.len()..];
        return match next(rest) {
            // `==` and `=>` are no control's.
            Some((b'=' | b'<' | b'>', _)) => fail(start, Alarm::RelationSymbol),
            _ => Ok((rest, (*relation, Written::Sign))),
        };
    }
    let letters = alt((
        value(Relation::Eq, word("EQ")),
        value(Relation::Ne, word("NE")),
        value(Relation::Gt, word("GT")),
        value(Relation::Ge, word("GE")),
        value(Relation::Lt, word("LT")),
        value(Relation::Le, word("LE")),
    ));
    letters.map(|relation| (relation, Written::Letters)).parse(input)
}

pub(super) fn deeper(input: Input<'_>, depth: u8) -> Result<u8, nom::Err<super::token::Fault>> {
    if depth < DEEPEST { Ok(depth + 1) } else { fail(input, Alarm::TooManyBrackets).map(|(_, depth)| depth) }
}

pub(super) fn close(input: Input<'_>) -> Read<'_, ()> {
    if spaces(input).is_empty() {
        return fail(spaces(input), Alarm::MissingCloseBracket);
    }
    must(sign(b']'), || Alarm::Expression { text: String::new() })(input)
}

/// `#5`, `#-1` (an alarm when it runs), `#[…]`; `##1` is none.
fn numbered(line: Line, input: Input<'_>, depth: u8) -> Read<'_, Expr> {
    let (rest, index) = match next(&input[1..]) {
        Some((b'[' | b'0'..=b'9' | b'.' | b'-', _)) => {
            let (rest, mixed) = wanted(signed(line, &input[1..], depth), input)?;
            number(rest, input, mixed)?
        }
        _ if comment_before(&input[1..]) => return round_brackets(&input[1..], None),
        _ => return no_expression(input),
    };
    Ok((rest, Expr { kind: ExprKind::Variable(Box::new(index)), span: line.span(input, rest) }))
}
