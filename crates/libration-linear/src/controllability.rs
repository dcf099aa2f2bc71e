//! How far a plant is from one whose inputs do not reach a mode, independent of the units of states and inputs.

use num_complex::Complex64;

use crate::eigenvector::size_of;
use crate::hessenberg::balance;
use crate::{Matrix, eigenvector};

/// A pair of matrices `A` and `B` in balanced coordinates.
///
/// Balancing and the scales of inputs are powers of two, so that they round nothing.
pub(crate) struct BalancedPair {
    a: Matrix,
    b: Matrix,
}

/// Controllability from which no other right inverse is tried.
const CLEAR: f64 = 1e-3;

/// Powers of the sizes of a mode's coordinates that weight its right inverses. Those of a mode that is far from the inputs, such as the
/// fast one behind a chain of lags, are largest where the mode is smallest.
const POWERS: [f64; 2] = [-0.5, -1.0];

/// Passes of the power method, which give the size of a positive matrix to a few per cent.
const PASSES: u32 = 30;

impl BalancedPair {
    pub(crate) fn new(a: &Matrix, b: &Matrix) -> Self {
        let mut balanced = a.clone();
        let scales = balance(&mut balanced);
        let mut driven = Matrix::from_fn(b.rows(), b.columns(), |i, k| b[(i, k)] / scales[i]);
        let size = size_of(&balanced);
        for k in 0..driven.columns() {
            let most = (0..driven.rows()).map(|i| driven[(i, k)].abs()).fold(0.0, f64::max);
            let factor = (size / most).log2().round().exp2();
            if factor.is_finite() && factor > 0.0 {
                (0..driven.rows()).for_each(|i| driven[(i, k)] *= factor);
            }
        }
        BalancedPair { a: balanced, b: driven }
    }

    /// A bound of the relative change of the entries of `A` and `B`, and of the eigenvalue, below which inputs reach all motions with
    /// this eigenvalue; from 0 to 1.
    ///
    /// By the test of Popov, Belevitch and Hautus they do where `M = [λ − A, B]` has full rank. Any right inverse `X` of `M` shows that no
    /// change `|δM| ≤ ε P` with `P = [|λ| + |A|, |B|]` takes that rank while `ε` is below the inverse of the spectral radius of `P |X|`
    /// (J. Rohn, *Systems of linear interval equations*, Linear Algebra and its Applications 126, 1989). The radius does not change with
    /// the units of states and inputs, unlike a singular value.
    pub(crate) fn controllability(&self, value: Complex64) -> f64 {
        let plain = self.bound(value, &vec![1.0; self.a.rows()]);
        if plain >= CLEAR || self.b.columns() == 0 {
            return plain;
        }
        let Some(shape) = eigenvector(&self.a, value) else { return plain };
        let weighted = POWERS.map(|power| {
            let sizes = shape.iter().map(|x| x.norm().max(f64::EPSILON).powf(power));
            self.bound(value, &sizes.collect::<Vec<_>>())
        });
        weighted.into_iter().fold(plain, f64::max)
    }

    /// The bound by the right inverse that is smallest with these weights of the states.
    fn bound(&self, value: Complex64, weights: &[f64]) -> f64 {
        let (n, m) = (self.a.rows(), self.b.columns());
        let entry = |i: usize, j: usize| match j.checked_sub(n) {
            None => (if i == j { value } else { Complex64::ZERO }) - self.a[(i, j)],
            Some(k) => Complex64::from(self.b[(i, k)]),
        };
        let size = |i: usize, j: usize| match j.checked_sub(n) {
            None => self.a[(i, j)].abs() + if i == j { value.norm() } else { 0.0 },
            Some(k) => self.b[(i, k)].abs(),
        };
        let weight = |j: usize| weights.get(j).copied().unwrap_or(1.0);
        let rows: Vec<Vec<Complex64>> =
            (0..n).map(|i| (0..n + m).map(|j| entry(i, j).conj() * weight(j)).collect()).collect();
        let Some(mut inverse) = right_inverse(rows) else { return 0.0 };
        inverse
            .iter_mut()
            .for_each(|x| x.iter_mut().enumerate().for_each(|(j, x)| *x *= weight(j)));
        // A right inverse to rounding: badly weighted equations may lose it.
        let residual = Matrix::from_fn(n, n, |i, k| {
            let product: Complex64 = (0..n + m).map(|j| entry(i, j) * inverse[k][j]).sum();
            (product - if i == k { 1.0 } else { 0.0 }).norm()
        });
        let moved = Matrix::from_fn(n, n, |i, k| {
            (0..n + m).map(|j| size(i, j) * inverse[k][j].norm()).sum()
        });
        let (off, radius) = (positive_radius(&residual), positive_radius(&moved));
        match off < 0.5 && radius.is_finite() {
            true => (1.0 - off) / radius,
            false => 0.0,
        }
    }
}

