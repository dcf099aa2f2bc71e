//! Tests of the analysis of one step.

use libration::integrator::VelocityVerlet;
use libration::system::Oscillator;
use libration::{AnySystem, Hamiltonian, Integrator, Method, State};
use libration_analyze::{Analysis, AnalyzeError, Criteria, Request, StepMatrix, analyze};

use super::requests::{at, request};

fn matrix(analysis: &Analysis) -> &StepMatrix {
    analysis.matrix.as_ref().unwrap()
}

fn json(analysis: &Analysis) -> serde_json::Value {
    serde_json::to_value(analysis).unwrap()
}

#[test]
fn the_promised_keys_are_there() {
    let analysis = analyze(&request("oscillator", Method::Rk4, 0.01, &[1.0], &[0.0])).unwrap();
    let json = json(&analysis);
    for key in [
        "update_matrix",
        "determinant",
        "trace",
        "eigenvalues",
        "spectral_radius",
        "symplecticity_defect",
        "reversibility_defect",
        "phase_error_per_step",
        "max_energy_drift",
    ] {
        assert!(!json[key].is_null(), "{key}");
    }
    assert_eq!(json["force_evaluations_per_step"], 4);
    assert_eq!(json["update_matrix_in_z"][0][0], "1 − z²/2 + z⁴/24");
}

#[test]
fn stability_windows_are_in_seconds_and_have_gaps() {
    let windows = |system: &str, method| {
        let answer = analyze(&request(system, method, 0.01, &[1.0], &[0.0])).unwrap();
        json(&answer)["stability_windows"].clone()
    };
    // 2/√10 s, and for Suzuki's composition two windows, found by a scan of its trace.
    let verlet = windows("oscillator", Method::VelocityVerlet);
    assert_eq!(verlet, serde_json::json!([[0.0, 0.6324555320336759]]));
    assert_eq!(windows("oscillator", Method::ExplicitEuler), serde_json::json!([]));
    let suzuki = windows("oscillator", Method::Suzuki4);
    for (i, want) in [[0.0, 2.72098], [4.01989, 4.30167]].into_iter().enumerate() {
        for (end, z) in want.into_iter().enumerate() {
            let got = suzuki[i][end].as_f64().unwrap() * 10.0_f64.sqrt();
            assert!((got - z).abs() < 1e-5, "{got}, not {z}");
        }
    }
    // det M = 1 − γΔt + ω²Δt² is one at Δt = γ/ω²; the defaults are ω² = 10 and γ = 0.2.
    let damped = windows("damped-oscillator", Method::ExplicitEuler)[0][1].as_f64().unwrap();
    let parameters =
        AnySystem::build("damped-oscillator", &[] as &[(&str, f64)]).unwrap().parameters();
    let of = |name| parameters.iter().find(|p| p.0 == name).unwrap().1;
    assert!((damped / (of("gamma") / of("omega2")) - 1.0).abs() < 1e-15, "{damped}");
    assert!(windows("pendulum", Method::Rk4).is_null());
}

#[test]
fn the_conserved_form_of_verlet_is_the_energy_of_a_softer_spring() {
    let answer =
        analyze(&request("oscillator", Method::VelocityVerlet, 0.1, &[1.0], &[0.0])).unwrap();
    let form = answer.modified_hamiltonian.unwrap();
    // ½(v² + ω²(1 − z²/4)q²) with ω² = 10 and z² = 0.1.
    assert_eq!((form.qv, form.vv), (0.0, 0.5));
    assert!((form.qq - 5.0 * (1.0 - 0.025)).abs() < 1e-15, "{}", form.qq);
    let rk4 = analyze(&request("oscillator", Method::Rk4, 0.1, &[1.0], &[0.0])).unwrap();
    assert!(rk4.modified_hamiltonian.is_none() && rk4.order_of_word.is_none());
}

/// The largest `|E − E₀|/E₀` and `|q|` of a long simulated orbit of velocity Verlet with ω = 1.
fn simulated(q: [f64; 2], v: [f64; 2], dt: f64) -> (f64, f64) {
    let (mut state, system) = (State { q, v }, Oscillator { omega2: 1.0 });
    let energy = |s: &State<f64, 2>| system.energy(s);
    let (initial, mut drift, mut length) = (energy(&state), 0.0_f64, 0.0_f64);
    for _ in 0..200_000 {
        state = VelocityVerlet.step(&system, state, dt);
        drift = drift.max((energy(&state) / initial - 1.0).abs());
        length = length.max(state.q[0].hypot(state.q[1]));
    }
    (drift, length)
}

