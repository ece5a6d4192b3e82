//! Reader of expressions and conditions in one pass: brackets, and operators in their three levels.
//!
//! `[…]` holds a number or a condition; only its end tells which. Both are read as [`ExprOrCondition`] and
//! separated where one of them is required, so that nothing is read twice.
mod function;

use super::ast::{BinaryOp, Condition, Expr, ExprKind, OperatorSpelling, Relation};
use super::number::{EXPRESSION_LIMIT, decimal};
use super::token::{
    Input, LineInput, ReadResult, comment, comment_before, fail, next, no_expression, no_match, require,
    sign, spaces, word,
};
use crate::alarm::Alarm;
use function::{call, named};
pub(super) use function::{is_name, variable_name};

/// Deepest nesting of brackets, those of functions and of `#[…]` included (manual: at most five).
const MAX_BRACKET_DEPTH: u8 = 5;

/// Most operators of one level in a chain. No control accepts so long a block; the limit keeps the tree
/// shallow.
const MAX_OPERATORS: usize = 100;

/// Most signs before one operand; the limit keeps the tree shallow.
const MAX_SIGNS: usize = 10;

enum ExprOrCondition {
    Expr(Expr),
    Condition(Condition),
}

/// Reads an expression; a condition in its place raises an alarm.
pub(super) fn expr(line: LineInput, input: Input<'_>, depth: u8) -> ReadResult<'_, Expr> {
    let (rest, mixed) = sum(line, input, depth)?;
    number(rest, input, mixed)
}

/// Reads `[c]` of IF and WHILE, or `[c1]AND[c2]`, which some programs write for `[[c1]AND[c2]]`.
///
/// The brackets around the whole condition are not kept. A single value in brackets is a condition of `of_loop`, true for
/// WHILE.
pub(super) fn condition(line: LineInput, input: Input<'_>, of_loop: bool) -> ReadResult<'_, Condition> {
    sign(b'[')(input)?;
    match sum(line, input, 0)? {
        (rest, ExprOrCondition::Condition(Condition::Bracket(inner))) => Ok((rest, *inner)),
        (rest, ExprOrCondition::Condition(condition)) => Ok((rest, condition)),
        (rest, ExprOrCondition::Expr(Expr { kind: ExprKind::Bracket(value), .. })) => {
            Ok((rest, Condition::Value { value: *value, of_loop }))
        }
        (_, ExprOrCondition::Expr(_)) => no_match(input),
    }
}

/// Reads the left side of `=`: `#n`, `#[…]`, or a variable name in brackets.
pub(super) fn variable(line: LineInput, input: Input<'_>) -> ReadResult<'_, Expr> {
    let start = spaces(input);
    match start.first() {
        Some(b'#') => numbered(line, start, 0),
        Some(b'[') if is_name(start) => named(line, start, 0),
        _ => no_match(input),
    }
}

/// Reads one value after an address: a variable or `[…]`.
pub(super) fn single_value(line: LineInput, input: Input<'_>) -> ReadResult<'_, Expr> {
    let start = spaces(input);
    match start.first() {
        Some(b'[') if !is_name(start) => {
            let (rest, mixed) = bracket(line, start, 0)?;
            number(rest, start, mixed)
        }
        _ => variable(line, start),
    }
}

fn number<'a>(rest: Input<'a>, from: Input<'a>, mixed: ExprOrCondition) -> ReadResult<'a, Expr> {
    match mixed {
        ExprOrCondition::Expr(expr) => Ok((rest, expr)),
        ExprOrCondition::Condition(_) => no_expression(spaces(from)),
    }
}

type OperandParser = for<'a> fn(LineInput, Input<'a>, u8) -> ReadResult<'a, ExprOrCondition>;

/// Reads a chain of `+ - OR XOR |`, left to right.
fn sum(line: LineInput, input: Input<'_>, depth: u8) -> ReadResult<'_, ExprOrCondition> {
    chain(line, input, depth, BinaryOp::OF_SUM, term)
}

/// Reads a chain of `* / AND MOD &`, left to right.
fn term(line: LineInput, input: Input<'_>, depth: u8) -> ReadResult<'_, ExprOrCondition> {
    chain(line, input, depth, BinaryOp::OF_PRODUCT, signed)
}

fn operator<'a>(
    input: Input<'a>,
    spellings: [(&'static str, BinaryOp); 5],
) -> Option<(Input<'a>, BinaryOp, OperatorSpelling)> {
    let (first, after) = next(input)?;
    let begins = |text: &str| text.as_bytes()[0] == first.to_ascii_uppercase();
    spellings.iter().filter(|(text, _)| begins(text)).find_map(|(text, op)| match text.len() {
        1 => Some((after, *op, OperatorSpelling::Sign)),
        _ => word(text)(input).ok().map(|(rest, ())| (rest, *op, OperatorSpelling::Letters)),
    })
}

fn chain<'a>(
    line: LineInput,
    input: Input<'a>,
    depth: u8,
    spellings: [(&'static str, BinaryOp); 5],
    part: OperandParser,
) -> ReadResult<'a, ExprOrCondition> {
    let start = spaces(input);
    let (mut rest, mut left) = part(line, input, depth)?;
    let mut count = 0;
    while let Some((after, op, written)) = operator(rest, spellings) {
        let at = spaces(rest);
        count += 1;
        if count > MAX_OPERATORS {
            let what = format!("an expression of more than {MAX_OPERATORS} operators");
            return fail(at, Alarm::NotSimulated { what });
        }
        let (after, right) = require_value(part(line, after, depth), after)?;
        let bits = matches!(op, BinaryOp::And | BinaryOp::Or | BinaryOp::Xor);
        left = match (left, right) {
            // `&` and `|` join conditions only.
            (ExprOrCondition::Expr(_), ExprOrCondition::Expr(_))
                if bits && written == OperatorSpelling::Sign =>
            {
                return no_expression(at);
            }
            (ExprOrCondition::Expr(left), ExprOrCondition::Expr(right)) => ExprOrCondition::Expr(Expr {
                kind: ExprKind::Binary(op, Box::new(left), Box::new(right)),
                span: line.span(start, after),
            }),
            (ExprOrCondition::Condition(left), ExprOrCondition::Condition(right)) if bits => {
                ExprOrCondition::Condition(Condition::Logic(op, written, Box::new(left), Box::new(right)))
            }
            _ => return no_expression(at),
        };
        rest = after;
    }
    Ok((rest, left))
}

/// Turns a mismatch into an alarm where a value must follow; round brackets, a comment, have their own alarm.
pub(super) fn require_value<'a, T>(read: ReadResult<'a, T>, at: Input<'a>) -> ReadResult<'a, T> {
    match read {
        Err(nom::Err::Error(_)) if comment_before(at) => fail(comment(at), Alarm::RoundBracketsForValue),
        Err(nom::Err::Error(_)) => no_expression(spaces(at)),
        read => read,
    }
}

/// Reads an operand with its signs: `-#1`, `-+5`; a sign may follow an operator or another sign.
fn signed(line: LineInput, input: Input<'_>, depth: u8) -> ReadResult<'_, ExprOrCondition> {
    signed_after(line, input, depth, 0)
}

/// Reads an operand with its signs after a number of others.
fn signed_after(
    line: LineInput,
    input: Input<'_>,
    depth: u8,
    signs: usize,
) -> ReadResult<'_, ExprOrCondition> {
    let start = spaces(input);
    let wrap: fn(Box<Expr>) -> ExprKind = match start.first() {
        Some(b'-') => ExprKind::Negate,
        Some(b'+') => ExprKind::Plus,
        _ => return primary(line, input, depth),
    };
    if signs == MAX_SIGNS {
        return no_expression(start);
    }
    let operand = signed_after(line, &start[1..], depth, signs + 1);
    let (rest, mixed) = require_value(operand, &start[1..])?;
    let (rest, inner) = number(rest, start, mixed)?;
    Ok((rest, ExprOrCondition::Expr(Expr { kind: wrap(Box::new(inner)), span: line.span(start, rest) })))
}

fn primary(line: LineInput, input: Input<'_>, depth: u8) -> ReadResult<'_, ExprOrCondition> {
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
        _ => return no_match(input),
    };
    Ok((rest, ExprOrCondition::Expr(expr)))
}

/// Reads `[…]` with a number or a condition.
fn bracket(line: LineInput, input: Input<'_>, depth: u8) -> ReadResult<'_, ExprOrCondition> {
    let depth = increase_depth(input, depth)?;
    let start = &input[1..];
    let (rest, left) = require_value(sum(line, start, depth), start)?;
    let (rest, inside) = match (relation(rest), left) {
        (Ok((after, (relation, spelling))), ExprOrCondition::Expr(left)) => {
            let (after, right) = require_value(expr(line, after, depth), after)?;
            let span = line.span(spaces(start), after);
            let compare = Condition::Compare { left, relation, spelling, right, span };
            (after, ExprOrCondition::Condition(compare))
        }
        (Ok(_), ExprOrCondition::Condition(_)) => return no_expression(spaces(rest)),
        (Err(nom::Err::Error(_)), left) => (rest, left),
        (Err(error), _) => return Err(error),
    };
    let (rest, ()) = close(rest)?;
    let inside = match inside {
        ExprOrCondition::Expr(inner) => ExprOrCondition::Expr(Expr {
            kind: ExprKind::Bracket(Box::new(inner)),
            span: line.span(input, rest),
        }),
        ExprOrCondition::Condition(inner) => ExprOrCondition::Condition(Condition::Bracket(Box::new(inner))),
    };
    Ok((rest, inside))
}

fn relation(input: Input<'_>) -> ReadResult<'_, (Relation, OperatorSpelling)> {
    let start = spaces(input);
    for (relation, letters, sign) in Relation::SPELLINGS {
        if let Ok((rest, ())) = word(letters)(start) {
            return Ok((rest, (relation, OperatorSpelling::Letters)));
        }
        if let Some(rest) = start.strip_prefix(sign.as_bytes()) {
            return match next(rest) {
                // No control has `==` or `=>`.
                Some((b'=' | b'<' | b'>', _)) => fail(start, Alarm::RelationSymbol),
                _ => Ok((rest, (relation, OperatorSpelling::Sign))),
            };
        }
    }
    no_match(input)
}

/// Returns the next bracket depth, or fails beyond [`MAX_BRACKET_DEPTH`].
pub(super) fn increase_depth(input: Input<'_>, depth: u8) -> Result<u8, nom::Err<super::token::ReadFailure>> {
    if depth < MAX_BRACKET_DEPTH {
        Ok(depth + 1)
    } else {
        fail(input, Alarm::TooManyBrackets).map(|(_, depth)| depth)
    }
}

pub(super) fn close(input: Input<'_>) -> ReadResult<'_, ()> {
    if spaces(input).is_empty() {
        return fail(spaces(input), Alarm::MissingCloseBracket);
    }
    require(sign(b']'), || Alarm::Expression { text: String::new() })(input)
}

/// Reads `#5`, `#-1` (an alarm at run time) or `#[…]`; `##1` is invalid.
fn numbered(line: LineInput, input: Input<'_>, depth: u8) -> ReadResult<'_, Expr> {
    let (rest, index) = match next(&input[1..]) {
        Some((b'[' | b'0'..=b'9' | b'.' | b'-', _)) => {
            let (rest, mixed) = require_value(signed(line, &input[1..], depth), input)?;
            number(rest, input, mixed)?
        }
        _ if comment_before(&input[1..]) => {
            return fail(comment(&input[1..]), Alarm::RoundBracketsForValue);
        }
        _ => return no_expression(input),
    };
    Ok((rest, Expr { kind: ExprKind::Variable(Box::new(index)), span: line.span(input, rest) }))
}
