//! Balanced Hessenberg form, and its resolvent.

use num_complex::Complex64;

use crate::Matrix;

/// `A = S H S⁻¹` of a square matrix `A`, with a Hessenberg matrix `H`: zero below its first subdiagonal.
///
/// Balancing (B. N. Parlett, C. Reinsch, *Balancing a matrix for calculation of eigenvalues and eigenvectors*, Numerische Mathematik
/// 13, 1969), and reflections (G. H. Golub, C. F. Van Loan, *Matrix Computations*, 4th ed., section 7.4).
pub(crate) struct HessenbergForm {
    pub(crate) h: Matrix,
    /// `S = D Q`: factors of rows, and a rotation.
    scales: Vec<f64>,
    rotation: Matrix,
}

/// `(z − H)⁻¹ b` of some columns `b`, with the determinant of `z − H`.
#[derive(Clone, Debug)]
pub(crate) struct Resolved {
    pub(crate) solutions: Vec<Vec<Complex64>>,
    pub(crate) determinant: Complex64,
}

impl HessenbergForm {
    pub(crate) fn new(matrix: &Matrix) -> Self {
        let n = matrix.rows();
        let (mut h, mut rotation) = (matrix.clone(), Matrix::identity(n));
        let scales = balance(&mut h);
        for k in 0..n.saturating_sub(2) {
            let column: Vec<f64> = (k + 1..n).map(|i| h[(i, k)]).collect();
            let Some(reflection) = Reflection::onto_first(&column) else { continue };
            reflection.reflect_rows(&mut h, k + 1, k..n);
            reflection.reflect_columns(&mut h, k + 1, 0..n);
            reflection.reflect_columns(&mut rotation, k + 1, 0..n);
            (k + 2..n).for_each(|i| h[(i, k)] = 0.0);
        }
        HessenbergForm { h, scales, rotation }
    }

    /// `S⁻¹ b` of a column `b`.
    pub(crate) fn column(&self, b: &[f64]) -> Vec<f64> {
        let balanced: Vec<f64> = b.iter().zip(&self.scales).map(|(b, scale)| b / scale).collect();
        self.rotation.transposed().apply(&balanced)
    }

    /// `c S` of a row `c`.
    pub(crate) fn row(&self, c: &[f64]) -> Vec<f64> {
        let balanced: Vec<f64> = c.iter().zip(&self.scales).map(|(c, scale)| c * scale).collect();
        self.rotation.transposed().apply(&balanced)
    }

    /// `S x` of a column `x`.
    pub(crate) fn restored(&self, x: &[Complex64]) -> Vec<Complex64> {
        let n = self.h.rows();
        let turned = |i: usize| (0..n).map(|j| x[j] * self.rotation[(i, j)]).sum::<Complex64>();
        (0..n).map(|i| turned(i) * self.scales[i]).collect()
    }

    /// `(z − H)⁻¹ b` of each of these columns, by elimination with the larger pivot of two rows.
    pub(crate) fn resolvent(&self, z: Complex64, columns: &[Vec<f64>]) -> Resolved {
        let n = self.h.rows();
        let full_row = |i: usize| -> Vec<Complex64> {
            let mut row: Vec<Complex64> =
                self.h.row(i).iter().map(|x| Complex64::from(-x)).collect();
            row[i] += z;
            row
        };
        let complex =
            |b: &Vec<f64>| -> Vec<Complex64> { b.iter().map(|&x| Complex64::from(x)).collect() };
        let mut solutions: Vec<Vec<Complex64>> = columns.iter().map(complex).collect();
        let mut upper: Vec<Vec<Complex64>> = Vec::with_capacity(n);
        let mut determinant = Complex64::ONE;
        let mut current = if n > 0 { full_row(0) } else { Vec::new() };
        for k in 0..n {
            if k + 1 == n {
                determinant *= current[k];
                upper.push(core::mem::take(&mut current));
                break;
            }
            let mut next = full_row(k + 1);
            if next[k].norm_sqr() > current[k].norm_sqr() {
                core::mem::swap(&mut current, &mut next);
                solutions.iter_mut().for_each(|solution| solution.swap(k, k + 1));
                determinant = -determinant;
            }
            determinant *= current[k];
            if next[k] != Complex64::ZERO {
                let factor = next[k] / current[k];
                next[k + 1..].iter_mut().zip(&current[k + 1..]).for_each(|(x, p)| *x -= factor * p);
                for solution in &mut solutions {
                    let eliminated = factor * solution[k];
                    solution[k + 1] -= eliminated;
                }
            }
            upper.push(core::mem::replace(&mut current, next));
        }
        for k in (0..n).rev() {
            for solution in &mut solutions {
                let (known, rest) = (&upper[k][k + 1..], &solution[k + 1..]);
                let sum: Complex64 = known.iter().zip(rest).map(|(a, x)| a * x).sum();
                solution[k] = (solution[k] - sum) / upper[k][k];
            }
        }
        Resolved { solutions, determinant }
    }
}

