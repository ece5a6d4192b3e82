//! Rule: a rounded π as a factor. With 3.14 the circumference of a 300 mm cylinder is half a millimetre
//! short.
use std::f64::consts::PI;

use gcode_lang::source::Span;
use gcode_lang::syntax::ast::{BinaryOp, Expr, ExprKind};

use crate::expressions;
use crate::literal::constant;
use crate::prelude::*;

pub(super) static RULE: Rule = Rule::new("rounded-pi", Severity::Warning, "a rounded π as a factor", find);

/// Numbers this close to π are meant as π; 22/7 differs by 0.0013.
const PI_TOLERANCE: f64 = 0.002;
/// Six decimals are exact enough: 1 µm on a diameter of 1 m.
const PI_PRECISION: f64 = 1e-6;

fn find(_: &CheckContext<'_>, unit: &ProgramUnit<'_>) -> Vec<Diagnostic> {
    let mut found = Vec::new();
    for (index, block) in unit.reached_blocks() {
        let mut factors = Vec::new();
        for (expr, _) in expressions::block_expressions(block) {
            collect_factors(expr, &mut factors);
        }
        for (pi, span) in factors {
            let deviation = (pi - PI) / PI * 100.0;
            let written = format!("{pi:.7}");
            let message = format!(
                "{} is used for π: {:.4} % too {}, an error of {:.3} mm round a diameter of 500 mm",
                written.trim_end_matches('0'),
                deviation.abs(),
                if deviation < 0.0 { "small" } else { "large" },
                (pi - PI).abs() * 500.0
            );
            found.push(unit.finding(&RULE.kind, index, message).with_span(span).help("write 3.14159265"));
        }
    }
    found
}

/// Collects the factors and divisors that are nearly π.
fn collect_factors(expr: &Expr, found: &mut Vec<(f64, Span)>) {
    match &expr.kind {
        ExprKind::Binary(BinaryOp::Mul | BinaryOp::Div, left, right) => {
            for part in [left, right] {
                match constant(part).filter(|value| (value - PI).abs() < PI_TOLERANCE) {
                    Some(pi) if (pi - PI).abs() > PI_PRECISION => found.push((pi, part.span)),
                    Some(_) => {}
                    None => collect_factors(part, found),
                }
            }
        }
        ExprKind::Variable(_) | ExprKind::Named(_) | ExprKind::Parameter { .. } => {}
        _ => expr.operands().for_each(|part| collect_factors(part, found)),
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::{lines, messages};
    use super::RULE;

    #[test]
    fn a_factor_near_pi_is_one_if_it_is_exact() {
        let text = "O1\n#1=500.\n#2=3.14*#1\n#3=#1*3.1416/2.\n#4=FIX[#1/[22/7]]\n#5=3.14159265*#1\nX[3.142*#1]\n\
                    IF[#2*3.14 GT 5.]THEN #2=#1/3.14\n#6=355/113*#1\nM30\n";
        assert_eq!(lines(&RULE, text), [3, 4, 5, 7, 8, 8]);
    }

    #[test]
    fn a_length_near_pi_is_a_length() {
        assert_eq!(lines(&RULE, "O1\n#1=3.14\nX3.14\n#2=#1+3.14\n#3=#1*3.15\nM30\n"), [0u32; 0]);
    }

    /// 3.14 is π less 0.00159265: 0.0507 % of it, and 0.796 mm of 500·π.
    #[test]
    fn what_it_costs_is_told() {
        assert_eq!(
            messages(&RULE, "O1\n#2=3.14*500.\nM30\n"),
            ["3.14 is used for π: 0.0507 % too small, an error of 0.796 mm round a diameter of 500 mm"]
        );
    }
}
