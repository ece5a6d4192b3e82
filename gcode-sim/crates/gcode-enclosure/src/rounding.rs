//! Bounds of the rounding error of a node: the computed value against the real one of the same inputs.
use crate::enclosures::Enclosures;
use crate::form::conversions;
use crate::hull::{FUNCTION_ERROR, UNDERFLOW};
use crate::interval::Interval;
use crate::model::HALF_ULP;
use crate::node::{Binary, Node, NodeId, Unary};
use crate::{Arena, values};

/// Margin for the arithmetic of a bound.
const MARGIN: f64 = 1.0 + 1e-12;

impl Enclosures {
    /// Returns a bound of the difference between what the control computes and the real value of the expression at the
    /// same inputs; `None` without a bound.
    ///
    /// The real expression has the same doubles as constants, and exact conversions of degrees.
    pub fn rounding_error(&mut self, arena: &Arena, node: NodeId) -> Option<f64> {
        let mut errors: Vec<Option<f64>> = vec![None; node.index() + 1];
        for id in arena.cone(&[node]) {
            let hull = self.enclose(arena, id);
            let operand = |x: NodeId| Some((self.hull(x), errors[x.index()]?));
            let error = match arena.node(id) {
                Node::Constant(_) | Node::Input(_) => Some(0.0),
                Node::Unary(function, x) => operand(x).and_then(|x| of_unary(function, x, hull)),
                Node::Binary(operator, a, b) => match (operand(a), operand(b)) {
                    (Some(a), Some(b)) => of_binary(operator, a, b, hull),
                    _ => None,
                },
            };
            errors[id.index()] = error.map(|error| error * MARGIN).filter(|error| error.is_finite());
        }
        errors[node.index()]
    }
}

/// A range of computed values and the bound of their error.
type Operand = (Interval, f64);

/// Returns the error of rounding a result to a double.
fn half_ulp(result: Interval) -> f64 {
    result.magnitude() * HALF_ULP + UNDERFLOW
}

/// Returns the error of a function of `libm` with results in a range, whose real value may differ by `moved`.
fn of_function(result: Interval, moved: f64) -> f64 {
    (result.magnitude() + moved) * FUNCTION_ERROR + UNDERFLOW
}

fn of_unary(function: Unary, (x, error): Operand, result: Interval) -> Option<f64> {
    let (to_radians, to_degrees) = conversions();
    // The conversion is off by less than a unit in the last place of the angle.
    let radians = (error + x.magnitude() * 2.0 * f64::EPSILON) * to_radians + UNDERFLOW;
    let degrees = |moved: f64| moved * to_degrees + of_function(result, moved * to_degrees);
    match function {
        Unary::Neg | Unary::Abs => Some(error),
        Unary::Sqrt => {
            // |√x − √y| is at most √|x − y|, and at most |x − y| / (√x + √y).
            let least = (x.lo().max(0.0) - error).max(0.0).sqrt();
            let moved = error.sqrt().min(if least > 0.0 { error / (2.0 * least) } else { f64::INFINITY });
            Some(moved + half_ulp(result))
        }
        Unary::Sin | Unary::Cos => Some(radians + of_function(result, radians)),
        Unary::Tan => {
            // The slope 1 + tan² at the steeper end, as far as the argument moves.
            let steepest = result.magnitude() * MARGIN;
            let slope = 1.0 + steepest * steepest;
            // While the argument moves, the slope at most doubles.
            let is_small = radians * slope * 4.0 < 0.1 && radians * steepest * 8.0 < 0.5;
            is_small.then(|| 2.0 * slope * radians + of_function(result, 2.0 * slope * radians))
        }
        Unary::Asin | Unary::Acos => {
            let most = x.magnitude() + error;
            let rest = (1.0 - most) * (1.0 + most) * (1.0 - 1e-12);
            // A jump from 0° to 360° has no bound.
            let is_continuous =
                function == Unary::Acos || error == 0.0 || x.mignitude() > error || result.lo() < 0.0;
            let moved = if error == 0.0 { 0.0 } else { error / rest.max(0.0).sqrt() };
            (is_continuous && (rest > 0.0 || error == 0.0))
                .then(|| degrees(moved) + result.magnitude() * 2.0 * f64::EPSILON)
        }
        Unary::Atan => Some(degrees(error)),
        Unary::Exp => {
            let moved = (result.magnitude() + UNDERFLOW) * (libm::expm1(error) * 1.001);
            Some(moved + of_function(result, moved))
        }
        Unary::Ln => {
            let least = x.lo() - error;
            (least > 0.0).then(|| error / least).map(|moved| moved + of_function(result, moved))
        }
        // A rounding moves by a whole number more where the argument crosses a step.
        Unary::Fix | Unary::Fup | Unary::Round => Some(if error == 0.0 { 0.0 } else { error + 1.0 }),
        Unary::Residue if x.mignitude() >= values::RESIDUE => Some(error),
        Unary::Residue => Some(error + values::RESIDUE),
        Unary::Bin | Unary::Bcd => (error == 0.0).then_some(0.0),
    }
}

fn of_binary(operator: Binary, (a, of_a): Operand, (b, of_b): Operand, result: Interval) -> Option<f64> {
    match operator {
        Binary::Add | Binary::Sub => Some(of_a + of_b + half_ulp(result)),
        Binary::Mul => Some(a.magnitude() * of_b + b.magnitude() * of_a + of_a * of_b + half_ulp(result)),
        Binary::Div => {
            let least = b.mignitude() - of_b;
            let moved = (of_a + result.magnitude() * MARGIN * of_b) / least;
            (least > 0.0).then(|| moved + half_ulp(result))
        }
        Binary::Atan => {
            // The slope of the direction is one over the distance from the origin.
            let (y, x) = (b.mignitude() - of_b, a.mignitude() - of_a);
            let distance = (y.max(0.0) * y.max(0.0) + x.max(0.0) * x.max(0.0)).sqrt();
            // Across the x axis the angle jumps on one side: on the left if some are negative, else on the right.
            let is_continuous = of_a + of_b == 0.0
                || a.mignitude() > of_a
                || b.lo() > of_b && result.lo() < 0.0
                || b.hi() < -of_b && result.lo() >= 0.0 && a.lo() < 0.0;
            let moved = if of_a + of_b == 0.0 { 0.0 } else { (of_a + of_b) / distance };
            let (_, to_degrees) = conversions();
            let rounding = (360.0 + moved * to_degrees) * 2.0 * FUNCTION_ERROR;
            (is_continuous && moved.is_finite()).then_some(moved * to_degrees + rounding)
        }
        Binary::Pow => {
            let (lo, hi) = (a.lo() - of_a, a.hi() + of_a);
            if of_a + of_b == 0.0 {
                return Some(of_function(result, 0.0));
            }
            if lo <= 0.0 {
                return None;
            }
            // a^b = exp(b·ln a), whose exponent moves by this much.
            let logarithm = libm::log(lo).abs().max(libm::log(hi).abs()) * MARGIN;
            let moved = b.magnitude() * of_a / lo + of_b * logarithm + of_a * of_b / lo;
            let moved = result.magnitude() * libm::expm1(moved) * 1.001;
            Some(moved + of_function(result, moved))
        }
        Binary::Mod | Binary::And | Binary::Or | Binary::Xor | Binary::Compare(_) => {
            (of_a + of_b == 0.0).then_some(0.0)
        }
    }
}
