//! Changes and rates of the energy off an equilibrium, beside closed forms.

use libration_probe::{ProbeReport, Subject};
use libration_report::verdict::Outcome;

use crate::simulators::Simulator;
use crate::verdicts::{Rates, change, motion, rk4};

/// The spring x'' = −10 x − c x' from a start, with the energy above some zero.
fn spring(
    step: impl Fn(&[f64], f64) -> Vec<f64> + Copy,
    start: f64,
    zero: f64,
    dt: f64,
) -> ProbeReport {
    Simulator::new(move |x, _, dt| step(x, dt))
        .with_energy(move |x| x[1] * x[1] / 2.0 + 5.0 * x[0] * x[0] + zero)
        .audit(&motion([start, 0.0], dt, true))
}

#[test]
fn the_loss_of_a_linear_system_does_not_depend_on_its_start_or_the_zero_of_the_energy() {
    let linear: Rates = |x| [x[1], -10.0 * x[0]];
    for h in [0.05_f64, 0.057, 0.061, 0.065, 0.075, 0.11] {
        // |R(iz)|² = 1 − z⁶/72 + z⁸/576 of RK4.
        let z = 10.0_f64.sqrt() * h;
        let lost = 1.0 - (1.0 - z.powi(6) / 72.0 + z.powi(8) / 576.0).powi(20_000);
        for (start, zero) in
            [(1.0, 0.0), (0.3, 0.0), (0.1, 7.0), (0.03, 0.0), (0.01, -2.0), (30.0, 0.0)]
        {
            let report = spring(|x, dt| rk4(linear, x, dt), start, zero, h);
            // The largest of 256 samples of a squared sine, and the exponential through three means.
            let found = -change(&report) / lost;
            assert!((found - 1.0).abs() < 0.02, "{h} {start} {found}");
            assert_eq!(report.verdict.outcome == Outcome::Fault, lost > 0.01, "{}", report.answer);
        }
    }
}

#[test]
fn the_rate_of_a_damped_system_is_that_of_its_energy_whatever_the_start() {
    // Exact decay between half steps: the mean energy falls as e^(−ct) to first order in h².
    for damping in [1e-3, 0.1, 0.4, 1.0] {
        let step = |x: &[f64], dt: f64| {
            let v = x[1] - dt / 2.0 * 10.0 * x[0];
            let q = x[0] + dt / 2.0 * v;
            let v = v * (-damping * dt).exp();
            let q = q + dt / 2.0 * v;
            vec![q, v - dt / 2.0 * 10.0 * q]
        };
        for (start, zero) in [(1.0, 0.0), (0.1, 0.0), (0.01, 3.0), (100.0, 0.0)] {
            let report = spring(step, start, zero, 0.002);
            let told = report.findings.iter().find(|own| own.kind.name() == "energy-leak");
            let rate = report.defects.as_ref().unwrap().energy.as_ref().unwrap().rate;
            assert!(told.is_some(), "{damping} {start} {}", report.answer);
            assert!((rate / -damping - 1.0).abs() < 0.03, "{damping} {start} {rate}");
        }
    }
}

#[test]
fn the_loss_of_several_oscillators_is_that_of_their_whole_energy() {
    // Springs of 10, 13 and 17 N/m, each from 30 m: displacements of 0.1 m matter little.
    let (stiffness, h) = ([10.0_f64, 13.0, 17.0], 0.065_f64);
    for count in 1..=3 {
        let parts = &stiffness[..count];
        let step = move |x: &[f64], dt: f64| -> Vec<f64> {
            let mut next = x.to_vec();
            for i in 0..count {
                let z = rk4_of_spring(stiffness[i], [x[i], x[count + i]], dt);
                (next[i], next[count + i]) = (z[0], z[1]);
            }
            next
        };
        let energy = move |x: &[f64]| -> f64 {
            (0..count).map(|i| (x[count + i].powi(2) + stiffness[i] * x[i] * x[i]) / 2.0).sum()
        };
        let mut state = vec![30.0; count];
        state.resize(2 * count, 0.0);
        let mut subject = Subject::new("springs", state, vec![], h);
        (subject.equilibrium, subject.is_conservative) = (Some(false), true);
        subject.pairs = Some((0..count).map(|i| (i, count + i)).collect());
        let report =
            Simulator::new(move |x, _, dt| step(x, dt)).with_energy(energy).audit(&subject);
        let kept = |k: f64| {
            let z = k.sqrt() * h;
            (1.0 - z.powi(6) / 72.0 + z.powi(8) / 576.0).powi(20_000)
        };
        let lost =
            1.0 - parts.iter().map(|k| k * kept(*k)).sum::<f64>() / parts.iter().sum::<f64>();
        // A mean of a squared sine over 128 phases errs by 1/√(2·128).
        let found = -change(&report) / lost;
        assert!((found - 1.0).abs() < 0.1, "{count} {found}");
    }
}

fn rk4_of_spring(k: f64, x: [f64; 2], dt: f64) -> [f64; 2] {
    // The Taylor polynomial of fourth order of the turn.
    let z = k.sqrt() * dt;
    let (c, s) = (1.0 - z * z / 2.0 + z.powi(4) / 24.0, z - z.powi(3) / 6.0);
    [c * x[0] + s * x[1] / k.sqrt(), c * x[1] - s * k.sqrt() * x[0]]
}
