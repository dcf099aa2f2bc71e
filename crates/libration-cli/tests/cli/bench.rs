//! The command `bench` as a user meets it, and instruction sets that are asked for.

use assert_cmd::Command;
use predicates::prelude::PredicateBooleanExt;
use predicates::str::{contains, is_empty};
use serde_json::Value;

const SIMULATE: &str =
    "simulate --system pendulum --integrator rk4 --dt 0.1 --steps 3 --num-trajectories 70";

fn libration(words: &str) -> Command {
    let mut command = Command::cargo_bin("libration").unwrap();
    command.env_remove("LIBRATION_SIMD").args(words.split_whitespace());
    command
}

#[test]
fn named_implementations_are_timed_alone_and_each_once() {
    let words = "--quiet bench --implementation fused,in-place --num-trajectories 1e3,10,1000 --dtype f32,f32 --json";
    let run = libration(words).assert().success().stderr(is_empty());
    let answer: Value = serde_json::from_slice(&run.get_output().stdout).unwrap();
    assert_eq!(answer["schema"], "libration.bench/2");
    assert!(answer["machine"]["caches"].is_array());
    let rates = answer["rates"].as_array().unwrap();
    let timed: Vec<_> = rates
        .iter()
        .map(|r| (r["implementation"].as_str().unwrap(), r["count"].as_u64().unwrap()))
        .collect();
    assert_eq!(timed, [("fused", 1000), ("fused", 10), ("in-place", 1000), ("in-place", 10)]);
    assert!(rates.iter().all(|r| r["steps_per_second"].as_f64().unwrap() > 0.0));
    let mut text =
        libration("--quiet bench --implementation scalar --num-trajectories 10 --dtype f64");
    text.assert().success().stdout(contains("10⁹ steps/s").and(contains("scalar")));
}

#[test]
fn rollouts_are_timed_in_both_layouts_beside_fills_of_as_much_memory() {
    let words = "--quiet bench --rollouts --case 256x16,300x40 --json";
    let run = libration(words).assert().success().stderr(is_empty());
    let answer: Value = serde_json::from_slice(&run.get_output().stdout).unwrap();
    assert_eq!(answer["schema"], "libration.bench/2");
    let rates = answer["rollouts"].as_array().unwrap();
    for (environments, horizon) in [(256, 16), (300, 40)] {
        let size = |rate: &Value| [&rate["num_envs"], &rate["horizon"]].map(Value::as_u64);
        let of_case = |rate: &&Value| size(rate) == [Some(environments), Some(horizon)];
        let found: Vec<_> = rates.iter().filter(of_case).collect();
        assert!(found.iter().any(|rate| rate["layout"] == "interleaved" && rate["threads"] == 1));
        assert!(found.iter().any(|rate| rate["layout"] == "planes"));
        // The source's 17 bytes a transition.
        assert!(found.iter().all(|rate| rate["bytes"] == 17 * environments * horizon));
    }
    for rate in rates {
        assert_eq!(rate["task"], "regulate");
        assert!(rate["transitions_per_second"].as_f64().unwrap() > 0.0);
        assert!(rate["share_of_fill"].as_f64().unwrap() > 0.0);
    }
}

#[test]
fn what_cannot_be_timed_is_refused_before_any_work() {
    for (words, told) in [
        ("bench --implementation fussed", "fused"),
        ("bench --implementation fused --num-trajectories 0", "at least 1"),
        ("bench --implementation fused --dtype f16", "f32"),
        ("bench --num-trajectories 10", "--implementation"),
        (
            "bench --implementation in-place --num-trajectories 1e15 --dtype f64",
            "GB of memory are needed",
        ),
        ("bench --simd sse9", "avx512"),
        ("bench --rollouts --implementation fused", "--implementation"),
        ("bench --rollouts --case 4096", "e.g. 4096x1024"),
        ("bench --rollouts --case 0x5", "at least 1"),
        ("bench --rollouts --case 1e9x1e9", "GB of memory are needed"),
        ("bench --case 256x16", "--rollouts"),
    ] {
        libration(words).assert().code(2).stdout(is_empty()).stderr(contains(told));
    }
}

#[test]
fn the_environment_names_an_instruction_set_where_no_flag_does() {
    let plain = libration(SIMULATE).assert().success().get_output().stdout.clone();
    let named = libration(SIMULATE).env("LIBRATION_SIMD", "baseline").assert().success();
    assert_eq!(named.get_output().stdout, plain);
    let wrong = libration(SIMULATE).env("LIBRATION_SIMD", "sse9").assert().code(2);
    wrong.stderr(contains("LIBRATION_SIMD is `sse9`").and(contains("baseline, avx2, avx512")));
    let flag = format!("{SIMULATE} --simd baseline");
    libration(&flag).env("LIBRATION_SIMD", "sse9").assert().success();
    // A single trajectory uses none.
    let lone = SIMULATE.replace(" --num-trajectories 70", "");
    libration(&lone).env("LIBRATION_SIMD", "sse9").assert().success();
    libration("lab spectrum").env("LIBRATION_SIMD", "sse9").assert().code(2);
}
