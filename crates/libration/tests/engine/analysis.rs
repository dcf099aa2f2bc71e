//! The analysis of the shipped steps, against a 60-digit oracle.
//!
//! `../reference/oracle.json` was computed with mpmath from textbook matrices; its time steps are the
//! decimals written, ours the nearest doubles, which differ by at most a part in 10¹⁶.

use libration::analysis::{
    Linearisation, Spectrum, SymbolicStep, UpdateMatrix, drift_keeps_within, forecast_drift,
};
use libration::equations::{Dynamics, StepProgram};
use libration::number::Wide;
use libration::system::Oscillator;
use libration::{Elementary, Method, Scalar, State, with_method};
use serde_json::Value;

/// Digits that must agree. The parameters agree to 10⁻¹⁶; a drift after 10⁶ growing steps of
/// z² = 4 magnifies that by at most n·z²/(1 + z²) < 10⁶, and hence to 10⁻¹⁰ there.
const DIGITS: f64 = 1e-12;

fn oracle() -> Value {
    serde_json::from_str(include_str!("../reference/oracle.json")).unwrap()
}

fn number(value: &Value) -> f64 {
    match value {
        Value::String(s) => s.parse().unwrap(),
        other => other.as_f64().unwrap(),
    }
}

fn method(name: &str) -> Method {
    match name {
        "explicit_euler" => Method::ExplicitEuler,
        "semi_implicit_euler" => Method::SymplecticEuler,
        "semi_implicit_euler_drift_first" => Method::SymplecticEulerDriftFirst,
        "velocity_verlet" => Method::VelocityVerlet,
        "rk4" => Method::Rk4,
        other => panic!("no method {other}"),
    }
}

#[track_caller]
fn close(got: f64, want: f64, what: &str) {
    let scale = want.abs().max(f64::MIN_POSITIVE);
    assert!(got == want || (got - want).abs() <= DIGITS * scale, "{what}: {got:e}, not {want:e}");
}

/// Every case of the oracle: its label, the method, ω², Δt and the reference values.
fn cases(check: impl Fn(&str, Method, f64, f64, &Value)) {
    let oracle = oracle();
    let mut count = 0;
    for case in oracle["cases"].as_array().unwrap() {
        let (w2, dt) = (number(&case["w2"]), number(&case["dt"]));
        for (name, want) in case["integrators"].as_object().unwrap() {
            check(&format!("{name} at w2 = {w2}, dt = {dt}"), method(name), w2, dt, want);
            count += 1;
        }
    }
    assert_eq!(count, 30);
}

const START: State<f64, 1> = State { q: [1.0], v: [0.0] };

fn linearise(method: Method, omega2: f64, dt: f64) -> UpdateMatrix<Wide> {
    with_method!(method, |m| UpdateMatrix::of_step(m, Oscillator { omega2 }, &START, dt))
}

#[test]
fn update_matrices_spectra_and_defects_meet_the_oracle_to_12_digits() {
    cases(|label, method, w2, dt, want| {
        let it = linearise(method, w2, dt);
        for (i, row) in it.rows().iter().enumerate() {
            for (j, entry) in row.iter().enumerate() {
                close(entry.to_f64(), number(&want["M"][i][j]), &format!("{label} M{i}{j}"));
            }
        }
        let dynamics = Dynamics::of::<1>(&Oscillator { omega2: w2 }, None);
        let step = StepProgram::of(method, &dynamics);
        let by_program = Linearisation::new(&step, &dynamics, &[1.0, 0.0], dt);
        let distance = (0..4).map(|k| (k / 2, k % 2)).fold(0.0_f64, |most, (i, j)| {
            most.max((by_program.step.entry(i, j) - it.entry(i, j)).abs().to_f64())
        });
        // 1024 bits, less the few hundred roundings of one step.
        assert!(distance < 1e-300, "{label}: the program of a step is another map by {distance:e}");
        let spectrum = Spectrum::new(&it);
        close(spectrum.trace.to_f64(), number(&want["trace"]), label);
        close(spectrum.determinant.to_f64(), number(&want["det"]), label);
        close(spectrum.radius().to_f64(), number(&want["spectral_radius"]), label);
        for (got, key) in [
            (spectrum.determinant_minus_one(), "det_minus_1"),
            (spectrum.radius_minus_one(), "spectral_radius_minus_1"),
            (by_program.step.symplecticity_defect(), "MtJM_minus_J_frobenius"),
        ] {
            let (got, want) = (got.to_f64(), number(&want[key]));
            // Zero in the oracle is zero to 48 digits.
            if want == 0.0 { assert!(got < 1e-48, "{label} {key}") } else { close(got, want, key) }
        }
    });
}

#[test]
fn phase_errors_meet_the_oracle_after_a_cancellation_of_12_digits() {
    cases(|label, method, w2, dt, want| {
        let it = linearise(method, w2, dt);
        let exact = Wide::from_f64(w2).sqrt() * Wide::from_f64(dt);
        let phase = Spectrum::new(&it).angle() - exact;
        close(phase.to_f64(), number(&want["phase_error_per_step"]), label);
    });
}

