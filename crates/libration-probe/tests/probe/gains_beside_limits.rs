//! Verdicts on gains beside limits, of any size, and of coupled joints.

use libration_probe::{GainReport, IntegratorRow};

use crate::gains::{close, report};

/// The row of an integrator.
fn row<'a>(report: &'a GainReport, name: &str) -> &'a IntegratorRow {
    report.integrators.iter().find(|row| row.name == name).unwrap()
}

/// A torque held on a free mass: `det = 1 + kp h²/2` in steps that are exact under a constant force, and both factors grow.
#[test]
fn a_held_torque_without_damping_grows_however_small_its_gain() {
    for (kp, h) in [(1e-5, 0.1), (1.0, 1e-9), (1e-30, 1e-30), (100.0, 0.1)] {
        let text = format!(r#"{{"mass": [1], "kp": [{kp:?}], "torque": "held"}}"#);
        let found = report(&text, h, 1, "rk4");
        assert!(!found.holds && found.joints[0].largest_kp == 0.0, "{kp} {h}");
        let excess = kp * h * h / 2.0;
        for name in ["rk4", "velocity-verlet", "implicit-midpoint"] {
            let row = row(&found, name);
            assert!(!row.holds && row.largest_factor == 0.0, "{kp} {h} {name}");
            close(row.spectral_radius_minus_one, excess / (1.0 + (1.0 + excess).sqrt()), 1e-12);
        }
        // With damping it holds up to `det = 1`: `kp h²/2 = kv h`.
        let kv = kp * h;
        let damped = text.replace("\"torque\"", &format!("\"kv\": [{kv:?}], \"torque\""));
        if kv * h < 0.5 {
            let found = report(&damped, h, 1, "rk4");
            close(found.joints[0].largest_kp, 2.0 * kv / h, 1e-12);
            assert!(found.holds, "{kp} {h}");
        }
    }
}

#[test]
fn small_gains_hold_with_integrators_that_damp_and_not_with_those_that_grow() {
    for (kp, h) in [(1e-9, 0.1), (1e-5, 1e-4), (1.0, 1e-40)] {
        let found = report(&format!(r#"{{"mass": [1], "kp": [{kp:?}]}}"#), h, 1, "explicit-euler");
        // |R|² = 1 + a of explicit Euler, 1/(1 + a) of the implicit one, 1 − a³/72 + a⁴/576 of Runge and Kutta.
        let a = kp * h * h;
        assert!(!found.holds && found.largest_factor == 0.0 && found.fewest_substeps.is_none());
        close(found.spectral_radius_minus_one, a / 2.0, 1e-4);
        for (name, wanted) in [("backward-euler", -a / 2.0), ("rk4", -a * a * a / 144.0)] {
            assert!(row(&found, name).holds, "{name} {kp} {h}");
            close(row(&found, name).spectral_radius_minus_one, wanted, 1e-4);
        }
        for name in ["symplectic-euler", "implicit-midpoint", "gauss-legendre-6", "yoshida4"] {
            let row = row(&found, name);
            assert!(row.holds && row.spectral_radius_minus_one == 0.0, "{name} {kp} {h}");
        }
    }
}

/// Symplectic Euler holds for `kp < 2 (2 − kv h)/h²` and `kv h < 2`, of inertia 1.
#[test]
fn gains_just_beyond_a_limit_do_not_hold_and_those_just_inside_it_do() {
    for (kv, h) in [(0.0, 0.125), (15.96875, 0.125), (1.0, 9.5367431640625e-7)] {
        let limit = 2.0 * (2.0 - kv * h) / (h * h);
        for (part, holds) in [(1.0 - 1e-9, true), (1.0, false), (1.0 + 1e-9, false)] {
            let text = format!(r#"{{"mass": [1], "kp": [{:?}], "kv": [{kv}]}}"#, limit * part);
            let found = report(&text, h, 1, "symplectic-euler");
            assert_eq!(found.holds, holds, "{kv} {h} {part}");
            close(found.joints[0].largest_kp, limit, 1e-12);
            assert!(found.joints[0].largest_kp < limit);
            let is_at_limit = found.answer.contains("at the limit of stability");
            assert_eq!(is_at_limit, part == 1.0, "{}", found.answer);
        }
    }
    for (kv, holds) in [(16.0 - 1e-8, true), (16.0, false), (16.0 + 1e-8, false)] {
        let text = format!(r#"{{"mass": [1], "kp": [0], "kv": [{kv:?}]}}"#);
        let found = report(&text, 0.125, 1, "symplectic-euler");
        assert_eq!(found.holds, holds, "{kv}");
        close(found.joints[0].largest_kv, 16.0, 1e-12);
    }
}

/// `kp h²/m` and its limit 4 are numbers, whatever the sizes of the three.
#[test]
fn limits_of_gains_have_no_range_of_sizes() {
    for (mass, kp, h) in [
        (1.0, 1.0, 1e-6),
        (1.0, 1e-6, 1e-9),
        (1e-300, 1.0, 1e-200),
        (1e300, 1e-5, 1e150),
        (1e-200, 1e-200, 1e-3),
        (1e200, 1e250, 1e-28),
    ] {
        let text = format!(r#"{{"mass": [{mass:?}], "kp": [{kp:?}]}}"#);
        let found = report(&text, h, 1, "symplectic-euler");
        let joint = &found.joints[0];
        let limit = 4.0 * (mass / h / h);
        assert!(found.holds, "{mass:e} {kp:e} {h:e}");
        close(joint.largest_kp, limit, 1e-12);
        close(found.largest_factor, limit / kp, 1e-12);
        close(joint.largest_turn, 2.0, 1e-12);
        close(joint.largest_kv, (4.0 - (kp * h) * (h / mass)) * (mass / h) / 2.0, 1e-12);
        close(found.modes[0].turn, joint.turn, 1e-12);
        close(found.modes[0].frequency, (kp / mass).sqrt() / core::f64::consts::TAU, 1e-12);
    }
    // A gain of velocity far below its limit.
    let text = r#"{"mass": [1], "kp": [1], "kv": [1e-12]}"#;
    close(
        report(text, 1e-3, 1, "symplectic-euler").joints[0].largest_kv,
        2e3 * (1.0 - 0.25e-6),
        1e-12,
    );
}

/// Modes of coupled joints without damping are joints alone: `det(K − λM) = 0` with λ = 1 and 3 of M = 1 and K = [[2, −1], [−1, 2]].
#[test]
fn coupled_joints_without_damping_grow_as_their_modes_do() {
    let text = r#"{"mass": [1, 1], "kp": [[2e-6, -1e-6], [-1e-6, 2e-6]], "torque": "held"}"#;
    let held = report(text, 0.1, 1, "rk4");
    assert!(!held.holds && held.largest_factor == 0.0);
    close(held.spectral_radius_minus_one, 3e-6 * 0.01 / 4.0, 1e-7);
    let anew = report(&text.replace("held", "each-substep"), 0.1, 1, "symplectic-euler");
    assert!(anew.holds && anew.spectral_radius_minus_one == 0.0);
    close(anew.largest_factor, 4.0 / (3e-6 * 0.01), 1e-9);
    let explicit = report(&text.replace("held", "each-substep"), 0.1, 1, "explicit-euler");
    assert!(!explicit.holds && explicit.largest_factor == 0.0);
    // Two masses with a servo between them move on together.
    let free = r#"{"mass": [1, 3], "kp": [[6, -6], [-6, 6]], "kv": [[1, -1], [-1, 1]]}"#;
    for integrator in ["symplectic-euler", "implicitfast", "euler"] {
        let found = report(free, 0.01, 1, integrator);
        assert!(found.holds, "{integrator} {}", found.answer);
    }
    // The reduced mass 3/4 of their relative motion: kp h² < 4 m − 2 kv h.
    let found = report(free, 0.01, 1, "symplectic-euler");
    close(found.largest_factor * 6.0, (4.0 * 0.75 - 2.0 * 0.01) / 1e-4, 1e-6);
    for unlimited in ["implicit-midpoint", "trapezoid", "backward-euler", "gauss-legendre-4"] {
        assert_eq!(report(free, 0.01, 1, unlimited).largest_factor, f64::INFINITY, "{unlimited}");
    }
    let undamped = report(&free.replace("[1, -1], [-1, 1]", "[0, 0], [0, 0]"), 0.01, 1, "rk4");
    assert!(undamped.holds, "{}", undamped.answer);
}

/// Forces across two equal joints without damping turn their motion: it grows, but by less than rounding parts a double eigenvalue.
#[test]
fn growth_of_coupled_joints_that_rounding_may_hide_is_unknown() {
    let text = r#"{"mass": [1, 1], "kp": [[1, 1e-12], [-1e-12, 1]]}"#;
    let found = report(text, 0.01, 1, "symplectic-euler");
    assert!(!found.verdict.is_good() && !found.holds);
    assert!(found.answer.starts_with("Whether the gains hold"), "{}", found.answer);
    assert_eq!(row(&found, "symplectic-euler").answer(), "unknown");
    // No limit of gains is shown beside it.
    assert!(found.largest_factor.is_nan() && found.joints[0].largest_kp.is_nan());
    assert!(!found.answer.contains("must stay below"), "{}", found.answer);
    assert!(libration_probe::gains_page(&found).contains("Whether the gains hold is unknown"));
}

/// A servo of `kp h²/m = 100` turns its joint too far, which a negative stiffness of the same joint does not explain.
#[test]
fn a_gain_that_is_too_large_beside_a_negative_stiffness_is_the_reason() {
    let text = r#"{"mass": [1], "kp": [1e6], "kv": [1], "stiffness": [-5]}"#;
    let found = report(text, 0.01, 1, "symplectic-euler");
    assert!(!found.holds && !found.unstable_without_servos, "{}", found.answer);
    close(found.largest_factor * 1e6, 5.0 + (4.0 - 2.0 * 0.01) / 1e-4, 1e-12);
}
