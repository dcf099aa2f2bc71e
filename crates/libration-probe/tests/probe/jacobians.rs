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
fn a_kink_of_a_function_that_saturates_nearby_has_an_error_of_its_size() {
    // The slopes are 0 and 1 on both sides: half of the difference.
    for width in [1e-4, 4.6e-4, 1e-3, 1e-2, 1.0] {
        let found = of(|z| vec![z[0].clamp(0.0, width)], &[0.0], &[1.0]);
        assert!(found.errors[(0, 0)] >= 0.5, "{width} {found:?}");
    }
}

#[test]
fn points_at_which_the_function_is_not_finite_are_left_out() {
    let found = of(|z| vec![z[0].sqrt()], &[0.01], &[1.0]);
    assert!((found.values[(0, 0)] - 5.0).abs() <= found.errors[(0, 0)], "{found:?}");
    assert!(found.errors[(0, 0)] < 1e-9, "{found:?}");
}

/// A slope of −0.9 at zero, and of −1 beyond a width.
fn bent(name: &str, x: f64, width: f64) -> f64 {
    let part = match name {
        "compact" => (1.0 - (x / width).abs()).max(0.0).powi(2) * x,
        "quartic" => (1.0 - (x / width).powi(2)).max(0.0).powi(2) * x,
        "gauss" => (-(x / width).powi(2)).exp() * x,
        "tanh" => width * (x / width).tanh(),
        "rational" => x / (1.0 + (x / width).powi(4)),
        _ => width * (x / width).clamp(-1.0, 1.0),
    };
    0.1 * part - x
}

#[test]
fn differences_become_shorter_until_a_bend_near_the_point_is_resolved() {
    for name in ["compact", "quartic", "gauss", "tanh", "rational", "clamp"] {
        for width in [3e-2, 3e-3, 3e-4] {
            let found = of(|z| vec![bent(name, z[0], width)], &[0.0], &[1.0]);
            let (value, error) = (found.values[(0, 0)], found.errors[(0, 0)]);
            assert!((value + 0.9).abs() <= error.max(1e-14), "{name} {width}: {value} {error}");
            // The second derivative of `compact` jumps: its differences fall with the step only, to 2⁻³² of the scale beside a width.
            assert!(error < 1e-5, "{name} {width}: {value} {error}");
        }
    }
}

#[test]
fn a_bend_is_resolved_beside_noise_as_that_of_a_solver() {
    let hash = |x: f64| {
        let bits = x.to_bits().wrapping_mul(0x9E37_79B9_7F4A_7C15).rotate_left(31);
        (bits.wrapping_mul(0xD6E8_FEB8_6659_FD93) >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
    };
    for name in ["compact", "gauss", "tanh", "rational"] {
        let noisy = |z: &[f64]| vec![bent(name, z[0], 3e-3) + 1e-10 * hash(z[0])];
        let found = of(noisy, &[0.0], &[1.0]);
        // Noise of 10⁻¹⁰ over a part of the width of 3·10⁻³.
        assert!((found.values[(0, 0)] + 0.9).abs() < 1e-3, "{name}: {found:?}");
        assert!(found.errors[(0, 0)] < 9e-3, "{name}: {found:?}");
    }
}

#[test]
fn noise_that_close_points_do_not_show_does_not_contradict_long_steps() {
    let hash = |x: f64| {
        let bits = (x * 2.0_f64.powi(30)).round().to_bits().wrapping_mul(0x9E37_79B9_7F4A_7C15);
        (bits.rotate_left(31).wrapping_mul(0xD6E8_FEB8_6659_FD93) >> 11) as f64
            / (1_u64 << 53) as f64
            - 0.5
    };
    for size in [1e-10, 1e-9, 1e-8] {
        for slope in [-0.9, 0.3, 7.0] {
            let found = of(|z| vec![slope * z[0] + size * hash(z[0])], &[0.1], &[1.0]);
            // Some differences of the noise over steps of 1/16 to 1/1024.
            let error = (found.values[(0, 0)] - slope).abs();
            assert!(error < 1e4 * size, "{size} {slope}: {found:?}");
        }
    }
}

#[test]
fn the_dead_zone_of_a_solver_at_its_warm_start_is_no_derivative() {
    // A solver that returns its warm start for changes below a part of the scale.
    for (zone, slope) in [(2e-7, 0.3), (1e-8, -0.9), (3e-7, 5.0)] {
        let dead = |x: f64| if x.abs() < zone { 0.5 * slope * x } else { slope * x };
        let found = of(|z| vec![dead(z[0]), 3.0 * z[0]], &[0.0], &[1.0]);
        assert!((found.values[(0, 0)] - slope).abs() < 1e-9, "{zone} {slope}: {found:?}");
        // Also in a column that has another entry with a bend.
        let bends = |z: &[f64]| vec![dead(z[0]), bent("compact", z[0], 3e-4)];
        let found = of(bends, &[0.0], &[1.0]);
        assert!((found.values[(0, 0)] - slope).abs() < 1e-9, "{zone} {slope}: {found:?}");
    }
}
