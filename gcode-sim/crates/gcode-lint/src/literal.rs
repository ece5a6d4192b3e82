//! Numbers that a program writes out: what a word, an operand or an expression is without running anything.
use gcode_lang::program::{LoweredWord, Operand, WordOperand, names};
use gcode_lang::syntax::ast::{BinaryOp, Decimal, Expr, ExprKind, Name};

/// The number a word writes out, point or not; `None` where it is computed.
pub(super) fn word_number(word: &LoweredWord) -> Option<f64> {
    match word.value {
        WordOperand::Literal(number) => Some(number.value()),
        WordOperand::Number(number) => Some(number),
        WordOperand::G(code, _) => Some(f64::from(code) / 10.0),
        WordOperand::Variable { .. } | WordOperand::Code(_) => None,
    }
}

/// The whole number a word writes out.
pub(super) fn word_count(word: &LoweredWord) -> Option<u32> {
    word_number(word).and_then(to_whole)
}

pub(super) fn operand_number(operand: &Operand) -> Option<f64> {
    match operand {
        Operand::Number(number) => Some(*number),
        Operand::Variable { .. } | Operand::Code(_) => None,
    }
}

/// As a control makes an index or a sequence number of it.
pub(super) fn to_whole(value: f64) -> Option<u32> {
    let rounded = value.round();
    (0.0..=999_999_999.0).contains(&rounded).then_some(rounded as u32)
}

/// A literal without a point that isn't 0: increments where a control has no calculator-type input.
pub(super) fn without_point(word: &LoweredWord) -> Option<Decimal> {
    match word.value {
        WordOperand::Literal(number) if number.places.is_none() && number.digits != 0 => Some(number),
        _ => None,
    }
}

/// The value of an expression of literals, as far as sums and products go.
pub(super) fn constant(expr: &Expr) -> Option<f64> {
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

/// The four kinds of arithmetic; the operators on bits and the remainder are left to a run.
pub(super) fn arithmetic(op: BinaryOp, left: f64, right: f64) -> Option<f64> {
    match op {
        BinaryOp::Add => Some(left + right),
        BinaryOp::Sub => Some(left - right),
        BinaryOp::Mul => Some(left * right),
        BinaryOp::Div if right != 0.0 => Some(left / right),
        BinaryOp::Div | BinaryOp::Mod | BinaryOp::And | BinaryOp::Or | BinaryOp::Xor => None,
    }
}

/// The number of a variable, `#5` or `#[100+1]`.
pub(super) fn variable(expr: &Expr) -> Option<u32> {
    match &expr.kind {
        ExprKind::Variable(index) => constant(index).and_then(to_whole),
        ExprKind::Named(name) => named(name),
        ExprKind::Bracket(inner) => variable(inner),
        _ => None,
    }
}

/// The number of a system variable's name; names given by SETVN are common variables, which only a run knows.
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
