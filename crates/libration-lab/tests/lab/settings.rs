//! The studies of one step and of the drift, at settings far from the default.

use std::sync::atomic::AtomicBool;

use libration::Method;
use libration_lab::STUDIES;
use libration_report::Record;
use libration_report::record::{Agreement, Finding};
use libration_study::{Config, Effort, Lab, Silent, Spring, Study};
use libration_study_motion::{DriftSettings, Efficiency, EfficiencySettings, SpectrumSettings};

use crate::default_run::records;

fn run(study: &dyn Study, config: &Config) -> Record {
    let stop = AtomicBool::new(false);
    study.run(&Lab::new(config, Effort::Quick, &Silent, &stop)).unwrap()
}

fn drift(dt: &[f64], steps: u64) -> DriftSettings {
    DriftSettings { dt: dt.to_vec(), steps }
}

fn spring(k: f64) -> Spring {
    Spring { m: 1.0, k }
}

#[track_caller]
fn agrees(study: &dyn Study, config: &Config, what: &str) -> Record {
    let record = run(study, config);
    let broken: Vec<_> = record.disagreements().collect();
    assert!(broken.is_empty(), "{what}: {broken:#?}");
    record
}

fn tolerance(finding: &Finding) -> f64 {
    finding.tolerance.tolerance.unwrap()
}

fn judged(record: &Record, id: &str) -> bool {
    record.claims.iter().any(|claim| claim.id == id)
}

#[test]
fn an_orbit_that_closes_after_a_few_points_drifts_as_predicted() {
    // z = 1 and √3: six and three points. The slip of the phase counts there to first order.
    for (k, dt) in [(1e6, 1e-3), (100.0, 0.1), (3e6, 1e-3), (4.0, 0.2)] {
        let base = Config { oscillator: spring(k), ..STUDIES.config() };
        let config = base.with(drift(&[dt], 1_000_000));
        let record = agrees(&libration_study_motion::Drift, &config, &format!("k = {k}"));
        let id = format!("drift.velocity-verlet.dt-{dt}.largest");
        // 10⁶ steps slip by 8uz·10⁶ = 10⁻⁹ rad: a tolerance far below the drift of 0.2.
        assert!(tolerance(record.finding(&id).unwrap()) < 1e-8, "{id}");
    }
}

#[test]
fn rounding_of_round_numbers_is_biased_and_covered() {
    // Δt·ω² = 1 and 2: the additions of Verlet round in a pattern, 0.006 and 0.024 u a step.
    let config =
        Config { integrators: vec![Method::VelocityVerlet, Method::Leapfrog], ..STUDIES.config() }
            .with(drift(&[0.1, 0.2], 3_000_000));
    let record = agrees(&libration_study_motion::Drift, &config, "3·10⁶ steps");
    let strayed = record.finding("drift.velocity-verlet.dt-0.2.invariant").unwrap();
    // 12·√n·e^z·u is what independent roundings would leave; 0.024·n·u is more from 9·10⁵ steps on.
    assert!(strayed.measured > 12.0 * 3e6_f64.sqrt() * 1.88 * 1.1e-16, "{}", strayed.measured);
}

#[test]
fn findings_agree_up_to_the_limit_of_stability_and_at_it() {
    let dts = [0.6324, 0.632455, 0.6324555320336759];
    let config = STUDIES.config().with(drift(&dts, 100_000));
    agrees(&libration_study_motion::Drift, &config, "drift");
    for dt in dts {
        let config = STUDIES.config().with(SpectrumSettings { dt });
        agrees(&libration_study_motion::Spectrum, &config, &format!("spectrum at {dt}"));
    }
}

#[test]
fn a_composition_rounds_in_each_of_its_substeps() {
    // Beyond the limit of Yoshida's composition; z = 1.63.
    let config = Config {
        integrators: Method::ALL.to_vec(),
        oscillator: spring(0.1272938754405746),
        ..STUDIES.config()
    }
    .with(SpectrumSettings { dt: 4.562678649912722 });
    agrees(&libration_study_motion::Spectrum, &config, "z = 1.63");
}

#[test]
fn an_extreme_step_ends_no_study_and_takes_no_longer() {
    for (k, dt) in [(10.0, 1e-30), (10.0, 1e-9), (1e-30, 0.01), (10.0, 1e9), (1e300, 1e308)] {
        let spectrum = SpectrumSettings { dt };
        let config = Config { oscillator: spring(k), ..STUDIES.config() }.with(spectrum);
        agrees(&libration_study_motion::Spectrum, &config, &format!("k = {k}, Δt = {dt}"));
    }
    for (k, dt) in [(10.0, 1e-30), (10.0, 1e-300), (1e-30, 0.1)] {
        let drift = drift(&[dt], 100_000);
        let config = Config { oscillator: spring(k), ..STUDIES.config() }.with(drift);
        let record =
            agrees(&libration_study_motion::Drift, &config, &format!("k = {k}, Δt = {dt}"));
        let longest = record.series.iter().map(|series| series.name.len()).max();
        assert!(longest.unwrap() < 60);
    }
}