/// Scales rows and columns by powers of two until their norms are alike, which rounds nothing. Returns the factors of the columns; rows
/// are divided by them.
pub(crate) fn balance(a: &mut Matrix) -> Vec<f64> {
    let n = a.rows();
    let mut scales = vec![1.0; n];
    // Each pass halves what is left at least; far fewer are needed.
    for _ in 0..64 {
        let mut settled = true;
        for i in 0..n {
            let others = || (0..n).filter(|&j| j != i);
            let column: f64 = others().map(|j| a[(j, i)].abs()).sum();
            let row: f64 = others().map(|j| a[(i, j)].abs()).sum();
            if column == 0.0 || row == 0.0 {
                continue;
            }
            let factor = (0.5 * (row / column).log2()).round().clamp(-500.0, 500.0).exp2();
            if column * factor + row / factor < 0.95 * (column + row) {
                settled = false;
                scales[i] *= factor;
                for j in 0..n {
                    a[(i, j)] /= factor;
                    a[(j, i)] *= factor;
                }
            }
        }
        if settled {
            break;
        }
    }
    scales
}

/// `1 − τvvᵀ`.
pub(crate) struct Reflection {
    v: Vec<f64>,
    tau: f64,
}

impl Reflection {
    /// That which takes `x` to a multiple of the first unit vector; none of a zero vector.
    pub(crate) fn onto_first(x: &[f64]) -> Option<Self> {
        let largest = x.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
        if largest == 0.0 || !largest.is_finite() {
            return None;
        }
        let mut v: Vec<f64> = x.iter().map(|x| x / largest).collect();
        let norm = v.iter().map(|x| x * x).sum::<f64>().sqrt();
        v[0] += norm.copysign(v[0]);
        let square: f64 = v.iter().map(|x| x * x).sum();
        Some(Reflection { v, tau: 2.0 / square })
    }

    /// Reflects the rows from `first` on, in these columns.
    pub(crate) fn reflect_rows(
        &self,
        a: &mut Matrix,
        first: usize,
        columns: core::ops::Range<usize>,
    ) {
        for j in columns {
            let along: f64 = self.v.iter().enumerate().map(|(i, v)| v * a[(first + i, j)]).sum();
            for (i, v) in self.v.iter().enumerate() {
                a[(first + i, j)] -= self.tau * along * v;
            }
        }
    }

    /// Reflects the columns from `first` on, in these rows.
    pub(crate) fn reflect_columns(
        &self,
        a: &mut Matrix,
        first: usize,
        rows: core::ops::Range<usize>,
    ) {
        for i in rows {
            let row = &mut a.row_mut(i)[first..first + self.v.len()];
            let along: f64 = row.iter().zip(&self.v).map(|(x, v)| x * v).sum();
            row.iter_mut().zip(&self.v).for_each(|(x, v)| *x -= self.tau * along * v);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{eigenvalues, solve};

    #[test]
    fn the_resolvent_solves_its_equations_also_of_badly_scaled_matrices() {
        let scales = [1e-6, 1.0, 1e3, 1e6, 1.0, 1e-2];
        let plain = |i: usize, j: usize| ((i * 7 + j * 3) % 11) as f64 - 5.0;
        let a = Matrix::from_fn(6, 6, |i, j| 0.1 * plain(i, j) * scales[i] / scales[j]);
        let b: Vec<f64> = scales.iter().map(|scale| 0.3 * scale).collect();
        let c: Vec<f64> = scales.iter().enumerate().map(|(i, s)| (1.0 + i as f64) / s).collect();
        let form = HessenbergForm::new(&a);
        let z = Complex64::from_polar(1.0, 0.7);
        let resolved = form.resolvent(z, &[form.column(&b)]);
        let found: Complex64 =
            form.row(&c).iter().zip(&resolved.solutions[0]).map(|(c, x)| c * x).sum();
        let row = |i: usize| -> Vec<Complex64> {
            let entry = |j: usize| if i == j { z - a[(i, j)] } else { Complex64::from(-a[(i, j)]) };
            (0..6).map(entry).chain([Complex64::from(b[i])]).collect()
        };
        let x = solve((0..6).map(row).collect(), |x: Complex64| x.norm());
        let wanted: Complex64 = x.iter().zip(&c).map(|(x, c)| x * c).sum();
        // Roundings of matrices of norm 3, twelve powers of ten apart before they are balanced.
        assert!((found - wanted).norm() < 1e-12 * wanted.norm(), "{found} {wanted}");
        let product: Complex64 = eigenvalues(&a).unwrap().iter().map(|value| z - value).product();
        assert!((resolved.determinant - product).norm() < 1e-12 * product.norm());
    }
}
