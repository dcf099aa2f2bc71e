//! All studies, as a user runs them: what they find, what they judge, and that they repeat.

use std::collections::HashSet;
use std::sync::atomic::AtomicBool;

use libration::Method;
use libration_lab::STUDIES;
use libration_report::Record;
use libration_report::record::ClaimVerdict::{Conditional, Confirmed, NotReproducible, Refuted};
use libration_report::record::{Agreement, ClaimVerdict};
use libration_study::{Config, Effort, Lab, Silent, Spring, Start, Study};
use libration_study_motion::{DriftSettings, EfficiencySettings, ErrorSettings, StabilitySettings};

use crate::default_run::{measured, predicted, records};

#[track_caller]
fn all_agree(records: &[Record], what: &str) {
    let broken: Vec<_> = records.iter().flat_map(Record::disagreements).collect();
    assert!(broken.is_empty(), "{what}: {broken:#?}");
}

#[test]
fn every_finding_of_the_default_run_agrees() {
    all_agree(records(), "default");
    let predictions =
        records().iter().flat_map(|r| &r.findings).filter(|f| f.predicted.is_some()).count();
    assert!(predictions >= 200, "{predictions} predictions");
}

#[test]
fn every_finding_says_where_its_tolerance_comes_from_and_has_a_name_of_its_own() {
    let mut seen = HashSet::new();
    for record in records() {
        for finding in &record.findings {
            assert!(finding.id.starts_with(&format!("{}.", record.name)), "{}", finding.id);
            assert!(seen.insert(&finding.id), "{} twice", finding.id);
            assert!(finding.tolerance.tolerance_reason.len() > 10, "{}", finding.id);
            assert_eq!(finding.predicted.is_none(), finding.verdict == Agreement::Measured);
        }
    }
}

/// A derivation that agrees with itself may still be wrong: these are the textbook's numbers.
#[test]
fn predictions_are_those_of_the_textbook() {
    let close = |id: &str, want: f64, tolerance: f64| {
        let got = predicted(id);
        assert!((got - want).abs() <= tolerance * want.abs(), "{id}: {got:e}, not {want:e}");
    };
    // Limits found by bisection to the last bit but two.
    close("spectrum.symplectic-euler.imaginary-limit", 2.0, 1e-14);
    close("spectrum.velocity-verlet.imaginary-limit", 2.0, 1e-14);
    close("spectrum.rk4.imaginary-limit", 8.0_f64.sqrt(), 1e-14);
    close("spectrum.rk4.real-limit", 2.785_293_563_405_282, 1e-14);
    close("spectrum.explicit-euler.real-limit", 2.0, 1e-14);
    assert_eq!(predicted("spectrum.explicit-euler.imaginary-limit"), 0.0);
    // At z² = 10⁻³ the next terms are of relative size z².
    let z = 0.1 * 0.1_f64.sqrt();
    close("spectrum.velocity-verlet.phase-error", z.powi(3) / 24.0, z * z);
    close("spectrum.symplectic-euler.phase-error", z.powi(3) / 24.0, z * z);
    close("spectrum.rk4.phase-error", -z.powi(5) / 120.0, z * z);
    close("spectrum.explicit-euler.phase-error", -z.powi(3) / 3.0, z * z);
    close("spectrum.rk4.symplecticity", 2.0_f64.sqrt() * z.powi(6) / 72.0, z * z);
    // Over 10⁶ steps the discrete orbit comes within 10⁻¹¹ of the extremes of its curve.
    close("drift.velocity-verlet.dt-0.01.largest", z * z / 4.0, 1e-11);
    close("drift.velocity-verlet.dt-0.01.worst", z * z / (4.0 - z * z), 1e-11);
    close("drift.symplectic-euler.dt-0.01.largest", z / (2.0 - z), 1e-9);
    close("drift.explicit-euler.dt-0.001.largest", (1e6 * 1e-5_f64.ln_1p()).exp_m1(), 1e-12);
    close("drift.crossover.dt-0.1.leading-order", 1800.0, 1e-12);
    assert_eq!(measured("drift.explicit-euler.dt-0.1.overflow"), 7425.0);
    // A small pendulum is an oscillator of √9.81 rad/s.
    let omega = 9.81_f64.sqrt();
    close("nonlinear.pendulum.velocity-verlet.small-limit", 2.0 / omega, 1e-14);
    close("nonlinear.pendulum.rk4.small-limit", 8.0_f64.sqrt() / omega, 1e-14);
    assert_eq!(predicted("nonlinear.pendulum.explicit-euler.small-limit"), 0.0);
    for (id, order) in [
        ("convergence.kepler.rk4.global-order", 4.0),
        ("convergence.pendulum.velocity-verlet.local-order", 3.0),
        ("convergence.trap.position", 2.0),
        ("convergence.trap.velocity", 1.0),
        ("nonlinear.kepler.rk4.rate-order", 5.0),
        ("nonlinear.kepler.rk4.swing-order", 4.0),
        ("nonlinear.henon-heiles.rk4.return-order", 6.0),
    ] {
        assert_eq!(predicted(id), order, "{id}");
        assert!((measured(id) - order).abs() < 0.1, "{id}: {}", measured(id));
    }
}

/// Claims about speed, on which machines may differ: how slow Verlet is, what arrays and blocks gain, what fills the memory.
const OF_THE_MACHINE: [&str; 15] = [
    "C01", "C02", "C36", "C37", "C39", "C40", "C42", "C46", "C47", "C56", "C57", "C81", "C82",
    "C95", "C96",
];

