//! Ranges of operations over ranges of their operands: every double that the interpreter can compute.
//!
//! An operation that rounds correctly is monotone in doubles where the real one is: its values at the ends are the range,
//! without a margin. The functions of `libm` get the margin [`FUNCTION_ERROR`].
use crate::interval::{Interval, add_up, mul_up, sub_down, sub_up};
use crate::node::{Binary, Relation, Semantics, Unary};
use crate::values::{self, BCD_MAX, RESIDUE};

/// Bound of the relative error of a function of `libm`: four units in the last place.
///
/// The algorithms are those of FreeBSD's msun, whose comments and tests state less than one unit for sin, cos, tan, exp,
/// log, asin, acos, atan and pow, and less than two for atan2. A conversion of degrees adds less than one.
pub(crate) const FUNCTION_ERROR: f64 = 4.0 * f64::EPSILON;

/// Bound of the relative error of a sine or a cosine of radians: one unit in the last place, as stated and measured.
pub(crate) const SINE_ERROR: f64 = f64::EPSILON;

/// Bound of the absolute error of a function where its result underflows.
pub(crate) const UNDERFLOW: f64 = 1e-320;

/// Returns the values of a function of one value; the operand's values without a result are left out.
pub(crate) fn unary(function: Unary, x: Interval, semantics: Semantics) -> Interval {
    if x.is_empty() {
        return x;
    }
    if let Some(point) = x.as_point() {
        return values::unary(function, point, semantics).map_or(Interval::EMPTY, Interval::point);
    }
    match function {
        Unary::Neg => Interval::new(-x.hi(), -x.lo()),
        Unary::Abs => Interval::new(x.mignitude(), x.magnitude()),
        Unary::Sqrt => x.intersect(POSITIVE).map(f64::sqrt),
        Unary::Sin => sine(radians(x), 0),
        Unary::Cos => sine(radians(x), 1),
        Unary::Tan => tangent(radians(x)),
        Unary::Asin => {
            let angles = increasing(x.intersect(UNIT), |sine| degrees(libm::asin(sine)));
            angle_range(angles.intersect(Interval::new(-90.0, 90.0)), semantics)
        }
        Unary::Acos => {
            let x = x.intersect(UNIT);
            let angles = Interval::new(degrees(libm::acos(x.hi())), degrees(libm::acos(x.lo())));
            with_function_error(if x.is_empty() { x } else { angles }).intersect(Interval::new(0.0, 180.0))
        }
        Unary::Atan => {
            increasing(x, |tangent| degrees(libm::atan(tangent))).intersect(Interval::new(-90.0, 90.0))
        }
        Unary::Exp => exponential(x),
        // LN of the largest double is below 710.
        Unary::Ln => increasing(x.intersect(POSITIVE), libm::log).intersect(Interval::new(-746.0, 710.0)),
        Unary::Fix | Unary::Fup | Unary::Round => {
            x.map(|end| values::unary(function, end, semantics).unwrap_or(end))
        }
        Unary::Bin => Interval::new(0.0, BCD_MAX),
        Unary::Bcd => x
            .intersect(Interval::new(-0.5, BCD_MAX))
            .map(|end| values::unary(function, end, semantics).unwrap_or(0.0)),
        Unary::Residue if x.magnitude() < RESIDUE => Interval::point(0.0),
        Unary::Residue if x.mignitude() < RESIDUE => x.hull(Interval::point(0.0)),
        Unary::Residue => x,
    }
}

/// Numbers that have a root.
const POSITIVE: Interval = Interval::of_ends(0.0, f64::MAX);
/// Sines.
const UNIT: Interval = Interval::of_ends(-1.0, 1.0);

impl Interval {
    /// Returns the values of a non-decreasing function that is computed exactly as it rounds.
    fn map(self, function: impl Fn(f64) -> f64) -> Self {
        if self.is_empty() { self } else { Self::new(function(self.lo()), function(self.hi())) }
    }
}

/// Returns a number of radians as degrees, as the interpreter computes it.
fn degrees(radians: f64) -> f64 {
    radians.to_degrees()
}

/// Returns numbers of degrees as radians, as the interpreter computes them.
fn radians(x: Interval) -> Interval {
    x.map(f64::to_radians)
}

