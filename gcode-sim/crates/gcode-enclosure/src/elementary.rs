//! Real functions of one variable: values, derivatives, and bounds of their Taylor coefficients.
use crate::hull::{FUNCTION_ERROR, UNDERFLOW, quarter_turns};
use crate::interval::Interval;

/// A real function of one variable; angles are radians.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Elementary {
    Reciprocal,
    Sqrt,
    Sin,
    Cos,
    Tan,
    Asin,
    Acos,
    Atan,
    Exp,
    Ln,
    /// A power with a fixed exponent, of positive numbers.
    Power(f64),
}

/// Margin of bounds computed in a few hundred roundings.
const MARGIN: f64 = 1.0 + 1e-10;

/// Bound of a coefficient that underflows.
const UNDERFLOWN: f64 = 1e-290;

impl Elementary {
    /// Returns the value as computed, off by at most [`Elementary::value_error`].
    pub(crate) fn value(self, x: f64) -> f64 {
        match self {
            Self::Reciprocal => 1.0 / x,
            Self::Sqrt => x.sqrt(),
            Self::Sin => libm::sin(x),
            Self::Cos => libm::cos(x),
            Self::Tan => libm::tan(x),
            Self::Asin => libm::asin(x),
            Self::Acos => libm::acos(x),
            Self::Atan => libm::atan(x),
            Self::Exp => libm::exp(x),
            Self::Ln => libm::log(x),
            Self::Power(exponent) => libm::pow(x, exponent),
        }
    }

    /// Returns a bound of the difference between a computed value of this magnitude and the real one.
    pub(crate) fn value_error(self, magnitude: f64) -> f64 {
        let relative = match self {
            Self::Reciprocal | Self::Sqrt => f64::EPSILON / 2.0,
            _ => FUNCTION_ERROR,
        };
        (magnitude * relative * MARGIN + UNDERFLOW).next_up()
    }

    /// Returns the derivative, within a relative 1e-12.
    pub(crate) fn derivative(self, x: f64) -> f64 {
        match self {
            Self::Reciprocal => -1.0 / x / x,
            Self::Sqrt => 0.5 / x.sqrt(),
            Self::Sin => libm::cos(x),
            Self::Cos => -libm::sin(x),
            Self::Tan => 1.0 + libm::tan(x) * libm::tan(x),
            Self::Asin => 1.0 / ((1.0 - x) * (1.0 + x)).sqrt(),
            Self::Acos => -1.0 / ((1.0 - x) * (1.0 + x)).sqrt(),
            Self::Atan => 1.0 / (1.0 + x * x),
            Self::Exp => libm::exp(x),
            Self::Ln => 1.0 / x,
            Self::Power(exponent) => exponent * libm::pow(x, exponent - 1.0),
        }
    }

    /// Returns the part of a range on which the function is real and has all derivatives at inner points.
    pub(crate) fn domain(self, range: Interval) -> Option<Interval> {
        // The bounds of coefficients don't underflow below this magnitude.
        if range.magnitude() > 1e25 {
            return None;
        }
        let positive = Interval::new(0.0, f64::MAX);
        let part = match self {
            Self::Reciprocal if range.contains(0.0) => return None,
            Self::Sqrt | Self::Ln | Self::Power(_) => range.intersect(positive),
            Self::Asin | Self::Acos => range.intersect(Interval::new(-1.0, 1.0)),
            Self::Tan => {
                let (first, last) = quarter_turns(range)?;
                if (first + 1..=last).any(|quarter| quarter % 2 != 0) {
                    return None;
                }
                range
            }
            _ => range,
        };
        (!part.is_empty()).then_some(part)
    }

