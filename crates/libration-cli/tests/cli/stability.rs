//! What `advise` says of loops that are unstable, or stable in a window only, and of requests without sense.

use predicates::prelude::*;
use serde_json::Value;

use super::advise::libration;

fn advice(words: &str, code: i32) -> Value {
    let words: Vec<&str> = words.split_whitespace().chain(["--json", "-q"]).collect();
    let told = libration(&words).code(code);
    serde_json::from_slice(&told.get_output().stdout).unwrap()
}

fn close(found: &Value, wanted: f64, part: f64) {
    let found = found.as_f64().unwrap();
    assert!((found / wanted - 1.0).abs() < part, "{found} {wanted}");
}

#[test]
fn a_window_that_is_regained_is_named_with_its_ends_and_uses_no_part_of_a_budget() {
    let told = advice(
        "advise --system oscillator --set omega2=10 --feedback=-2,0.5 --period 0.2 --latency 2.2",
        0,
    );
    let answer = told["answer"].as_str().unwrap();
    assert!(answer.contains("only in a separate stability window"), "{answer}");
    let budget = &told["loop"]["budgets"][0];
    assert_eq!(budget["used"], Value::Null);
    // Where the spectral radius of the loop with split steps passes 1, by `numpy.linalg.eigvals` and bisection.
    close(&budget["stable_up_to"], 0.5792309191502759, 1e-9);
    // The ends of the window are found to 1e-7.
    close(&budget["regained"]["from"], 1.9602638913650112, 2e-7);
    close(&budget["regained"]["to"], 2.3492350657992582, 2e-7);
    assert_eq!(told["loop"]["fails_first"], Value::Null);
}

#[test]
fn an_unstable_loop_gets_what_would_help_and_no_integrator() {
    let told = advice(
        "advise --system oscillator --set m=0.05 --set k=0 --feedback 400,20 --period 0.002 --latency 0.005",
        1,
    );
    assert_eq!(told["integrators"], serde_json::json!([]));
    assert_eq!(told["floats"], serde_json::json!([]));
    let remedies = &told["loop"]["remedies"];
    // By `numpy.linalg.eigvals` and bisection; found here by thirty halvings.
    close(&remedies["gain_factor"], 0.6316238963812184, 1e-9);
    close(&remedies["latency"], 0.0029822497912501615, 1e-7);
    let answer = told["answer"].as_str().unwrap();
    assert!(answer.contains("all gains times 0.6316 (K_p = 252.64"), "{answer}");
    assert!(answer.contains("a latency of at most 0.002982 s"), "{answer}");
}

#[test]
fn a_loop_that_is_unstable_by_itself_is_told_the_gains_and_the_period_that_stabilise_it() {
    let told = |words: &str| advice(words, 1)["answer"].as_str().unwrap().to_owned();
    // About the hilltop the plant is −α = 1 s⁻² unstable: a position gain above that holds it.
    let weak = told("advise --system duffing --feedback 0.5,0.1");
    assert!(weak.contains("all gains times 2.001"), "{weak}");
    // A double integrator in steps of T under K_p, K_d is stable for K_p·T < 2·K_d and K_d·T < 2 (Jury): T < 4e-3/100.
    let coarse =
        told("advise --system oscillator --set omega2=0 --feedback 100000,2 --period 0.02");
    assert!(coarse.contains("a period of 0.00003999 s"), "{coarse}");
}

/// The answer about a loop that is unstable without imperfections, which is printed as any other.
fn complaint(words: &str) -> String {
    let advice = advice(words, 1);
    assert_ne!(advice["verdict"]["outcome"], "stable", "{advice}");
    advice["answer"].as_str().unwrap().to_owned()
}

#[test]
fn what_stabilises_a_loop_does_so_with_the_latency_that_is_stated() {
    let joint = "advise --system oscillator --set m=0.05 --set k=0 --period 0.002 --latency 0.005 --feedback";
    // The limit of 400, 20 times 0.63162 above, as the gains have the same ratio; rounded toward the stable side.
    let told = complaint(&format!("{joint} 8000,400"));
    assert!(told.contains("all gains times 0.03158 (K_p = 252.64"), "{told}");
    // What is advised is stable when it is tried.
    let tried = advice(&format!("{joint} 252.64,12.632"), 0);
    assert_eq!(tried["loop"]["remedies"], Value::Null);
    // A latency that alone stabilises is named as such.
    let late = "advise --system oscillator --set omega2=10 --feedback=-3,-0.2 --latency 0.1";
    let late = advice(late, 0);
    let told = late["answer"].as_str().unwrap();
    assert!(told.contains("only in a stability window that less latency leaves"), "{told}");
}

