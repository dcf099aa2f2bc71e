//! The exponential of a matrix.

use crate::Matrix;

/// `exp(a)`, by Taylor's series of a small part, squared as often as necessary.
///
/// What is squared is `E = exp − 1`, as `(1 + E)² = 1 + (2E + E²)`: in the square of `1 + E` a slow mode of a stiff matrix would lose the
/// digits of its small rate beside 1, and each squaring would double the loss.
pub fn exponential(a: &Matrix) -> Matrix {
    // A part of norm below ½ has terms that fall by a half and a factorial: 2⁻²⁰/20! is 4·10⁻²⁵.
    const TERMS: u32 = 20;
    let halvings = halvings(a.row_sum_norm());
    let small = a.scaled(2.0_f64.powi(-halvings));
    let unit = Matrix::identity(a.rows());
    // Horner's rule: s(1 + s/2(1 + s/3(…))).
    let mut sum = unit.clone();
    for k in (2..=TERMS).rev() {
        sum = &small * &sum;
        for (x, unit) in sum.entries_mut().iter_mut().zip(unit.entries()) {
            *x = *x / f64::from(k) + unit;
        }
    }
    let grown = (0..halvings).fold(&small * &sum, |grown, _| twice(&grown));
    unit.plus(&grown)
}

/// `exp(2a) − 1` of `exp(a) − 1`.
pub(crate) fn twice(grown: &Matrix) -> Matrix {
    let mut double = grown * grown;
    double.add_scaled(2.0, grown);
    double
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

    #[test]
    fn beside_a_rate_ten_orders_faster_a_slow_mode_keeps_its_digits() {
        // 34 squarings of numbers near 1 would lose ten digits.
        let stiff = Matrix::from_rows(&[[-0.01, 1.0], [0.0, -1e10]]).unwrap();
        let found = exponential(&stiff);
        let slow = (-0.01_f64).exp();
        assert!((found[(0, 0)] / slow - 1.0).abs() < 1e-15, "{}", found[(0, 0)]);
        // (e^{−0.01} − e^{−10¹⁰})/(10¹⁰ − 0.01); some roundings.
        let through = slow / (1e10 - 0.01);
        assert!((found[(0, 1)] / through - 1.0).abs() < 1e-14, "{} {through}", found[(0, 1)]);
    }
}
