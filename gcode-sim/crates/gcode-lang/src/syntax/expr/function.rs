//! Reader of functions and named values: `SIN[…]`, `ATAN[a]/[b]`, `PRM[n,bit]`, `[#_ABSMT[1]]`.
use nom::Parser;
use nom::combinator::opt;
use nom::sequence::{pair, preceded};

use super::{close, expr, increase_depth, require_value};
use crate::alarm::Alarm;
use crate::syntax::ast::{CallForm, Expr, ExprKind, Function, Name};
use crate::syntax::token::{
    Input, LineInput, ReadResult, comment_before, fail, is_space, letters, next, no_expression,
    round_brackets, sign, spaces,
};

impl Function {
    /// Full names. All but POW may be abbreviated to two letters or more.
    pub(in crate::syntax) const ALL: [(&'static str, Self); 17] = [
        ("SIN", Self::Sin),
        ("COS", Self::Cos),
        ("TAN", Self::Tan),
        ("ASIN", Self::Asin),
        ("ACOS", Self::Acos),
        ("ATAN", Self::Atan),
        ("SQRT", Self::Sqrt),
        ("ABS", Self::Abs),
        ("ROUND", Self::Round),
        ("FIX", Self::Fix),
        ("FUP", Self::Fup),
        ("LN", Self::Ln),
        ("EXP", Self::Exp),
        ("POW", Self::Pow),
        ("BIN", Self::Bin),
        ("BCD", Self::Bcd),
        ("ADP", Self::Adp),
    ];

    pub(crate) fn name(self) -> &'static str {
        Self::ALL.iter().find(|(_, function)| *function == self).map_or("", |(name, _)| name)
    }
}

/// Reads a function with its brackets. The input begins with a letter.
pub(in crate::syntax) fn call(line: LineInput, input: Input<'_>, depth: u8) -> ReadResult<'_, Expr> {
    if let (rest, 3) = letters(input, "PRM") {
        return parameter(line, input, rest, depth);
    }
    if let (rest, 5) = letters(input, "AXNUM") {
        return axis_number(line, input, rest, depth);
    }
    let enough = |name: &str| if name == "POW" { 3 } else { 2 };
    let found = Function::ALL.iter().find_map(|(name, function)| {
        let (rest, count) = letters(input, name);
        (count >= enough(name)).then_some((rest, *function))
    });
    let Some((rest, function)) = found else { return no_expression(input) };
    let (rest, (first, second)) = arguments(line, rest, function.name(), depth)?;
    let (rest, form) = match second {
        Some(second) => (rest, CallForm::Comma(first, second)),
        None if function == Function::Atan => match divided_by(line, rest, function.name(), depth)? {
            (rest, Some(second)) => (rest, CallForm::Slash(first, second)),
            (rest, None) => (rest, CallForm::One(first)),
        },
        None => (rest, CallForm::One(first)),
    };
    match (function, &form) {
        (Function::Pow, CallForm::One(_)) => fail(input, Alarm::MissingComma),
        (Function::Pow | Function::Atan, _) | (_, CallForm::One(_)) => {
            Ok((rest, Expr { kind: ExprKind::Call(function, form), span: line.span(input, rest) }))
        }
        _ => fail(input, Alarm::ArgumentFormat { function: function.name().to_owned() }),
    }
}

type Arguments = (Box<Expr>, Option<Box<Expr>>);

/// Reads `[a]` or `[a,b]`.
fn arguments<'a>(line: LineInput, input: Input<'a>, name: &str, depth: u8) -> ReadResult<'a, Arguments> {
    let Some((b'[', inside)) = next(input) else {
        if comment_before(input) {
            return round_brackets(input, None);
        }
        return fail(spaces(input), Alarm::MissingOpenBracket);
    };
    let depth = increase_depth(spaces(input), depth)?;
    let argument = |input| require_value(expr(line, input, depth), input);
    let (rest, (first, second)) = pair(argument, opt(preceded(sign(b','), argument))).parse(inside)?;
    if let (Some(_), Some((b',', _))) = (&second, next(rest)) {
        return fail(spaces(rest), Alarm::ArgumentFormat { function: name.to_owned() });
    }
    let (rest, ()) = close(rest)?;
    Ok((rest, (Box::new(first), second.map(Box::new))))
}