#[test]
fn criteria_are_about_the_whole_orbit_in_two_dimensions() {
    for (q, v) in [([0.0, 1.0], [0.0, 0.0]), ([1.0, 0.2], [0.1, 0.9]), ([1e-9, 1.0], [0.0, 1.0])] {
        let criteria =
            Criteria { max_drift: Some(0.03), max_amplitude: Some(1.5), max_error: None };
        let system = AnySystem::build("oscillator", &[("omega2", 1.0)]).unwrap();
        let method = Method::VelocityVerlet;
        let system = at(system, &q, &v);
        let asked = Request { system, criteria, ..request("oscillator", method, 0.1, &q, &v) };
        let dt = analyze(&asked).unwrap().largest_dt.unwrap();
        let (drift, amplitude) = (dt.energy_drift.unwrap(), dt.amplitude.unwrap());
        // 2·10⁵ points of the curve come within 10⁻⁸ of its extremes.
        let found = simulated(q, v, drift.unwrap()).0;
        assert!((found / 0.03 - 1.0).abs() < 1e-6, "{q:?}: drift {found} at {drift:?}");
        let amplitude = amplitude.unwrap();
        if v == [0.0, 0.0] {
            // From rest no orbit grows before the end of stability.
            assert_eq!(amplitude, 2.0);
        } else {
            let found = simulated(q, v, amplitude).1;
            assert!((found / 1.5 - 1.0).abs() < 1e-6, "{q:?}: length {found} at {amplitude}");
        }
    }
}

#[test]
fn a_start_with_tiny_coordinates_and_criteria_that_every_step_meets_have_answers() {
    let of = |method, v: f64, criteria| {
        let asked = Request { criteria, ..request("oscillator", method, 0.1, &[1.0], &[v]) };
        analyze(&asked).unwrap().largest_dt.unwrap()
    };
    let drift = Criteria { max_drift: Some(1e-3), ..Criteria::default() };
    let largest = |v| of(Method::VelocityVerlet, v, drift).energy_drift.unwrap().unwrap();
    assert_eq!(largest(1e-200), largest(0.0));
    // An unstable method keeps to an error only at steps far below 10⁻⁶.
    let error = Criteria { max_error: Some(1e-8), ..Criteria::default() };
    let euler = of(Method::ExplicitEuler, 0.0, error).trajectory_error.unwrap().unwrap();
    // (1 + z²)^{n/2} = 1 + 10⁻⁸ after a thousand steps.
    assert!((10.0 * euler * euler * 500.0 / 1e-8 - 1.0).abs() < 1e-3, "{euler}");
    // Far beyond its limit RK4 overflows within the run, which is an error, too.
    let error = Criteria { max_error: Some(2.0), ..Criteria::default() };
    let rk4 = of(Method::Rk4, 0.0, error).trajectory_error.unwrap().unwrap() * 10.0_f64.sqrt();
    assert!((0.01..8.0_f64.sqrt()).contains(&rk4), "{rk4}");
}

#[test]
fn beyond_half_a_turn_the_phase_error_is_that_of_the_map() {
    let phase = |method, z: f64| {
        let dt = z / 10.0_f64.sqrt();
        matrix(&analyze(&request("oscillator", method, dt, &[1.0], &[0.0])).unwrap())
            .phase_error_per_step
    };
    // RK4 at z = 2.7 is c + s·J with c = −0.4307, s = −0.5805; Suzuki 4 at 4.1 is in its second
    // window. Both by hand from powers of the matrix.
    assert!((phase(Method::Rk4, 2.7).unwrap() - 1.374_10).abs() < 1e-5);
    assert!((phase(Method::Suzuki4, 4.1).unwrap() + 0.072_35).abs() < 1e-5);
    assert!(phase(Method::VelocityVerlet, 3.0).is_none(), "nothing turns there");
}

