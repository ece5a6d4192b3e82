//! Sums of squares: a polynomial as squares of polynomials and a rest.
use crate::algebra::Algebra;
use crate::polynomial::{Monomial, Polynomial, merged};

/// Largest number of monomials whose squares are used.
const MAX_ROOTS: usize = 12;

impl Algebra<'_> {
    /// Returns what is left of a polynomial less squares, which are 0 or more; `None` without a square.
    ///
    /// The squares are those of the Gram matrix: of x² + 2·x·y + y² that of x + y. Whatever they are rounded to, the rest
    /// has it.
    pub(crate) fn without_squares(&mut self, polynomial: &Polynomial) -> Option<Polynomial> {
        let roots: Vec<Monomial> = polynomial
            .terms
            .iter()
            .filter(|(_, value)| **value > 0.0)
            .filter_map(|(m, _)| root_of(m))
            .collect();
        if !(2..=MAX_ROOTS).contains(&roots.len()) {
            return None;
        }
        let mut gram = gram_matrix(polynomial, &roots)?;
        let mut rest = polynomial.clone();
        let mut is_found = false;
        for pivot in 0..roots.len() {
            let size = gram[pivot][pivot];
            let row: Vec<f64> = gram[pivot].iter().map(|value| value / size).collect();
            let has_others = row[pivot + 1..].iter().any(|value| *value != 0.0);
            if size <= 0.0 || !has_others || row.iter().any(|value| !value.is_finite()) {
                continue;
            }
            for i in pivot + 1..roots.len() {
                for j in pivot + 1..roots.len() {
                    gram[i][j] -= row[i] * row[j] * size;
                }
            }
            let terms = roots.iter().zip(&row).skip(pivot).filter(|(_, value)| **value != 0.0);
            let sum =
                Polynomial { terms: terms.map(|(root, value)| (root.clone(), *value)).collect(), error: 0.0 };
            let square = self.product(&sum, &sum)?;
            rest = self.sum(&rest, &self.scaled(&square, -size));
            is_found = true;
        }
        is_found.then_some(rest)
    }
}

/// Returns the matrix whose quadratic form of the monomials is the polynomial, without the terms that are no product of two.
fn gram_matrix(polynomial: &Polynomial, roots: &[Monomial]) -> Option<Vec<Vec<f64>>> {
    let mut gram = vec![vec![0.0; roots.len()]; roots.len()];
    for (place, root) in roots.iter().enumerate() {
        gram[place][place] = polynomial.terms.get(&merged(root, root)?).copied()?;
    }
    for (monomial, value) in &polynomial.terms {
        let pairs = (0..roots.len()).flat_map(|i| (i + 1..roots.len()).map(move |j| (i, j)));
        let pairs: Vec<_> =
            pairs.filter(|(i, j)| merged(&roots[*i], &roots[*j]).as_ref() == Some(monomial)).collect();
        if *value > 0.0 && root_of(monomial).is_some() {
            continue;
        }
        for (i, j) in &pairs {
            let share = value / (2 * pairs.len()) as f64;
            gram[*i][*j] += share;
            gram[*j][*i] += share;
        }
    }
    Some(gram)
}

/// Returns the monomial whose square a monomial is.
fn root_of(monomial: &Monomial) -> Option<Monomial> {
    let halves = monomial.iter().map(|(atom, power)| (power % 2 == 0).then_some((*atom, power / 2)));
    halves.collect()
}
