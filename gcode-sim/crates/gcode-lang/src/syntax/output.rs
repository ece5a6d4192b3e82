//! Reader of the statements that name variables and print them: SETVN, DPRNT, BPRNT.
use super::ast::{PrintKind, PrintPart, Statement};
use super::expr::{close, is_name, single_value, variable_name};
use super::number::{EXPRESSION_LIMIT, decimal};
use super::token::{COMMENT, Input, LineInput, ReadResult, fail, next, require, sign, spaces};
use crate::alarm::Alarm;
use crate::syntax::ast::{Expr, ExprKind};

/// Longest name that SETVN assigns.
const MAX_NAME_LENGTH: usize = 8;

/// Reads the rest of `SETVN 510[TOOL_NO, WORK]` after the keyword.
pub(super) fn set_names(line: LineInput, input: Input<'_>) -> ReadResult<'_, Statement> {
    let at = spaces(input);
    let (rest, first) = match at.first() {
        Some(b'0'..=b'9') => {
            let (rest, number) = decimal(at, false, EXPRESSION_LIMIT)?;
            (rest, Expr { kind: ExprKind::Literal(number), span: line.span(at, rest) })
        }
        _ => require(|input| single_value(line, input), || Alarm::SetNamesFormat)(at)?,
    };
    let (mut rest, ()) = require(sign(b'['), || Alarm::SetNamesFormat)(rest)?;
    let mut names = Vec::new();
    loop {
        let (after, name) = name(rest)?;
        names.push(name);
        match next(after) {
            Some((b',', after)) => rest = after,
            _ => {
                let (rest, ()) = close(after)?;
                return Ok((rest, Statement::SetNames { first, names }));
            }
        }
    }
}

/// Reads a name of letters, digits and underscores.
fn name(input: Input<'_>) -> ReadResult<'_, String> {
    let (rest, name) = variable_name(input);
    match (rest.first(), name.len()) {
        (Some(byte), _) if !matches!(byte, b',' | b']' | &COMMENT) => fail(rest, Alarm::NameCharacter),
        (_, 0) => fail(rest, Alarm::SetNamesFormat),
        (_, 1..=MAX_NAME_LENGTH) => Ok((rest, name)),
        _ => fail(input, Alarm::NameTooLong { name }),
    }
}

/// Reads the rest of `DPRNT[TEXT#1[44]*#[#2][30]]` after the keyword. Spaces print nothing; `*` prints a
/// space.
pub(super) fn print(line: LineInput, input: Input<'_>, kind: PrintKind) -> ReadResult<'_, Statement> {
    let (mut rest, ()) = require(sign(b'['), || Alarm::PrintFormat)(input)?;
    let mut parts = Vec::new();
    let mut text = String::new();
    loop {
        rest = spaces(rest);
        let Some((byte, after)) = rest.split_first() else { return fail(rest, Alarm::MissingCloseBracket) };
        if matches!(byte, b']' | b'#') || is_name(rest) {
            if !text.is_empty() {
                parts.push(PrintPart::Text(std::mem::take(&mut text)));
            }
            if *byte == b']' {
                return Ok((after, Statement::Print { kind, parts }));
            }
            let (after, part) = printed_value(line, rest)?;
            parts.push(part);
            rest = after;
            continue;
        }
        match byte {
            // Manuals list * / + - ? @ & _ beside letters and digits; controls print the others too.
            byte if byte.is_ascii_graphic() && !matches!(byte, b'[' | b';') => {
                text.push(char::from(byte.to_ascii_uppercase()));
            }
            _ => return fail(rest, Alarm::PrintFormat),
        }
        rest = after;
    }
}

/// Reads `#1[44]`: a variable with its digits before and after the decimal point.
fn printed_value(line: LineInput, input: Input<'_>) -> ReadResult<'_, PrintPart> {
    let (rest, variable) = require(|input| single_value(line, input), || Alarm::PrintFormat)(input)?;
    let (mut rest, ()) = require(sign(b'['), || Alarm::PrintFormat)(rest)?;
    let mut format = String::new();
    while let Some((digit @ b'0'..=b'9', after)) = next(rest) {
        format.push(char::from(digit));
        rest = after;
    }
    let (rest, ()) = close(rest)?;
    if format.is_empty() {
        return fail(rest, Alarm::PrintFormat);
    }
    Ok((rest, PrintPart::Value { variable, format }))
}
