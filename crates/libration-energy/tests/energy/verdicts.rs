//! Verdicts: what the runs do not tell is unknown, and a stated tolerance is judged.

use libration_energy::{EnergyReport, EnergyTrace, Requirement, audit, page};
use libration_report::verdict::Outcome;

use crate::programs::{Noise, oscillator, rk4, trace, verlet};

const STEPS: [f64; 3] = [0.2, 0.1, 0.05];

fn required(traces: &[EnergyTrace], requirement: Requirement) -> EnergyReport {
    match audit(traces, requirement) {
        Ok(report) => report,
        Err(error) => panic!("{error}"),
    }
}

fn tolerated(traces: &[EnergyTrace], tolerance: f64) -> EnergyReport {
    required(traces, Requirement { tolerance: Some(tolerance), ..Requirement::default() })
}

/// An energy of few particles with a truncated potential: pairs within the cutoff enter and leave it, whatever the step, and each changes
/// the sum by the potential at the cutoff.
fn dilute_gas(dt: f64, seed: u64, pairs: usize, memory: f64) -> EnergyTrace {
    const AT_CUTOFF: f64 = 0.0163;
    let mut noise = Noise(seed);
    let mut within = vec![false; pairs];
    let mut step = 0.0_f64;
    let next = || {
        step += 1.0;
        for pair in &mut within {
            if noise.uniform() < dt / memory {
                *pair = !*pair;
            }
        }
        let sum = within.iter().filter(|pair| **pair).count() as f64;
        5.0 - AT_CUTOFF * sum + 1e-3 * dt * dt * (3.0 * step * dt).sin()
    };
    trace("gas", dt, (200.0 / dt).round() as usize, 1, next, 5.0)
}

#[test]
fn a_spread_that_does_not_fall_with_the_step_is_never_no_fault() {
    for (seed, pairs, memory) in
        [(3, 1, 60.0), (4, 2, 60.0), (5, 3, 40.0), (6, 1, 30.0), (7, 5, 80.0), (8, 2, 20.0)]
    {
        let traces: Vec<EnergyTrace> = STEPS
            .iter()
            .enumerate()
            .map(|(i, dt)| dilute_gas(*dt, seed + 100 * i as u64, pairs, memory))
            .collect();
        let report = required(&traces, Requirement::default());
        let outcome = report.verdict.outcome;
        assert!(
            matches!(outcome, Outcome::Unknown | Outcome::Fault),
            "{seed}: {outcome}: {}",
            report.answer
        );
        assert!(!report.holds() && !report.answer.contains("no fault"), "{}", report.answer);
        let title = ["have a fault is unknown</h1>", "have a fault</h1>"];
        assert!(title.iter().any(|title| page(&report).contains(title)));
    }
}

#[test]
fn runs_that_exceed_the_tolerance_are_told_by_how_much() {
    // Verlet from q = 1 deviates by at most h²/8 from the energy ½: h²/4 of it.
    let traces = STEPS.map(|dt| oscillator(verlet, dt, 300.0));
    for (tolerance, words) in [
        (
            1e-6,
            "3 of 3 runs deviate by 625 to 10\u{202f}000 times 10⁻⁶ of the energy at the start, 0.5",
        ),
        (1e-5, "3 of 3 runs deviate by 62 to 1000 times"),
        (5e-3, "1 of 3 runs deviate by 2 times"),
        (1e-3, "2 of 3 runs deviate by 2.5 to 10 times"),
    ] {
        let report = tolerated(&traces, tolerance);
        assert!(page(&report).contains("exceed the tolerance</h1>"));
        let Some(verdict) = &report.tolerance_verdict else { panic!("no verdict") };
        assert_eq!(verdict.outcome, Outcome::Exceeds, "{tolerance}");
        assert!(verdict.evidence.contains(words), "{tolerance}: {}", verdict.evidence);
        assert!(!report.holds() && report.answer.contains("; the tolerance is exceeded: "));
    }
    // Steps that keep it are named.
    let Some(verdict) = tolerated(&traces, 1e-3).tolerance_verdict else { panic!("no verdict") };
    assert!(verdict.evidence.contains("a step of 0.05 s keep it"), "{}", verdict.evidence);
    let report = tolerated(&traces, 0.0101);
    let Some(verdict) = &report.tolerance_verdict else { panic!("no verdict") };
    assert_eq!(verdict.outcome, Outcome::Within);
    assert!(report.holds(), "{}", report.answer);
    // Without a stated tolerance nothing is judged by one.
    assert_eq!(required(&traces, Requirement::default()).tolerance_verdict, None);
}

#[test]
fn a_tolerance_over_a_longer_horizon_counts_the_drift() {
    // RK4 loses ½·h⁵/72 per second at first: over 300 s h⁵/72·300 = 1.3·10⁻³ of the energy at h = 0.2, over 30,000 s all of it.
    let traces = STEPS.map(|dt| oscillator(rk4, dt, 300.0));
    let over = |horizon: f64, tolerance: f64| {
        let requirement =
            Requirement { tolerance: Some(tolerance), horizon: Some(horizon), scale: None };
        required(&traces, requirement).tolerance_verdict.map(|verdict| verdict.outcome)
    };
    assert_eq!(over(300.0, 1.4e-3), Some(Outcome::Within));
    assert_eq!(over(300.0, 1.2e-3), Some(Outcome::Exceeds));
    assert_eq!(over(3000.0, 1.4e-3), Some(Outcome::Exceeds));
    // Up to 100 s a third of it: 4.4·10⁻⁴.
    assert_eq!(over(100.0, 4.6e-4), Some(Outcome::Within));
    assert_eq!(over(100.0, 4.3e-4), Some(Outcome::Exceeds));
}

#[test]
fn a_stated_scale_does_not_depend_on_the_constant_of_the_potential() {
    let raised = |constant: f64| {
        STEPS.map(|dt| {
            let mut trace = oscillator(verlet, dt, 300.0);
            trace.energies.iter_mut().for_each(|energy| *energy += constant);
            trace
        })
    };
    let requirement =
        Requirement { tolerance: Some(5e-3), scale: Some(0.5), ..Requirement::default() };
    for constant in [0.0, 1000.0, -0.5, -0.4, 7.0] {
        let report = required(&raised(constant), requirement);
        let Some(verdict) = &report.tolerance_verdict else { panic!("no verdict") };
        assert_eq!(verdict.outcome, Outcome::Exceeds, "{constant}");
        assert!(
            verdict.evidence.contains("1 of 3 runs deviate by 2 times"),
            "{}",
            verdict.evidence
        );
        assert!(verdict.evidence.contains("of the given scale, 0.5"), "{}", verdict.evidence);
    }
    // Without one the tolerance says what it is relative to.
    let answer = tolerated(&raised(1000.0), 5e-3).answer;
    assert!(answer.contains("of the energy at the start, 1000"), "{answer}");
    let answer = tolerated(&raised(-0.5), 5e-3).answer;
    assert!(answer.contains("in the unit of the energies"), "{answer}");
}

#[test]
fn runs_from_different_energies_are_not_compared() {
    let mut traces = STEPS.map(|dt| oscillator(verlet, dt, 300.0));
    traces[1].energies.iter_mut().for_each(|energy| *energy += 0.1);
    let report = required(&traces, Requirement::default());
    assert_eq!(report.verdict.outcome, Outcome::Unknown, "{}", report.answer);
    assert!(report.verdict.evidence.contains("different energies"), "{:?}", report.verdict);
}
