//! Eigenvalues of small complex matrices.

use num_complex::Complex64;

use crate::Matrix;
use crate::hessenberg::balance;

/// Iterations for one eigenvalue; it takes two or three.
const MOST: usize = 60;

/// All eigenvalues of a square matrix of size `n`, given row by row; NaN if the iteration does not settle.
///
/// Of the balanced Hessenberg form, by shifted QR steps of plane rotations (G. H. Golub, C. F. Van Loan, *Matrix Computations*, 4th
/// ed., section 7.3 to 7.5).
pub(crate) fn complex_eigenvalues(entries: Vec<Complex64>, n: usize) -> Vec<Complex64> {
    if n == 1 {
        return entries;
    }
    if !entries.iter().all(|x| x.is_finite()) {
        return vec![Complex64::new(f64::NAN, f64::NAN); n];
    }
    let mut a = Square { n, entries };
    if n > 2 {
        a.balance();
        a.reduce();
    }
    let mut values = Vec::with_capacity(n);
    let size = a.entries.iter().map(|x| x.norm()).sum::<f64>();
    let (mut end, mut iterations) = (n, 0);
    while end > 0 {
        let negligible = |k: usize| {
            let beside = a.at(k, k).norm() + a.at(k - 1, k - 1).norm();
            let beside = if beside == 0.0 { size } else { beside };
            a.at(k, k - 1).norm() <= f64::EPSILON * beside
        };
        let begin = (1..end).rev().find(|&k| negligible(k)).unwrap_or(0);
        if begin > 0 {
            // For good: sweeps of the block leave the rows above it as they are.
            a.entries[begin * n + begin - 1] = Complex64::ZERO;
        }
        match end - begin {
            1 => values.push(a.at(begin, begin)),
            2 => values.extend(a.pair(begin)),
            _ if iterations == MOST => return vec![Complex64::new(f64::NAN, f64::NAN); n],
            _ => {
                iterations += 1;
                let [near, far] = a.pair(end - 2);
                let last = a.at(end - 1, end - 1);
                let shift = if (near - last).norm() < (far - last).norm() { near } else { far };
                // One that breaks circles.
                let odd = Complex64::from(a.at(end - 1, end - 2).norm());
                a.sweep(begin..end, if iterations % 10 == 0 { last + odd } else { shift });
                continue;
            }
        }
        end = begin;
        iterations = 0;
    }
    values
}

struct Square {
    n: usize,
    entries: Vec<Complex64>,
}

impl Square {
    fn at(&self, i: usize, j: usize) -> Complex64 {
        self.entries[i * self.n + j]
    }

    /// Scales rows and columns by powers of two until their norms are alike.
    fn balance(&mut self) {
        let n = self.n;
        let mut sizes = Matrix::from_fn(n, n, |i, j| self.at(i, j).norm());
        let scales = balance(&mut sizes);
        for i in 0..n {
            for j in 0..n {
                self.entries[i * n + j] *= scales[j] / scales[i];
            }
        }
    }

    /// To zeros below the first subdiagonal.
    fn reduce(&mut self) {
        for k in 0..self.n.saturating_sub(2) {
            for i in (k + 2..self.n).rev() {
                let rotation = Rotation::onto_first(self.at(i - 1, k), self.at(i, k));
                self.rotate_rows(rotation, i - 1, k..self.n);
                self.rotate_columns(rotation, i - 1, 0..self.n);
                self.entries[i * self.n + k] = Complex64::ZERO;
            }
        }
    }

    /// The eigenvalues of the block of two rows that begins at `k`, the larger first.
    fn pair(&self, k: usize) -> [Complex64; 2] {
        let [a, b] = [self.at(k, k), self.at(k, k + 1)];
        let [c, d] = [self.at(k + 1, k), self.at(k + 1, k + 1)];
        let (mean, half) = ((a + d) * 0.5, (a - d) * 0.5);
        let root = (half * half + b * c).sqrt();
        let alike = (root * mean.conj()).re >= 0.0;
        let far = if alike { mean + root } else { mean - root };
        // From the product, without cancellation.
        let near = if far == Complex64::ZERO { far } else { (a * d - b * c) / far };
        [far, near]
    }

