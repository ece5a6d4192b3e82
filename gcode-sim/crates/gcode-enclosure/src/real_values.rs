//! Real values of nodes: what an expression has without roundings, and how far the computed value is off it.
//!
//! Inputs and numbers are real as they are. A sine is that of the computed radians. A root of what may be below 0, a
//! quotient by what may be 0 and any other function stands for its computed value.
use crate::arena::Arena;
use crate::hull::{FUNCTION_ERROR, SINE_ERROR, UNDERFLOW};
use crate::interval::Interval;
use crate::model::HALF_ULP;
use crate::node::{Binary, Node, NodeId, Unary};

/// Margin for the arithmetic of a bound.
const MARGIN: f64 = 1.0 + 1e-12;

/// Values of any sine.
pub(crate) const SINES: Interval = Interval::of_ends(-1.0, 1.0);

/// Numbers of 0 or more.
const POSITIVE: Interval = Interval::of_ends(0.0, f64::MAX);

/// Real value of one node: the computed one is off by `relative` of it and by `absolute` at most.
#[derive(Clone, Copy, Debug)]
struct RealValue {
    range: Interval,
    relative: f64,
    absolute: f64,
    /// True for a node whose real value is the computed one, whatever its operands have.
    is_computed: bool,
}

impl RealValue {
    /// Returns the value of which nothing but the computed one is known.
    fn computed(range: Interval) -> Self {
        Self { range, relative: 0.0, absolute: 0.0, is_computed: true }
    }

    /// Returns a bound of the difference from the computed value.
    fn error(&self) -> f64 {
        (self.range.magnitude() * self.relative + self.absolute) * MARGIN
    }

    /// Returns the relative error where the magnitude is at least that of the range.
    fn pure_relative(&self) -> f64 {
        self.relative + if self.absolute > 0.0 { self.absolute / self.range.mignitude() } else { 0.0 }
    }

    fn is_positive(&self) -> bool {
        self.range.lo() >= 0.0
    }
}

/// Real values of nodes and of all that they are computed of.
pub(crate) struct RealValues {
    values: Vec<Option<RealValue>>,
}

impl RealValues {
    /// Returns the values of nodes whose computed values lie in known ranges; `None` if one has no value.
    pub(crate) fn of(arena: &Arena, roots: &[NodeId], hull: &dyn Fn(NodeId) -> Interval) -> Option<Self> {
        let size = roots.iter().map(|node| node.index() + 1).max()?;
        let mut known = Self { values: vec![None; size] };
        for node in arena.cone(roots) {
            let range = hull(node);
            if range.is_empty() {
                return None;
            }
            let real = known.real(arena, node, range).unwrap_or_else(|| RealValue::computed(range));
            known.values[node.index()] = Some(real);
        }
        Some(known)
    }

    /// Returns a bound of the difference between the computed and the real value of a node.
    pub(crate) fn error(&self, node: NodeId) -> f64 {
        self.get(node).map_or(f64::INFINITY, |real| real.error())
    }

    /// Returns a range of the real values of a node.
    pub(crate) fn range(&self, arena: &Arena, node: NodeId) -> Interval {
        match (self.get(node), arena.node(node)) {
            (Some(real), _) => real.range,
            // A function of a part of an angle, which no node is computed of.
            (None, Node::Unary(Unary::Sin | Unary::Cos, _)) => SINES,
            (None, _) => Interval::ALL,
        }
    }

    /// Returns true for a node whose real value is its computed one.
    pub(crate) fn is_computed(&self, node: NodeId) -> bool {
        self.get(node).is_some_and(|real| real.is_computed)
    }

    fn get(&self, node: NodeId) -> Option<RealValue> {
        self.values.get(node.index()).copied().flatten()
    }

