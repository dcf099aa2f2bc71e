//! What `analyze` says of the timing of a loop, through the binary.

use assert_cmd::Command;
use predicates::prelude::PredicateBooleanExt;
use predicates::str::contains;
use serde_json::Value;

const LOOP: &str = "analyze --system oscillator --set omega2=10 --dt 0.01 --feedback 10,2";

fn libration(words: &str) -> Command {
    let mut command = Command::cargo_bin("libration").unwrap();
    command.args(words.split_whitespace());
    command
}

fn json(words: &str) -> Value {
    let run = libration(&format!("{words} --json")).assert().success();
    serde_json::from_slice(&run.get_output().stdout).unwrap()
}

/// The values of the reference for this loop are met to twelve digits.
fn close(found: &Value, wanted: f64) {
    let found = found.as_f64().unwrap();
    assert!((found / wanted - 1.0).abs() < 1e-12, "{found} {wanted}");
}

#[test]
fn latency_moves_the_radius_and_has_its_critical_values() {
    let late = json(&format!("{LOOP} --integrator exact --latency 5steps"));
    close(&late["spectral_radius"], 0.992_337_179_288_081);
    close(&late["critical_latency_steps"], 15.324_841_096_092_2);
    close(&late["critical_latency_seconds"], 0.153_248_410_960_922);
    close(&late["delay_margin_seconds"], 0.158_235_684_716_435);
    close(&late["latency_windows"][0][1], 15.324_841_096_092_2);
    let verlet = json(&format!("{LOOP} --integrator velocity-verlet --latency 0.05"));
    close(&verlet["spectral_radius"], 0.992_338_434_173_543);
    close(&verlet["latency_steps"], 5.0);
    // The quotient of 0.07 and 0.01 is no whole number of floats.
    let seven = json(&format!("{LOOP} --integrator rk4 --latency 0.07"));
    assert_eq!(seven["latency_steps"], 7.0);
    // Explicit Euler at ten times the step is not stable at any latency.
    let none = json(
        "analyze --system oscillator --set omega2=10 --dt 0.1 --steps 10 --feedback 10,2 \
                     --integrator explicit-euler",
    );
    assert!(none["critical_latency_steps"].is_null());
    assert_eq!(none["latency_windows"], Value::Array(Vec::new()));
}

#[test]
fn jitter_and_skew_are_told_with_and_without_feedback() {
    let plain =
        "analyze --system oscillator --set omega2=10 --integrator symplectic-euler --dt 0.1";
    let noisy = json(&format!("{plain} --jitter gaussian:0.1 --skew uniform:0.01"));
    close(&noisy["mean_square_growth"], 5.136_578_180_582e-5);
    assert!((noisy["lyapunov_exponent"].as_f64().unwrap() / 1.284_107_9e-5 - 1.0).abs() < 2e-7);
    assert!(noisy["dephasing_steps"].as_f64().unwrap() > 100.0);
    assert!(noisy.get("critical_latency_steps").is_none());
    let text =
        libration(&format!("{LOOP} --integrator rk4 --latency 1.5steps --jitter uniform:0.1"));
    let told = contains("critical latency").and(contains("second moments grow by"));
    { text }.assert().success().stdout(told);
}

#[test]
fn what_cannot_be_asked_of_timing_is_refused_in_words() {
    for (words, told) in [
        ("--integrator rk4 --latency -1", "at least 0"),
        ("--integrator rk4 --latency nan", "at least 0"),
        ("--integrator rk4 --latency 1e9steps", "4096"),
        ("--integrator rk4 --jitter gamma:0.1", "gaussian:0.1"),
        ("--integrator rk4 --jitter gaussian:-1", "at least 0"),
        ("--integrator rk9", "exact"),
        ("--integrator exact --max-drift 1e-3", "max-drift"),
    ] {
        libration(&format!("{LOOP} {words}")).assert().code(2).stderr(contains(told));
    }
    let kepler = "analyze --system kepler --integrator rk4 --dt 0.01 --feedback 1,1";
    libration(kepler).assert().code(2).stderr(contains("one degree of freedom"));
    let gains = "analyze --system oscillator --integrator rk4 --dt 0.01 --feedback 1";
    libration(gains).assert().code(2).stderr(contains("two numbers"));
    let late = "analyze --system oscillator --integrator rk4 --dt 0.01 --latency 1";
    libration(late).assert().code(2).stderr(contains("--feedback"));
    let pendulum = "analyze --system pendulum --integrator exact --dt 0.01";
    libration(pendulum).assert().code(2).stderr(contains("linear"));
}
