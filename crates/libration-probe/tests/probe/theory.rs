//! Audits of integrators whose theory is known.

use libration::linear::{Complex64, Matrix};
use libration_probe::{ProbeReport, Reference, Subject};

use crate::simulators::{Simulator, damped_pendulum, pendulum, pendulum_energy, pendulum_subject};

fn close(found: f64, wanted: f64, tolerance: f64) {
    assert!((found - wanted).abs() <= tolerance, "{found:e} {wanted:e}");
}

fn methods(report: &ProbeReport) -> Vec<&'static str> {
    report.recognition.as_ref().unwrap().by_results.methods.clone()
}

/// A system of first order, `ẋ = f(x)`, stepped by RK4.
fn rk4(f: impl Fn(&[f64]) -> Vec<f64>, x: &[f64], dt: f64) -> Vec<f64> {
    let along =
        |k: &[f64], h: f64| -> Vec<f64> { x.iter().zip(k).map(|(x, k)| x + h * k).collect() };
    let k1 = f(x);
    let k2 = f(&along(&k1, dt / 2.0));
    let k3 = f(&along(&k2, dt / 2.0));
    let k4 = f(&along(&k3, dt));
    (0..x.len()).map(|i| x[i] + dt / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i])).collect()
}

#[test]
fn symplectic_euler_is_recognised_with_its_frequency_limit_and_latency() {
    let report = Simulator::new(pendulum).with_energy(pendulum_energy).audit(&pendulum_subject());
    assert_eq!(methods(&report), ["symplectic-euler"]);
    assert_eq!(report.order.as_ref().unwrap().order, Some(1));
    // ω = 3: stable to ωh = 2, and 2 sin(φ/2) = ωh for the turn φ of a step.
    let limit = report.largest_dt.as_ref().unwrap();
    close(limit.dt.unwrap(), 2.0 / 3.0, 1e-6);
    close(limit.turns, 0.5, 1e-6);
    let mode = &report.modes[0];
    close(mode.step.frequency, 2.0 * (0.015_f64).asin() / 0.01 / core::f64::consts::TAU, 1e-11);
    close(mode.flow.unwrap().frequency, 3.0 / core::f64::consts::TAU, 1e-11);
    close(mode.step.growth_rate, 0.0, 1e-10);
    // A kick at the start and a drift with its result: half a step early.
    close(report.hidden_latency[0].integrator_delay.unwrap(), -0.005, 1e-6);
    let defects = report.defects.unwrap();
    close(defects.symplecticity.unwrap(), 0.0, 1e-12);
    assert!(defects.reversibility.unwrap() > 1e-3, "it is not its own inverse");
}

#[test]
fn explicit_euler_grows_with_every_step_and_is_half_a_step_late() {
    let step = |x: &[f64], u: &[f64], dt: f64| {
        vec![x[0] + dt * x[1], x[1] + dt * (-9.0 * x[0].sin() + u[0])]
    };
    let report = Simulator::new(step).audit(&pendulum_subject());
    assert_eq!(methods(&report), ["explicit-euler"]);
    assert!(report.largest_dt.as_ref().unwrap().grows_always);
    // |z|² = 1 + ω²h².
    close(report.modes[0].radius, (1.0_f64 + 9e-4).sqrt(), 1e-12);
    // ω²h² beside the square of a turn of 1/20: 1 %, and with it the damping that the method takes away.
    close(report.hidden_latency[0].integrator_delay.unwrap(), 0.005, 2e-4);
    // −ω²h/2 of the natural frequency.
    close(report.modes[0].numerical_damping.unwrap(), -0.015, 1e-5);
}

