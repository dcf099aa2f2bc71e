//! The exponential of a matrix.

use crate::Matrix;

/// `exp(a)`, by Taylor's series of a small part, squared as often as necessary.
///
/// What is squared is `E = exp − 1`, as `(1 + E)² = 1 + (2E + E²)`: in the square of `1 + E` a slow mode of a stiff matrix would lose the
/// digits of its small rate beside 1, and each squaring would double the loss.
pub fn exponential(a: &Matrix) -> Matrix {
    // A part of norm below ½ has terms that fall by a half and a factorial: 2⁻²⁰/20! is 4·10⁻²⁵.
    let halvings = halvings(a.row_sum_norm());
    let small = a.scaled(2.0_f64.powi(-halvings));
    let unit = Matrix::identity(a.rows());
    // In blocks of five powers, seven products for twenty terms (M. S. Paterson, L. J. Stockmeyer, SIAM Journal on Computing 2, 1973).
    let second = &small * &small;
    let third = &small * &second;
    let fourth = &small * &third;
    let fifth = &small * &fourth;
    let inverse_factorial = |k: u32| (1..=k).fold(1.0, |share, i| share / f64::from(i));
    // Terms `first` to `first + 4` of (exp(s) − 1)/s, without s^first.
    let block = |first: u32| {
        let mut sum = unit.scaled(inverse_factorial(first + 1));
        for (k, power) in (2..).zip([&small, &second, &third, &fourth]) {
            sum.add_scaled(inverse_factorial(first + k), power);
        }
        sum
    };
    let sum = [10, 5, 0].into_iter().fold(block(15), |sum, first| {
        let mut higher = &fifth * &sum;
        higher.add_scaled(1.0, &block(first));
        higher
    });
    let grown = (0..halvings).fold(&small * &sum, |grown, _| twice(&grown));
    unit.plus(&grown)
}

/// The change of `exp(a)`, relative to its largest entry, if entries of `a` change by a unit of rounding: the largest of three patterns.
///
/// It is about the unit of rounding, unless `a` is stiff and dense: where an entry is a sum of motions of very different rates, the slow
/// ones lose digits beside the fast ones.
pub fn exponential_rounding(a: &Matrix) -> f64 {
    let own = exponential(a);
    let change = |pattern: usize| {
        let moved = Matrix::from_fn(a.rows(), a.columns(), |i, j| {
            let up = (5 * i + 3 * j + pattern) % 7 < 3;
            a[(i, j)] * if up { 1.0 + f64::EPSILON } else { 1.0 - f64::EPSILON }
        });
        let moved = exponential(&moved);
        let off = own.entries().iter().zip(moved.entries()).map(|(x, y)| (x - y).abs());
        off.fold(0.0, f64::max)
    };
    (0..3).map(change).fold(0.0, f64::max) / own.largest()
}

/// `exp(2a) − 1` of `exp(a) − 1`.
pub(crate) fn twice(grown: &Matrix) -> Matrix {
    let mut double = grown * grown;
    double.add_scaled(2.0, grown);
    double
}

/// How often a matrix of this norm is halved until its norm is below ½.
pub(crate) fn halvings(norm: f64) -> i32 {
    if norm > 0.5 { (norm.log2().ceil() as i32).saturating_add(1).clamp(0, 1000) } else { 0 }
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
        // 35 squarings of numbers near 1 would lose ten digits.
        let stiff = Matrix::from_rows(&[[-0.01, 1.0], [0.0, -1e10]]).unwrap();
        let found = exponential(&stiff);
        let slow = (-0.01_f64).exp();
        assert!((found[(0, 0)] / slow - 1.0).abs() < 1e-15, "{}", found[(0, 0)]);
        // (e^{−0.01} − e^{−10¹⁰})/(10¹⁰ − 0.01); some roundings.
        let through = slow / (1e10 - 0.01);
        assert!((found[(0, 1)] / through - 1.0).abs() < 1e-14, "{} {through}", found[(0, 1)]);
        assert!(exponential_rounding(&stiff) < 1e-15);
    }

    #[test]
    fn the_digits_that_a_dense_stiff_matrix_loses_are_told() {
        // With the eigenvectors (1, 1) and (1, −2), the exponential is ⅓[2s + f, s − f; 2s − 2f, s + 2f] of slow and fast.
        let mixed = |slow: f64, fast: f64| {
            let rows =
                [[2.0 * slow + fast, slow - fast], [2.0 * slow - 2.0 * fast, slow + 2.0 * fast]];
            Matrix::from_rows(&rows).unwrap().scaled(1.0 / 3.0)
        };
        for rate in [3e3, 3e6, 3e9] {
            let a = mixed(-1.5, -rate);
            let wanted = mixed((-1.5_f64).exp(), (-rate).exp());
            let found = exponential(&a);
            let off = found.entries().iter().zip(wanted.entries()).map(|(x, y)| (x - y).abs());
            let off = off.fold(0.0, f64::max) / wanted.largest();
            let told = exponential_rounding(&a);
            // The entries of `a` are rounded themselves, often by less than a unit: a unit of the fast rate reaches the slow one.
            let unit = f64::EPSILON * rate;
            assert!(
                off < told && (0.1 * unit..10.0 * unit).contains(&told),
                "{rate:e}: {off:e} {told:e}"
            );
        }
    }
}
