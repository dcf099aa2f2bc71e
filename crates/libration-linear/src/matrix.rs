//! Dense matrices of floats.

use core::ops::{Index, IndexMut, Mul};

/// A dense matrix, stored row by row.
#[derive(Clone, Debug, PartialEq)]
pub struct Matrix {
    rows: usize,
    columns: usize,
    entries: Vec<f64>,
}

impl Matrix {
    /// A matrix of zeros.
    pub fn zeros(rows: usize, columns: usize) -> Self {
        Matrix { rows, columns, entries: vec![0.0; rows * columns] }
    }

    /// A matrix with these entries.
    pub fn from_fn(rows: usize, columns: usize, entry: impl Fn(usize, usize) -> f64) -> Self {
        let mut entries = Vec::with_capacity(rows * columns);
        for i in 0..rows {
            for j in 0..columns {
                entries.push(entry(i, j));
            }
        }
        Matrix { rows, columns, entries }
    }

    /// A matrix of rows of equal length; none if their lengths differ.
    pub fn from_rows<R: AsRef<[f64]>>(rows: &[R]) -> Option<Self> {
        let columns = rows.first().map_or(0, |row| row.as_ref().len());
        let equal = rows.iter().all(|row| row.as_ref().len() == columns);
        let entries = rows.iter().flat_map(|row| row.as_ref().iter().copied()).collect();
        equal.then_some(Matrix { rows: rows.len(), columns, entries })
    }

    /// The identity of size `n`.
    pub fn identity(n: usize) -> Self {
        let mut identity = Matrix::zeros(n, n);
        (0..n).for_each(|i| identity[(i, i)] = 1.0);
        identity
    }

    /// A square matrix with these entries on its diagonal, and zeros elsewhere.
    pub fn diagonal(entries: &[f64]) -> Self {
        let n = entries.len();
        Self::from_fn(n, n, |i, j| if i == j { entries[i] } else { 0.0 })
    }

    /// The number of rows.
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// The number of columns.
    pub fn columns(&self) -> usize {
        self.columns
    }

    /// All entries, row by row.
    pub fn entries(&self) -> &[f64] {
        &self.entries
    }

    /// All entries, row by row.
    pub fn entries_mut(&mut self) -> &mut [f64] {
        &mut self.entries
    }

    /// Row `i`.
    pub fn row(&self, i: usize) -> &[f64] {
        &self.entries[i * self.columns..(i + 1) * self.columns]
    }

    /// Row `i`.
    pub fn row_mut(&mut self, i: usize) -> &mut [f64] {
        &mut self.entries[i * self.columns..(i + 1) * self.columns]
    }

    /// The transpose.
    pub fn transposed(&self) -> Self {
        Self::from_fn(self.columns, self.rows, |i, j| self[(j, i)])
    }

    /// The matrix with `f` applied to each entry.
    pub fn map(&self, f: impl Fn(f64) -> f64) -> Self {
        Matrix { entries: self.entries.iter().map(|&x| f(x)).collect(), ..*self }
    }

    /// The matrix times `factor`.
    pub fn scaled(&self, factor: f64) -> Self {
        self.map(|x| factor * x)
    }

    /// Adds `factor` times a matrix of the same shape.
    pub fn add_scaled(&mut self, factor: f64, other: &Matrix) {
        for (x, &y) in self.entries.iter_mut().zip(&other.entries) {
            *x += factor * y;
        }
    }

    /// The sum of two matrices of the same shape.
    pub fn plus(&self, other: &Matrix) -> Self {
        let mut sum = self.clone();
        sum.add_scaled(1.0, other);
        sum
    }

    /// The block of `rows` × `columns` entries that begins at `(i, j)`.
    pub fn block(&self, (i, j): (usize, usize), (rows, columns): (usize, usize)) -> Self {
        Self::from_fn(rows, columns, |a, b| self[(i + a, j + b)])
    }

    /// Copies `block` to the entries that begin at `(i, j)`.
    pub fn set_block(&mut self, (i, j): (usize, usize), block: &Matrix) {
        for a in 0..block.rows {
            self.row_mut(i + a)[j..j + block.columns].copy_from_slice(block.row(a));
        }
    }

    /// Exchanges two rows.
    pub(crate) fn swap_rows(&mut self, i: usize, j: usize) {
        if i != j {
            for k in 0..self.columns {
                self.entries.swap(i * self.columns + k, j * self.columns + k);
            }
        }
    }

    /// Subtracts `factor` times row `other` from row `i`, from column `from` on.
    pub(crate) fn subtract_row(&mut self, i: usize, factor: f64, other: usize, from: usize) {
        for k in from..self.columns {
            self.entries[i * self.columns + k] -= factor * self.entries[other * self.columns + k];
        }
    }

    /// `self · other · selfᵀ`, for a symmetric `other`.
    pub fn congruence(&self, other: &Matrix) -> Self {
        self * &(self * other).transposed()
    }