#[test]
fn drifts_over_a_million_steps_meet_the_oracle_even_where_they_exceed_every_float() {
    cases(|label, method, w2, dt, want| {
        let it = linearise(method, w2, dt);
        let model = Oscillator { omega2: w2 };
        let got = forecast_drift(model, &it, &START, 1_000_000).unwrap();
        let text = want["max_rel_energy_drift_1e6"].as_str().unwrap();
        let (mantissa, exponent) = text.split_once('e').unwrap_or((text, "0"));
        let logarithm = number(&Value::from(mantissa)).log10() + number(&Value::from(exponent));
        if logarithm > 20.0 {
            // ln(1 + z²)·n with z² known to a part in 10¹⁶ leaves 10⁻¹⁵ of the logarithm.
            close(got.drift.log10().to_f64(), logarithm, label);
        } else {
            close(got.drift.to_f64(), number(&Value::from(text)), label);
        }
    });
}

#[test]
fn a_drift_keeps_within_a_limit_exactly_where_its_forecast_does() {
    let model = Oscillator { omega2: 1.0 };
    for method in [Method::ExplicitEuler, Method::SymplecticEuler, Method::VelocityVerlet] {
        for dt in [1e-3, 0.1, 1.3, 2.5] {
            let step = linearise(method, 1.0, dt);
            let drift = forecast_drift(model, &step, &START, 10_000).unwrap().drift.to_f64();
            for part in [1e-3, 0.5, 1.0 - 1e-9, 1.0, 1.0 + 1e-9, 2.0] {
                let limit = drift * part;
                let keeps = drift_keeps_within(model, &step, &START, 10_000, limit);
                let label = format!("{}, dt = {dt}, {part} of the drift", method.name());
                assert_eq!(keeps, Some(drift <= limit), "{label}");
            }
        }
    }
    let step = linearise(Method::VelocityVerlet, 1.0, 0.1);
    let rest = State { q: [0.0], v: [0.0] };
    assert_eq!(drift_keeps_within(model, &step, &rest, 10, 1.0), None, "no energy at the start");
}

#[test]
fn the_largest_drift_of_an_orbit_too_slow_for_a_search_is_found() {
    // (2/z)·drift of symplectic Euler from rest over a quarter turn and more is 1; of Verlet (4/z²).
    let model = Oscillator { omega2: 1.0 };
    for (method, dt, drift) in
        [(Method::SymplecticEuler, 1e-8, 5e-9), (Method::VelocityVerlet, 1e-7, 2.5e-15)]
    {
        let step = linearise(method, 1.0, dt);
        let start = State { q: [1.0], v: [0.0] };
        // Half a turn.
        let got = forecast_drift(model, &step, &start, (3.2 / dt) as u64).unwrap();
        let got = got.drift.to_f64();
        // The next term is a factor 1 + z/2.
        assert!((got / drift - 1.0).abs() < 1e-7, "{}: {got}, not {drift}", method.name());
    }
    // The first extreme of symplectic Euler, after an eighth of a turn, a little beyond the steps that
    // are searched one by one.
    let step = linearise(Method::SymplecticEuler, 1.0, 1.428e-7);
    let start = State { q: [1.0], v: [0.0] };
    let got = forecast_drift(model, &step, &start, 7_000_000).unwrap();
    assert!((got.drift.to_f64() / 0.714e-7 - 1.0).abs() < 1e-6, "{:?}", got.drift.to_f64());
    assert!(got.at_step.abs_diff(5_500_000) < 5_000, "{}", got.at_step);
    // Nearly √2: the orbit goes round its curve in 10⁹ steps, eight points at a time.
    let step = linearise(Method::VelocityVerlet, 1.0, f64::from(141_421_356) * 1e-8);
    let start = State { q: [1.0], v: [0.7] };
    let got = forecast_drift(model, &step, &start, 10_000_000_000).unwrap().drift.to_f64();
    // From powers of the matrix with mpmath.
    assert!((got - 0.335_57).abs() < 1e-5, "{got}");
}

#[test]
fn a_tiny_step_loses_no_digits() {
    // At z = 10⁻¹² RK4 has det M − 1 = −z⁶/72 + z⁸/576 and a phase error of −z⁵/120 + O(z⁷).
    let dt = 1e-12;
    let spectrum = Spectrum::new(&linearise(Method::Rk4, 1.0, dt));
    close(spectrum.determinant_minus_one().to_f64(), -dt.powi(6) / 72.0, "det");
    let phase = spectrum.angle() - Wide::from_f64(dt);
    close(phase.to_f64(), -dt.powi(5) / 120.0, "phase");
}

#[test]
fn every_symbolic_matrix_agrees_with_the_numeric_one() {
    // Two routes through the same step: polynomials in z, and duals with 1024 bits at z = 0.7.
    let z = 0.7;
    for method in Method::ALL {
        let symbolic = with_method!(method, |m| SymbolicStep::new(m)).unwrap();
        let numeric = linearise(method, 1.0, z);
        for (i, row) in symbolic.matrix.rows().iter().enumerate() {
            for (j, entry) in row.iter().enumerate() {
                let difference = entry.eval_wide(Wide::from_f64(z)) - numeric.entry(i, j);
                // 1024 bits, less the few hundred roundings of one step.
                assert!(difference.abs().to_f64() < 1e-300, "{} {i}{j}", method.name());
            }
        }
    }
}

#[test]
fn only_the_euler_and_runge_kutta_methods_change_areas() {
    for method in Method::ALL {
        let determinant = with_method!(method, |m| SymbolicStep::new(m)).unwrap().determinant();
        let text = determinant.to_string();
        match method {
            Method::ExplicitEuler => assert_eq!(text, "1 + z²"),
            Method::Rk4 => assert_eq!(text, "1 − z⁶/72 + z⁸/576"),
            _ => assert_eq!(text, "1", "{}", method.name()),
        }
    }
}
