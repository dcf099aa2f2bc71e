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
    let run = libration(&format!("{words} --json")).output().unwrap();
    // An unstable loop has exit code 1 and its numbers.
    assert!(matches!(run.status.code(), Some(0 | 1)), "{words}");
    serde_json::from_slice(&run.stdout).unwrap()
}

/// The values of the reference for this loop are met to twelve digits.
fn close(found: &Value, wanted: f64) {
    let found = found.as_f64().unwrap();
    assert!((found / wanted - 1.0).abs() < 1e-12, "{found} {wanted}");
}

#[test]
fn latency_moves_the_radius_and_has_its_critical_values() {
    let late = json(&format!("{LOOP} --integrator exact --latency 5steps"));
    close(&late["closed_loop_spectral_radius"], 0.992_337_179_288_081);
    close(&late["critical_latency_steps"], 15.324_841_096_092_2);
    close(&late["critical_latency_seconds"], 0.153_248_410_960_922);
    let split = late["critical_latency_split_steps"].as_f64().unwrap();
    assert!((split - 15.323_426_710_9).abs() < 1e-9, "{split}");
    close(&late["delay_margin_seconds"], 0.158_235_684_716_435);
    close(&late["latency_windows"][0][1], 15.324_841_096_092_2);
    let verlet = json(&format!("{LOOP} --integrator velocity-verlet --latency 0.05"));
    close(&verlet["closed_loop_spectral_radius"], 0.992_338_434_173_543);
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
    assert!(none["critical_latency_split_steps"].is_null());
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
    assert_eq!(noisy["jitter_clips"], false);
    // Where its steps turn too far for any quadrature there are no moments; no number is better than a wrong one.
    let far = "analyze --system oscillator --set omega2=10 --integrator exact --dt 1e4 --feedback 1,0.001 --jitter gaussian:0.2";
    let far = json(far);
    assert!(far["mean_square_radius"].is_null() && far["lyapunov_exponent"].is_null());
    assert_eq!(far["jitter_clips"], true);
    // With a latency the second moments are those of the loop that has it.
    let exact = format!("{LOOP} --integrator exact --jitter uniform:0");
    let radius = |words: &str| json(&format!("{exact} {words}"))["mean_square_radius"].clone();
    close(&radius("--latency 5steps"), 0.992_337_179_288_081_f64.powi(2));
    let long = json(&format!("{exact} --latency 40steps"));
    close(
        &long["mean_square_radius"],
        long["closed_loop_spectral_radius"].as_f64().unwrap().powi(2),
    );
    assert_eq!(radius("--latency 400steps"), Value::Null);
    assert!(json(&format!("{exact} --latency 1steps"))["lyapunov_exponent"].is_null());
    let text = libration(&format!(
        "{LOOP} --integrator rk4 --latency 1.5steps --jitter uniform:0.1 --verbose"
    ));
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
        ("--integrator rk4 --jitter gaussian:-1", "from 0 to 100"),
        ("--integrator rk4 --jitter uniform:1e300", "from 0 to 100"),
        ("--integrator rk4 --latency 1e300", "1e302 periods"),
        ("--integrator rk9", "exact"),
        ("--integrator exact --max-drift 1e-3", "max-drift"),
    ] {
        libration(&format!("{LOOP} {words}")).assert().code(2).stderr(contains(told));
    }
    let kepler = "analyze --system kepler --integrator rk4 --dt 0.01 --feedback 1,1";
    libration(kepler).assert().code(2).stderr(contains("one degree of freedom"));
    let gains = "analyze --system oscillator --integrator rk4 --dt 0.01 --feedback 1";
    libration(gains).assert().code(2).stderr(contains("two finite numbers"));
    let late = "analyze --system oscillator --integrator rk4 --dt 0.01 --latency 1";
    libration(late).assert().code(2).stderr(contains("--feedback"));
    let pendulum = "analyze --system pendulum --integrator exact --dt 0.01";
    libration(pendulum).assert().code(2).stderr(contains("linear"));
}

/// The rows of a table of `simulate`, as numbers.
fn rows(words: &str) -> Vec<Vec<f64>> {
    let run = libration(&format!("simulate {words}")).assert().success();
    let text = String::from_utf8(run.get_output().stdout.clone()).unwrap();
    text.lines().skip(1).map(|row| row.split(',').map(|x| x.parse().unwrap()).collect()).collect()
}

#[test]
fn a_simulated_loop_falls_below_its_critical_latency_and_grows_above() {
    let words = "--system oscillator --set omega2=10 --integrator velocity-verlet --dt 0.01 --steps 20000 \
                 --save-every 20000 --q 1 --v 0 --feedback 10,2";
    let size = |latency: &str| {
        let last = rows(&format!("{words} --latency {latency}")).pop().unwrap();
        assert_eq!(last[1], 200.0);
        10.0 * last[2] * last[2] + last[3] * last[3]
    };
    // 15.323 steps is where `analyze` sees the edge; 0.25 steps beyond, the rate is 3·10⁻⁴ a step.
    assert!(size("15steps") < 10.0 * 1e-3 && size("0.1575") > 10.0 * 1e3);
}

