//! Polynomials near a function of one variable, with the bound of their distance.
//!
//! Chebyshev interpolation has half the error of a Taylor polynomial per degree. Where a derivative is infinite, at the
//! ends of SQRT or ASIN, a chord of the convex or concave function holds.
use crate::elementary::Elementary;
use crate::interval::{Interval, add_up};

/// A polynomial of s = (x − middle) / radius, |s| ≤ 1, and its largest distance from the function.
#[derive(Clone, Debug)]
pub(crate) struct Approximation {
    pub(crate) middle: f64,
    pub(crate) radius: f64,
    pub(crate) coefficients: Vec<f64>,
    pub(crate) error: f64,
}

/// Bound of the Lebesgue constant of ten Chebyshev nodes or fewer, with room for their rounding.
const LEBESGUE: f64 = 5.0;
/// Largest degree.
const MAX_DEGREE: usize = 9;

impl Approximation {
    /// Returns the best polynomial up to a degree; `None` without any on this range.
    pub(crate) fn of(function: Elementary, range: Interval, degree: usize) -> Option<Self> {
        let range = function.domain(range)?;
        let middle = range.midpoint();
        let radius = (range.hi() - middle).next_up().max((middle - range.lo()).next_up());
        // The powers of a radius below would underflow.
        if radius < 1e-25 {
            return None;
        }
        let degree = degree.clamp(1, MAX_DEGREE);
        let bounds = function.coefficient_bounds(range, degree + 1);
        let scale = function.value(middle).abs() * f64::EPSILON / 8.0;
        let (mut best, mut least) = (0, f64::INFINITY);
        let mut power = radius;
        for candidate in 0..=degree {
            // The factor 2^−n belongs to the nodes.
            let error = bounds[candidate + 1] * power;
            if error < least {
                (best, least) = (candidate, error);
            }
            if error <= scale {
                break;
            }
            power = power * radius / 2.0 * (1.0 + 1e-10);
        }
        let chord = || Self::chord(function, range, middle, radius);
        // Far from 0 on a short range the nodes would lose their digits.
        if radius < middle.abs() * 1e-9 {
            return Self::tangent(function, middle, radius, &bounds).or_else(chord);
        }
        let interpolated = Self::interpolate(function, middle, radius, best, least, range);
        match (interpolated, if best <= 2 || least > 0.01 * scale / f64::EPSILON { chord() } else { None }) {
            (Some(a), Some(b)) => Some(if a.error <= b.error { a } else { b }),
            (a, b) => a.or(b),
        }
        .filter(|found| found.error.is_finite())
    }

    /// Returns the tangent at the middle.
    fn tangent(function: Elementary, middle: f64, radius: f64, bounds: &[f64]) -> Option<Self> {
        let (value, slope) = (function.value(middle), function.derivative(middle));
        let error = function.value_error(value.abs())
            + (slope.abs() * 1e-11 * radius + bounds[2] * radius * radius) * (1.0 + 1e-9);
        let found =
            Self { middle, radius, coefficients: vec![value, slope * radius], error: add_up(error, 1e-300) };
        (found.error.is_finite() && value.is_finite()).then_some(found)
    }

    /// Returns the interpolation at the Chebyshev nodes; `remainder` bounds that of exact values.
    fn interpolate(
        function: Elementary,
        middle: f64,
        radius: f64,
        degree: usize,
        remainder: f64,
        range: Interval,
    ) -> Option<Self> {
        let count = degree + 1;
        let angle = |node: usize| std::f64::consts::PI * (node as f64 + 0.5) / count as f64;
        let nodes: Vec<f64> = (0..count)
            .map(|node| (middle + radius * libm::cos(angle(node))).clamp(range.lo(), range.hi()))
            .collect();
        let values: Vec<f64> = nodes.iter().map(|&node| function.value(node)).collect();
        let coefficients = power_coefficients(&values, angle);
        // The distance of the polynomial from the interpolation is at most that at the nodes × the Lebesgue constant.
        let size: f64 =
            coefficients.iter().enumerate().map(|(power, value)| value.abs() * (power + 1) as f64).sum();
        let rounding = size * (4 * count + 8) as f64 * f64::EPSILON;
        let mut worst = 0.0_f64;
        for (node, value) in nodes.iter().zip(&values) {
            let s = (node - middle) / radius;
            let polynomial = coefficients.iter().rev().fold(0.0, |sum, coefficient| sum * s + coefficient);
            let distance = (polynomial - value).abs() * (1.0 + 1e-9) + function.value_error(value.abs());
            if distance.is_nan() {
                return None;
            }
            worst = worst.max(distance);
        }
        let error = add_up(remainder * 1.01 + LEBESGUE * (worst + rounding) * (1.0 + 1e-9), 1e-300);
        Some(Self { middle, radius, coefficients, error })
    }