#[test]
fn a_plant_that_is_neutral_is_not_said_to_grow_nor_to_be_stable_with_another_period() {
    for words in ["--set omega2=10 --feedback 0,0", "--set omega2=0 --feedback 0,0"] {
        let told = complaint(&format!("advise --system oscillator {words}"));
        assert!(told.contains("a motion neither grows nor decays"), "{told}");
        assert!(!told.contains("with a period of"), "{told}");
    }
}

#[test]
fn requests_without_sense_are_refused_by_the_name_of_what_was_typed() {
    for (words, wanted) in [
        ("--system kepler --feedback 1,1", "--system kepler has 2"),
        (
            "--system oscillator --set omega2=1e250",
            "`omega2` is 1e250; expected 0, or 1e-60 to 1e60",
        ),
        (
            "--system oscillator --set omega2=1e250 --feedback 1,1",
            "`omega2` is 1e250; expected 0, or 1e-60 to 1e60",
        ),
        ("--system oscillator --feedback 10,2 --period 1e300", "--period is 1e300; expected"),
        ("--system oscillator --feedback 10,2 --period 1e-300", "--period is 1e-300; expected"),
        ("--system oscillator --feedback 10,2 --period 1e-30", "expected 3.162e-10 to 3.162e2 s"),
        ("--system oscillator --horizon 1e300", "--horizon is 1e300; expected"),
    ] {
        let words: Vec<&str> = ["advise"].into_iter().chain(words.split_whitespace()).collect();
        libration(&words)
            .code(2)
            .stderr(predicate::str::contains(wanted).and(predicate::str::contains("--q").not()));
    }
    for (words, wanted) in [
        ("--set omega2=1e250 --dt 0.01", "turns by 1.000e123 rad; expected at most 1e9 rad"),
        ("--set omega2=1e-250 --dt 1 --feedback 1,1", "omega2 is 1e-250; expected 0, or 1e-60 to"),
        ("--set omega2=10 --dt 1e-300 --feedback 1,1", "dt is 1e-300; expected 1e-60 to 1e60"),
        ("--set omega2=10 --dt 1e300", "turns by 3.162e300 rad; expected at most 1e9 rad"),
    ] {
        let analyze = ["analyze", "--system", "oscillator", "--integrator", "exact"];
        let words: Vec<&str> = analyze.into_iter().chain(words.split_whitespace()).collect();
        libration(&words).code(2).stderr(predicate::str::contains(wanted));
    }
}

#[test]
fn a_simulated_loop_that_overflows_says_that_it_is_unstable_and_up_to_which_latency_it_is_not() {
    let reason = |words: &str| {
        let simulate = ["simulate", "--system", "oscillator", "--set", "omega2=10"];
        let words: Vec<&str> = simulate.into_iter().chain(words.split_whitespace()).collect();
        let told = libration(&words).code(1);
        String::from_utf8(told.get_output().stderr.clone()).unwrap()
    };
    let steps = "--steps 1e5 --save-every 1e5";
    let late = format!("--integrator exact --dt 0.1 --feedback 10,2 {steps}");
    let told = reason(&format!("{late} --latency 10steps"));
    assert!(told.contains("the closed loop is unstable: its spectral radius is 1."), "{told}");
    // What `analyze` says of it, to three digits and not above.
    let words =
        "analyze --system oscillator --set omega2=10 --integrator exact --dt 0.1 --feedback 10,2";
    let critical = advice(words, 0)["critical_latency_seconds"].as_f64().unwrap();
    let (_, rest) = told.split_once("up to a --latency of ").unwrap();
    let named: f64 = rest.split_whitespace().next().unwrap().parse().unwrap();
    assert!(named <= critical && named > 0.99 * critical, "{named} {critical}");
    // Where only a window of latencies is stable: by numpy.linalg.eigvals of the loop with d whole steps of delay, its spectral
    // radius is below 1 for d = 7 to 92.
    let window =
        reason("--integrator exact --dt 0.01 --feedback=-3,-0.2 --steps 1e6 --save-every 1e6");
    assert!(window.contains("its spectral radius is 1 + 0.000924"), "{window}");
    assert!(window.contains("stable with a --latency from 7steps to 92steps"), "{window}");
    // Clocks that are slow by more than 0.6325/0.6 − 1.
    let slow = reason(&format!(
        "--integrator velocity-verlet --dt 0.6 --skew gaussian:0.1 --num-trajectories 100 {steps} --output /dev/null"
    ));
    assert!(slow.contains("at the steps of the slowest clocks, ωΔt = "), "{slow}");
    // Further than a command can brake.
    let strong = reason(&format!("--integrator velocity-verlet --dt 1 --feedback 1,1 {steps}"));
    assert!(strong.contains("no --latency stabilises it"), "{strong}");
    // A clock that jitters about a step that is too long.
    let long =
        reason(&format!("--integrator velocity-verlet --dt 0.7 --jitter gaussian:0.1 {steps}"));
    assert!(long.contains("ωΔt = 2.21 exceeds velocity-verlet's limit 2"), "{long}");
}
