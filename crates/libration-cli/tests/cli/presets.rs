//! Presets of latencies.

use std::fs;
use std::path::Path;

use libration_settings::latency_presets::{PRESETS, markdown};
use predicates::prelude::*;
use serde_json::Value;

use super::advise::libration;

const LOOP: [&str; 8] = [
    "--system",
    "oscillator",
    "--set",
    "omega2=10",
    "--feedback",
    "10,2",
    "--latency",
    "preset:px4-gyro",
];

/// The output up to the throughput, which is measured anew.
fn results(output: &assert_cmd::assert::Assert) -> String {
    let text = String::from_utf8(output.get_output().stdout.clone()).unwrap();
    text.split("\"throughput\"").next().unwrap().to_owned()
}

#[test]
fn the_table_of_the_documentation_is_that_of_the_program() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/advise.md");
    let text = fs::read_to_string(path).unwrap();
    assert!(text.contains(&markdown()), "docs/advise.md: expected\n{}", markdown());
}

#[test]
fn presets_are_listed_with_their_sources() {
    let text = libration(&["list", "--presets"]).success();
    let text = String::from_utf8(text.get_output().stdout.clone()).unwrap();
    assert!(
        PRESETS.iter().all(|preset| text.contains(preset.name) && text.contains(preset.source))
    );
    let json = libration(&["list", "--presets", "--json"]).success();
    let json: Vec<Value> = serde_json::from_slice(&json.get_output().stdout).unwrap();
    assert_eq!(json.len(), PRESETS.len());
    let gyro = json.iter().find(|preset| preset["name"] == "px4-gyro").unwrap();
    // √2/(2π·30 Hz).
    assert!((gyro["latency"].as_f64().unwrap() - 7.502_636e-3).abs() < 1e-9, "{gyro}");
}

#[test]
fn a_preset_is_the_latency_that_it_lists_in_advise_analyze_and_simulate() {
    for command in [
        &["advise", "--period", "0.1"][..],
        &["analyze", "--integrator", "exact", "--dt", "0.01"],
        &["simulate", "--integrator", "exact", "--dt", "0.01", "--steps", "50"],
    ] {
        let output = |latency: &str| {
            let mut words: Vec<&str> = [command, &LOOP].concat();
            *words.last_mut().unwrap() = latency;
            if command[0] != "simulate" {
                words.push("--json");
            }
            results(&libration(&words).success()).replace("preset:usb-frame", "0.001")
        };
        assert_eq!(output("preset:usb-frame"), output("0.001"), "{command:?}");
    }
}

#[test]
fn an_unknown_preset_is_refused_with_the_nearest_name() {
    let mut words = [&["advise"][..], &LOOP].concat();
    *words.last_mut().unwrap() = "preset:px4-gyr";
    libration(&words)
        .code(2)
        .stderr(predicate::str::contains("unknown preset `px4-gyr`; did you mean `px4-gyro`?"));
}

#[test]
fn files_take_presets_and_refuse_unknown_ones() {
    let folder = tempfile::tempdir().unwrap();
    let plant = "[system.linear]\na = [[0, 1], [0, 0]]\nb = [[0], [1]]\n[controller.lqr]\nstates = [1, 0]\ninputs = [1]\n";
    let system = "[system.oscillator]\nomega2 = 10\n[controller.pd]\nposition = 10\nvelocity = 2\n";
    for (text, value) in [(plant, "[\"preset:usb-frame\"]"), (system, "\"preset:usb-frame\"")] {
        let path = folder.path().join("loop.toml");
        let run = |latency: &str| {
            fs::write(&path, format!("{text}[loop]\nperiod = 0.1\nlatency = {latency}\n")).unwrap();
            libration(&["advise", "--config", path.to_str().unwrap(), "--json"])
        };
        let output = results(&run(value));
        assert_eq!(output, results(&run("0.001")), "{value}");
        assert!(output.contains("\"answer\""), "{value}");
        run("\"preset:usb-fram\"").code(2).stderr(
            predicate::str::contains("did you mean `usb-frame`?")
                .and(predicate::str::contains("loop.toml")),
        );
        run("\"fast\"").code(2).stderr(predicate::str::contains(
            "expected a number of seconds, one with a unit such as \"2ms\", or \"preset:NAME\"",
        ));
    }
}
