//! Planted faults: each is named, with its size where theory has one.

use libration_energy::{DriftCause, FindingKind, OscillationCause, WalkCause};

use libration_report::verdict::Outcome;

use crate::molecular_dynamics::{End, lennard_jones};
use crate::programs::{Noise, chain, chain_f32, curl, trace};
use crate::theory::audited;

#[test]
fn a_force_with_curl_is_a_drift_that_does_not_depend_on_the_step() {
    let curl_force = 1e-4;
    let report = audited(&[0.2, 0.1, 0.05].map(|dt| curl(curl_force, dt, 300.0)));
    assert_eq!(report.drift_cause, DriftCause::StepIndependent);
    assert_eq!(report.findings[0].kind, FindingKind::StepIndependentDrift);
    assert!(!report.holds());
    // The power of the force c(−y, x) is c·(x v_y − y v_x), c times the angular momentum, which is 1·0.7 − 0.3·0.2 = 0.64 at the start.
    // It grows by c·⟨x² + y²⟩·t, so that the energy has a slope of 0.64·c at the start and a curvature of relative size c·300·0.81/0.64.
    for run in &report.runs {
        let relative = run.drift_rate.value / (0.64 * curl_force) - 1.0;
        assert!(relative.abs() < curl_force * 300.0 * 0.81 / 0.64, "{:?}", run.drift_rate);
    }
    assert!(report.largest_dt.unwrap().dt.is_none());
}

#[test]
fn a_truncated_potential_is_an_oscillation_that_does_not_fall_with_the_step() {
    let report = audited(&[0.008, 0.004, 0.002].map(|dt| lennard_jones(End::Cut, dt, 200.0)));
    assert_eq!(report.oscillation_cause, OscillationCause::StepIndependent);
    assert_eq!(report.findings[0].kind, FindingKind::StepIndependentOscillation);
    // What is conserved is the energy less u(r_c) for each pair within the cutoff, u(2.5) = −0.0163: the energy fluctuates by that times the
    // deviation of the number of pairs, which is at least 1 and less than 10 of 120 pairs.
    let fluctuation = report.runs[0].oscillation.value / 0.0163;
    assert!(fluctuation > 1.0 && fluctuation < 10.0, "{fluctuation}");
}

#[test]
fn single_precision_is_a_random_walk_that_grows_as_the_step_falls() {
    let steps = [4e-3, 1e-3, 2.5e-4];
    let report = audited(&steps.map(|dt| chain_f32(dt, 400.0)));
    assert_eq!(report.walk_cause, WalkCause::Rounding, "{:?}", report.runs);
    assert!(report.findings.iter().any(|finding| finding.kind == FindingKind::RoundingWalk));
    assert!(!report.holds());
    // Velocities of about 0.5 round by 2⁻²⁵ to either side twice in a step, for eight masses: v·δv adds up to about 2⁻²⁵ of energy.
    let run = &report.runs[0];
    let per_step = (run.walk.unwrap().diffusion.value * run.dt).sqrt() * 2.0_f64.powi(25);
    assert!(per_step > 0.2 && per_step < 5.0, "{per_step}");
    // The same chain in double precision has none.
    let report = audited(&steps.map(|dt| chain(dt, 400.0)));
    assert!(report.holds(), "{:?}", report.findings);
}

#[test]
fn a_rounding_with_a_bias_is_a_drift_with_the_number_of_steps() {
    // Each step adds 10⁻⁷ on average.
    let mut noise = Noise(99);
    let traces = [0.02, 0.01, 0.005].map(|dt: f64| {
        let (mut energy, mut step) = (1.0, 0.0_f64);
        let next = || {
            step += 1.0;
            energy += 1e-7 * 2.0 * noise.uniform();
            energy + dt * dt * (10.0 * step * dt).sin()
        };
        trace("bias", dt, (100.0 / dt).round() as usize, 1, next, 1.0)
    });
    let report = audited(&traces);
    assert_eq!(report.drift_cause, DriftCause::Rounding, "{:?}", report.runs);
    assert_eq!(report.findings[0].kind, FindingKind::RoundingDrift);
    // The rate is 10⁻⁷/h, but for the walk of the uniform numbers: 10⁻⁷/√3 per root of a step, 1 % of 5000 steps.
    for run in &report.runs {
        assert!((run.drift_rate.value * run.dt / 1e-7 - 1.0).abs() < 0.03, "{:?}", run.drift_rate);
    }
    let order = report.drift_law.unwrap().exponent;
    assert!(order.contains(-1.0), "{order:?}");
}

#[test]
fn a_thermostat_is_a_walk_that_does_not_depend_on_the_step() {
    let mut noise = Noise(5);
    // Random kicks with the same variance per second, ten steps for each ratio of steps.
    let traces = [0.1, 0.01, 0.001].map(|dt: f64| {
        let mut energy = 100.0;
        let next = || {
            energy += 0.01 * dt.sqrt() * noise.normal();
            energy
        };
        let steps = (500.0 / dt).round() as usize;
        trace("thermostat", dt, steps, (steps / 5000).max(1), next, 100.0)
    });
    let report = audited(&traces);
    assert_eq!(report.walk_cause, WalkCause::StepIndependent, "{:?}", report.runs);
    assert_eq!(report.findings[0].kind, FindingKind::StepIndependentWalk);
    for run in &report.runs {
        let diffusion = run.walk.unwrap().diffusion;
        // 47 increments of batches: an error of √(2/47) = 21 % of the variance; three of them.
        assert!((diffusion.value / 1e-4).ln().abs() < 3.0 * 0.21, "{diffusion:?}");
    }
}

#[test]
fn a_single_jump_of_one_run_is_no_fault() {
    // Such as that of a particle that crosses the cutoff of a force. Its size says nothing of the step.
    for (jump, at) in [(3e-3, 0.1), (3e-3, 0.5), (1e-2, 0.3)] {
        let traces = [0.2, 0.1].map(|dt: f64| {
            let mut noise = Noise(17);
            let mut step = 0.0_f64;
            let next = || {
                step += 1.0;
                let late = f64::from(dt < 0.15 && step * dt > at * 500.0);
                1.0 + jump * late + dt * dt * (0.1 * noise.normal() + 0.2 * (3.0 * step * dt).sin())
            };
            trace("jump", dt, (500.0 / dt).round() as usize, 1, next, 1.0)
        });
        let report = audited(&traces);
        let outcome = report.verdict.outcome;
        assert_ne!(outcome, Outcome::Fault, "{jump} {at}: {:?} {:?}", report.findings, report.runs);
    }
}
