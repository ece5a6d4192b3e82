//! Rule: a rounded π as a factor. With 3.14 the circumference of a 300 mm cylinder is half a millimetre
//! short.
use std::f64::consts::PI;

use gcode_lang::source::Span;
use gcode_lang::syntax::ast::{BinaryOp, Expr, ExprKind};
use gcode_lang::units::POWERS;

use crate::expressions;
use crate::literal::constant;
use crate::prelude::*;

pub(super) static RULE: Rule =
    Rule::of_block("rounded-pi", Severity::Warning, "a rounded π as a factor", find);

/// Largest deviation of a rounded π; 22/7 differs by 0.0013.
const PI_TOLERANCE: f64 = 0.002;
/// Six decimals are exact enough: 1 µm on a diameter of 1 m.
const PI_PRECISION: f64 = 1e-6;

fn find(_: &CheckContext<'_>, unit: &ProgramUnit<'_>, block: OpIndex) -> Vec<Diagnostic> {
    let mut factors = Vec::new();
    for (expr, _) in expressions::block_expressions(&unit.blocks[block]) {
        collect_factors(expr, false, &mut factors);
    }
    let finding = |(pi, span): (f64, Span)| {
        let deviation = (pi - PI) / PI * 100.0;
        let written = format!("{pi:.7}");
        let message = format!(
            "{} is used for π: {:.4} % too {}, an error of {:.3} mm round a diameter of 500 mm",
            written.trim_end_matches('0'),
            deviation.abs(),
            if deviation < 0.0 { "small" } else { "large" },
            (pi - PI).abs() * 500.0
        );
        unit.finding(&RULE.kind, block, message).with_span(span).help("write 3.14159265")
    };
    factors.into_iter().map(finding).collect()
}

/// Collects the factors and divisors that are a rounded π.
///
/// A product of constants is a length or a conversion; `is_scaled` is true for a part of a product with another value.
fn collect_factors(expr: &Expr, is_scaled: bool, found: &mut Vec<(f64, Span)>) {
    match &expr.kind {
        ExprKind::Binary(BinaryOp::Mul | BinaryOp::Div, left, right) => {
            let is_scaled = is_scaled || constant(left).is_none() || constant(right).is_none();
            for part in [left, right] {
                match constant(part).filter(|value| is_near_pi(part, *value)) {
                    Some(pi) if is_scaled && (pi - PI).abs() > PI_PRECISION => found.push((pi, part.span)),
                    Some(_) => {}
                    None => collect_factors(part, is_scaled, found),
                }
            }
        }
        ExprKind::Variable(_) | ExprKind::Named(_) | ExprKind::Parameter { .. } => {}
        ExprKind::Bracket(inner) | ExprKind::Plus(inner) | ExprKind::Negate(inner) => {
            collect_factors(inner, is_scaled, found);
        }
        _ => expr.operands().for_each(|part| collect_factors(part, false, found)),
    }
}

/// Returns true for a written number that is π or 22/7, cut off or rounded at its last place, and for a quotient near π.
fn is_near_pi(expr: &Expr, value: f64) -> bool {
    let is_close = (value - PI).abs() < PI_TOLERANCE;
    match &expr.kind {
        ExprKind::Literal(number) => {
            let Some(power) = POWERS.get(usize::from(number.places.unwrap_or(0))) else { return is_close };
            let last = (value * power).round();
            let is_rounded = |exact: f64| last == (exact * power).floor() || last == (exact * power).round();
            is_close && (is_rounded(PI) || is_rounded(22.0 / 7.0))
        }
        ExprKind::Bracket(inner) | ExprKind::Plus(inner) => is_near_pi(inner, value),
        ExprKind::Negate(inner) => is_near_pi(inner, -value),
        _ => is_close,
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::{lines, messages};
    use super::RULE;

    #[test]
    fn a_rounded_factor_near_pi_is_reported() {
        let text = "O1\n#1=500.\n#2=3.14*#1\n#3=#1*3.1416/2.\n#4=FIX[#1/[22/7]]\n#5=3.14159265*#1\nX[3.142*#1]\n\
                    IF[#2*3.14 GT 5.]THEN #2=#1/3.14\n#6=355/113*#1\nM30\n";
        assert_eq!(lines(&RULE, text), [3, 4, 5, 7, 8, 8]);
    }

    #[test]
    fn a_length_near_pi_is_accepted() {
        assert_eq!(lines(&RULE, "O1\n#1=3.14\nX3.14\n#2=#1+3.14\n#3=#1*3.15\nM30\n"), [0u32; 0]);
    }

    /// π is 3.14159265…, 22/7 is 3.142857…
    #[test]
    fn only_a_rounded_pi_is_reported() {
        for (factor, is_rounded) in [
            ("3.141", true),
            ("3.142", true),
            ("3.143", true),
            ("3.1428", true),
            ("3.1415", true),
            ("3.140", false),
            ("3.144", false),
            ("3.1406", false),
            ("3.1417", false),
            ("3.14159265", false),
        ] {
            let found = lines(&RULE, &format!("O1\n#1=500.\n#2=#1*{factor}\nM30\n"));
            assert_eq!(!found.is_empty(), is_rounded, "{factor}");
        }
    }

    #[test]
    fn constants_alone_are_a_length() {
        let text = "O1\n#2=3.14/2\nX[3.1416*25.4]\n#3=[3.14+1.]*2\n#4=SIN[3.14*2]*#1\nM30\n";
        assert_eq!(lines(&RULE, text), [0u32; 0]);
        assert_eq!(lines(&RULE, "O1\n#1=5.\n#2=2*3.14*#1\n#3=#1*[3.14/180]\nM30\n"), [3, 4]);
    }

    /// 3.14 is π less 0.00159265: 0.0507 % of it, and 0.796 mm of 500·π.
    #[test]
    fn the_message_states_the_error() {
        assert_eq!(
            messages(&RULE, "O1\n#2=3.14*#1\nM30\n"),
            ["3.14 is used for π: 0.0507 % too small, an error of 0.796 mm round a diameter of 500 mm"]
        );
    }
}