    /// The largest size of an entry; NaN if one is NaN.
    pub fn largest(&self) -> f64 {
        let larger = |most: f64, x: &f64| if x.abs() > most || x.is_nan() { x.abs() } else { most };
        self.entries.iter().fold(0.0, larger)
    }

    /// The norm that vectors with entries of size 1 at most induce: the largest sum of sizes in a row.
    pub fn row_sum_norm(&self) -> f64 {
        let sum = |i| self.row(i).iter().map(|x| x.abs()).sum::<f64>();
        (0..self.rows).map(sum).fold(0.0, |most: f64, x| if x.is_nan() { x } else { most.max(x) })
    }

    /// The sum of the diagonal.
    pub fn trace(&self) -> f64 {
        (0..self.rows.min(self.columns)).map(|i| self[(i, i)]).sum()
    }

    /// The sum of the products of equal entries: the trace of `selfᵀ · other`.
    pub fn inner(&self, other: &Matrix) -> f64 {
        dot(&self.entries, &other.entries)
    }

    /// The product with a vector.
    pub fn apply(&self, x: &[f64]) -> Vec<f64> {
        (0..self.rows).map(|i| dot(self.row(i), x)).collect()
    }

    /// Whether no entry is infinite or NaN.
    pub fn is_finite(&self) -> bool {
        self.entries.iter().all(|x| x.is_finite())
    }

    /// Divides all entries by `norm` and sets those that vanish beside the largest to zero: their products would be denormal
    /// numbers, with which processors take a hundred times as long.
    pub fn normalise(&mut self, norm: f64) {
        const NOTHING: f64 = 1e-150;
        for x in &mut self.entries {
            *x /= norm;
            *x = if x.abs() < NOTHING { 0.0 } else { *x };
        }
    }
}

impl Index<(usize, usize)> for Matrix {
    type Output = f64;

    #[inline]
    fn index(&self, (i, j): (usize, usize)) -> &f64 {
        &self.entries[i * self.columns + j]
    }
}

impl IndexMut<(usize, usize)> for Matrix {
    #[inline]
    fn index_mut(&mut self, (i, j): (usize, usize)) -> &mut f64 {
        &mut self.entries[i * self.columns + j]
    }
}

/// The sum of products, one after the other; a plain loop, since iterators that add up remain calls in tests.
fn dot(a: &[f64], b: &[f64]) -> f64 {
    let mut sum = 0.0;
    for (a, b) in a.iter().zip(b) {
        sum += a * b;
    }
    sum
}

impl Mul for &Matrix {
    type Output = Matrix;

    /// The product; cheap for a left factor with many zeros.
    fn mul(self, other: &Matrix) -> Matrix {
        let mut product = Matrix::zeros(self.rows, other.columns);
        for i in 0..self.rows {
            let row = &mut product.entries[i * other.columns..(i + 1) * other.columns];
            let factors = self.row(i).chunks(4).enumerate();
            for (k, factors) in factors.filter(|(_, four)| four.iter().any(|x| *x != 0.0)) {
                let own = |i: usize| &other.row(4 * k + i)[..row.len()];
                match *factors {
                    // Four at once keep each sum in a register, in the order of one after the other.
                    [a, b, c, d] => {
                        let [p, q, r, s] = [own(0), own(1), own(2), own(3)];
                        for (j, x) in row.iter_mut().enumerate() {
                            *x = *x + a * p[j] + b * q[j] + c * r[j] + d * s[j];
                        }
                    }
                    _ => {
                        for (i, factor) in factors.iter().enumerate() {
                            let other = other.row(4 * k + i);
                            row.iter_mut().zip(other).for_each(|(x, y)| *x += factor * y);
                        }
                    }
                }
            }
        }
        product
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn products_blocks_and_transposes_are_those_of_the_textbook() {
        let a = Matrix::from_rows(&[[1.0, 2.0, 0.0], [0.0, -1.0, 3.0]]).unwrap();
        let b = Matrix::from_rows(&[[2.0], [1.0], [4.0]]).unwrap();
        assert_eq!((&a * &b).entries(), [4.0, 11.0]);
        assert_eq!(a.apply(b.entries()), [4.0, 11.0]);
        assert_eq!(a.transposed().row(2), [0.0, 3.0]);
        assert_eq!(a.block((0, 1), (2, 2)).entries(), [2.0, 0.0, -1.0, 3.0]);
        assert_eq!(a.row_sum_norm(), 4.0);
        // a·diag(1, 2, 3)·aᵀ.
        let congruent = a.congruence(&Matrix::diagonal(&[1.0, 2.0, 3.0]));
        assert_eq!(congruent.entries(), [9.0, -4.0, -4.0, 29.0]);
        let ragged: [&[f64]; 2] = [&[1.0], &[1.0, 2.0]];
        assert_eq!(Matrix::from_rows(&ragged), None);
    }
}