/// Returns the values of a function of `libm` that is non-decreasing as a real function.
fn increasing(x: Interval, function: impl Fn(f64) -> f64) -> Interval {
    // An infinite value at the lower end doesn't exclude the largest double between the ends.
    with_function_error(x.map(|end| function(end).clamp(-f64::MAX, f64::MAX)))
}

/// Returns the values of EXP: of 0 and less at most 1, since the double above 1 is more than a unit in the last place away.
fn exponential(x: Interval) -> Interval {
    let limit = if x.hi() <= 0.0 { 1.0 } else { f64::MAX };
    increasing(x, libm::exp).intersect(Interval::new(0.0, limit))
}

/// Returns a range that is wider by twice the error of a function: that of the ends, and that of the values between.
///
/// A relative error doesn't change a sign, and an underflow gives 0 at most.
pub(crate) fn with_function_error(range: Interval) -> Interval {
    if range.is_empty() {
        return range;
    }
    let margin = |end: f64| add_up(mul_up(end.abs(), 2.0 * FUNCTION_ERROR), UNDERFLOW);
    let lo = sub_down(range.lo(), margin(range.lo()));
    let hi = add_up(range.hi(), margin(range.hi()));
    Interval::new(
        if range.lo() >= 0.0 { lo.max(0.0) } else { lo },
        if range.hi() <= 0.0 { hi.min(0.0) } else { hi },
    )
}

/// Returns a range of angles as the interpreter returns them.
pub(crate) fn angle_range(angles: Interval, semantics: Semantics) -> Interval {
    if semantics.returns_signed_angles || angles.lo() >= 0.0 || angles.is_empty() {
        return angles;
    }
    let turned = Interval::new(angles.lo() + 360.0, (angles.hi() + 360.0).min(360.0));
    if angles.hi() < 0.0 { turned } else { turned.hull(Interval::new(0.0, angles.hi())) }
}

/// Returns the values of the sine of radians shifted by quarter turns: 0 for SIN, 1 for COS.
///
/// A computed sine stays within ±1: the double above 1 is more than a unit in the last place away.
fn sine(x: Interval, quarters: i64) -> Interval {
    let function = |radians: f64| if quarters == 0 { libm::sin(radians) } else { libm::cos(radians) };
    let Some((first, last)) = quarter_turns(x) else { return UNIT };
    if last - first >= 4 {
        return UNIT;
    }
    let ends = Interval::new(function(x.lo()), function(x.lo()))
        .hull(Interval::new(function(x.hi()), function(x.hi())));
    let mut range = with_function_error(ends);
    for quarter in first + 1..=last {
        // A multiple of the quarter turn between the ends, or near one of them.
        match (quarter + quarters).rem_euclid(4) {
            1 => range = range.hull(Interval::point(1.0)),
            3 => range = range.hull(Interval::point(-1.0)),
            _ => {}
        }
    }
    range.intersect(UNIT)
}

/// Returns the quadrants of the ends of a range of radians, as far outward as their rounding can matter; `None` for
/// numbers too large.
pub(crate) fn quarter_turns(x: Interval) -> Option<(i64, i64)> {
    const MARGIN: f64 = 1e-9;
    if x.magnitude() > 1e6 {
        return None;
    }
    let quarters = |radians: f64| radians / std::f64::consts::FRAC_PI_2;
    Some(((quarters(x.lo()) - MARGIN).floor() as i64, (quarters(x.hi()) + MARGIN).floor() as i64))
}

/// Returns the values of the tangent of radians.
fn tangent(x: Interval) -> Interval {
    match quarter_turns(x) {
        // No odd multiple of the quarter turn lies between the ends.
        Some((first, last)) if (first + 1..=last).all(|quarter| quarter % 2 == 0) => increasing(x, libm::tan),
        _ => Interval::ALL,
    }
}