    /// Returns the middle line between the chord and the parallel tangent of a convex or concave function.
    fn chord(function: Elementary, range: Interval, middle: f64, radius: f64) -> Option<Self> {
        let sign = function.curvature(range)?;
        let (lo, hi) = (range.lo(), range.hi());
        let ends = [function.value(lo), function.value(hi)];
        let slope = (ends[1] - ends[0]) / (hi - lo);
        if !slope.is_finite() || !ends.iter().all(|end| end.is_finite()) {
            return None;
        }
        // Any tangent bounds the function on its other side: the nearly parallel one is closest.
        let (mut left, mut right) = (lo, hi);
        for _ in 0..60 {
            let half = left / 2.0 + right / 2.0;
            if (function.derivative(half) - slope) * sign < 0.0 { left = half } else { right = half }
        }
        let touch = left / 2.0 + right / 2.0;
        let (value, tangent) = (function.value(touch), function.derivative(touch));
        if !tangent.is_finite() || !value.is_finite() {
            return None;
        }
        // The function minus the line of this slope through 0 at the middle.
        let above = |x: f64, value: f64| value - slope * (x - middle);
        let chord = [above(lo, ends[0]), above(hi, ends[1])];
        let parallel = [lo, hi].map(|x| above(x, value + tangent * (x - touch)));
        let size = ends.iter().chain(&[value]).fold(0.0_f64, |most, end| most.max(end.abs()))
            + (slope.abs() + tangent.abs()) * (hi - lo);
        let all = chord.iter().chain(&parallel);
        let least = all.clone().copied().fold(f64::INFINITY, f64::min);
        let most = all.copied().fold(f64::NEG_INFINITY, f64::max);
        let offset = least / 2.0 + most / 2.0;
        let error = (most - least) / 2.0 + size * 1e-11 + function.value_error(size);
        let found =
            Self { middle, radius, coefficients: vec![offset, slope * radius], error: add_up(error, 1e-300) };
        found.error.is_finite().then_some(found)
    }
}

/// Returns the coefficients by power of the polynomial through values at the Chebyshev nodes.
fn power_coefficients(values: &[f64], angle: impl Fn(usize) -> f64) -> Vec<f64> {
    let count = values.len();
    let mut coefficients = vec![0.0; count];
    // T_0 and T_1 by power; each next one is 2·s·T_k − T_(k−1).
    let (mut before, mut last) = (vec![0.0; count], vec![0.0; count]);
    before[0] = 1.0;
    if count > 1 {
        last[1] = 1.0;
    }
    for order in 0..count {
        let sum: f64 = values
            .iter()
            .enumerate()
            .map(|(node, value)| value * libm::cos(order as f64 * angle(node)))
            .sum();
        let factor = if order == 0 { sum / count as f64 } else { 2.0 * sum / count as f64 };
        for (coefficient, power) in coefficients.iter_mut().zip(&before) {
            *coefficient += factor * power;
        }
        let mut next = vec![0.0; count];
        for power in 0..count {
            next[power] = if power > 0 { 2.0 * last[power - 1] } else { 0.0 } - before[power];
        }
        (before, last) = (last, next);
    }
    coefficients
}