/// The columns of the least right inverse of the matrix whose rows have these conjugates, by orthogonal rows; none if they depend on each
/// other.
#[allow(clippy::needless_range_loop, reason = "an index of rows and of columns")]
fn right_inverse(mut rows: Vec<Vec<Complex64>>) -> Option<Vec<Vec<Complex64>>> {
    let n = rows.len();
    let norm = |x: &[Complex64]| x.iter().map(|x| x.norm_sqr()).sum::<f64>().sqrt();
    let mut triangle = vec![vec![Complex64::ZERO; n]; n];
    for k in 0..n {
        let (done, rest) = rows.split_at_mut(k);
        let row = &mut rest[0];
        // Twice is enough: what cancels in the first pass leaves roundings (L. Giraud, J. Langou, 2002).
        for _ in 0..2 {
            for (before, q) in done.iter().enumerate() {
                let part: Complex64 = q.iter().zip(&*row).map(|(q, x)| q.conj() * x).sum();
                row.iter_mut().zip(q).for_each(|(x, q)| *x -= part * q);
                triangle[before][k] += part;
            }
        }
        let size = norm(row);
        if !(size.is_finite() && size > 0.0) {
            return None;
        }
        triangle[k][k] = Complex64::from(size);
        row.iter_mut().for_each(|x| *x /= size);
    }
    // Mᴴ = Q R, so that X = Q R⁻ᴴ: the columns of R⁻ᴴ by substitution downwards.
    let column = |k: usize| {
        let mut y = vec![Complex64::ZERO; n];
        for i in k..n {
            let known: Complex64 = (k..i).map(|j| triangle[j][i].conj() * y[j]).sum();
            let own = if i == k { Complex64::ONE } else { Complex64::ZERO };
            y[i] = (own - known) / triangle[i][i].conj();
        }
        let mut x = vec![Complex64::ZERO; rows[0].len()];
        for (y, q) in y.iter().zip(&rows) {
            x.iter_mut().zip(q).for_each(|(x, q)| *x += y * q);
        }
        x
    };
    Some((0..n).map(column).collect())
}

