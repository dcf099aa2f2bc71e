//! The eigenvalues of a matrix of any size, in 1024 bits.
//!
//! Characteristic polynomial by Faddeev and LeVerrier, roots by Weierstrass' simultaneous iteration
//! (Durand–Kerner). In floats that would be a poor way; with 1024 bits a few hundred are left
//! after it for matrices as small as those of a time step.

use libration_core::Scalar;
use libration_core::number::Wide;

use super::{Complex, LinearMap};

/// Sweeps of the iteration. A double root gains one bit a sweep, a simple one doubles its bits.
const SWEEPS: usize = 400;

/// Corrections below `2^-SETTLED` of the largest root end the iteration.
const SETTLED: i64 = 600;

/// All eigenvalues of `matrix`, multiple ones repeated, by falling real part.
pub fn eigenvalues(matrix: &LinearMap) -> Vec<Complex> {
    let mut roots = roots(&characteristic_polynomial(&matrix.rows()));
    roots.sort_by(|a, b| b.re.partial_cmp(&a.re).unwrap_or(core::cmp::Ordering::Equal));
    roots
}

/// The determinant of `matrix`.
pub fn determinant(matrix: &LinearMap) -> Wide {
    // The dimension 2D is even, so the constant term carries the sign of the determinant.
    characteristic_polynomial(&matrix.rows())[0]
}

/// The largest absolute value among the roots of the monic polynomial with these lower coefficients.
pub(super) fn largest_root(coefficients: &[Wide]) -> Wide {
    let sizes = roots(coefficients).into_iter().map(Complex::abs);
    sizes.fold(Wide::ZERO, |a, b| if a > b { a } else { b })
}

/// The coefficients of `det(λ − A)` from the constant term up; the leading 1 is left out.
pub(super) fn characteristic_polynomial(a: &[Vec<Wide>]) -> Vec<Wide> {
    let n = a.len();
    let mut coefficients = vec![Wide::one(); n + 1];
    let mut m = vec![vec![Wide::ZERO; n]; n];
    let moved = |m: &[Vec<Wide>], i: usize, j: usize| {
        (0..n).fold(Wide::ZERO, |sum, k| sum + a[i][k] * m[k][j])
    };
    for k in 1..=n {
        let c = coefficients[n + 1 - k];
        let next = |i: usize, j: usize| moved(&m, i, j) + if i == j { c } else { Wide::ZERO };
        m = (0..n).map(|i| (0..n).map(|j| next(i, j)).collect()).collect();
        let trace = (0..n).fold(Wide::ZERO, |sum, i| sum + moved(&m, i, i));
        coefficients[n - k] = -trace.ratio(1, k as i32);
    }
    coefficients.pop();
    coefficients
}

/// The roots of the monic polynomial with these lower coefficients.
pub(super) fn roots(coefficients: &[Wide]) -> Vec<Complex> {
    let real = |re| Complex { re, im: Wide::ZERO };
    let value = |z: Complex| {
        coefficients.iter().rev().fold(real(Wide::one()), |sum, &c| sum.times(z).plus(real(c)))
    };
    // Cauchy's bound on the roots; the seed is on no axis of symmetry of a real polynomial.
    let bound = coefficients.iter().fold(Wide::one(), |sum, c| sum + c.abs());
    let seed = Complex { re: Wide::from_f64(0.4), im: Wide::from_f64(0.9) };
    let mut power = real(bound);
    let mut roots: Vec<Complex> = Vec::with_capacity(coefficients.len());
    for _ in coefficients {
        power = power.times(seed);
        roots.push(power);
    }
    for _ in 0..SWEEPS {
        let mut largest = Wide::ZERO;
        for i in 0..roots.len() {
            let others = roots.iter().enumerate().filter(|(j, _)| *j != i);
            let product =
                others.fold(real(Wide::one()), |product, (_, &r)| product.times(roots[i].minus(r)));
            if product.abs().is_zero() {
                continue;
            }
            let correction = value(roots[i]).over(product);
            roots[i] = roots[i].minus(correction);
            if correction.abs() > largest {
                largest = correction.abs();
            }
        }
        let scale =
            roots.iter().map(|r| r.abs()).fold(Wide::ZERO, |a, b| if a > b { a } else { b });
        match (largest.exponent(), scale.exponent()) {
            (Some(change), Some(scale)) if change >= scale - SETTLED => {}
            _ => break,
        }
    }
    roots
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rotation_with_a_shear_has_its_four_eigenvalues() {
        // q₀, v₀ rotate by 0.3 rad and shrink by 0.9; q₁, v₁ shear: eigenvalue 1, twice, defective.
        let (s, c) = Wide::from_f64(0.3).sin_cos();
        let factor = Wide::from_f64(0.9);
        let (zero, one) = (Wide::ZERO, Wide::one());
        let matrix = LinearMap::of_rows(&[
            vec![factor * c, zero, factor * s, zero],
            vec![zero, one, zero, one],
            vec![-factor * s, zero, factor * c, zero],
            vec![zero, zero, zero, one],
        ]);
        let found = eigenvalues(&matrix);
        assert!((determinant(&matrix) - factor * factor).abs().to_f64() < 1e-290);
        // One bit a sweep for the double root: 2⁻⁴⁰⁰ is 10⁻¹²⁰, and rounding stops it earlier.
        for one in &found[..2] {
            assert!((one.re - Wide::one()).abs().to_f64() < 1e-60, "{one:?}");
        }
        for turn in &found[2..] {
            assert!((turn.abs() - factor).abs().to_f64() < 1e-150, "{turn:?}");
            assert!((turn.arg().abs() - Wide::from_f64(0.3)).abs().to_f64() < 1e-150, "{turn:?}");
        }
    }

    #[test]
    fn a_matrix_of_zeros_has_the_eigenvalue_zero() {
        let zero = LinearMap::of_rows(&vec![vec![Wide::ZERO; 4]; 4]);
        assert!(eigenvalues(&zero).iter().all(|z| z.abs().to_f64() < 1e-60));
    }
}