    /// A shifted QR step on a block of a Hessenberg matrix.
    fn sweep(&mut self, block: core::ops::Range<usize>, shift: Complex64) {
        let n = self.n;
        let (begin, end) = (block.start, block.end);
        block.clone().for_each(|i| self.entries[i * n + i] -= shift);
        let mut rotations = Vec::with_capacity(end - begin);
        for k in begin..end - 1 {
            let rotation = Rotation::onto_first(self.at(k, k), self.at(k + 1, k));
            self.rotate_rows(rotation, k, k..end);
            self.entries[(k + 1) * n + k] = Complex64::ZERO;
            rotations.push(rotation);
        }
        for (k, rotation) in (begin..).zip(rotations) {
            self.rotate_columns(rotation, k, begin..(k + 2).min(end));
        }
        block.for_each(|i| self.entries[i * n + i] += shift);
    }

    /// Rotates rows `k` and `k + 1`, in these columns.
    fn rotate_rows(
        &mut self,
        Rotation { c, s }: Rotation,
        k: usize,
        columns: core::ops::Range<usize>,
    ) {
        for j in columns {
            let [x, y] = [self.at(k, j), self.at(k + 1, j)];
            self.entries[k * self.n + j] = x * c + s * y;
            self.entries[(k + 1) * self.n + j] = y * c - s.conj() * x;
        }
    }

    /// Rotates columns `k` and `k + 1` back, in these rows.
    fn rotate_columns(
        &mut self,
        Rotation { c, s }: Rotation,
        k: usize,
        rows: core::ops::Range<usize>,
    ) {
        for i in rows {
            let [x, y] = [self.at(i, k), self.at(i, k + 1)];
            self.entries[i * self.n + k] = x * c + s.conj() * y;
            self.entries[i * self.n + k + 1] = y * c - s * x;
        }
    }
}

/// The unitary matrix `(c, s; −s*, c)`.
#[derive(Clone, Copy)]
struct Rotation {
    c: f64,
    s: Complex64,
}

impl Rotation {
    /// That which takes `(x, y)` to a multiple of `(1, 0)`.
    fn onto_first(x: Complex64, y: Complex64) -> Self {
        let (size, length) = (x.norm(), x.norm().hypot(y.norm()));
        if y == Complex64::ZERO || length == 0.0 {
            return Rotation { c: 1.0, s: Complex64::ZERO };
        }
        let phase = if size == 0.0 { Complex64::ONE } else { x / size };
        Rotation { c: size / length, s: phase * y.conj() / length }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn eigenvalues_are_roots_of_the_characteristic_polynomial() {
        let mut state = 1_u64;
        let mut next = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            (state >> 33) as f64 / (1_u64 << 31) as f64 - 0.5
        };
        for n in 1..9 {
            for _ in 0..20 {
                let scales: Vec<f64> = (0..n).map(|_| 10.0_f64.powf(6.0 * next())).collect();
                let plain: Vec<Complex64> =
                    (0..n * n).map(|_| Complex64::new(next(), next())).collect();
                let scaled = |k: usize| plain[k] * (scales[k / n] / scales[k % n]);
                let values = complex_eigenvalues((0..n * n).map(scaled).collect(), n);
                for value in values {
                    let off =
                        |k: usize| plain[k] - if k / n == k % n { value } else { Complex64::ZERO };
                    let form = Square { n, entries: (0..n * n).map(off).collect() };
                    // Roundings of entries below 1, in simple eigenvalues.
                    assert!(determinant(form).norm() < 1e-12, "{n} {value}");
                }
            }
        }
    }

    fn determinant(mut form: Square) -> Complex64 {
        let n = form.n;
        for k in 0..n {
            for i in (k + 1..n).rev() {
                let rotation = Rotation::onto_first(form.at(i - 1, k), form.at(i, k));
                form.rotate_rows(rotation, i - 1, 0..n);
            }
        }
        (0..n).map(|k| form.at(k, k)).product()
    }
}