#[test]
fn the_order_of_a_word_is_claimed_only_where_it_holds() {
    let word = |name| {
        let (q, v) = if name == "driven-oscillator" {
            (vec![1.0, 0.0], vec![0.0, 1.0])
        } else {
            (vec![1.0], vec![0.0])
        };
        analyze(&request(name, Method::Yoshida4, 0.01, &q, &v)).unwrap().order_of_word
    };
    assert_eq!(word("pendulum").unwrap().order, 4);
    assert!(word("damped-oscillator").is_none() && word("driven-oscillator").is_none());
}

#[test]
fn the_largest_step_is_given_for_the_criteria_that_are_asked() {
    let criteria =
        Criteria { max_drift: Some(1e-4), max_amplitude: Some(1.1), max_error: Some(0.01) };
    let asked =
        Request { criteria, ..request("oscillator", Method::SymplecticEuler, 0.1, &[1.0], &[0.0]) };
    let dt = analyze(&asked).unwrap().largest_dt.unwrap();
    let omega = 10.0_f64.sqrt();
    let close = |got: Option<Option<f64>>, want: f64| {
        assert!((got.unwrap().unwrap() / want - 1.0).abs() < 1e-14);
    };
    close(Some(dt.bounded), 2.0 / omega);
    close(dt.energy_drift, 2e-4 / 1.0001 / omega);
    close(dt.amplitude, 2.0 * (1.0 - 1.0 / 1.21_f64).sqrt() / omega);
    // Found by maximising ‖Mⁿ − R‖ over a fine grid of phases, with a precision of 10⁻⁶.
    let error = dt.trajectory_error.unwrap().unwrap() * omega;
    assert!((error / 0.019_384_6 - 1.0).abs() < 2e-6, "{error}");
    let pendulum = Request { criteria, ..request("pendulum", Method::Rk4, 0.1, &[1.0], &[0.0]) };
    let error = analyze(&pendulum).unwrap_err().to_string();
    assert!(error.contains("--max-drift") && error.contains("pendulum"), "{error}");
}

#[test]
fn a_drift_beyond_every_float_is_still_a_number_in_json() {
    let mut request = request("oscillator", Method::ExplicitEuler, 0.1, &[1.0], &[0.0]);
    request.steps = 1_000_000;
    let text = serde_json::to_string(&analyze(&request).unwrap()).unwrap();
    // (1 + z²)ⁿ − 1 with z² = 0.1 and n = 10⁶: 4.84348796603303…·10⁴¹³⁹². The double nearest to
    // 0.1 is 5.6·10⁻¹⁷ too large, which n·z²/(1 + z²) magnifies to a part in 10¹¹.
    assert!(text.contains("\"max_energy_drift\":4.8434879660"), "{text}");
    assert!(text.contains("e41392,"), "{text}");
}

#[test]
fn a_nonlinear_step_is_symplectic_about_every_state_if_the_method_is() {
    for (system, q, v) in [
        ("pendulum", &[2.0][..], &[0.1][..]),
        ("henon-heiles", &[0.3, -0.2], &[0.1, 0.25]),
        ("kepler", &[0.4, 0.1], &[0.2, 2.0]),
    ] {
        let defect = |m| {
            analyze(&request(system, m, 0.05, q, v))
                .unwrap()
                .matrix
                .as_ref()
                .unwrap()
                .symplecticity_defect
        };
        assert_eq!(defect(Method::VelocityVerlet), 0.0, "{system}");
        assert_eq!(defect(Method::Yoshida4), 0.0, "{system}");
        assert!(defect(Method::Rk4) > 1e-12, "{system}");
        assert!(defect(Method::ExplicitEuler) > 1e-4, "{system}");
    }
}

#[test]
fn small_swings_of_the_pendulum_turn_as_the_oscillator_does() {
    // cos q differs from 1 by q²/2 = 5·10⁻¹⁷ at q = 10⁻⁸, and with it the frequency.
    let pendulum = analyze(&request("pendulum", Method::VelocityVerlet, 0.1, &[1e-8], &[0.0]));
    let oscillator = Request {
        system: at(AnySystem::build("oscillator", &[("omega2", 9.81)]).unwrap(), &[1.0], &[0.0]),
        ..request("oscillator", Method::VelocityVerlet, 0.1, &[1.0], &[0.0])
    };
    let (a, b) = (pendulum.unwrap(), analyze(&oscillator).unwrap());
    let (a, b) =
        (matrix(&a).phase_error_per_step.unwrap(), matrix(&b).phase_error_per_step.unwrap());
    assert!((a / b - 1.0).abs() < 1e-12, "{a:e} {b:e}");
}