#[test]
fn rk4_is_recognised_on_an_oscillator_and_on_a_system_of_first_order() {
    let oscillator = |x: &[f64]| vec![x[1], -4.0 * x[0] - 0.1 * x[1]];
    let subject = Subject::new("oscillator", vec![0.0, 0.0], vec![], 0.1);
    let report = Simulator::new(|x, _, dt| rk4(oscillator, x, dt)).audit(&subject);
    assert_eq!(methods(&report), ["rk4"]);
    assert_eq!(report.order.as_ref().unwrap().order, Some(4));
    // |1 + z + z²/2 + z³/6 + z⁴/24| = 1 at z = hλ for λ² + 0.1 λ + 4 = 0.
    let growth = |h: f64| {
        let z = Complex64::new(-0.05, (4.0_f64 - 0.0025).sqrt()) * h;
        (1.0 + z * (1.0 + z / 2.0 * (1.0 + z / 3.0 * (1.0 + z / 4.0)))).norm()
    };
    let (mut low, mut high) = (1.0, 2.0);
    for _ in 0..60 {
        let middle = f64::midpoint(low, high);
        if growth(middle) < 1.0 { low = middle } else { high = middle }
    }
    close(report.largest_dt.as_ref().unwrap().dt.unwrap() / low, 1.0, 1e-6);
    let lorenz = |x: &[f64]| {
        vec![10.0 * (x[1] - x[0]), x[0] * (28.0 - x[2]) - x[1], x[0] * x[1] - 8.0 / 3.0 * x[2]]
    };
    let subject = Subject::new("Lorenz", vec![0.0; 3], vec![], 0.01);
    let report = Simulator::new(|x, _, dt| rk4(lorenz, x, dt)).audit(&subject);
    assert_eq!(methods(&report), ["rk4"]);
    // λ² + 11 λ − 270 = 0 and −8/3.
    let growth = (-11.0 + (121.0_f64 + 1080.0).sqrt()) / 2.0;
    close(report.modes[0].flow.unwrap().growth_rate, growth, 1e-8);
}

#[test]
fn the_largest_step_of_a_damped_oscillator_is_that_of_theory() {
    // Symplectic Euler with an explicit damper: ωh < 2√(1 + ζ²) − 2ζ.
    for zeta in [0.05, 0.5, 1.5_f64] {
        let gamma = 2.0 * zeta * 3.0;
        let report =
            Simulator::new(|x, u, dt| damped_pendulum(gamma, x, u, dt)).audit(&pendulum_subject());
        let wanted = 2.0 * ((1.0 + zeta * zeta).sqrt() - zeta) / 3.0;
        // Bisection to 10⁻⁷.
        close(report.largest_dt.unwrap().dt.unwrap() / wanted, 1.0, 1e-6);
    }
}

#[test]
fn damping_that_is_implicit_shows_as_numerical_damping() {
    let (stiffness, damping) = (400.0, 4.0);
    let step = |x: &[f64], _: &[f64], dt: f64| {
        let v = (x[1] - dt * stiffness * x[0]) / (1.0 + dt * damping);
        vec![x[0] + dt * v, v]
    };
    let subject = Subject::new("servo", vec![0.0, 0.0], vec![], 0.02);
    let report = Simulator::new(step).audit(&subject);
    // z² − (2 − (h²k + hd)/(1 + hd)) z + 1/(1 + hd): |z|² = 1/(1 + hd).
    close(report.modes[0].radius, (1.0_f64 / 1.08).sqrt(), 1e-12);
    // ωh < 2√(1 + ζ²) + 2ζ with ζ = 0.1.
    let limit = report.largest_dt.unwrap().dt.unwrap() * 20.0;
    close(limit, 2.0 * 1.01_f64.sqrt() + 0.2, 1e-4);
}

#[test]
fn modes_of_a_chain_are_named_and_followed_to_those_of_the_flow() {
    // Two masses, the second of which is ten times as light: a slow mode and a fast one.
    let rates = |x: &[f64]| {
        let spring = 100.0 * (x[1] - x[0]);
        [spring - 5.0 * x[0], -10.0 * spring]
    };
    let step = |x: &[f64], u: &[f64], dt: f64| {
        let [a, b] = rates(x);
        let v = [x[2] + dt * (a + u[0]), x[3] + dt * b];
        vec![x[0] + dt * v[0], x[1] + dt * v[1], v[0], v[1]]
    };
    let report = Simulator::new(step).audit(&Subject::new("chain", vec![0.0; 4], vec![0.0], 0.04));
    // Eigenvalues of [[105, −100], [−1000, 1000]].
    let root = ((1105.0_f64 * 1105.0 - 4.0 * 5000.0).sqrt(), 1105.0);
    for (sign, name) in [(1.0, "x4"), (-1.0, "x4")] {
        let omega = ((root.1 + sign * root.0) / 2.0_f64).sqrt();
        let mode = report
            .modes
            .iter()
            .min_by(|a, b| {
                let off = |mode: &libration_probe::ProbedMode| {
                    (mode.flow.unwrap().frequency * core::f64::consts::TAU - omega).abs()
                };
                off(a).total_cmp(&off(b))
            })
            .unwrap();
        close(mode.flow.unwrap().frequency * core::f64::consts::TAU, omega, 1e-7);
        let turn = 2.0 * (omega * 0.02).asin() / 0.04;
        close(mode.step.frequency * core::f64::consts::TAU, turn, 1e-7);
        assert_eq!(mode.states[0].0, name);
    }
    let fastest = ((root.1 + root.0) / 2.0_f64).sqrt();
    close(report.largest_dt.unwrap().dt.unwrap() * fastest, 2.0, 1e-5);
}

