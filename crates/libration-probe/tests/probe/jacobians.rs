//! Jacobians by differences.

use libration::linear::Matrix;
use libration_probe::{Jacobian, jacobian};

fn of(f: impl Fn(&[f64]) -> Vec<f64>, z: &[f64], scale: &[f64]) -> Jacobian {
    let rows = |points: &Matrix| {
        let values: Vec<Vec<f64>> = (0..points.rows()).map(|i| f(points.row(i))).collect();
        Ok::<_, ()>(Matrix::from_rows(&values).unwrap())
    };
    jacobian(rows, z, scale, 0.0).unwrap()
}

#[test]
fn the_error_of_a_derivative_is_at_most_its_estimate_and_the_estimate_is_small() {
    for x in [0.3, -1.2, 2.9] {
        let found = of(|z| vec![z[0].sin() * z[1].exp()], &[x, 0.2], &[1.0, 1.0]);
        let wanted = [x.cos() * 0.2_f64.exp(), x.sin() * 0.2_f64.exp()];
        for (j, wanted) in wanted.into_iter().enumerate() {
            let error = (found.values[(0, j)] - wanted).abs();
            // Eleven digits: some roundings over a step of 1/256.
            assert!(error <= found.errors[(0, j)] && found.errors[(0, j)] < 1e-11, "{found:?}");
        }
    }
}

#[test]
fn a_kink_and_a_jump_have_an_error_of_their_size() {
    let found = of(|z| vec![z[0].abs(), f64::from(z[0] > 0.0)], &[0.0], &[1.0]);
    assert!(found.errors[(0, 0)] >= 1.0, "{found:?}");
    assert!(found.errors[(1, 0)] >= 1.0, "{found:?}");
}

#[test]
fn points_at_which_the_function_is_not_finite_are_left_out() {
    let found = of(|z| vec![z[0].sqrt()], &[0.01], &[1.0]);
    assert!((found.values[(0, 0)] - 5.0).abs() <= found.errors[(0, 0)], "{found:?}");
    assert!(found.errors[(0, 0)] < 1e-9, "{found:?}");
}
