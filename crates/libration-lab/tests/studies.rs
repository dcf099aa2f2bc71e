//! All studies, as a user runs them: what they find, what they judge, and that they repeat.

#![allow(clippy::unwrap_used)]

use std::collections::HashSet;
use std::sync::OnceLock;
use std::sync::atomic::AtomicBool;

use libration::Method;
use libration_lab::config::{Drift, Spring, Start};
use libration_lab::record::ClaimVerdict::{self, Conditional, Confirmed, NotReproducible, Refuted};
use libration_lab::record::Verdict;
use libration_lab::{Config, Effort, Lab, Record, Silent, studies};

fn run(config: &Config) -> Vec<Record> {
    let stop = AtomicBool::new(false);
    let lab = Lab::new(config, Effort::Quick, &Silent, &stop);
    studies::ALL.iter().map(|study| study.run(&lab).unwrap()).collect()
}

/// The records of the default configuration, made once.
fn default() -> &'static [Record] {
    static RECORDS: OnceLock<Vec<Record>> = OnceLock::new();
    RECORDS.get_or_init(|| run(&Config::default()))
}

fn measured(id: &str) -> f64 {
    let found = default().iter().find_map(|record| record.finding(id).ok());
    found.unwrap_or_else(|| panic!("no finding {id}")).measured
}

fn predicted(id: &str) -> f64 {
    let found = default().iter().find_map(|record| record.finding(id).ok());
    found.and_then(|f| f.predicted).unwrap_or_else(|| panic!("no prediction {id}"))
}

#[track_caller]
fn all_agree(records: &[Record], what: &str) {
    let broken: Vec<_> = records.iter().flat_map(Record::disagreements).collect();
    assert!(broken.is_empty(), "{what}: {broken:#?}");
}

#[test]
fn every_finding_of_the_default_run_agrees() {
    all_agree(default(), "default");
    let predictions =
        default().iter().flat_map(|r| &r.findings).filter(|f| f.predicted.is_some()).count();
    assert!(predictions >= 60, "{predictions} predictions");
}

#[test]
fn every_finding_says_where_its_tolerance_comes_from_and_has_a_name_of_its_own() {
    let mut seen = HashSet::new();
    for record in default() {
        for finding in &record.findings {
            assert!(finding.id.starts_with(&format!("{}.", record.name)), "{}", finding.id);
            assert!(seen.insert(&finding.id), "{} twice", finding.id);
            assert!(finding.tolerance.tolerance_reason.len() > 10, "{}", finding.id);
            assert_eq!(finding.predicted.is_none(), finding.verdict == Verdict::Measured);
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
}

#[test]
fn verdicts_on_the_source_are_these() {
    let expected: &[(&str, ClaimVerdict)] = &[
        ("C03", Conditional),
        ("C04", Confirmed),
        ("C05", Confirmed),
        ("C06", Refuted),
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
        ("C25", Refuted),
        ("C26", Confirmed),
        ("C32", Confirmed),
        ("C33", Conditional),
        ("C34", Confirmed),
        ("C73", Refuted),
        ("C74", Confirmed),
        ("C75", Conditional),
        ("C76", Conditional),
        ("C77", NotReproducible),
        ("C78", Refuted),
        ("C79", Refuted),
    ];
    let mut judged: Vec<_> = default()
        .iter()
        .flat_map(|r| &r.claims)
        .map(|claim| (claim.id.as_str(), claim.verdict))
        .collect();
    judged.sort_by_key(|(id, _)| *id);
    assert_eq!(judged, expected);
}

#[test]
fn findings_agree_for_other_springs_starts_methods_and_steps() {
    let base = Config::default();
    let drift = |dt: &[f64], steps| Drift { dt: dt.to_vec(), steps };
    let all = Method::ALL.to_vec();
    let configs = [
        ("RK4 alone", Config { integrators: vec![Method::Rk4], ..base.clone() }),
        (
            "all methods, large steps and a dyadic one",
            Config {
                integrators: all.clone(),
                oscillator: Spring { m: 1.0, k: 1.0 },
                drift: drift(&[0.0009765625, 0.7, 1.0], 200_000),
                ..base.clone()
            },
        ),
        (
            "a start in motion",
            Config {
                oscillator: Spring { m: 2.5, k: 3.0 },
                start: Start { q: 0.3, v: -1.2 },
                drift: drift(&[0.004, 0.03], 300_000),
                ..base.clone()
            },
        ),
        (
            "beyond every limit of stability",
            Config {
                integrators: all,
                start: Start { q: 0.0, v: 1.0 },
                drift: drift(&[0.7, 1.5], 5_000),
                ..base.clone()
            },
        ),
        ("a single step", Config { drift: drift(&[1e-6], 1), ..base }),
    ];
    for (what, config) in &configs {
        all_agree(&run(config), what);
    }
}

#[test]
fn a_run_repeats_to_the_bit_on_one_thread_and_on_many() {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    let alone = pool.install(|| run(&Config::default()));
    for (a, b) in default().iter().zip(&alone) {
        assert_eq!(serde_json::to_string(a).unwrap(), serde_json::to_string(b).unwrap());
        // NaN marks what is missing, so columns are compared by their bits.
        for (a, b) in
            a.series.iter().zip(&b.series).flat_map(|(a, b)| a.columns.iter().zip(&b.columns))
        {
            let bits = |values: &[f64]| values.iter().map(|x| x.to_bits()).collect::<Vec<_>>();
            assert_eq!(bits(&a.values), bits(&b.values), "{}", a.name);
        }
    }
}
