//! The studies of uneven clocks: numbers that were found elsewhere, and settings far from the default.

use std::sync::atomic::AtomicBool;

use libration::Method;
use libration_lab::STUDIES;
use libration_report::Record;
use libration_study::{Config, Effort, Lab, Silent, Spring, Start, Study};

use crate::default_run::{measured, predicted, records};

#[track_caller]
fn close(found: f64, wanted: f64, tolerance: f64) {
    assert!((found / wanted - 1.0).abs() < tolerance, "{found:e}, not {wanted:e}");
}

/// What stands in the `column` of the row of a method and a time step, of a table of the study `jitter`.
fn entry(table: &str, method: &str, dt: f64, column: usize) -> f64 {
    let record = records().iter().find(|record| record.name == "jitter").unwrap();
    let rows = &record.table(table).unwrap().rows;
    rows.iter().find(|r| r[0] == method.into() && r[1] == dt.into()).unwrap()[column]
        .value()
        .unwrap()
}

#[test]
fn second_moments_grow_as_an_independent_calculation_says() {
    // Gaussian jitter of 10 % at Δt = 0.1 s.
    let excess = entry("second moments", Method::SymplecticEuler.title(), 0.1, 3);
    close(excess, 5.136578180582e-5, 1e-9);
}

#[test]
fn the_exponents_are_those_of_theory() {
    let mean = |method: &str, dt: &str| predicted(&format!("jitter.{method}.dt-{dt}.rms-0.1.mean"));
    // The mean of ln E after 10 000 steps of a quick run.
    close(mean("symplectic-euler", "0.1"), 2.0 * 1.2841079e-5 * 1e4, 1e-6);
    close(mean("velocity-verlet", "0.1"), 2.0 * 3.355775e-7 * 1e4, 1e-5);
    // σ²z⁴/8 and σ²z⁶/32 at z² = 10⁻⁵, where the next terms are of relative size z².
    close(mean("symplectic-euler", "0.001"), 2.0 * 1e-12 / 8.0 * 1e4, 1e-5);
    close(mean("velocity-verlet", "0.001"), 2.0 * 1e-17 / 32.0 * 1e4, 1e-5);
}

#[test]
fn ensembles_fall_to_1_over_e_after_the_steps_that_were_found_by_hand() {
    close(predicted("asynchrony.gaussian.steps"), 4471.577, 1e-6);
    close(predicted("asynchrony.uniform.steps"), 4014.529, 1e-6);
    assert!(measured("asynchrony.jitter.slower") > 50.0);
}

#[test]
fn a_swinging_clock_is_worse_than_a_white_one_and_missed_ticks_undo_a_damper() {
    assert!(measured("jitter.resonance.beside-white") > 30.0);
    assert!(measured("jitter.switching.short") < 0.0 && measured("jitter.switching.long") < 0.0);
    assert!(measured("jitter.switching.worst") > 0.1);
}

fn run(study: &dyn Study, config: &Config) -> Record {
    let stop = AtomicBool::new(false);
    study.run(&Lab::new(config, Effort::Quick, &Silent, &stop)).unwrap()
}

#[test]
fn findings_agree_for_other_springs_starts_and_methods() {
    let base = STUDIES.config();
    let spring = |k: f64| Spring { m: 1.0, k };
    for (what, config) in [
        ("a soft spring", Config { oscillator: spring(0.5), ..base.clone() }),
        ("steps beyond the limit", Config { oscillator: spring(1e3), ..base.clone() }),
        (
            "a start in motion",
            Config {
                oscillator: Spring { m: 2.5, k: 3.0 },
                start: Start { q: 0.3, v: -1.2 },
                ..base.clone()
            },
        ),
        ("RK4 alone", Config { integrators: vec![Method::Rk4], ..base.clone() }),
        ("a method that is not jittered", Config { integrators: vec![Method::Leapfrog], ..base }),
    ] {
        for study in
            [&libration_study_loops::Jitter as &dyn Study, &libration_study_loops::Asynchrony]
        {
            let record = run(study, &config);
            let broken: Vec<_> = record.disagreements().collect();
            assert!(broken.is_empty(), "{what}: {broken:#?}");
        }
    }
}
