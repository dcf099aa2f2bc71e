//! Faults that are planted on purpose are found and named.

use std::cell::Cell;

use crate::simulators::{
    Simulator, damped_pendulum, kinds, pendulum, pendulum_energy, pendulum_subject,
};

#[test]
fn a_clean_step_has_no_finding() {
    let mut subject = pendulum_subject();
    subject.is_conservative = true;
    let report = Simulator::new(pendulum).with_energy(pendulum_energy).audit(&subject);
    assert_eq!(report.findings, [], "{}", report.answer);
    let mut batched = Simulator::new(pendulum);
    batched.is_batched = true;
    assert_eq!(kinds(&batched.audit(&pendulum_subject())), [""; 0]);
    let damped = Simulator::new(|x, u, dt| damped_pendulum(0.3, x, u, dt));
    assert_eq!(kinds(&damped.audit(&pendulum_subject())), [""; 0]);
}

#[test]
fn an_action_or_a_length_in_single_precision_is_found_and_named() {
    let single = |x: f64| f64::from(x as f32);
    fn audit(step: impl FnMut(&[f64], &[f64], f64) -> Vec<f64>) -> Vec<String> {
        let report = Simulator::new(step).audit(&pendulum_subject());
        report.findings.into_iter().map(|found| found.text).collect()
    }
    let action = audit(|x, u, dt| pendulum(x, &[single(u[0])], dt));
    assert_eq!(action, ["the step rounds `u1` to single precision"]);
    let length = audit(|x, u, dt| pendulum(x, u, single(dt)));
    assert_eq!(length, ["the step rounds dt to single precision"]);
    // A weak action is no rounded one, nor is a limit.
    for weak in [0.1, 1e-3, 3e-4, 1e-4] {
        assert_eq!(
            audit(|x, u, dt| pendulum(&[x[0], x[1] + weak * dt * u[0]], &[0.0], dt)),
            [""; 0]
        );
    }
    assert_eq!(audit(|x, u, dt| pendulum(x, &[1e-6 * u[0]], dt)), [""; 0]);
    assert_eq!(audit(|x, u, dt| pendulum(x, &[u[0].min(0.013 + 3e-6)], dt)), [""; 0]);
}

#[test]
fn damping_with_the_wrong_sign_is_found_but_an_unstable_equilibrium_is_no_fault() {
    let driven = Simulator::new(|x, u, dt| damped_pendulum(-0.1, x, u, dt));
    let report = driven.audit(&pendulum_subject());
    assert_eq!((kinds(&report), report.holds()), (vec!["negative-damping"], true));
    let rate = report.driven_velocities[0].rate;
    assert!((rate - 0.1).abs() < 1e-8, "{rate}");
    let mut upright = pendulum_subject();
    upright.state[0] = core::f64::consts::PI;
    assert_eq!(kinds(&Simulator::new(pendulum).audit(&upright)), [""; 0]);
}

#[test]
fn an_energy_that_leaks_a_millionth_per_second_is_found() {
    // The energy falls with γ, on average over an oscillation.
    let leaking = || Simulator::new(|x, u, dt| damped_pendulum(1e-6, x, u, dt));
    let mut subject = pendulum_subject();
    subject.is_conservative = true;
    for report in
        [leaking().audit(&subject), leaking().with_energy(pendulum_energy).audit(&subject)]
    {
        assert_eq!(kinds(&report), ["energy-leak"], "{:?}", report.defects);
    }
}

#[test]
fn a_batch_that_differs_in_the_last_bit_is_found_and_located() {
    let mut simulator = Simulator::new(pendulum);
    simulator.is_batched = true;
    simulator.spoil = Some(4096);
    let report = simulator.audit(&pendulum_subject());
    assert_eq!(kinds(&report), ["bits-differ"]);
    let text = &report.findings[0].text;
    assert!(
        text.contains("first in environment 4095, component 1") && text.contains("1 ulps"),
        "{text}"
    );
}

