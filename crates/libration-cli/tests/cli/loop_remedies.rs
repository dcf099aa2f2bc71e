//! Changes that `advise` proposes for a loop that is unstable, or that only its latency stabilises.

use super::advise::libration;
use super::linear::written;

/// `x″ = −10x + u` under `u = −2x`: without latency the commands, held for 10 ms, feed it. Late by 1.3 s its matrix of a period has the
/// spectral radius 0.997806 by NumPy, and that of the opposite sign 1.00210.
#[test]
fn a_loop_that_only_its_latency_stabilises_is_stable_as_stated_by_both_commands() {
    let folder = tempfile::tempdir().unwrap();
    let text = "a = [[0, 1], [-10, 0]]\nb = [[0], [1]]\n";
    let file = written(&folder, "late.toml", text);
    let file = file.to_str().unwrap();
    let run = |command: &str, gain: &str, code: i32| {
        let words = ["-q", command, "--plant", file, "--gain", gain];
        let run = libration(&[&words[..], &["--period", "0.01", "--latency", "1.3"]].concat());
        String::from_utf8(run.code(code).get_output().stdout.clone()).unwrap()
    };
    let advised = run("advise", "2,0", 0);
    assert!(
        advised.contains("only in a stability window") && !advised.contains("opposite"),
        "{advised}"
    );
    assert!(run("analyze", "2,0", 0).starts_with("The loop is stable"));
    assert!(run("analyze", "-2,0", 1).starts_with("The loop is unstable"));
}

/// Both latencies are scaled by one factor: neither may be as long as the longest that is stable.
#[test]
fn changes_of_several_latencies_name_the_factor_of_all() {
    let folder = tempfile::tempdir().unwrap();
    let request = |factor: f64| {
        format!(
            "[system.linear]\na = [[0.013]]\nb = [[1]]\n[controller.state-feedback]\ngain = [[25]]\n[loop]\nperiod = 0.05\nlatency = {}\noutput-latency = {}\n",
            0.028 * factor,
            0.024 * factor
        )
    };
    let run = |factor: f64, code: i32| {
        let file = written(&folder, "late.toml", &request(factor));
        let run = libration(&["-q", "advise", "--config", file.to_str().unwrap()]).code(code);
        String::from_utf8(run.get_output().stdout.clone()).unwrap()
    };
    let advised = run(1.0, 1);
    assert!(advised.contains("with all latencies times at most 0.7689"), "{advised}");
    run(0.7689, 0);
    run(0.7691, 1);
}
