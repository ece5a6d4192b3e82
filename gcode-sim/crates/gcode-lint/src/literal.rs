//! Literal numbers: values of words, operands and expressions known without a run.
use gcode_lang::program::{LoweredWord, WordOperand, names};
use gcode_lang::syntax::ast::{BinaryOp, Decimal, Expr, ExprKind, Name};

/// Returns the number of a word, with or without a decimal point; `None` if it is computed.
pub(super) fn word_number(word: &LoweredWord) -> Option<f64> {
    match word.value {
        WordOperand::Literal(number) => Some(number.value()),
        WordOperand::Number(number) => Some(number),
        WordOperand::G(code, _) => Some(f64::from(code) / 10.0),
        WordOperand::Variable { .. } | WordOperand::Code(_) => None,
    }
}

pub(super) fn word_count(word: &LoweredWord) -> Option<u32> {
    word_number(word).and_then(to_whole)
}

/// Rounds as a control does for an index or a sequence number; `None` out of range.
pub(super) fn to_whole(value: f64) -> Option<u32> {
    let rounded = value.round();
    (0.0..=999_999_999.0).contains(&rounded).then_some(rounded as u32)
}

/// Returns a literal other than 0 without a decimal point, which counts increments unless calculator input is
/// on.
pub(super) fn without_point(word: &LoweredWord) -> Option<Decimal> {
    match word.value {
        WordOperand::Literal(number) if number.places.is_none() && number.digits != 0 => Some(number),
        _ => None,
    }
}

/// Returns the value of an expression of literals, limited to sums and products.
pub fn constant(expr: &Expr) -> Option<f64> {
    match &expr.kind {
        ExprKind::Literal(number) => Some(number.value()),
        ExprKind::Negate(inner) => constant(inner).map(|v| -v),
        ExprKind::Plus(inner) | ExprKind::Bracket(inner) => constant(inner),
        ExprKind::Binary(op, left, right) => arithmetic(*op, constant(left)?, constant(right)?),
        ExprKind::Variable(_)
        | ExprKind::Named(_)
        | ExprKind::Call(..)
        | ExprKind::Parameter { .. }
        | ExprKind::AxisNumber(_) => None,
    }
}

/// Computes the four basic operations; `None` for the others and for division by 0.
pub(super) fn arithmetic(op: BinaryOp, left: f64, right: f64) -> Option<f64> {
    match op {
        BinaryOp::Add => Some(left + right),
        BinaryOp::Sub => Some(left - right),
        BinaryOp::Mul => Some(left * right),
        BinaryOp::Div if right != 0.0 => Some(left / right),
        BinaryOp::Div | BinaryOp::Mod | BinaryOp::And | BinaryOp::Or | BinaryOp::Xor => None,
    }
}

/// Returns the number of a variable, `#5` or `#[100+1]`.
pub fn variable(expr: &Expr) -> Option<u32> {
    match &expr.kind {
        ExprKind::Variable(index) => constant(index).and_then(to_whole),
        ExprKind::Named(name) => named(name),
        ExprKind::Bracket(inner) => variable(inner),
        _ => None,
    }
}

/// Returns the number of a named system variable. A name given by SETVN is known at run time only.
fn named(name: &Name) -> Option<u32> {
    let row = names::find(&name.text)?;
    match (&name.index, row.suffix) {
        (None, None) => Some(row.number),
        (Some(index), Some((lowest, _))) => {
            let suffix = constant(index).and_then(to_whole)?;
            Some(row.number + suffix.checked_sub(lowest)?)
        }
        _ => None,
    }
}
