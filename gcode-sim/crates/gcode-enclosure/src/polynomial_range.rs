//! Ranges of polynomials over the unit box, tighter than term by term.
use crate::basis::{Basis, MAX_VARIABLES};
use crate::interval::{Interval, add_up};
use crate::model::{HALF_ULP, Model};

/// Largest number of Bernstein coefficients that are computed.
const MAX_COEFFICIENTS: usize = 6000;

impl Model {
    /// Returns a range of the value: by Bernstein coefficients, else by the faces on which the polynomial is extreme.
    pub(crate) fn range(&self, basis: &Basis) -> Interval {
        let by_terms = self.bound(basis);
        let mut degrees = [0_usize; MAX_VARIABLES];
        for (monomial, _) in &self.terms {
            for (variable, degree) in degrees.iter_mut().enumerate() {
                *degree = (*degree).max(basis.exponent(*monomial, variable) as usize);
            }
        }
        let count = degrees.iter().try_fold(1_usize, |count, degree| {
            Some(count * (degree + 1)).filter(|count| *count <= MAX_COEFFICIENTS)
        });
        let tighter = match count {
            Some(1) => return by_terms,
            Some(count) => self.bernstein(basis, &degrees, count),
            None => self.on_faces(basis),
        };
        by_terms.intersect(tighter)
    }

    /// Returns the range of the Bernstein coefficients, which has that of the polynomial.
    fn bernstein(&self, basis: &Basis, degrees: &[usize; MAX_VARIABLES], count: usize) -> Interval {
        let mut coefficients = vec![0.0; count];
        for &(monomial, value) in &self.terms {
            let mut place = 0;
            for (variable, degree) in degrees.iter().enumerate() {
                place = place * (degree + 1) + basis.exponent(monomial, variable) as usize;
            }
            coefficients[place] += value;
        }
        let mut stride = count;
        let mut steps = 2;
        let mut column = Vec::new();
        for &degree in degrees.iter().filter(|degree| **degree > 0) {
            let matrix = bernstein_matrix(degree);
            let size = degree + 1;
            steps += size + 4;
            stride /= size;
            for start in (0..count).filter(|start| (start / stride).is_multiple_of(size)) {
                column.clear();
                column.extend((0..size).map(|power| coefficients[start + power * stride]));
                for (index, row) in matrix.chunks(size).enumerate() {
                    let products = row.iter().zip(&column).map(|(factor, value)| factor * value);
                    coefficients[start + index * stride] = products.sum();
                }
            }
        }
        // Every entry of the matrices is in [−1, 1].
        let error = add_up(self.norm() * 2.0 * HALF_ULP * steps as f64 + self.rest, 1e-300);
        let lo = coefficients.iter().copied().fold(f64::INFINITY, f64::min);
        let hi = coefficients.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        Interval::new(lo, hi).widened(error)
    }

    /// Returns the range with every variable at the end where the polynomial is extreme, where its derivative has one
    /// sign.
    fn on_faces(&self, basis: &Basis) -> Interval {
        let hi = self.upper_face(basis, 1.0);
        Interval::new(-self.upper_face(basis, -1.0), hi)
    }

    /// Returns an upper bound of the value × `sign`.
    fn upper_face(&self, basis: &Basis, sign: f64) -> f64 {
        let mut terms: Vec<([u8; MAX_VARIABLES], f64)> = Vec::with_capacity(self.terms.len());
        for &(monomial, value) in &self.terms {
            let exponents = std::array::from_fn(|variable| basis.exponent(monomial, variable) as u8);
            terms.push((exponents, value * sign));
        }
        let mut is_changed = true;
        while is_changed {
            is_changed = false;
            for variable in 0..MAX_VARIABLES {
                // The linear coefficient against all that can outweigh it.
                let (mut slope, mut others) = (0.0_f64, 0.0_f64);
                for (exponents, value) in &terms {
                    let exponent = exponents[variable];
                    if exponent == 1 && exponents.iter().map(|e| u32::from(*e)).sum::<u32>() == 1 {
                        slope += value;
                    } else {
                        others += f64::from(exponent) * value.abs();
                    }
                }
                if slope == 0.0 || slope.abs() <= others * (1.0 + 1e-9) {
                    continue;
                }
                is_changed = true;
                for (exponents, value) in &mut terms {
                    if slope < 0.0 && exponents[variable] % 2 == 1 {
                        *value = -*value;
                    }
                    exponents[variable] = 0;
                }
            }
        }
        let mut sums: std::collections::BTreeMap<[u8; MAX_VARIABLES], f64> =
            std::collections::BTreeMap::new();
        for (exponents, value) in terms {
            *sums.entry(exponents).or_default() += value;
        }
        let mut upper = 0.0;
        for (exponents, value) in sums {
            let is_constant = exponents.iter().all(|exponent| *exponent == 0);
            let is_even = exponents.iter().all(|exponent| exponent % 2 == 0);
            upper += if is_constant {
                value
            } else if is_even {
                value.max(0.0)
            } else {
                value.abs()
            };
        }
        let rounding = self.norm() * 4.0 * HALF_ULP * (self.terms.len() + 4) as f64;
        add_up(add_up(upper, rounding), self.rest)
    }
}

/// Returns the matrix from powers of a variable in [−1, 1] to Bernstein coefficients, by rows.
fn bernstein_matrix(degree: usize) -> Vec<f64> {
    let choose = |n: usize, k: usize| {
        if k > n { 0.0 } else { (0..k).fold(1.0, |value, i| value * (n - i) as f64 / (i + 1) as f64) }
    };
    let mut matrix = Vec::with_capacity((degree + 1) * (degree + 1));
    for index in 0..=degree {
        for power in 0..=degree {
            // The mean of the products of `power` of the control values: `index` of them are 1, the others −1.
            let sum: f64 = (0..=power)
                .map(|ones| {
                    let sign = if (power - ones).is_multiple_of(2) { 1.0 } else { -1.0 };
                    sign * choose(index, ones) * choose(degree - index, power - ones)
                })
                .sum();
            matrix.push(sum / choose(degree, power));
        }
    }
    matrix
}
