//! The exponential of a matrix.

use crate::Matrix;

/// `exp(a)`, by Taylor's series of a small part, squared as often as necessary.
pub fn exponential(a: &Matrix) -> Matrix {
    // A part of norm below ½ has terms that fall by a half and a factorial: 2⁻²⁰/20! is 4·10⁻²⁵.
    const TERMS: u32 = 20;
    let halvings = halvings(a.row_sum_norm());
    let small = a.scaled(2.0_f64.powi(-halvings));
    let unit = Matrix::identity(a.rows());
    // Horner's rule: 1 + s(1 + s/2(1 + s/3(…))).
    let mut sum = unit.clone();
    for k in (1..=TERMS).rev() {
        sum = &small * &sum;
        for (x, unit) in sum.entries_mut().iter_mut().zip(unit.entries()) {
            *x = *x / f64::from(k) + unit;
        }
    }
    (0..halvings).fold(sum, |power, _| &power * &power)
}

/// How often a matrix of this norm is halved until its norm is below ½.
pub(crate) fn halvings(norm: f64) -> i32 {
    if norm > 0.5 { (norm.log2().ceil() as i32 + 1).clamp(0, 1000) } else { 0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn of_a_rotation_it_turns_and_of_a_shear_it_adds() {
        let turn = Matrix::from_rows(&[[0.0, -3.0], [3.0, 0.0]]).unwrap();
        let (sine, cosine) = 3.0_f64.sin_cos();
        for (found, wanted) in
            exponential(&turn).entries().iter().zip([cosine, -sine, sine, cosine])
        {
            // Four squarings double what rounding leaves of numbers below one.
            assert!((found - wanted).abs() < 1e-14, "{found} {wanted}");
        }
        let shear = Matrix::from_rows(&[[0.0, 7.0], [0.0, 0.0]]).unwrap();
        assert_eq!(exponential(&shear).entries(), [1.0, 7.0, 0.0, 1.0]);
    }
}
