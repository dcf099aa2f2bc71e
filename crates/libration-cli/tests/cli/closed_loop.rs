//! `libration analyze` of a loop, through the binary: which numbers hold of what.

use assert_cmd::Command;
use predicates::prelude::PredicateBooleanExt;
use predicates::str::contains;
use serde_json::Value;

/// A loop that stands its latency, its jitter and its losses each alone, and not together.
const LOSSY: &str = "analyze --system oscillator --set omega2=15.98 --integrator exact --dt 0.0608 --feedback 23.97,2.47 \
                     --latency 0.5steps --jitter gaussian:0.068 --loss 0.41";

fn libration(words: &str) -> Command {
    let mut command = Command::cargo_bin("libration").unwrap();
    command.args(words.split_whitespace());
    command
}

fn told(words: &str) -> String {
    let run = libration(words).output().unwrap();
    // An unstable loop has exit code 1 and its numbers.
    assert!(matches!(run.status.code(), Some(0 | 1)), "{words}");
    String::from_utf8(run.stdout).unwrap()
}

fn json(words: &str) -> Value {
    serde_json::from_str(&told(&format!("{words} --json"))).unwrap()
}

/// The rows under each heading.
fn blocks(text: &str) -> Vec<(String, Vec<String>)> {
    let mut blocks: Vec<(String, Vec<String>)> = Vec::new();
    for line in text.lines() {
        match (line.strip_prefix("  "), blocks.last_mut()) {
            (Some(row), Some((_, rows))) => rows.push(row.to_owned()),
            _ => blocks.push((line.to_owned(), Vec::new())),
        }
    }
    blocks
}

/// The first number of the row of that name.
fn number(rows: &[String], name: &str) -> f64 {
    let row = rows
        .iter()
        .find_map(|row| row.strip_prefix(name))
        .unwrap_or_else(|| panic!("{name} in {rows:?}"));
    row.split_whitespace().next().unwrap().parse().unwrap()
}

#[test]
fn losses_are_in_the_growth_of_second_moments_also_alone() {
    // By an independent NumPy program, tools/loop_reference.py, which is right to some 12 digits.
    let growth = |words: &str| json(words)["mean_square_growth"].as_f64().unwrap();
    assert!((growth(LOSSY) - 0.028_147_536_838_268).abs() < 1e-12, "{}", growth(LOSSY));
    let alone = "analyze --system oscillator --set omega2=10 --integrator exact --dt 0.05 --feedback 10,2 --loss 0.3";
    assert!((growth(alone) - (0.924_232_830_713_709 - 1.0)).abs() < 1e-12, "{}", growth(alone));
    let text = told(&format!("{alone} --verbose"));
    assert!(
        text.contains("second moments grow by") && text.contains("not known with losses"),
        "{text}"
    );
    assert!(json(alone)["lyapunov_exponent"].is_null());
    assert!(told(&format!("{LOSSY} --verbose")).contains("not known with a latency and losses"));
    // A law of skews is one of other clocks.
    let skewed = told(&format!("{alone} --skew uniform:0.01"));
    assert!(skewed.contains("for a clock at its nominal rate"), "{skewed}");
}

#[test]
fn what_is_open_and_what_is_closed_stands_in_blocks_of_their_own() {
    let blocks = blocks(&told(&format!("{LOSSY} --verbose")));
    let headings: Vec<&str> = blocks[1..].iter().map(|(heading, _)| heading.as_str()).collect();
    let wanted = [
        "Open loop: one step of the plant",
        "Closed loop: with feedback, latency",
        "Closed loop: with feedback, latency, jitter, losses",
    ];
    assert_eq!(headings, wanted);
    let [(_, open), (_, closed), (_, drawn)] = &blocks[1..] else { panic!() };
    // An oscillator that nobody commands neither grows nor decays.
    assert_eq!(number(open, "spectral radius"), 1.0);
    // The text has ten digits; JSON, below, has all.
    assert!((number(closed, "spectral radius") - 0.972_274_008_985_203).abs() < 1e-10);
    assert!(number(closed, "critical latency") < 1.0);
    assert!(number(drawn, "second moments grow by") > 1.028);
    assert!(drawn.iter().any(|row| row.starts_with("cost")));
    let found = json(LOSSY);
    assert_eq!(found["spectral_radius"], 1.0);
    assert_eq!(found["spectral_radius_minus_one"], 0.0);
    let radius = found["closed_loop_spectral_radius"].as_f64().unwrap();
    assert!((radius - number(closed, "spectral radius")).abs() < 1e-10);
    let excess = found["closed_loop_spectral_radius_minus_one"].as_f64().unwrap();
    assert!((radius - 1.0 - excess).abs() < 1e-15);
    // Without a loop there is one block, and the plant alone loses its phase under a skewed clock.
    let plain = "analyze --system oscillator --integrator rk4 --dt 0.01";
    assert!(!told(&format!("{plain} --verbose")).contains("loop"));
    let skewed = told(&format!("{plain} --skew gaussian:0.01 --feedback 10,2 --verbose"));
    let open = skewed.split("Closed loop").next().unwrap();
    assert!(open.contains("mean falls to 1/e in"), "{skewed}");
    libration(&format!("{plain} --jitter uniform:0.1 --verbose"))
        .assert()
        .success()
        .stdout(contains("Open loop: with jitter").and(contains("Closed loop").not()));
}

#[test]
fn every_command_that_takes_an_integrator_says_when_textbook_verlet_is_another_method() {
    let step = "--system damped-oscillator --integrator textbook-verlet --dt 0.01";
    let said = contains("note: the force of `damped-oscillator` depends on the velocity");
    libration(&format!("analyze {step}")).assert().success().stdout(said.clone());
    let simulate = format!("simulate {step} --steps 3");
    libration(&simulate).assert().success().stderr(said.clone()).stdout(said.clone().not());
    libration(&format!("{simulate} --set gamma=0")).assert().success().stderr(said.clone().not());
    let verlet = simulate.replace("textbook-verlet", "velocity-verlet");
    libration(&verlet).assert().success().stderr(said.clone().not());
    libration("list --json").assert().success().stdout(contains("differs from velocity-verlet"));
    let folder = tempfile::tempdir().unwrap();
    let (config, out) = (folder.path().join("set.toml"), folder.path().join("set"));
    let settings = told("rollout --print-config");
    let settings = settings
        .replace("\"symplectic-euler\"", "\"textbook-verlet\"")
        .replace("[system.oscillator]", "[system.damped-oscillator]");
    std::fs::write(&config, settings).unwrap();
    let mut rollout = libration("rollout --transitions 10 --config");
    rollout.arg(&config).arg("--out").arg(&out).assert().success().stderr(said);
}

#[test]
fn steps_of_suzuki_with_damping_have_windows() {
    // By a scan of the spectral radius in NumPy, tools/window_reference.py.
    let found = json(
        "analyze --system damped-oscillator --set omega2=10 --set gamma=0.2 --integrator suzuki4 --dt 0.01",
    );
    let windows = &found["stability_windows"];
    let wanted = [[0.0, 0.845_291_484_014_023], [1.217_041_459_632_847, 1.337_316_536_167_95]];
    for (i, ends) in wanted.into_iter().enumerate() {
        for (j, end) in ends.into_iter().enumerate() {
            assert!((windows[i][j].as_f64().unwrap() - end).abs() < 1e-13, "{windows}");
        }
    }
}
