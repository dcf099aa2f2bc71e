//! The growth of motions in exact steps, and steps that are too long for them.

use core::f64::consts::PI;

use libration::Method;
use libration_analyze::analyze;

use super::requests::request;

#[test]
fn the_growth_of_an_exact_step_is_that_of_the_linearised_equations() {
    let growth = |system: &str, q: &[f64], v: &[f64]| {
        let answer = analyze(&request(system, Method::Rk4, 0.01, q, v)).unwrap();
        answer.matrix.as_ref().unwrap().flow_spectral_radius_minus_one
    };
    // Beyond a right angle a pendulum falls at √(−ω² cos q), with ω² = 9.81.
    let rate = (-9.81 * 2.5_f64.cos()).sqrt();
    let falls = growth("pendulum", &[2.5], &[0.0]);
    assert!((falls / (0.01 * rate).exp_m1() - 1.0).abs() < 1e-14, "{falls}");
    // The tide of a centre stretches at √(2μ/r³) along the radius.
    let stretches = growth("kepler", &[0.5, 0.0], &[0.0, 1.0]);
    assert!((stretches / 0.04_f64.exp_m1() - 1.0).abs() < 1e-14, "{stretches}");
    // At rest a pendulum swings without growth, and friction damps at γ/2 = 0.1/s.
    assert_eq!(growth("pendulum", &[0.0], &[0.0]), 0.0);
    let damps = growth("damped-oscillator", &[1.0], &[0.0]);
    assert!((damps / (-0.001_f64).exp_m1() - 1.0).abs() < 1e-14, "{damps}");
}

#[test]
fn steps_beyond_the_digits_of_an_angle_have_no_phase_error() {
    for dt in [1e15, 1e60, 1e150] {
        let found = analyze(&request("oscillator", Method::Rk4, dt, &[1.0], &[0.0])).unwrap();
        assert!(
            found
                .matrix
                .as_ref()
                .unwrap()
                .phase_error_per_step
                .is_none_or(|error| error.abs() <= PI),
            "{dt}"
        );
    }
    let found = analyze(&request("oscillator", Method::Rk4, 1e60, &[1.0], &[0.0])).unwrap();
    assert!(found.matrix.as_ref().unwrap().loses_oscillation);
    let close = analyze(&request("oscillator", Method::Rk4, 0.1, &[1.0], &[0.0])).unwrap();
    assert!(
        !close.matrix.as_ref().unwrap().loses_oscillation
            && close.matrix.as_ref().unwrap().phase_error_per_step.is_some()
    );
}