/// Returns the values of an operator or a function of two values.
pub(crate) fn binary(operator: Binary, a: Interval, b: Interval, semantics: Semantics) -> Interval {
    if a.is_empty() || b.is_empty() {
        return Interval::EMPTY;
    }
    if let (Some(left), Some(right)) = (a.as_point(), b.as_point()) {
        return values::binary(operator, left, right, semantics).map_or(Interval::EMPTY, Interval::point);
    }
    match operator {
        Binary::Add => Interval::new(a.lo() + b.lo(), a.hi() + b.hi()),
        Binary::Sub => Interval::new(a.lo() - b.hi(), a.hi() - b.lo()),
        Binary::Mul => corners(a, b, |a, b| a * b),
        Binary::Div => quotient(a, b, f64::from_bits(1)),
        Binary::Mod => modulo(a, b),
        Binary::And | Binary::Or | Binary::Xor => bitwise(operator, a, b),
        Binary::Pow => {
            with_function_error(corners(a.intersect(POSITIVE), b, |a, b| libm::pow(a, b).min(f64::MAX)))
                .intersect(POSITIVE)
        }
        Binary::Atan => angles(a, b, semantics),
        Binary::Compare(relation) => match decide(relation, a, b) {
            Some(is_true) => Interval::point(f64::from(u8::from(is_true))),
            None => Interval::new(0.0, 1.0),
        },
    }
}

/// Returns the quotients by divisors whose magnitude is at least `least`, above 0.
pub(crate) fn quotient(a: Interval, b: Interval, least: f64) -> Interval {
    if let (Some(_), Some(_)) = (a.as_point(), b.as_point()) {
        return binary(Binary::Div, a, b, Semantics::default());
    }
    let positive = b.intersect(Interval::new(least, f64::MAX));
    let negative = b.intersect(Interval::new(-f64::MAX, -least));
    corners(a, positive, |a, b| a / b).hull(corners(a, negative, |a, b| a / b))
}

/// Returns the range of a function between its values at the corners: it is monotone in either value.
fn corners(a: Interval, b: Interval, function: impl Fn(f64, f64) -> f64) -> Interval {
    if a.is_empty() || b.is_empty() {
        return Interval::EMPTY;
    }
    let ends = [(a.lo(), b.lo()), (a.lo(), b.hi()), (a.hi(), b.lo()), (a.hi(), b.hi())];
    let values = ends.map(|(a, b)| function(a, b));
    let lo = values.iter().copied().fold(f64::INFINITY, f64::min);
    Interval::new(lo, values.iter().copied().fold(f64::NEG_INFINITY, f64::max))
}

/// Returns the remainders of rounded values, with the sign of the dividend.
fn modulo(a: Interval, b: Interval) -> Interval {
    let (a, b) = (a.map(gcode_lang::units::round), b.map(gcode_lang::units::round));
    if b.magnitude() == 0.0 {
        return Interval::EMPTY;
    }
    if let Some(divisor) = b.as_point()
        && a.lo() * a.hi() >= 0.0
    {
        let (first, last) = (a.lo() % divisor, a.hi() % divisor);
        if sub_up(a.hi(), a.lo()) < divisor.abs() && first <= last && (first >= 0.0) == (a.lo() >= 0.0) {
            return Interval::new(first, last);
        }
    }
    let largest = (b.magnitude() - 1.0).max(0.0).min(a.magnitude());
    // Whole numbers beyond 2^53 aren't neighbours at a distance of 1.
    let largest = if b.magnitude() >= 1e15 { a.magnitude().min(b.magnitude()) } else { largest };
    Interval::new(if a.lo() < 0.0 { -largest } else { 0.0 }, if a.hi() > 0.0 { largest } else { 0.0 })
}

/// Returns the results of AND, OR and XOR.
fn bitwise(operator: Binary, a: Interval, b: Interval) -> Interval {
    let (a, b) = (a.map(gcode_lang::units::round), b.map(gcode_lang::units::round));
    let largest = f64::from(i32::MAX);
    let positive = |x: &Interval| x.lo() >= 0.0 && x.hi() <= largest;
    if operator == Binary::And && (positive(&a) || positive(&b)) {
        // The bits of a positive number leave no others.
        let most = [a, b].into_iter().filter(positive).map(Interval::hi).fold(largest, f64::min);
        return Interval::new(0.0, most);
    }
    if a.lo() < 0.0 || b.lo() < 0.0 || a.hi() > largest || b.hi() > largest {
        return Interval::new(f64::from(i32::MIN), largest);
    }
    let bits = 32 - (a.hi().max(b.hi()) as u32).leading_zeros();
    let all_bits = ((1_u64 << bits) - 1) as f64;
    match operator {
        Binary::Or => Interval::new(a.lo().max(b.lo()), all_bits),
        _ => Interval::new(0.0, all_bits),
    }
}

