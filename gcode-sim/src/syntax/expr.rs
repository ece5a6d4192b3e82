//! Expressions and conditions in one pass: brackets, functions, operators in their three levels.
//!
//! `[…]` may hold a number or a condition, which only its end tells, so both are read as [`Mixed`] and told apart
//! where one of them is wanted. Nothing is read twice.
use super::ast::{BinaryOp, CallForm, Condition, Expr, ExprKind, Function, Name, Relation};
use super::number::{EXPRESSION_DIGITS, decimal};
use super::token::{Input, Line, Read, fail, other, shown, spaces};
use crate::alarm::Alarm;

/// Brackets inside one another, those of functions and of `#[…]` included (manual: at most five).
const DEEPEST: u8 = 5;

enum Mixed {
    Number(Expr),
    Truth(Condition),
}

/// An expression; a condition in its place is an alarm.
pub(super) fn expr(line: Line, input: Input<'_>, depth: u8) -> Read<'_, Expr> {
    let (rest, mixed) = sum(line, input, depth)?;
    number(rest, input, mixed)
}

/// `[condition]`, the bracket of IF and WHILE.
pub(super) fn condition(line: Line, input: Input<'_>) -> Read<'_, Condition> {
    let start = spaces(input);
    let Some((b'[', _)) = start.split_first() else { return other(input) };
    match bracket(line, start, 0)? {
        (rest, Mixed::Truth(Condition::Bracket(inner))) => Ok((rest, *inner)),
        (rest, Mixed::Truth(condition)) => Ok((rest, condition)),
        (_, Mixed::Number(_)) => other(input),
    }
}

/// `#n`, `#[…]`, or a variable by its name in brackets: what may stand left of `=`.
pub(super) fn target(line: Line, input: Input<'_>) -> Read<'_, Expr> {
    let start = spaces(input);
    match start {
        [b'#', ..] => variable(line, start, 0),
        [b'[', ..] if is_name(start) => named(line, start, 0),
        _ => other(input),
    }
}

/// `[…]` with a number in it, as after an address.
pub(super) fn bracketed(line: Line, input: Input<'_>) -> Read<'_, Expr> {
    if is_name(input) {
        return named(line, input, 0);
    }
    let (rest, mixed) = bracket(line, input, 0)?;
    number(rest, input, mixed)
}

fn number<'a>(rest: Input<'a>, from: Input<'a>, mixed: Mixed) -> Read<'a, Expr> {
    match mixed {
        Mixed::Number(expr) => Ok((rest, expr)),
        Mixed::Truth(_) => fail(from, Alarm::Expression { text: shown(from) }),
    }
}

/// `+ - OR XOR`, left to right.
fn sum(line: Line, input: Input<'_>, depth: u8) -> Read<'_, Mixed> {
    const LEVEL: &[(&[u8], BinaryOp)] =
        &[(b"+", BinaryOp::Add), (b"-", BinaryOp::Sub), (b"OR", BinaryOp::Or), (b"XOR", BinaryOp::Xor)];
    chain(line, input, depth, LEVEL, term)
}

/// `* / AND MOD`, left to right.
fn term(line: Line, input: Input<'_>, depth: u8) -> Read<'_, Mixed> {
    const LEVEL: &[(&[u8], BinaryOp)] =
        &[(b"*", BinaryOp::Mul), (b"/", BinaryOp::Div), (b"AND", BinaryOp::And), (b"MOD", BinaryOp::Mod)];
    chain(line, input, depth, LEVEL, signed)
}

type Part = for<'a> fn(Line, Input<'a>, u8) -> Read<'a, Mixed>;

fn chain<'a>(
    line: Line,
    input: Input<'a>,
    depth: u8,
    level: &[(&[u8], BinaryOp)],
    part: Part,
) -> Read<'a, Mixed> {
    let start = spaces(input);
    let (mut rest, mut left) = part(line, input, depth)?;
    loop {
        let at = spaces(rest);
        let Some((text, op)) = level.iter().find(|(text, _)| starts_with(at, text)) else {
            return Ok((rest, left));
        };
        let (after, right) = operand(part(line, &at[text.len()..], depth), at)?;
        left = match (left, right) {
            (Mixed::Number(left), Mixed::Number(right)) => Mixed::Number(Expr {
                kind: ExprKind::Binary(*op, Box::new(left), Box::new(right)),
                span: line.span(start, after),
            }),
            (Mixed::Truth(left), Mixed::Truth(right))
                if matches!(op, BinaryOp::And | BinaryOp::Or | BinaryOp::Xor) =>
            {
                Mixed::Truth(Condition::Logic(*op, Box::new(left), Box::new(right)))
            }
            _ => return fail(at, Alarm::Expression { text: shown(at) }),
        };
        rest = after;
    }
}

/// After an operator a value must follow.
fn operand<'a, T>(read: Read<'a, T>, at: Input<'a>) -> Read<'a, T> {
    match read {
        Err(nom::Err::Error(_)) => fail(at, Alarm::Expression { text: shown(at) }),
        read => read,
    }
}

fn signed(line: Line, input: Input<'_>, depth: u8) -> Read<'_, Mixed> {
    let start = spaces(input);
    let wrap: fn(Box<Expr>) -> ExprKind = match start.first() {
        Some(b'-') => ExprKind::Negate,
        Some(b'+') => ExprKind::Plus,
        _ => return primary(line, start, depth),
    };
    let (rest, mixed) = operand(primary(line, spaces(&start[1..]), depth), start)?;
    let (rest, inner) = number(rest, start, mixed)?;
    Ok((rest, Mixed::Number(Expr { kind: wrap(Box::new(inner)), span: line.span(start, rest) })))
}

fn primary(line: Line, input: Input<'_>, depth: u8) -> Read<'_, Mixed> {
    match input.first() {
        Some(b'0'..=b'9' | b'.') => {
            let (rest, number) = decimal(input, false, EXPRESSION_DIGITS)?;
            Ok((rest, Mixed::Number(Expr { kind: ExprKind::Literal(number), span: line.span(input, rest) })))
        }
        Some(b'#') => variable(line, input, depth).map(|(rest, expr)| (rest, Mixed::Number(expr))),
        Some(b'[') if is_name(input) => {
            named(line, input, depth).map(|(rest, expr)| (rest, Mixed::Number(expr)))
        }
        Some(b'[') => bracket(line, input, depth),
        Some(b'(') => fail(input, Alarm::MissingOpenBracket),
        Some(b'A'..=b'Z' | b'a'..=b'z') => {
            call(line, input, depth).map(|(rest, expr)| (rest, Mixed::Number(expr)))
        }
        _ => other(input),
    }
}

fn bracket(line: Line, input: Input<'_>, depth: u8) -> Read<'_, Mixed> {
    let depth = deeper(input, depth)?.1;
    let start = spaces(&input[1..]);
    let (rest, left) = operand(sum(line, start, depth), start)?;
    let at = spaces(rest);
    let relation = RELATIONS.iter().find(|(text, _)| starts_with(at, text));
    let (rest, inside) = match (relation, left) {
        (Some((text, relation)), Mixed::Number(left)) => {
            let (after, right) = operand(sum(line, &at[text.len()..], depth), at)?;
            let (after, right) = number(after, at, right)?;
            let span = line.span(start, after);
            (after, Mixed::Truth(Condition::Compare { left, relation: *relation, right, span }))
        }
        (Some(_), Mixed::Truth(_)) => return fail(at, Alarm::Expression { text: shown(at) }),
        (None, left) => (rest, left),
    };
    let rest = close(rest)?.0;
    let inside = match inside {
        Mixed::Number(inner) => {
            Mixed::Number(Expr { kind: ExprKind::Bracket(Box::new(inner)), span: line.span(input, rest) })
        }
        Mixed::Truth(inner) => Mixed::Truth(Condition::Bracket(Box::new(inner))),
    };
    Ok((rest, inside))
}

const RELATIONS: [(&[u8], Relation); 6] = [
    (b"EQ", Relation::Eq),
    (b"NE", Relation::Ne),
    (b"GT", Relation::Gt),
    (b"GE", Relation::Ge),
    (b"LT", Relation::Lt),
    (b"LE", Relation::Le),
];

fn deeper(input: Input<'_>, depth: u8) -> Read<'_, u8> {
    if depth >= DEEPEST { fail(input, Alarm::TooManyBrackets) } else { Ok((input, depth + 1)) }
}

fn close(input: Input<'_>) -> Read<'_, ()> {
    let at = spaces(input);
    match at.first() {
        Some(b']') => Ok((&at[1..], ())),
        None => fail(at, Alarm::MissingCloseBracket),
        Some(_) => fail(at, Alarm::Expression { text: shown(at) }),
    }
}

/// `#5`, `#-1` (an alarm when it runs), `#[…]`; `##1` is none.
fn variable(line: Line, input: Input<'_>, depth: u8) -> Read<'_, Expr> {
    let at = spaces(&input[1..]);
    let (rest, number) = match at.first() {
        Some(b'[') => {
            let (rest, inside) = bracket(line, at, depth)?;
            number(rest, at, inside)?
        }
        Some(b'0'..=b'9' | b'.' | b'-') => {
            let (rest, mixed) = signed(line, at, depth)?;
            number(rest, at, mixed)?
        }
        _ => return fail(input, Alarm::Expression { text: shown(input) }),
    };
    Ok((rest, Expr { kind: ExprKind::Variable(Box::new(number)), span: line.span(input, rest) }))
}

/// `[#_` or `[#A`.
fn is_name(input: Input<'_>) -> bool {
    let Some((b'[', rest)) = input.split_first() else { return false };
    let Some((b'#', rest)) = spaces(rest).split_first() else { return false };
    spaces(rest).first().is_some_and(|b| b.is_ascii_alphabetic() || *b == b'_')
}

fn named(line: Line, input: Input<'_>, depth: u8) -> Read<'_, Expr> {
    let depth = deeper(input, depth)?.1;
    let at = spaces(&spaces(&input[1..])[1..]);
    let length = at.iter().take_while(|b| b.is_ascii_alphanumeric() || **b == b'_').count();
    let text = String::from_utf8_lossy(&at[..length]).to_ascii_uppercase();
    let mut rest = spaces(&at[length..]);
    let mut index = None;
    if let Some(b'[') = rest.first() {
        let inside = deeper(rest, depth)?.1;
        let (after, value) = operand(expr(line, &rest[1..], inside), rest)?;
        index = Some(Box::new(value));
        rest = close(after)?.0;
    }
    let rest = close(rest)?.0;
    Ok((rest, Expr { kind: ExprKind::Named(Name { text, index }), span: line.span(input, rest) }))
}

/// Function names; all but POW may be cut to their first two letters or more.
const FUNCTIONS: [(&str, Function); 17] = [
    ("SIN", Function::Sin),
    ("COS", Function::Cos),
    ("TAN", Function::Tan),
    ("ASIN", Function::Asin),
    ("ACOS", Function::Acos),
    ("ATAN", Function::Atan),
    ("SQRT", Function::Sqrt),
    ("ABS", Function::Abs),
    ("ROUND", Function::Round),
    ("FIX", Function::Fix),
    ("FUP", Function::Fup),
    ("LN", Function::Ln),
    ("EXP", Function::Exp),
    ("POW", Function::Pow),
    ("BIN", Function::Bin),
    ("BCD", Function::Bcd),
    ("ADP", Function::Adp),
];

fn call(line: Line, input: Input<'_>, depth: u8) -> Read<'_, Expr> {
    let length = input.iter().take_while(|b| b.is_ascii_alphabetic()).count();
    let word = String::from_utf8_lossy(&input[..length]).to_ascii_uppercase();
    let after = spaces(&input[length..]);
    if word == "PRM" && after.first() == Some(&b'[') {
        return parameter(line, input, after, depth);
    }
    let found = FUNCTIONS.iter().find(|(name, function)| {
        let whole = word == *name;
        whole || (*function != Function::Pow && word.len() >= 2 && name.starts_with(word.as_str()))
    });
    let Some((_, function)) = found else { return other(input) };
    let Some(b'[') = after.first() else {
        return fail(after, Alarm::MissingOpenBracket);
    };
    let (rest, (first, second)) = arguments(line, after, depth)?;
    let (rest, form) = match second {
        Some(second) => (rest, CallForm::Comma(first, second)),
        None => match spaces(rest) {
            [b'/', more @ ..] if *function == Function::Atan && spaces(more).first() == Some(&b'[') => {
                let (rest, (second, none)) = arguments(line, spaces(more), depth)?;
                if none.is_some() {
                    return fail(more, Alarm::ArgumentFormat { function: "ATAN".into() });
                }
                (rest, CallForm::Slash(first, second))
            }
            _ => (rest, CallForm::One(first)),
        },
    };
    let takes_two = matches!(function, Function::Atan | Function::Pow);
    if matches!(form, CallForm::Comma(..)) && !takes_two
        || matches!(form, CallForm::One(_)) && *function == Function::Pow
    {
        return fail(input, Alarm::ArgumentFormat { function: word });
    }
    Ok((rest, Expr { kind: ExprKind::Call(*function, form), span: line.span(input, rest) }))
}

type Arguments = (Box<Expr>, Option<Box<Expr>>);

/// `[a]` or `[a,b]`.
fn arguments(line: Line, input: Input<'_>, depth: u8) -> Read<'_, Arguments> {
    let depth = deeper(input, depth)?.1;
    let (rest, first) = operand(expr(line, &input[1..], depth), input)?;
    let at = spaces(rest);
    let (rest, second) = match at.first() {
        Some(b',') => {
            let (rest, second) = operand(expr(line, &at[1..], depth), at)?;
            (rest, Some(Box::new(second)))
        }
        _ => (rest, None),
    };
    Ok((close(rest)?.0, (Box::new(first), second)))
}

/// `PRM[n]`, `PRM[n,bit]`, `PRM[n]/[axis]`, `PRM[n,bit]/[axis]`.
fn parameter<'a>(line: Line, input: Input<'a>, bracket: Input<'a>, depth: u8) -> Read<'a, Expr> {
    let (rest, (number, bit)) = arguments(line, bracket, depth)?;
    let (rest, axis) = match spaces(rest) {
        [b'/', more @ ..] if spaces(more).first() == Some(&b'[') => {
            let (rest, (axis, _)) = arguments(line, spaces(more), depth)?;
            (rest, Some(axis))
        }
        _ => (rest, None),
    };
    Ok((rest, Expr { kind: ExprKind::Parameter { number, bit, axis }, span: line.span(input, rest) }))
}

/// Whether the input begins with a symbol or a macro word in either case.
pub(super) fn starts_with(input: Input<'_>, text: &[u8]) -> bool {
    input.len() >= text.len() && input[..text.len()].eq_ignore_ascii_case(text)
}
