//! Data sets whose writers are killed.
//!
//! `LIBRATION_KILLS` says how often; `cargo xtask torture` asks for 50.

use std::process::{Command, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use crate::rollout::{contents, libration, settings};

/// Forty chunks, at any of which a kill may fall.
const SETTINGS: &str = "\
num_envs = 800
steps = 3000
max_episode_steps = 90
[chunk]
num_envs = 200
steps = 300
[start]
q = [-1.0, 1.0]
[policy.random]
";

/// The same with fewer episodes, each of which is two files.
const EPISODES: &str = "\
num_envs = 60
steps = 400
max_episode_steps = 90
[chunk]
num_envs = 20
steps = 50
[start]
q = [-1.0, 1.0]
[policy.random]
";

#[test]
fn a_data_set_whose_writer_is_killed_ends_as_one_that_was_left_in_peace_byte_for_byte() {
    let kills = std::env::var("LIBRATION_KILLS").ok().and_then(|n| n.parse().ok()).unwrap_or(3);
    let program = assert_cmd::cargo::cargo_bin("libration");
    for (format, settings_of) in [("npy", SETTINGS), ("parquet", SETTINGS), ("minari", EPISODES)] {
        let dir = settings(settings_of);
        let words =
            |out: &str| format!("--quiet rollout --config set.toml --out {out} --format {format}");
        let began = Instant::now();
        libration(&words("whole")).current_dir(dir.path()).assert().success();
        let whole = began.elapsed();
        let (mut killed, mut at) = (0, 0);
        while killed < kills {
            let mut child = Command::new(&program)
                .args((words("part") + " --resume").split_whitespace())
                .current_dir(dir.path())
                .stdout(Stdio::null())
                .stderr(Stdio::null())
                .spawn()
                .unwrap();
            at = (at * 61 + 17) % 101;
            sleep(whole.mul_f64(f64::from(at) / 101.0 * 0.6) + Duration::from_millis(2));
            if child.try_wait().unwrap().is_some() {
                // It was done before, and begins anew.
                assert!(contents(&dir.path().join("part")) == contents(&dir.path().join("whole")));
                std::fs::remove_dir_all(dir.path().join("part")).unwrap();
                continue;
            }
            child.kill().unwrap();
            child.wait().unwrap();
            killed += 1;
            // What the manifest tells is there, whatever else is.
            let manifest = std::fs::read_to_string(dir.path().join("part/manifest.jsonl"));
            if manifest.is_ok_and(|text| text.contains('\n')) {
                let verified = libration("--quiet verify part").current_dir(dir.path()).assert();
                let said = String::from_utf8_lossy(&verified.get_output().stderr).into_owned();
                let unfinished = said.lines().all(|line| line.contains("is unfinished"));
                assert!(unfinished, "{said}");
            }
        }
        libration(&(words("part") + " --resume")).current_dir(dir.path()).assert().success();
        assert!(
            contents(&dir.path().join("part")) == contents(&dir.path().join("whole")),
            "{format}"
        );
        libration("--quiet verify part --replay").current_dir(dir.path()).assert().success();
    }
}