#[test]
fn a_step_in_single_precision_is_found_also_if_it_returns_double_precision() {
    let single = |x: f64| f64::from(x as f32);
    let inside = Simulator::new(move |x, u, dt| {
        let v = x[1] + dt * (-9.0 * single(single(x[0]).sin()) + u[0]);
        vec![x[0] + dt * v, v]
    });
    let whole = Simulator::new(move |x, u, dt| {
        let x: Vec<f64> = x.iter().map(|x| single(*x)).collect();
        pendulum(&x, u, dt).into_iter().map(single).collect()
    });
    for simulator in [inside, whole] {
        let report = simulator.audit(&pendulum_subject());
        assert!(kinds(&report).contains(&"single-precision"), "{:?}", report.findings);
    }
}

#[test]
fn random_numbers_are_found_and_end_the_audit() {
    let draws = Cell::new(1_u64);
    let noisy = Simulator::new(move |x, u, dt| {
        draws.set(draws.get().wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1));
        let noise = (draws.get() >> 11) as f64 / (1_u64 << 53) as f64 - 0.5;
        pendulum(x, &[u[0] + noise], dt)
    });
    let report = noisy.audit(&pendulum_subject());
    assert_eq!(kinds(&report), ["not-reproducible"]);
    assert!(report.step.is_none() && report.answer.starts_with("One fault"), "{}", report.answer);
}

#[test]
fn a_simulator_that_ignores_dt_is_found() {
    let fixed = Simulator::new(|x, u, _| pendulum(x, u, 0.01));
    let report = fixed.audit(&pendulum_subject());
    assert_eq!(kinds(&report), ["ignores-dt"]);
    assert!(report.flow.is_none() && !report.modes.is_empty());
}

#[test]
fn a_state_that_is_no_equilibrium_is_a_warning_unless_it_is_said_to_be_none() {
    let mut subject = pendulum_subject();
    subject.state[0] = 0.5;
    let report = Simulator::new(pendulum).audit(&subject);
    assert_eq!((kinds(&report), report.holds()), (vec!["no-equilibrium"], true));
    subject.equilibrium = Some(false);
    assert_eq!(kinds(&Simulator::new(pendulum).audit(&subject)), [""; 0]);
}

#[test]
fn damping_with_the_wrong_sign_is_found_also_where_nothing_oscillates() {
    let driven = Simulator::new(|x, _, dt| {
        let v = x[1] + dt * (-x[0] + 5.0 * x[1]);
        vec![x[0] + dt * v, v]
    });
    assert!(kinds(&driven.audit(&pendulum_subject())).contains(&"negative-damping"));
}

#[test]
fn a_rough_step_is_no_step_in_single_precision() {
    // A smooth function of short waves is neither.
    let waves = Simulator::new(|x, u, dt| pendulum(x, &[u[0] + (1e4 * x[0]).sin() / 1e4], dt));
    assert!(!kinds(&waves.audit(&pendulum_subject())).contains(&"single-precision"));
    // Noise by the bits of the state, and the tolerance of an iterative solver.
    let hashed =
        |x: f64| (x.to_bits().wrapping_mul(0x9E37_79B9_7F4A_7C15) >> 40) as f64 / 16_777_216.0;
    for size in [1e-3, 1e-7] {
        let rough = Simulator::new(|x, u, dt| {
            let next = pendulum(x, u, dt);
            vec![next[0], next[1] + size * (hashed(x[0]) - 0.5)]
        });
        let found = kinds(&rough.audit(&pendulum_subject()));
        assert!(found.contains(&"rough") && !found.contains(&"single-precision"), "{found:?}");
    }
}

#[test]
fn a_step_that_diverges_is_audited_and_called_unstable() {
    // Rates of −1 and −10⁶ by explicit Euler.
    let stiff = Simulator::new(|x, _, dt| vec![x[0] - dt * x[0], x[1] - dt * 1e6 * x[1]]);
    let report = stiff.audit(&libration_probe::Subject::new("stiff", vec![0.0, 0.0], vec![], 0.01));
    assert!(kinds(&report).contains(&"unstable-step"), "{:?}", report.findings);
    assert!((report.largest_dt.unwrap().dt.unwrap() - 2e-6).abs() < 1e-11);
}

