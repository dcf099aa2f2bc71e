//! Tests of `libration analyze --temperature`.

use assert_cmd::Command;
use predicates::prelude::*;
use predicates::str::contains;
use serde_json::Value;

fn libration(words: &str) -> assert_cmd::assert::Assert {
    Command::cargo_bin("libration").unwrap().args(words.split_whitespace()).assert()
}

#[test]
fn temperatures_are_printed_with_their_closed_forms_and_as_json() {
    let words = "analyze --system oscillator --set omega2=1 --temperature 2 --friction 1 --dt 1 --steps 1e5 --seed 3";
    libration(&format!("{words} --verbose")).success().stdout(
        contains("BAOA is stable and has the least bias of positions")
            .and(contains("1/(1 − z²/4)")),
    );
    let output = libration(&format!("{words} --json --thermostat BAOAB --thermostat obabo"))
        .success()
        .get_output()
        .stdout
        .clone();
    let found: Value = serde_json::from_slice(&output).unwrap();
    assert_eq!(found["schema"], "libration.temperature/1");
    assert_eq!(found["recommended"], "BAOAB");
    let [baoab, obabo] = &found["thermostats"].as_array().unwrap()[..] else { panic!("{found}") };
    assert_eq!([&baoab["thermostat"], &obabo["thermostat"]], ["BAOAB", "OBABO"]);
    for (bias, predicted) in [
        (&baoab["configuration"], 0.0),
        (&baoab["kinetic"], -0.25),
        (&obabo["configuration"], 1.0 / 3.0),
        (&obabo["kinetic"], 0.0),
    ] {
        let number = |key: &str| bias[key].as_f64().unwrap();
        assert!((number("predicted_bias") - predicted).abs() < 1e-12, "{bias}");
        let off = (number("measured_bias") - predicted).abs();
        assert!(off < 4.0 * number("standard_error"), "{bias}");
    }
}

#[test]
fn the_default_step_is_that_of_the_fastest_mode() {
    let words = "analyze --force=-4*q0-q0^3 --temperature 1 --friction 1 --steps 32000 --json";
    let output = libration(words).success().get_output().stdout.clone();
    let found: Value = serde_json::from_slice(&output).unwrap();
    assert!((found["dt"].as_f64().unwrap() - 0.5).abs() < 1e-9, "{found}");
}

#[test]
fn numbers_of_any_size_are_printed_with_five_digits() {
    libration("analyze --system oscillator --set m=1.67e-27 --set k=1000 --temperature 4.1e-21 --friction 1e12 --dt 5e-16 --thermostat BAOAB --steps 32")
        .success()
        .stdout(contains("with steps of 5e-16 s").and(contains("kT = 4.1e-21, friction 1e12 /s")));
    libration("analyze --system oscillator --set omega2=1 --temperature 1 --friction 1 --dt 1e300")
        .code(1)
        .stdout(
            contains("with steps of 1e300 s.").and(contains("not stable: dt must be below 2 s")),
        );
}

#[test]
fn an_exact_thermostat_is_exact_at_a_high_friction() {
    libration("analyze --system oscillator --set omega2=1 --temperature 1 --friction 1e4 --dt 1 --thermostat BAOAB --steps 32 --verbose")
        .success()
        .stdout(contains(" exact ").and(contains("dt^0").not()));
}

#[test]
fn wrong_requests_of_temperatures_are_usage_errors() {
    let fails = |words: &str, what: &str| {
        libration(&format!("analyze {words}")).failure().code(2).stderr(contains(what));
    };
    let oscillator = "--system oscillator --temperature 1 --friction 1";
    fails("--system oscillator --temperature 1", "--friction");
    fails(
        "--system oscillator --friction 1 --integrator rk4 --dt 1",
        "--friction requires --temperature",
    );
    fails("--system oscillator --temperature 1 --friction 0", "friction 0: expected");
    fails("--system oscillator --temperature nan --friction 1", "temperature NaN: expected");
    fails(&format!("{oscillator} --thermostat BAXAB"), "`X` is no letter of a word");
    fails(&format!("{oscillator} --thermostat BAAB"), "the word has no O");
    fails(
        "--system pendulum --temperature 1 --friction 1 --dt 1e-300",
        "dt 1e-300: expected at least",
    );
    fails("--temperature 1 --friction 1 --force=-q0^3 --dt .1", "has no stiffness");
    fails(&format!("{oscillator} --integrator rk4"), "cannot be used with");
    fails("--system damped-oscillator --temperature 1 --friction 1", "depends on a velocity");
    fails("--system kepler --temperature 1 --friction 1", "no equilibrium");
}