#[test]
fn verdicts_on_the_source_are_these() {
    let expected: &[(&str, ClaimVerdict)] = &[
        ("C03", Conditional),
        ("C04", Confirmed),
        ("C05", Confirmed),
        ("C06", Refuted),
        ("C07", Confirmed),
        ("C08", Confirmed),
        ("C09", Confirmed),
        ("C10", Confirmed),
        ("C11", Confirmed),
        ("C12", Confirmed),
        ("C13", Conditional),
        ("C14", Confirmed),
        ("C15", Confirmed),
        ("C16", Conditional),
        ("C17", Refuted),
        ("C18", Confirmed),
        ("C19", Refuted),
        ("C22", Confirmed),
        ("C23", Confirmed),
        ("C24", Confirmed),
        ("C25", Refuted),
        ("C26", Confirmed),
        ("C27", Refuted),
        ("C28", Confirmed),
        ("C30", Conditional),
        ("C32", Confirmed),
        ("C33", Conditional),
        ("C34", Confirmed),
        ("C35", Conditional),
        ("C43", Conditional),
        ("C44", Refuted),
        ("C45", NotReproducible),
        ("C48", Confirmed),
        ("C49", Refuted),
        ("C50", Refuted),
        ("C51", Conditional),
        ("C52", Conditional),
        ("C53", Conditional),
        ("C53a", Refuted),
        ("C54", Refuted),
        ("C55", Conditional),
        ("C58", Confirmed),
        ("C58a", NotReproducible),
        ("C59", Confirmed),
        ("C59a", Conditional),
        ("C59b", Confirmed),
        ("C59c", Conditional),
        ("C60", Conditional),
        ("C61", Confirmed),
        ("C62", Conditional),
        ("C63", Confirmed),
        ("C64", Refuted),
        ("C65", Conditional),
        ("C65a", Conditional),
        ("C66", Conditional),
        ("C67", Conditional),
        ("C67a", Conditional),
        ("C68", NotReproducible),
        ("C69", Conditional),
        ("C70", Conditional),
        ("C71", Conditional),
        ("C73", Refuted),
        ("C74", Confirmed),
        ("C75", Conditional),
        ("C76", Conditional),
        ("C77", NotReproducible),
        ("C78", Refuted),
        ("C79", Refuted),
        ("C80", Conditional),
        ("C84", Refuted),
        ("C85", Confirmed),
        ("C86", Confirmed),
        ("C87", Confirmed),
        ("C88", Confirmed),
        ("C89", Refuted),
        ("C90", Confirmed),
        ("C91", Refuted),
        ("C93", Conditional),
    ];
    let mut judged: Vec<_> = records()
        .iter()
        .flat_map(|r| &r.claims)
        .map(|claim| (claim.id.as_str(), claim.verdict))
        .filter(|(id, _)| !OF_THE_MACHINE.contains(id))
        .collect();
    judged.sort_by_key(|(id, _)| *id);
    assert_eq!(judged, expected);
}

#[test]
fn a_conditional_verdict_says_its_condition_and_no_other_has_one() {
    for claim in records().iter().flat_map(|r| &r.claims) {
        let stated = claim.condition.as_ref().is_some_and(|words| !words.is_empty());
        assert_eq!(stated, claim.verdict == Conditional, "{}", claim.id);
    }
}

#[test]
fn findings_agree_for_other_springs_starts_methods_and_steps() {
    // The default run has the longest horizons, which take seconds.
    let efficiency = EfficiencySettings { periods: vec![10, 1000], ..Default::default() };
    let error = ErrorSettings { steps: 100_000, ..Default::default() };
    let stability = StabilitySettings { steps: vec![1000, 10_000], ..Default::default() };
    let base = STUDIES.config().with(efficiency.clone()).with(error).with(stability);
    let alone = EfficiencySettings { splitting_methods: Vec::new(), ..efficiency };
    let drift = |dt: &[f64], steps| DriftSettings { dt: dt.to_vec(), steps };
    let all = Method::ALL.to_vec();
    let configs = [
        (
            "RK4 alone",
            Config { integrators: vec![Method::Rk4], ..base.clone() }.with(alone.clone()),
        ),
        (
            "all methods, large steps and a dyadic one",
            Config {
                integrators: all.clone(),
                oscillator: Spring { m: 1.0, k: 1.0 },
                ..base.clone()
            }
            .with(drift(&[0.0009765625, 0.7, 1.0], 30_000)),
        ),
        (
            "a start in motion",
            Config {
                oscillator: Spring { m: 2.5, k: 3.0 },
                start: Start { q: 0.3, v: -1.2 },
                ..base.clone()
            }
            .with(drift(&[0.004, 0.03], 60_000)),
        ),
        (
            "beyond every limit of stability",
            Config { integrators: all, start: Start { q: 0.0, v: 1.0 }, ..base.clone() }
                .with(drift(&[0.7, 1.5], 5_000))
                .with(alone),
        ),
    ];
    let stop = AtomicBool::new(false);
    let single = base.with(drift(&[1e-6], 1));
    let lab = Lab::new(&single, Effort::Quick, &Silent, &stop);
    all_agree(&[libration_study_motion::Drift.run(&lab).unwrap()], "a single step");
    for (what, config) in &configs {
        let lab = Lab::new(config, Effort::Quick, &Silent, &stop);
        // These concern other systems, or one oscillator and no other; of `precision` other tests have such settings.
        let others = [
            "convergence",
            "nonlinear",
            "adaptive",
            "precision",
            "latency",
            "jitter",
            "asynchrony",
            "determinism",
            "hierarchy",
            "throughput",
            "memory",
            "rollout",
            "storage",
        ];
        let own = STUDIES.studies.iter().filter(|s| !others.contains(&s.name()));
        let records: Vec<Record> = own.map(|study| study.run(&lab).unwrap()).collect();
        all_agree(&records, what);
    }
}