#[test]
fn implicit_methods_are_recognised() {
    let (gamma, dt) = (6.0, 0.05);
    // MuJoCo's Euler: the force at the old state, and the damping at the new velocity.
    let damping = move |x: &[f64], u: &[f64], dt: f64| {
        let v = (x[1] + dt * (-9.0 * x[0].sin() + u[0])) / (1.0 + dt * gamma);
        vec![x[0] + dt * v, v]
    };
    let mut subject = pendulum_subject();
    subject.dt = dt;
    assert_eq!(methods(&Simulator::new(damping).audit(&subject)), ["damping-implicit"]);
    // Backward Euler by its fixed point.
    let backward = move |x: &[f64], u: &[f64], dt: f64| {
        let mut v = x[1];
        for _ in 0..100 {
            let q = x[0] + dt * v;
            v -= (v - x[1] - dt * (-9.0 * q.sin() - gamma * v + u[0]))
                / (1.0 + dt * gamma + 9.0 * dt * dt * q.cos());
        }
        vec![x[0] + dt * v, v]
    };
    assert_eq!(methods(&Simulator::new(backward).audit(&subject)), ["backward-euler"]);
}

#[test]
fn the_limit_of_explicit_euler_on_weakly_damped_oscillators_is_that_of_theory() {
    // h < 2ζ/ω, also where hardly anything is damped.
    for zeta in [0.05, 0.01, 0.001] {
        let step = move |x: &[f64], _: &[f64], dt: f64| {
            vec![x[0] + dt * x[1], x[1] + dt * (-4.0 * x[0] - 4.0 * zeta * x[1])]
        };
        for dt in [zeta / 3.0, 10.0 * zeta] {
            let subject = Subject::new("oscillator", vec![0.0, 0.0], vec![], dt);
            let report = Simulator::new(step).audit(&subject);
            let limit = report.largest_dt.as_ref().unwrap();
            close(limit.dt.unwrap() / zeta, 1.0, 1e-5);
            let kinds: Vec<&str> =
                report.findings.iter().map(|finding| finding.kind.name()).collect();
            assert_eq!(kinds.contains(&"unstable-step"), dt > zeta, "{kinds:?}");
        }
    }
}

#[test]
fn exact_derivatives_replace_differences_that_agree_with_them_and_no_others() {
    let (h, mut subject) = (0.01, pendulum_subject());
    let a = [[1.0 - 9.0 * h * h, h], [-9.0 * h, 1.0]];
    let exact = |spoil: f64| Reference {
        source: "theory".into(),
        is_exact: true,
        a: Matrix::from_fn(2, 2, |i, j| a[i][j] * (1.0 + spoil)),
        b: Matrix::from_fn(2, 1, |i, _| [h * h, h][i]),
    };
    subject.reference = Some(exact(0.0));
    let report = Simulator::new(pendulum).audit(&subject);
    assert_eq!(report.step.as_ref().unwrap().a, exact(0.0).a);
    // Eight roundings of 2⁻⁵².
    assert!(
        report.jacobian_error <= 8.0 * f64::EPSILON && report.findings.is_empty(),
        "{report:?}"
    );
    // Far below the error of other derivatives that are allowed, far above that of a difference.
    subject.reference = Some(exact(1e-8));
    let report = Simulator::new(pendulum).audit(&subject);
    assert_eq!(report.findings[0].kind.name(), "derivatives-differ");
    close(report.step.unwrap().a[(1, 0)], -9.0 * h, 1e-11);
}