    /// Returns bounds of the magnitudes of the Taylor coefficients 0 … `last` at all points of a range; infinite where
    /// there is none. That of index 0 isn't used.
    pub(crate) fn coefficient_bounds(self, range: Interval, last: usize) -> Vec<f64> {
        let (lo, hi) = (range.lo(), range.hi());
        let (least, most) = (range.mignitude(), range.magnitude());
        let mut bounds = vec![f64::INFINITY; last + 1];
        match self {
            Self::Reciprocal => geometric(&mut bounds, least),
            // |1/j · x^−j|
            Self::Ln => {
                let mut power = 1.0;
                for (order, bound) in bounds.iter_mut().enumerate().skip(1) {
                    power = power / lo * MARGIN;
                    *bound = power / order as f64 * MARGIN;
                }
            }
            Self::Sqrt => binomial(&mut bounds, 0.5, lo, hi),
            Self::Power(exponent) => binomial(&mut bounds, exponent, lo, hi),
            Self::Sin | Self::Cos => {
                let mut factor = MARGIN;
                for (order, bound) in bounds.iter_mut().enumerate().skip(1) {
                    factor = factor / order as f64 * MARGIN;
                    *bound = factor;
                }
            }
            Self::Exp => {
                let mut factor = libm::exp(hi) * (1.0 + FUNCTION_ERROR) * MARGIN;
                for (order, bound) in bounds.iter_mut().enumerate().skip(1) {
                    factor = factor / order as f64 * MARGIN;
                    *bound = factor;
                }
            }
            // |coefficient j| = |sin(j·(arctan x + π/2))| / (j · (1 + x²)^(j/2)).
            Self::Atan => {
                let shrink = 1.0 / (1.0 + least * least).sqrt() * MARGIN;
                let mut factor = MARGIN;
                for (order, bound) in bounds.iter_mut().enumerate().skip(1) {
                    factor *= shrink.min(1.0);
                    *bound = factor / order as f64 * MARGIN;
                }
            }
            // All coefficients of the arc sine at 0 are positive or 0: their magnitudes rise with |x|.
            Self::Asin | Self::Acos => arc_sine(&mut bounds, most),
            // The same holds of the tangent, within half a turn around a zero.
            Self::Tan => {
                let largest = libm::tan(lo).abs().max(libm::tan(hi).abs()) * (1.0 + 2.0 * FUNCTION_ERROR);
                tangent(&mut bounds, largest);
            }
        }
        // What underflows in these products is less than this.
        for bound in &mut bounds {
            *bound = bound.max(UNDERFLOWN);
        }
        bounds
    }

    /// Returns the sign of the second derivative on a range, if it has one sign.
    pub(crate) fn curvature(self, range: Interval) -> Option<f64> {
        let of_odd = |sign: f64| match range {
            _ if range.lo() >= 0.0 => Some(sign),
            _ if range.hi() <= 0.0 => Some(-sign),
            _ => None,
        };
        match self {
            Self::Reciprocal | Self::Asin => of_odd(1.0),
            Self::Acos | Self::Atan => of_odd(-1.0),
            Self::Sqrt | Self::Ln => Some(-1.0),
            Self::Exp => Some(1.0),
            Self::Power(exponent) if (0.0..=1.0).contains(&exponent) => Some(-1.0),
            Self::Power(_) => Some(1.0),
            Self::Sin | Self::Cos | Self::Tan => None,
        }
    }
}

/// Bounds the coefficients of 1/x: 1/|x|^(j+1).
fn geometric(bounds: &mut [f64], least: f64) {
    let mut power = 1.0 / least * MARGIN;
    for bound in bounds {
        *bound = power * MARGIN;
        power = power / least * MARGIN;
    }
}

/// Bounds the coefficients of x^p: C(p, j)·x^(p−j), whose magnitude is largest at an end.
fn binomial(bounds: &mut [f64], exponent: f64, lo: f64, hi: f64) {
    let mut factor = 1.0_f64;
    for (order, bound) in bounds.iter_mut().enumerate() {
        let power = |x: f64| libm::pow(x, exponent - order as f64);
        // The coefficients of a whole power end; no other factor is 0, though it may underflow.
        *bound = if factor == 0.0 { 0.0 } else { factor * power(lo).max(power(hi)) * MARGIN };
        let step = (exponent - order as f64).abs() / (order + 1) as f64 * MARGIN;
        factor = if factor == 0.0 || step == 0.0 { 0.0 } else { (factor * step).max(UNDERFLOWN) };
    }
}

/// Bounds the coefficients of the arc sine by those at `x` ≥ 0, which rise with it.
fn arc_sine(bounds: &mut [f64], x: f64) {
    let rest = ((1.0 - x) * (1.0 + x)).next_down();
    if rest <= 0.0 {
        return;
    }
    // (1 − x²)^(−1/2): j·g_j·(1 − x²) = 2x·(j − 1/2)·g_(j−1) + (j − 1)·g_(j−2).
    let (mut before, mut last) = (0.0, 1.0 / rest.sqrt() * MARGIN);
    for (order, bound) in bounds.iter_mut().enumerate().skip(1) {
        *bound = last / order as f64 * MARGIN;
        let j = order as f64;
        let next = (2.0 * x * (j - 0.5) * last + (j - 1.0) * before) / (j * rest) * MARGIN;
        (before, last) = (last, next);
    }
}

/// Bounds the coefficients of the tangent by those where it has this value: y' = 1 + y².
fn tangent(bounds: &mut [f64], value: f64) {
    let mut terms = vec![value];
    for order in 1..bounds.len() {
        let square: f64 = (0..order).map(|place| terms[place] * terms[order - 1 - place]).sum();
        let one = if order == 1 { 1.0 } else { 0.0 };
        terms.push((square + one) / order as f64 * MARGIN);
        bounds[order] = terms[order];
    }
}
