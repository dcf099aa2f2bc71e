//! Tests of published methods and of `libration analyze --compare`.

use assert_cmd::Command;
use predicates::prelude::*;
use predicates::str::contains;
use serde_json::Value;

fn libration(words: &str) -> assert_cmd::assert::Assert {
    Command::cargo_bin("libration").unwrap().args(words.split_whitespace()).assert()
}

#[test]
fn the_cheapest_integrator_of_a_motion_comes_first() {
    let words = "analyze --system kepler --compare --tolerance 1e-5 --horizon 20";
    libration(words).success().stdout(
        contains("the cheapest of 95 integrators that were tried")
            .and(contains("Not tried: implicit integrators, steps of variable length.")),
    );
    let output = libration(&format!("{words} --json")).success().get_output().stdout.clone();
    let found: Value = serde_json::from_slice(&output).unwrap();
    assert_eq!(found["schema"], "libration.integrator-comparison/1");
    let costs: Vec<f64> = found["integrators"]
        .as_array()
        .unwrap()
        .iter()
        .map_while(|one| one["evaluations"].as_f64())
        .collect();
    assert!(costs.len() > 40 && costs.is_sorted(), "{costs:?}");
}

#[test]
fn wrong_comparisons_are_usage_errors() {
    let fails = |words: &str, what: &str| {
        libration(words).failure().code(2).stderr(contains(what));
    };
    fails("analyze --system kepler --compare", "--tolerance");
    fails("analyze --system kepler --compare --tolerance 2 --horizon 1", "from 1e-13 to 0.1");
    fails(
        "analyze --system kepler --compare --tolerance 1e-3 --horizon 1 --dt 0.1",
        "cannot be used with",
    );
    fails("analyze --system kepler --integrator rk4 --dt 0.1 --tolerance 1e-3", "--compare");
    fails(
        "analyze --system kepler --q 1,0 --v 0,0 --compare --tolerance 1e-6 --horizon 9",
        "after 1.11072",
    );
}

#[test]
fn published_methods_are_listed_with_sources_and_run() {
    libration("list").success().stdout(contains("blanes-moan-srkn-11-6"));
    let output = libration("list --json").success().get_output().stdout.clone();
    let all: Value = serde_json::from_slice(&output).unwrap();
    let sources =
        all["integrators"].as_array().unwrap().iter().filter(|one| one["source"].is_string());
    assert_eq!(sources.count(), 86);
    let step = "--system oscillator --integrator blanes-moan-srkn-11-6 --dt 0.1";
    libration(&format!("analyze {step} --verbose"))
        .success()
        .stdout(contains("order 6 for forces of positions, symmetric"));
    libration(&format!("simulate {step} --steps 9 --num-trajectories 3")).success();
    // Messages do not list all of them, but find the nearest.
    libration("analyze --system oscillator --integrator blanes-moan-srkn --dt 0.1")
        .failure()
        .code(2)
        .stderr(contains("did you mean `blanes-moan-srkn-").and(contains("kahan-li").not()));
}

#[test]
fn a_table_has_the_order_of_its_certificate_where_it_applies_and_a_derived_one_elsewhere() {
    for (system, table, order) in [
        ("chain", "mclachlan-ss17-8", 8),
        ("chain", "dormand-prince-rkn-12", 12),
        ("dc_motor", "dormand-prince-8", 8),
        ("dc_motor", "dormand-prince-rkn-12", 1),
    ] {
        let file = format!("../../examples/systems/{system}.toml");
        let words =
            ["analyze", "--system", &file, "--integrator", table, "--dt", "0.001", "--json"];
        // One that has lost its order does not resolve the motion.
        let done = super::advise::libration(&words).code(i32::from(order == 1));
        let found: Value = serde_json::from_slice(&done.get_output().stdout).unwrap();
        assert_eq!(found["motion"]["order"], order, "{table} on {system}");
        assert_eq!(found["motion"]["order_is_certified"], order > 1, "{table} on {system}");
    }
}