#[test]
fn an_action_at_its_limit_has_no_derivative_there() {
    for step in [|u: f64| u.abs(), |u: f64| u.clamp(0.0, 1.0)] {
        let report =
            Simulator::new(|x, u, dt| pendulum(x, &[step(u[0])], dt)).audit(&pendulum_subject());
        assert_eq!(kinds(&report), ["not-differentiable"]);
        assert!(
            report.findings[0].text.contains("by `u1`") && !report.holds(),
            "{:?}",
            report.findings
        );
    }
}

#[test]
fn a_clean_motion_of_a_conservative_system_has_no_fault() {
    let energy = |x: &[f64]| x[1] * x[1] / 2.0 - 9.0 * x[0].cos();
    for (angle, speed) in [(1.2, 0.0), (0.4, 2.0), (2.5, -1.0)] {
        let mut subject = pendulum_subject();
        (subject.state, subject.equilibrium) = (vec![angle, speed], Some(false));
        subject.is_conservative = true;
        let rk4 = |x: &[f64], u: &[f64], dt: f64| {
            let rate = |x: &[f64]| [x[1], -9.0 * x[0].sin() + u[0]];
            let at = |k: [f64; 2], h: f64| vec![x[0] + h * k[0], x[1] + h * k[1]];
            let a = rate(x);
            let b = rate(&at(a, dt / 2.0));
            let c = rate(&at(b, dt / 2.0));
            let d = rate(&at(c, dt));
            (0..2).map(|i| x[i] + dt / 6.0 * (a[i] + 2.0 * b[i] + 2.0 * c[i] + d[i])).collect()
        };
        for simulator in [Simulator::new(rk4), Simulator::new(pendulum)] {
            let report = simulator.with_energy(energy).audit(&subject);
            assert_eq!(report.findings, [], "{angle} {}", report.answer);
        }
    }
}

#[test]
fn a_step_far_beyond_all_limits_is_unstable() {
    let mut subject = pendulum_subject();
    for dt in [1.0, 1e3, 1e6] {
        subject.dt = dt;
        let report = Simulator::new(pendulum).audit(&subject);
        assert!(kinds(&report).contains(&"unstable-step"), "{dt} {:?}", report.findings);
        assert!((report.largest_dt.unwrap().dt.unwrap() - 2.0 / 3.0).abs() < 1e-5);
    }
}

#[test]
fn a_step_in_single_precision_off_zero_has_the_limit_and_the_matrix_of_its_system() {
    let single = |x: f64| f64::from(x as f32);
    for rest in [0.3, 1.0] {
        let coarse = Simulator::new(move |x, _, dt| {
            let v = single(x[1] + dt * (-40.0 * (x[0] - rest) - 0.8 * x[1]));
            vec![single(x[0] + dt * v), v]
        });
        let mut subject = pendulum_subject();
        subject.state = vec![single(rest), 0.0];
        let report = coarse.audit(&subject);
        let a = report.step.as_ref().unwrap();
        // Roundings of 6e-8 over differences of 1/16, and some more.
        assert!((a.a[(0, 1)] - 0.00992).abs() < 1e-5 && (a.a[(1, 0)] + 0.4).abs() < 1e-5, "{a:?}");
        assert_eq!(kinds(&report), ["single-precision"], "{:?}", report.findings);
        // (ωh)² + 2 γ h < 4: symplectic Euler with explicit damping.
        let limit = (-0.8 + f64::sqrt(0.8 * 0.8 + 4.0 * 40.0)) / 40.0;
        let found = report.largest_dt.as_ref().unwrap().dt.unwrap();
        // Short steps in single precision leave the growth of the system unknown to some 0.5 1/s, and the limit to a few percent.
        assert!((found / limit - 1.0).abs() < 0.1, "{found} {limit}");
    }
}
