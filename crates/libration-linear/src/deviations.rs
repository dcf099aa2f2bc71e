//! Deviations of random matrices from their mean.

use crate::Matrix;

/// Random deviations `Δ` by few matrices: `E[Δ P Δᵀ] = Σ Dₖ P Dₖᵀ` for every `P`.
#[derive(Clone, Debug)]
pub(crate) struct Deviations {
    parts: Vec<Matrix>,
}

/// Part of the largest norm below which what is left of a deviation is rounding.
const ROUNDING: f64 = 1e-15;

impl Deviations {
    /// Of these deviations with their probabilities.
    ///
    /// Deviations under jitter are smooth functions of the length of a period, so that a handful of matrices spans them. They come
    /// from an orthogonal basis, the largest rest first, and the triangular factor of its coefficients.
    pub(crate) fn new(weighted: &[(f64, Matrix)]) -> Self {
        let Some((_, first)) = weighted.first() else { return Deviations { parts: Vec::new() } };
        let (rows, columns) = (first.rows(), first.columns());
        let mut rest: Vec<Matrix> =
            weighted.iter().map(|(weight, off)| off.scaled(weight.sqrt())).collect();
        let largest = rest.iter().map(square).fold(0.0, f64::max);
        let mut basis: Vec<Matrix> = Vec::new();
        let mut coefficients: Vec<Vec<f64>> = vec![Vec::new(); rest.len()];
        while basis.len() < rest.len() {
            let sizes = rest.iter().map(square).enumerate();
            let Some((pivot, size)) = sizes.max_by(|a, b| a.1.total_cmp(&b.1)) else { break };
            if size <= ROUNDING * ROUNDING * largest || size == 0.0 {
                break;
            }
            let mut direction = rest[pivot].scaled(size.sqrt().recip());
            // Once more against what rounding left of the others.
            for known in &basis {
                let along = known.inner(&direction);
                direction.add_scaled(-along, known);
            }
            direction = direction.scaled(square(&direction).sqrt().recip());
            for (rest, coefficients) in rest.iter_mut().zip(&mut coefficients) {
                let along = direction.inner(rest);
                rest.add_scaled(-along, &direction);
                coefficients.push(along);
            }
            basis.push(direction);
        }
        // C with CᵀC = TᵀT of the coefficients T, by Cholesky.
        let count = basis.len();
        let gram = Matrix::from_fn(count, count, |i, j| {
            coefficients.iter().map(|row| row[i] * row[j]).sum()
        });
        let factor = cholesky(&gram);
        let part = |k: usize| {
            let mut part = Matrix::zeros(rows, columns);
            for (j, direction) in basis.iter().enumerate().skip(k) {
                part.add_scaled(factor[(j, k)], direction);
            }
            part
        };
        Deviations { parts: (0..count).map(part).collect() }
    }

    /// `E[Δ P Δᵀ]`.
    pub(crate) fn spread(&self, moments: &Matrix) -> Matrix {
        let rows = self.parts.first().map_or(0, Matrix::rows);
        let mut sum = Matrix::zeros(rows, rows);
        for part in &self.parts {
            sum.add_scaled(1.0, &part.congruence(moments));
        }
        sum
    }

    /// `E[Δᵀ F Δ]` of a form `F`: none without deviations.
    pub(crate) fn gathered(&self, form: &Matrix) -> Option<Matrix> {
        let parts = self.parts.iter().map(|part| part.transposed().congruence(form));
        parts.reduce(|sum, part| sum.plus(&part))
    }
}

fn square(matrix: &Matrix) -> f64 {
    matrix.inner(matrix)
}

/// The lower factor of a positive semidefinite matrix; columns of no size are zero.
fn cholesky(matrix: &Matrix) -> Matrix {
    let n = matrix.rows();
    let mut factor = Matrix::zeros(n, n);
    for j in 0..n {
        for i in j..n {
            let known: f64 = (0..j).map(|k| factor[(i, k)] * factor[(j, k)]).sum();
            let rest = matrix[(i, j)] - known;
            factor[(i, j)] = match i == j {
                true => rest.max(0.0).sqrt(),
                false if factor[(j, j)] > 0.0 => rest / factor[(j, j)],
                false => 0.0,
            };
        }
    }
    factor
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn few_matrices_spread_moments_as_many_do() {
        // Of a smooth function of a number that is drawn 41 times.
        let at =
            |x: f64| Matrix::from_fn(3, 5, |i, j| (x * (1.0 + i as f64 + 0.3 * j as f64)).sin());
        let weighted: Vec<(f64, Matrix)> =
            (-20..=20).map(|k| (1.0 / 41.0, at(0.02 * f64::from(k)))).collect();
        let few = Deviations::new(&weighted);
        assert!(few.parts.len() < 16, "{}", few.parts.len());
        let moments = Matrix::from_fn(5, 5, |i, j| 1.0 / (1.0 + (i + j) as f64));
        let mut wanted = Matrix::zeros(3, 3);
        for (weight, off) in &weighted {
            wanted.add_scaled(*weight, &off.congruence(&moments));
        }
        let found = few.spread(&moments);
        for (found, wanted) in found.entries().iter().zip(wanted.entries()) {
            // Sums of 41 terms.
            assert!((found - wanted).abs() < 1e-14 * wanted.abs().max(0.01), "{found} {wanted}");
        }
    }
}
