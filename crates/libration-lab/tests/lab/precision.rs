//! The study of float types: numbers that were found elsewhere, and settings far from the default.

use std::sync::atomic::AtomicBool;

use libration::Method;
use libration_lab::STUDIES;
use libration_report::Record;
use libration_study::{Config, Effort, Lab, Silent, Spring, Start, Study};
use libration_study_motion::PrecisionSettings;

use crate::default_run::{measured, predicted, records};

fn run(config: &Config) -> Record {
    let stop = AtomicBool::new(false);
    libration_study_motion::Precision.run(&Lab::new(config, Effort::Quick, &Silent, &stop)).unwrap()
}

fn default_record() -> &'static Record {
    records().iter().find(|record| record.name == "precision").unwrap()
}

fn short(dt: &[f64]) -> PrecisionSettings {
    PrecisionSettings { dt: dt.to_vec(), steps: 50_000 }
}

#[test]
fn cycles_and_clocks_are_those_of_an_independent_search() {
    assert_eq!(measured("precision.textbook-verlet.f32.pre-period"), 177_350.0);
    assert_eq!(measured("precision.textbook-verlet.f32.period"), 377_896.0);
    // Printed with two decimals.
    assert!((predicted("precision.clock.f32.dt-0.01") - 9865.22).abs() < 0.005);
    // Half a unit in the last place of these is more than a tick.
    assert_eq!(predicted("precision.clock.f16.dt-0.01"), 32.0);
    assert_eq!(predicted("precision.clock.bf16.dt-0.01"), 4.0);
}

#[test]
fn short_floats_stop_drifting_and_long_ones_do_not() {
    let table = default_record().table("float types").unwrap();
    let drift = |name: &str| {
        table.rows.iter().find(|row| row[0] == name.into()).unwrap()[4].value().unwrap()
    };
    // Root mean squares over 16 orbits are known to 4/√32 of themselves.
    let known = [("f16", 1.5e-2), ("f32", 6.8e-5), ("f32-compensated", 1.2e-6), ("f64", 1.1e-13)];
    for (name, known) in known {
        assert!((drift(name) / known - 1.0).abs() < 0.72, "{name}: {}", drift(name));
    }
    // √n times the rounding of a step would be a drift of more than everything.
    assert!(drift("bf16") < 0.1, "{}", drift("bf16"));
}

#[test]
fn rounding_overtakes_truncation_where_it_was_found_to() {
    // The steps go as the square of a coefficient that is given to a tenth or so.
    let close = |found: f64, known: f64| assert!((found / known - 1.0).abs() < 0.25, "{found}");
    close(predicted("precision.crossover.dt-0.001"), 1.7e3);
    let table = default_record().table("rounding overtakes truncation").unwrap();
    close(table.rows[1][2].value().unwrap(), 1.4e7);
}

#[test]
fn a_force_in_single_precision_costs_a_small_part_of_a_state_in_it() {
    let scatter = |state: &str, force: &str| {
        measured(&format!("precision.state-{state}.force-{force}.scatter"))
    };
    // A kick adds the force in with ½Δt: z/2 = 0.016 of the rounding of a state, or about that.
    let part = scatter("f64", "f32") / scatter("f32", "f64");
    assert!((0.003..0.06).contains(&part), "{part}");
    // −ω²q is one product, which f64 rounds to the same f32.
    assert_eq!(scatter("f32", "f32"), scatter("f32", "f64"));
}

#[test]
fn findings_agree_wherever_a_prediction_is_made() {
    let base = Config { integrators: Method::ALL.to_vec(), ..STUDIES.config() };
    let spring = |k: f64| Spring { m: 1.0, k };
    let configs = [
        ("a soft spring", Config { oscillator: spring(1.0), ..base.clone() }.with(short(&[0.01]))),
        (
            "a start in motion",
            Config {
                oscillator: Spring { m: 2.5, k: 3.0 },
                start: Start { q: 0.3, v: -1.2 },
                ..base.clone()
            }
            .with(short(&[0.004, 0.03])),
        ),
        ("large steps and a dyadic one", base.clone().with(short(&[0.015625, 0.3]))),
        ("no stable step", base.clone().with(short(&[10.0]))),
        ("steps too small to count", base.clone().with(short(&[1e-9]))),
        (
            "a start beyond single precision",
            Config { start: Start { q: 1e100, v: 0.0 }, ..base.clone() }.with(short(&[0.01])),
        ),
        ("one step", base.with(PrecisionSettings { dt: vec![0.01], steps: 1 })),
    ];
    for (what, config) in &configs {
        let record = run(config);
        let broken: Vec<_> = record.disagreements().collect();
        assert!(broken.is_empty(), "{what}: {broken:#?}");
    }
}