/// Returns the angles of points (x, y).
fn angles(y: Interval, x: Interval, semantics: Semantics) -> Interval {
    angles_within(y, x, Interval::ALL, semantics)
}

/// Returns the angles of points (x, y) that lie in a range: those above the x axis, and those below it.
///
/// Beside the x axis there are angles near 0 and near a whole turn, and none in between.
pub(crate) fn angles_within(y: Interval, x: Interval, range: Interval, semantics: Semantics) -> Interval {
    let parts = angle_parts(y, x, semantics).map(|part| part.intersect(range));
    parts.into_iter().fold(Interval::EMPTY, Interval::hull)
}

/// Returns the angles of points (x, y): above the x axis and on it, 0 by itself, and below.
fn angle_parts(y: Interval, x: Interval, semantics: Semantics) -> [Interval; 3] {
    if y.is_empty() || x.is_empty() {
        return [Interval::EMPTY; 3];
    }
    let half_turn = Interval::new(-180.0, 180.0);
    let has_origin = y.contains(0.0) && x.contains(0.0) && !semantics.atan_of_zeros_alarms;
    // In each half the angle is monotone in either value.
    let upper = y.intersect(POSITIVE);
    let lower = y.intersect(Interval::new(-f64::MAX, -f64::from_bits(1)));
    let direction = |y: f64, x: f64| degrees(libm::atan2(y, x));
    let upper =
        with_function_error(upper_angles(upper, x, direction)).intersect(half_turn).intersect(POSITIVE);
    let below = upper_angles(Interval::new(-lower.hi(), -lower.lo()), x, direction);
    let below = with_function_error(if lower.is_empty() { lower } else { below }).intersect(half_turn);
    let lower = Interval::new(-below.hi(), -below.lo()).intersect(Interval::new(-180.0, -0.0));
    let lower = if below.is_empty() { below } else { lower };
    let is_turned = !semantics.returns_signed_angles && !lower.is_empty();
    // A negative angle that underflows stays 0.
    let has_zero = has_origin || is_turned && lower.hi() >= 0.0;
    let zero = if has_zero { Interval::point(0.0) } else { Interval::EMPTY };
    let lower = match is_turned {
        true => Interval::new(lower.lo() + 360.0, (lower.hi() + 360.0).min(360.0)),
        false => lower,
    };
    [upper, zero, lower]
}

/// Returns the angles of points that aren't below the x axis.
fn upper_angles(y: Interval, x: Interval, direction: impl Fn(f64, f64) -> f64) -> Interval {
    if y.is_empty() || x.is_empty() {
        return Interval::EMPTY;
    }
    let smallest = direction(if x.hi() > 0.0 { y.lo() } else { y.hi() }, x.hi());
    let largest = direction(if x.lo() > 0.0 { y.hi() } else { y.lo() }, x.lo());
    // The origin has no direction; points beside it have any between those of the axes.
    let smallest = if y.hi() > 0.0 && x.hi() == 0.0 { smallest.min(90.0) } else { smallest };
    let largest =
        if y.lo() == 0.0 && x.lo() == 0.0 && y.hi() > 0.0 { 90.0_f64.max(largest) } else { largest };
    Interval::new(smallest.min(largest), largest.max(smallest))
}

/// Decides a relation between two ranges.
pub(crate) fn decide(relation: Relation, a: Interval, b: Interval) -> Option<bool> {
    if a.is_empty() || b.is_empty() {
        return None;
    }
    match relation {
        Relation::Gt if a.lo() > b.hi() => Some(true),
        Relation::Gt if a.hi() <= b.lo() => Some(false),
        Relation::Ge if a.lo() >= b.hi() => Some(true),
        Relation::Ge if a.hi() < b.lo() => Some(false),
        Relation::Eq if a.hi() < b.lo() || a.lo() > b.hi() => Some(false),
        Relation::Eq if a.as_point().is_some() && a == b => Some(true),
        Relation::Gt | Relation::Ge | Relation::Eq => None,
        Relation::Lt | Relation::Le => decide(relation.swapped(), b, a),
        Relation::Ne => decide(Relation::Eq, a, b).map(|is_equal| !is_equal),
    }
}