#[test]
fn exact_steps_are_simulated_by_name_and_only_of_linear_systems() {
    let exact = "--integrator exact --steps 100 --save-every 100";
    let free = rows(&format!("--system oscillator --set omega2=10 --dt 0.3 {exact}"));
    let turned = (10.0_f64.sqrt() * 30.0).cos();
    assert!((free[1][2] - turned).abs() < 1e-13, "{} {turned}", free[1][2]);
    // At 15.3248 steps the loop of the reference becomes unstable.
    let late = |steps: f64| {
        rows(&format!(
            "--system oscillator --set omega2=10 --dt 0.01 --feedback 10,2 --integrator exact \
             --latency {steps}steps --steps 40000 --save-every 39990"
        ))
    };
    let size = |row: &[f64]| 10.0 * row[2] * row[2] + row[3] * row[3];
    assert!(size(&late(15.0)[1]) < 1e-3 && size(&late(15.65)[1]) > 1e5);
    libration("simulate --system pendulum --dt 0.1 --integrator exact --steps 10")
        .assert()
        .code(2)
        .stderr(contains("integrator").and(contains("exact for pendulum")).and(contains("linear")));
}

#[test]
fn simulated_noise_follows_from_its_seed_and_time_is_that_of_a_perfect_clock() {
    let words = "--system pendulum --integrator leapfrog --dt 0.01 --steps 1000 --save-every 500 \
                 --jitter gaussian:0.1 --skew uniform:0.01 --dtype f32";
    let first = rows(&format!("{words} --num-trajectories 3 --seed 7"));
    assert_eq!(first, rows(&format!("{words} --num-trajectories 3 --seed 7 --threads 2")));
    // The same trajectory in a larger ensemble, and without a number when it is alone.
    let more = rows(&format!("{words} --num-trajectories 100 --seed 7"));
    assert_eq!(first[..3], more[..3]);
    let alone = rows(&format!("{words} --seed 7"));
    assert_eq!(alone[2][1..], first.iter().rfind(|row| row[0] == 0.0).unwrap()[2..]);
    let other = rows(&format!("{words} --num-trajectories 3 --seed 8"));
    assert_ne!(first[8], other[8]);
    // A clock of its own for each: 10 s, but for 1 % of skew (no more than √3 times that) and 0.3 % of jitter.
    let times: Vec<f64> = first[6..].iter().map(|row| row[2]).collect();
    assert!(times.iter().all(|t| (t / 10.0 - 1.0).abs() < 0.03), "{times:?}");
    assert!(times[0] != times[1] && times[1] != times[2]);
}

#[test]
fn what_cannot_be_simulated_of_a_loop_is_refused_in_words() {
    let words = "simulate --integrator rk4 --dt 0.01 --steps 10";
    for (more, told) in [
        ("--system oscillator --feedback 1,1 --latency 1e9steps", "at most 4096 steps"),
        ("--system oscillator --latency 1steps", "--feedback"),
        ("--system oscillator --jitter gaussian:0.1 --dtype f16", "f64 or f32"),
        ("--system oscillator --q 1,0,0 --v 0,0,0 --skew uniform:0.1", "at most 2"),
        ("--system driven-oscillator --feedback 1,1", "without a time coordinate"),
        ("--system oscillator --seed -1", "--seed"),
    ] {
        libration(&format!("{words} {more}")).assert().code(2).stderr(contains(told));
    }
}

#[test]
fn a_loop_is_stepped_by_the_time_stamps_of_another() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str, text: &str| {
        let path = folder.path().join(name);
        std::fs::write(&path, text).unwrap();
        path.display().to_string()
    };
    let stamps = path("stamps.csv", "t\n10\n10.5\n10.5\n11.25\n");
    // Free, with velocity 2: as far as twice the time, which begins at the first stamp.
    let free =
        "--system oscillator --set omega2=1e-30 --integrator velocity-verlet --dt 0.25 --q 0 --v 2";
    let found = rows(&format!("{free} --steps 3 --time-stamps {stamps}"));
    let times: Vec<[f64; 2]> = found.iter().map(|row| [row[1], row[2]]).collect();
    assert_eq!(times, [[0.0, 0.0], [0.5, 1.0], [0.5, 1.0], [1.25, 2.5]]);
    let back = path("back", "1\n0.5\n");
    let text = path("text", "1\n2\nthree\n");
    for (steps, file, told) in [
        (4, stamps.as_str(), "--steps is 4; expected at most 3"),
        (1, &back, "time stamp 2 is -0.5 s; it must be at least the 0 s"),
        (1, &text, "line 3 is `three`"),
        (1, "/nowhere/at/all", "/nowhere/at/all"),
    ] {
        let words = format!("simulate {free} --steps {steps} --time-stamps {file}");
        libration(&words).assert().code(2).stderr(contains(told));
    }
}