/// The spectral radius of a matrix without negative entries, from above, by the power method (L. Collatz, 1942).
fn positive_radius(matrix: &Matrix) -> f64 {
    let mut x = vec![1.0; matrix.rows()];
    let mut radius = f64::INFINITY;
    for _ in 0..PASSES {
        let next = matrix.apply(&x);
        let ratio = next.iter().zip(&x).map(|(next, x)| next / x).fold(0.0, f64::max);
        if ratio.is_nan() {
            return f64::INFINITY;
        }
        radius = radius.min(ratio);
        let most = next.iter().copied().fold(0.0, f64::max);
        if most == 0.0 {
            return 0.0;
        }
        // Off zero, so that each ratio is a bound.
        x = next.iter().map(|next| (next / most).max(f64::MIN_POSITIVE.sqrt())).collect();
    }
    radius
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{LinearPlant, ModeDetails};

    fn transfer(numerator: &[f64], denominator: &[f64]) -> Vec<ModeDetails> {
        let plant = LinearPlant::from_transfer_functions(
            &[vec![numerator.to_vec()]],
            &[vec![denominator.to_vec()]],
        );
        plant.unwrap().mode_details()
    }

    /// The polynomial with these roots.
    fn polynomial(roots: &[f64]) -> Vec<f64> {
        let mut coefficients = vec![1.0];
        for root in roots {
            coefficients.push(0.0);
            (1..coefficients.len())
                .rev()
                .for_each(|i| coefficients[i] -= root * coefficients[i - 1]);
        }
        coefficients
    }

    /// A numerator of degree 0 cancels no pole, so that each mode is reached and shown, however far poles are apart.
    #[test]
    fn all_modes_of_a_transfer_function_without_zeros_are_reached_and_shown() {
        let decades = |poles: u32, decades: f64| {
            let pole = |k| -10.0_f64.powf(decades * f64::from(k) / f64::from(poles - 1));
            polynomial(&(0..poles).map(pole).collect::<Vec<_>>())
        };
        for denominator in [
            vec![1.0, 1e4, 1e6, 1e6],
            vec![1.0, 1e3, 1e6, 1e9, 1e10],
            decades(5, 4.0),
            decades(4, 6.0),
            decades(3, 9.0),
            decades(7, 3.0),
            vec![1e-12, 1e-6, 1e-2, 1.0],
            vec![1.0, 0.0, 1e12, 1e3],
            polynomial(&[-1e-3, -2e-3, -5e5]),
        ] {
            for mode in transfer(&[1.0], &denominator) {
                // Below 1e-6 a mode counts as weakly controllable or observable.
                assert!(
                    mode.controllability > 1e-6 && mode.observability > 1e-6,
                    "{denominator:?}: {mode:?}"
                );
            }
        }
    }

    #[test]
    fn a_motor_whose_current_is_fast_shows_each_mode_in_its_angle() {
        let (j, b, k, r, l) = (3.2284e-6, 3.5077e-6, 0.0274, 4.0, 2.75e-6);
        let a = [[0.0, 1.0, 0.0], [0.0, -b / j, k / j], [0.0, -k / l, -r / l]];
        let a = Matrix::from_rows(&a).unwrap();
        let b = Matrix::from_rows(&[[0.0], [0.0], [1.0 / l]]).unwrap();
        let c = Matrix::from_rows(&[[1.0, 0.0, 0.0]]).unwrap();
        let plant = LinearPlant::new(a, b, c, Matrix::zeros(1, 1)).unwrap();
        for mode in plant.mode_details() {
            assert!(mode.controllability > 1e-2 && mode.observability > 1e-2, "{mode:?}");
        }
    }

    /// A zero beside a pole by the relative part `δ` is cancelled by a change of its coefficients of about that size.
    #[test]
    fn a_zero_beside_a_pole_hides_its_mode_by_the_distance_between_them() {
        let poles = polynomial(&[-1.0, -2.0, -300.0]);
        for distance in [1e-2, 1e-4, 1e-6, 1e-8, 1e-10] {
            let modes = transfer(&polynomial(&[-1.0 - distance, -5.0]), &poles);
            let ratio = modes[0].observability / distance;
            assert!((0.05..2.0).contains(&ratio), "{distance}: {modes:?}");
            assert!(modes[0].is_observable(), "{distance}: {modes:?}");
            assert_eq!(modes[0].is_weakly_observable(), distance < 1e-5, "{distance}: {modes:?}");
            assert!(modes[1].observability > 1e-2, "{modes:?}");
        }
        let modes = transfer(&polynomial(&[-1.0, -5.0]), &poles);
        assert!(!modes[0].is_observable() && modes[0].is_controllable(), "{modes:?}");
    }

    #[test]
    fn units_of_states_and_inputs_do_not_change_what_is_reached() {
        let a =
            Matrix::from_rows(&[[0.0, 1.0, 0.0], [-4.0, -0.4, 2.0], [0.0, 0.0, -30.0]]).unwrap();
        let b = Matrix::from_rows(&[[0.0], [0.0], [30.0]]).unwrap();
        let units = [1e-9, 1e3, 1e6];
        let other = Matrix::from_fn(3, 3, |i, j| a[(i, j)] * units[i] / units[j]);
        let driven = Matrix::from_fn(3, 1, |i, _| 1e-7 * b[(i, 0)] * units[i]);
        for value in [Complex64::new(-0.2, 3.96_f64.sqrt()), Complex64::from(-30.0)] {
            let [plain, scaled] = [(&a, &b), (&other, &driven)]
                .map(|(a, b)| BalancedPair::new(a, b).controllability(value));
            // Powers of two balance to within a factor of two.
            assert!(plain > 0.1 && (0.25..4.0).contains(&(scaled / plain)), "{plain} {scaled}");
        }
    }
}