#[test]
fn coupled_modes_are_compared_frequency_by_frequency() {
    // About the origin Hénon–Heiles is two oscillators with ω = 1: the error of velocity Verlet is
    // 2 asin(z/2) − z.
    let answer =
        analyze(&request("henon-heiles", Method::VelocityVerlet, 0.1, &[1e-9, 1e-9], &[0.0, 0.0]));
    let expected = 2.0 * (0.05_f64).asin() - 0.1;
    let got = matrix(&answer.unwrap()).phase_error_per_step.unwrap();
    // The coupling shifts the frequencies by about q = 10⁻⁹, which turns 10⁻¹⁰ rad in a step.
    assert!((got - expected).abs() < 1e-12, "{got:e}, not {expected:e}");
}

#[test]
fn a_singular_state_is_refused() {
    let at_the_sun = request("kepler", Method::Rk4, 0.01, &[0.0, 0.0], &[0.0, 1.0]);
    assert!(matches!(analyze(&at_the_sun), Err(AnalyzeError::Singular { .. })));
}

#[test]
fn nothing_cancels_at_tiny_and_huge_steps() {
    let oscillator = |method, omega2: f64, dt| {
        let system = AnySystem::build("oscillator", &[("omega2", omega2)]).unwrap();
        let system = at(system, &[1.0], &[0.0]);
        analyze(&Request { system, ..request("oscillator", method, dt, &[1.0], &[0.0]) }).unwrap()
    };
    let close = |got: f64, want: f64| assert!((got / want - 1.0).abs() < 1e-14, "{got:e} {want:e}");
    // ω² = 10. The next terms of the expansions are smaller by z².
    let verlet = oscillator(Method::VelocityVerlet, 10.0, 1e-80);
    close(matrix(&verlet).phase_error_per_step.unwrap(), 10_f64.powf(1.5) * 1e-240 / 24.0);
    let rk4 = oscillator(Method::Rk4, 10.0, 1e-50);
    close(matrix(&rk4).determinant_minus_one, -1e3 * 1e-300 / 72.0);
    close(
        oscillator(Method::ExplicitEuler, 10.0, 1e-140)
            .matrix
            .as_ref()
            .unwrap()
            .determinant_minus_one,
        1e-279,
    );
    for dt in [1e-65, 1e-140] {
        let answer = oscillator(Method::SymplecticEuler, 10.0, dt);
        close(matrix(&answer).eigenvalues[0][1], 10_f64.sqrt() * dt);
        assert_eq!(answer.bounded, Some(true), "{dt}");
    }
    // −z⁵/120 and z⁶/72 of z = 3·10⁻⁶⁵ are below every f64.
    let tiny = oscillator(Method::Rk4, 10.0, 1e-65);
    assert_eq!(matrix(&tiny).phase_error_per_step, Some(0.0));
    assert_eq!(json(&tiny)["max_energy_drift"], 0.0);
    // z = 10⁸⁰.
    let huge = oscillator(Method::VelocityVerlet, 1e100, 1e30);
    assert_eq!((matrix(&huge).determinant, matrix(&huge).determinant_minus_one), (1.0, 0.0));
    assert_eq!(
        (matrix(&huge).symplecticity_defect, matrix(&huge).reversibility_defect),
        (0.0, 0.0)
    );
    assert_eq!(huge.bounded, Some(false));
}

#[test]
fn a_step_without_a_linearisation_says_what_a_start_must_be() {
    let message = |request: &Request| analyze(request).unwrap_err().to_string();
    let kepler = message(&request("kepler", Method::Rk4, 0.01, &[0.0, 0.0], &[0.0, 1.0]));
    assert!(kepler.contains("--q must not be the origin"), "{kepler}");
    let pendulum = message(&request("pendulum", Method::Rk4, 0.01, &[1e300], &[0.0]));
    assert!(pendulum.contains("--q") && pendulum.contains("rad"), "{pendulum}");
}