    /// Returns the real value of a node with computed values in a range; `None` where it is taken as computed.
    fn real(&self, arena: &Arena, node: NodeId, range: Interval) -> Option<RealValue> {
        let (relative, absolute, is_positive) = match arena.node(node) {
            Node::Constant(_) | Node::Input(_) => (0.0, 0.0, false),
            Node::Unary(function, x) => {
                let x = self.get(x)?;
                match function {
                    Unary::Neg => (x.relative, x.absolute, x.range.hi() <= 0.0),
                    Unary::Abs => (x.relative, x.absolute, true),
                    Unary::Sqrt if x.is_positive() => of_root(&x),
                    Unary::Sin | Unary::Cos => (SINE_ERROR, UNDERFLOW, false),
                    _ => return None,
                }
            }
            Node::Binary(operator, a, b) => {
                let (x, y) = (self.get(a)?, self.get(b)?);
                match operator {
                    Binary::Add => of_sum(&x, &y, x.is_positive() && y.is_positive()),
                    Binary::Sub => of_sum(&x, &y, x.is_positive() && y.range.hi() <= 0.0),
                    Binary::Mul => of_product(&x, &y, HALF_ULP, a == b),
                    Binary::Pow if arena.as_constant(b) == Some(2.0) => {
                        of_product(&x, &x, FUNCTION_ERROR, true)
                    }
                    Binary::Div => of_quotient(&x, &y)?,
                    _ => return None,
                }
            }
        };
        // |r| ≤ (|c| + absolute) / (1 − relative), by which the computed value c is off.
        let error = (range.magnitude() * relative + absolute) / (1.0 - relative) * MARGIN;
        if relative > 1e-3 || !error.is_finite() {
            return None;
        }
        let of_real = if error > 0.0 { range.widened(error) } else { range };
        let range = if is_positive { of_real.intersect(POSITIVE) } else { of_real };
        (!range.is_empty()).then_some(RealValue { range, relative, absolute, is_computed: false })
    }
}

/// Relative and absolute error of a result, and whether its real value is 0 or more.
type ResultError = (f64, f64, bool);

/// Returns errors with those of a rounding, a part of the result.
fn rounded(relative: f64, absolute: f64, unit: f64) -> (f64, f64) {
    ((relative + unit + relative * unit) * MARGIN, absolute * (1.0 + unit) * MARGIN)
}

fn of_root(x: &RealValue) -> ResultError {
    // √(r·(1 + e) + a) is off by e/2 of the root and by √a; or a is a part of r as well.
    let half = |relative: f64| relative / 2.0 * (1.0 + relative);
    let pure = x.pure_relative();
    let (relative, absolute) = if x.absolute == 0.0 || pure < 1e-3 {
        rounded(half(pure), 0.0, HALF_ULP)
    } else {
        rounded(half(x.relative), x.absolute.sqrt() * MARGIN, HALF_ULP)
    };
    (relative, absolute, true)
}

/// Returns the error of a sum; of numbers with one sign, the parts stay parts of the result.
fn of_sum(x: &RealValue, y: &RealValue, is_positive: bool) -> ResultError {
    let (relative, absolute) = match is_positive {
        true => rounded(x.relative.max(y.relative), x.absolute + y.absolute, HALF_ULP),
        false => rounded(0.0, x.error() + y.error(), HALF_ULP),
    };
    (relative, absolute, is_positive)
}

fn of_product(x: &RealValue, y: &RealValue, unit: f64, is_square: bool) -> ResultError {
    let relative = x.relative + y.relative + x.relative * y.relative;
    let size = |z: &RealValue| z.range.magnitude();
    let absolute = (size(x) * y.absolute * (1.0 + x.relative) + size(y) * x.absolute * (1.0 + y.relative))
        * MARGIN
        + x.absolute * y.absolute * MARGIN;
    let (relative, absolute) = rounded(relative, absolute, unit);
    (relative, absolute + UNDERFLOW, is_square || x.is_positive() && y.is_positive())
}

/// Returns the error of a quotient; `None` if the divisor can be 0.
fn of_quotient(x: &RealValue, y: &RealValue) -> Option<ResultError> {
    let least = y.range.mignitude();
    let divisor = y.pure_relative();
    if least == 0.0 || divisor > 1e-3 {
        return None;
    }
    let relative = (x.relative + divisor) / (1.0 - divisor);
    let (relative, absolute) = rounded(relative, x.absolute / least / (1.0 - divisor) * MARGIN, HALF_ULP);
    Some((relative, absolute + UNDERFLOW, x.is_positive() && y.is_positive()))
}
