//! Files that are longer than can be used, or have no end.

use std::fs::{self, File};
use std::process::Command;

use assert_cmd::assert::OutputAssertExt as _;
use predicates::prelude::PredicateBooleanExt as _;
use predicates::str::contains;
use tempfile::TempDir;

const SIMULATE: &str = "simulate --system oscillator --integrator rk4 --dt 0.1 --steps 3";
const ADVISE: &str = "advise --system oscillator --feedback 10,2";

/// A command that may take no more than 4 GB of memory, after what a shell does before.
fn libration(folder: &TempDir, before: &str, words: &str) -> Command {
    let program = assert_cmd::cargo::cargo_bin("libration");
    let mut shell = Command::new("sh");
    let script = format!("ulimit -v 4000000; {before} \"$0\" {words}");
    shell.arg("-c").arg(script).arg(program).current_dir(folder);
    shell
}

#[test]
fn a_file_without_an_end_is_refused_with_its_limit_by_every_command_that_reads_it() {
    let folder = tempfile::tempdir().unwrap();
    for (words, flag, most) in [
        ("lab", "--config", "1 MiB"),
        ("advise", "--config", "1 MiB"),
        ("rollout --out out", "--config", "1 MiB"),
        (SIMULATE, "--time-stamps", "256 MiB"),
        (ADVISE, "--jitter-file", "256 MiB"),
        ("measure-jitter", "--from", "256 MiB"),
    ] {
        let told = || contains(flag).and(contains(format!("expected at most {most}")));
        let words = format!("{words} {flag}");
        let device = libration(&folder, "", &format!("{words} /dev/zero")).assert().code(2);
        device.stderr(told().and(contains("`/dev/zero`")));
        if most == "1 MiB" {
            let pipe = libration(&folder, "yes |", &format!("{words} /dev/stdin")).assert();
            pipe.code(2).stderr(told().and(contains("`/dev/stdin`")));
        }
    }
    for (section, key, most) in [
        ("throughput", "peers", "1 MiB"),
        ("rollout", "peers", "1 MiB"),
        ("storage", "peers", "1 MiB"),
        ("jitter", "time_stamps", "256 MiB"),
    ] {
        let config = format!("[{section}]\n{key} = '/dev/zero'\n");
        fs::write(folder.path().join("mine.toml"), config).unwrap();
        let told = libration(&folder, "", "lab --config mine.toml").assert().code(2);
        told.stderr(contains("`/dev/zero`").and(contains(format!("expected at most {most}"))));
    }
    assert_eq!(fs::read_dir(&folder).unwrap().count(), 1, "nothing but the configuration");
}

#[test]
fn a_manifest_that_is_too_long_is_refused_with_its_limit() {
    let folder = tempfile::tempdir().unwrap();
    fs::create_dir(folder.path().join("data")).unwrap();
    let manifest = File::create(folder.path().join("data/manifest.jsonl")).unwrap();
    // Without any block on the disk.
    manifest.set_len((1 << 30) + 1).unwrap();
    for words in ["verify data", "rollout --out data --resume --transitions 1000"] {
        let told = contains("data/manifest.jsonl").and(contains("expected at most 1 GiB"));
        libration(&folder, "", words).assert().code(2).stderr(told);
    }
}