/// Reads `/[b]`, the second argument of the function before it.
fn divided_by<'a>(
    line: LineInput,
    input: Input<'a>,
    name: &str,
    depth: u8,
) -> ReadResult<'a, Option<Box<Expr>>> {
    match next(input) {
        Some((b'/', after)) if matches!(next(after), Some((b'[', _))) => {
            match arguments(line, after, name, depth)? {
                (rest, (value, None)) => Ok((rest, Some(value))),
                _ => no_expression(spaces(after)),
            }
        }
        _ => Ok((input, None)),
    }
}

/// Reads the rest of `PRM[n]`, `PRM[n,bit]`, `PRM[n]/[axis]` or `PRM[n,bit]/[axis]`.
fn parameter<'a>(line: LineInput, input: Input<'a>, after: Input<'a>, depth: u8) -> ReadResult<'a, Expr> {
    let (rest, (number, bit)) = arguments(line, after, "PRM", depth)?;
    let (rest, axis) = divided_by(line, rest, "PRM", depth)?;
    Ok((rest, Expr { kind: ExprKind::Parameter { number, bit, axis }, span: line.span(input, rest) }))
}

/// Reads the rest of `AXNUM[X]`.
fn axis_number<'a>(line: LineInput, input: Input<'a>, after: Input<'a>, depth: u8) -> ReadResult<'a, Expr> {
    let Some((b'[', inside)) = next(after) else {
        return fail(spaces(after), Alarm::MissingOpenBracket);
    };
    increase_depth(spaces(after), depth)?;
    match next(inside) {
        Some((letter, rest)) if letter.is_ascii_alphabetic() && matches!(next(rest), Some((b']', _))) => {
            let (rest, ()) = close(rest)?;
            let kind = ExprKind::AxisNumber(letter.to_ascii_uppercase());
            Ok((rest, Expr { kind, span: line.span(input, rest) }))
        }
        _ => fail(spaces(inside), Alarm::AxisAddress { text: String::new() }),
    }
}

/// Returns true at `[#_` or `[#A`, the start of a variable name.
pub(in crate::syntax) fn is_name(input: Input<'_>) -> bool {
    let begins = |rest| next(rest).is_some_and(|(b, _)| b.is_ascii_alphabetic() || b == b'_');
    matches!(next(input), Some((b'[', rest)) if matches!(next(rest), Some((b'#', rest)) if begins(rest)))
}

/// Reads the letters, digits and underscores of a name, which may be spaced, in upper case.
pub(in crate::syntax) fn variable_name(input: Input<'_>) -> (Input<'_>, String) {
    let mut name = String::new();
    let mut rest = spaces(input);
    while let Some((byte, after)) = rest.split_first() {
        match byte {
            b'A'..=b'Z' | b'a'..=b'z' | b'0'..=b'9' | b'_' => {
                name.push(char::from(byte.to_ascii_uppercase()));
            }
            byte if is_space(*byte) => {}
            _ => break,
        }
        rest = after;
    }
    (rest, name)
}

/// Reads `[#NAME]` or `[#NAME[n]]`. The input satisfies [`is_name`].
pub(in crate::syntax) fn named(line: LineInput, input: Input<'_>, depth: u8) -> ReadResult<'_, Expr> {
    let depth = increase_depth(input, depth)?;
    let (start, ()) = preceded(sign(b'['), sign(b'#')).parse(input)?;
    let (mut rest, text) = variable_name(start);
    let mut index = None;
    if let Some((b'[', inside)) = next(rest) {
        let depth = increase_depth(rest, depth)?;
        let (after, value) = require_value(expr(line, inside, depth), inside)?;
        index = Some(Box::new(value));
        rest = close(after)?.0;
    }
    let (rest, ()) = close(rest)?;
    Ok((rest, Expr { kind: ExprKind::Named(Name { text, index }), span: line.span(input, rest) }))
}