#[test]
fn what_a_symplectic_step_conserves_strays_by_rounding_alone() {
    let record = records().iter().find(|record| record.name == "drift").unwrap();
    for dt in ["dt-0.001", "dt-0.01", "dt-0.1"] {
        for method in ["symplectic-euler", "velocity-verlet"] {
            let finding = record.finding(&format!("drift.{method}.{dt}.invariant")).unwrap();
            assert_eq!((finding.predicted, finding.verdict), (Some(0.0), Agreement::Agrees));
            let swing = record.finding(&format!("drift.{method}.{dt}.largest")).unwrap().measured;
            assert!(finding.measured > 0.0 && finding.measured < 1e-6 * swing, "{method} {dt}");
        }
        for method in ["explicit-euler", "rk4"] {
            assert!(record.finding(&format!("drift.{method}.{dt}.invariant")).is_err());
        }
    }
    for id in ["C10", "C12"] {
        let claim = record.claims.iter().find(|claim| claim.id == id).unwrap();
        assert!(claim.findings.iter().any(|finding| finding.ends_with(".invariant")), "{id}");
    }
}

#[test]
fn where_no_form_is_definite_there_is_no_envelope_and_no_verdict_from_it() {
    // z = 2.85, beyond the limits of all methods.
    let config = STUDIES.config().with(drift(&[0.9], 1000));
    let record = agrees(&libration_study_motion::Drift, &config, "z = 2.85");
    assert!(record.finding("drift.velocity-verlet.dt-0.9.envelope").is_err());
    assert!(record.finding("drift.rk4.dt-0.9.envelope").is_ok());
    assert!(!judged(&record, "C34") && !judged(&record, "C10") && !judged(&record, "C12"));
}

#[test]
fn a_claim_about_the_source_s_runs_is_judged_at_its_own_setting_alone() {
    let base = STUDIES.config().with(drift(&[1e-3], 1_000_000));
    let own = run(&libration_study_motion::Drift, &base);
    let others = [
        Config { oscillator: spring(1e5), ..base.clone() },
        base.clone().with(drift(&[1e-3], 10)),
        base.clone().with(drift(&[2e-3], 1_000_000)),
        Config { start: libration_study::Start { q: 0.0, v: 1.0 }, ..base },
    ];
    for config in others {
        let record = run(&libration_study_motion::Drift, &config);
        for id in ["C03", "C16", "C25", "C73"] {
            assert!(judged(&own, id) && !judged(&record, id), "{id} at {config:?}");
        }
    }
}

#[test]
fn a_drift_that_is_no_more_than_rounding_confirms_nothing() {
    // RK4 loses z⁶/72 = 1.4·10⁻¹⁷ a step at Δt = 1 ms.
    let config = STUDIES.config().with(drift(&[1e-3], 10));
    let record = agrees(&libration_study_motion::Drift, &config, "ten steps");
    assert!(["C15", "C22", "C33"].iter().all(|id| !judged(&record, id)));
}

#[test]
fn verlet_overtakes_rk4_at_the_step_that_its_own_orbit_says() {
    // z = 1.0000007 and nearly √3: orbits that go round their curve in 10⁶ steps.
    for (dt, steps) in [(0.316228, 100), (0.547722, 10)] {
        let config = STUDIES.config().with(drift(&[dt], steps));
        let record = agrees(&libration_study_motion::Drift, &config, &format!("Δt = {dt}"));
        let crossover = record.finding(&format!("drift.crossover.dt-{dt}.measured")).unwrap();
        assert_eq!(crossover.verdict, Agreement::Agrees, "{crossover:?}");
    }
}

#[test]
fn an_error_whose_square_overflows_is_still_an_error() {
    let error = libration_study_motion::ErrorSettings { dt: 0.01, steps: 1_000_000 };
    let config =
        Config { integrators: vec![Method::ExplicitEuler], ..STUDIES.config() }.with(error);
    let record = agrees(&libration_study_motion::Error, &config, "10²¹⁵ m");
    assert!(record.finding("error.explicit-euler.late").unwrap().measured > 1e200);
}

#[test]
fn a_search_that_slips_past_its_limit_by_visiting_few_phases_is_expected_to() {
    // z = 1.37, where a turn is nearly four steps.
    for steps in [127, 129, 130] {
        let stability = libration_study_motion::StabilitySettings {
            tolerances: vec![2.17],
            steps: vec![steps],
        };
        let config = STUDIES.config().with(stability);
        agrees(&libration_study_motion::Stability, &config, &format!("{steps} steps"));
    }
}

#[test]
fn an_orbit_that_does_not_turn_is_no_test_of_a_drift() {
    // At z = 2 the start (1, 0) is an eigenvector of Verlet: its energy never changes.
    for tolerance in [1.0, 2.0] {
        let efficiency = EfficiencySettings {
            periods: vec![10],
            tolerances: vec![tolerance],
            ..Default::default()
        };
        let config = STUDIES.config().with(efficiency);
        agrees(&Efficiency, &config, &format!("{tolerance}"));
    }
}

#[test]
fn the_cheapest_of_the_source_s_methods_is_the_one_that_a_hand_calculation_finds() {
    let settings = EfficiencySettings { splitting_methods: Vec::new(), ..Default::default() };
    let record = run(&Efficiency, &STUDIES.config().with(settings));
    let rows = &record.table("answers").unwrap().rows;
    let answer = |kind: &str, periods: u64| {
        let asked = [kind.into(), 1e-4.into(), periods.into()];
        rows.iter().find(|row| row[..3] == asked).unwrap()[3].clone()
    };
    // Verlet: 2·2π/0.02 = 628 evaluations a period; RK4 at z = 0.0163: 1543, at z = 0.0649: 388.
    assert_eq!(answer("energy", 1_000_000), "velocity Verlet".into());
    assert_eq!(answer("energy", 1000), "RK4".into());
    assert_eq!(answer("state", 1_000_000), "RK4".into());
}