#[test]
fn the_limit_of_undamped_systems_and_of_those_that_grow_slowly_is_that_of_the_fastest_mode() {
    // Two masses on springs, ω² = 15 ± 5√5 and 2/ω, anywhere at rest.
    let fastest = (15.0 + 125.0_f64.sqrt()).sqrt();
    for rest in [[0.0, 0.0], [1.0, 2.0], [-0.3, 0.7]] {
        let force = |q: [f64; 2]| [-20.0 * q[0] + 10.0 * q[1], 10.0 * q[0] - 10.0 * q[1]];
        let offset = force(rest);
        // 0 and 10⁻⁹ of negative damping, and a pendulum's.
        for gamma in [0.0, -1e-9, -0.1] {
            let step = |x: &[f64], _: &[f64], dt: f64| {
                let f = force([x[0], x[1]]);
                let v = [2, 3].map(|i| x[i] + dt * (f[i - 2] - offset[i - 2] - gamma * x[i]));
                vec![x[0] + dt * v[0], x[1] + dt * v[1], v[0], v[1]]
            };
            let subject = Subject::new("masses", vec![rest[0], rest[1], 0.0, 0.0], vec![], 0.01);
            let report = Simulator::new(step).audit(&subject);
            // (ωh)² < 4 − 2γh to first order.
            let wanted = 2.0 / fastest * (1.0 - gamma / (2.0 * fastest));
            close(report.largest_dt.unwrap().dt.unwrap(), wanted, 1e-3 * gamma.abs() + 1e-5);
        }
    }
}

#[test]
fn an_integrator_is_named_only_where_its_results_are_its_own() {
    // Without a force: explicit and backward Euler, and trapezoid, have the same results.
    let mut subject = Subject::new("mass", vec![0.0, 0.0], vec![0.0], 0.001);
    let explicit = |x: &[f64], u: &[f64], dt: f64| vec![x[0] + dt * x[1], x[1] + dt * u[0]];
    let report = Simulator::new(explicit).audit(&subject);
    assert!(!report.answer.contains("none of the integrators"), "{}", report.answer);
    // A method of order 2 is not RK4, though both are exact up to the third derivative.
    subject = Subject::new("jerk", vec![0.0; 3], vec![0.0], 0.001);
    let heun = |x: &[f64], u: &[f64], h: f64| {
        let (x2, x3) = (x[1] + h * x[2] + h * h / 2.0 * u[0], x[2] + h * u[0]);
        vec![x[0] + h * x[1] + h * h / 2.0 * x[2], x2, x3]
    };
    let report = Simulator::new(heun).audit(&subject);
    assert_eq!(report.order.as_ref().unwrap().order, Some(2));
    assert!(!report.answer.contains("RK4"), "{}", report.answer);
}

#[test]
fn the_search_for_a_limit_follows_an_equilibrium_that_moves_with_the_step() {
    // A spring whose rest gives way by dt beyond 0.05 s.
    let gives_way = |x: &[f64], _: &[f64], dt: f64| {
        let rest = -(dt - 0.05).max(0.0);
        let v = x[1] + dt * (-9.0 * (x[0] - rest) - 0.3 * x[1]);
        vec![x[0] + dt * v, v]
    };
    let subject = Subject::new("contact", vec![0.0, 0.0], vec![], 0.01);
    let report = Simulator::new(gives_way).audit(&subject);
    let limit = report.largest_dt.as_ref().unwrap();
    // z = −1 at 9 h² + 2 · 0.3 h = 4, wherever the spring rests.
    let wanted = (-0.3 + (0.09_f64 + 36.0).sqrt()) / 9.0;
    close(limit.dt.unwrap(), wanted, 1e-5);
    // Trials grow by a quarter.
    let from = limit.rests_elsewhere_from.unwrap();
    assert!((0.05..=0.0625).contains(&from), "{limit:?}");
    assert!(report.answer.contains("at their own equilibria"), "{}", report.answer);
}

#[test]
fn the_search_for_a_limit_ends_where_longer_steps_have_no_equilibrium() {
    // A spring that pulls with 9 N at most, and a force that exceeds it from 0.059 s on.
    let slips = |x: &[f64], _: &[f64], dt: f64| {
        let push = 1000.0 * (dt - 0.05).max(0.0);
        let v = x[1] + dt * (push - 9.0 * x[0].tanh() - 0.3 * x[1]);
        vec![x[0] + dt * v, v]
    };
    let subject = Subject::new("contact", vec![0.0, 0.0], vec![], 0.01);
    let report = Simulator::new(slips).audit(&subject);
    let limit = report.largest_dt.as_ref().unwrap();
    assert_eq!(limit.dt, None);
    assert!((0.047..=0.059).contains(&limit.tried_up_to), "{limit:?}");
    assert!(report.answer.contains("no equilibrium of a step of"), "{}", report.answer);
}
