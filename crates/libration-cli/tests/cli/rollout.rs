//! The commands `rollout` and `verify` as a user meets them.

use std::fs;
use std::path::Path;

use assert_cmd::Command;
use predicates::prelude::PredicateBooleanExt;
use predicates::str::{contains, is_empty};
use serde_json::Value;
use tempfile::TempDir;

/// Six groups of at most 64 environments with all that can be wrong, in five chunks each.
pub(crate) const SETTINGS: &str = "\
seed = 5
num_envs = 350
steps = 450
max_episode_steps = 60
integrator = \"velocity-verlet\"
dt = 0.02
substeps = 2
[chunk]
num_envs = 64
steps = 100
[system.pendulum]
omega2 = 9.81
[task.track]
amplitude = 0.5
bound = 2.5
[start]
q = [-1.0, 1.0]
v = [-1.0, 1.0]
[delays]
observation = [0, \"40ms\"]
action = [\"20ms\", 0.08]
[noise]
jitter = 0.05
skew = 0.01
observation = 0.02
[policy.random]
low = -3.0
high = 3.0
";

pub(crate) fn libration(words: &str) -> Command {
    let mut command = Command::cargo_bin("libration").unwrap();
    command.args(words.split_whitespace());
    command
}

/// A folder with a file of settings.
pub(crate) fn settings(text: &str) -> TempDir {
    let dir = TempDir::new().unwrap();
    fs::write(dir.path().join("set.toml"), text).unwrap();
    dir
}

/// Writes the data set of the folder's settings.
pub(crate) fn write(dir: &TempDir, out: &str, more: &str) -> assert_cmd::assert::Assert {
    let words = format!("--quiet rollout --config set.toml --out {out} {more}");
    libration(&words).current_dir(dir.path()).assert()
}

/// All files of a folder with what they hold.
pub(crate) fn contents(folder: &Path) -> Vec<(String, Vec<u8>)> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        if path.is_dir() {
            let within = contents(&path).into_iter();
            found.extend(within.map(|(inner, bytes)| (format!("{name}/{inner}"), bytes)));
        } else {
            found.push((name, fs::read(&path).unwrap()));
        }
    }
    found.sort();
    found
}

#[test]
fn the_default_settings_are_printed_and_are_those_that_count_without_a_file() {
    let printed = libration("rollout --print-config").assert().success().stderr(is_empty());
    let text = String::from_utf8(printed.get_output().stdout.clone()).unwrap();
    let dir = settings(&text);
    write(&dir, "one", "--transitions 20000").success().stdout(is_empty()).stderr(is_empty());
    let words = "--quiet rollout --out two --transitions 20000";
    libration(words).current_dir(dir.path()).assert().success();
    // Its start is fixed and its policy deterministic.
    let note = contains("all 4096 environments are the same, as nothing is drawn");
    let words = words.replace("--quiet ", "").replace("two", "three");
    libration(&words).current_dir(dir.path()).assert().success().stderr(note);
    let one = contents(&dir.path().join("one"));
    assert!(one == contents(&dir.path().join("two")));
    // The source's case: five steps of its 4096 environments are the first whole ones beyond 20 000.
    let manifest = fs::read_to_string(dir.path().join("one/manifest.jsonl")).unwrap();
    let head: Value = serde_json::from_str(manifest.lines().next().unwrap()).unwrap();
    assert_eq!(head["data"]["num_envs"], 4096);
    assert_eq!(head["data"]["steps"], 5);
    assert_eq!(head["data"]["system"]["oscillator"]["omega2"], 10.0);
    let verified = libration("verify one --replay").current_dir(dir.path()).assert().success();
    verified.stdout(
        contains("1 chunks, 2 files").and(contains("as the manifest and the settings say")),
    );
}

#[test]
fn shards_together_are_the_data_set_whatever_their_number_and_the_threads() {
    for format in ["parquet", "npy"] {
        let dir = settings(SETTINGS);
        let flags = format!("--format {format}");
        write(&dir, "whole", &format!("{flags} --threads 1")).success();
        let whole = contents(&dir.path().join("whole"));
        let lines = |out: &str| -> Vec<String> {
            let text = fs::read_to_string(dir.path().join(out).join("manifest.jsonl")).unwrap();
            text.lines().skip(1).map(str::to_owned).collect()
        };
        for of in [2, 3] {
            let (mut files, mut told) = (Vec::new(), Vec::new());
            for shard in 1..=of {
                let out = format!("part-{shard}-{of}");
                write(&dir, &out, &format!("{flags} --shard {shard}/{of} --threads 3")).success();
                let found = contents(&dir.path().join(&out)).into_iter();
                files.extend(found.filter(|(name, _)| name != "manifest.jsonl"));
                told.extend(lines(&out));
                libration(&format!("--quiet verify {out} --replay"))
                    .current_dir(dir.path())
                    .assert()
                    .success();
            }
            files.sort();
            let same = whole.iter().filter(|(name, _)| name != "manifest.jsonl").eq(&files);
            assert!(same && told == lines("whole"), "{format} {of}");
        }
    }
}

#[test]
fn episodes_for_minari_are_the_same_on_any_threads_and_are_not_sharded() {
    // Rewards that leave the float type lose an environment, and the action leaves no transition.
    let text = "\
num_envs = 40
steps = 90
max_episode_steps = 25
[chunk]
num_envs = 30
steps = 40
[start]
v = [-1.0, 1.0]
[task.regulate]
bound = inf
effort = 1e38
[policy.random]
low = -2.0
high = 2.0
";
    let dir = settings(text);
    let flags = "--format minari --threads";
    write(&dir, "one", &format!("{flags} 1")).success();
    write(&dir, "three", &format!("{flags} 3")).success();
    let one = contents(&dir.path().join("one"));
    assert!(one == contents(&dir.path().join("three")));
    let json = |path: &str| -> Value {
        serde_json::from_slice(&fs::read(dir.path().join("one").join(path)).unwrap()).unwrap()
    };
    let about = json("data/metadata.json");
    let [episodes, actions] = ["total_episodes", "total_steps"].map(|n| about[n].as_u64().unwrap());
    assert!(actions > 40 * 40 && actions < 40 * 90, "{actions}");
    let each: u64 = (0..episodes)
        .map(|id| json(&format!("data/{id}/metadata.json"))["total_steps"].as_u64().unwrap())
        .sum();
    assert_eq!(each, actions);
    assert_eq!(one.len() as u64, 2 * episodes + 2);
    libration("--quiet verify one --replay").current_dir(dir.path()).assert().success();
    let refused = write(&dir, "part", "--format minari --shard 1/2").code(2);
    refused.stderr(contains("2 shards: Minari numbers the episodes"));
    assert!(!dir.path().join("part").exists());
}

#[test]
fn a_run_that_is_stopped_by_a_full_disk_says_so_and_goes_on_to_the_same_bytes() {
    for format in ["parquet", "npy"] {
        let dir = settings(SETTINGS);
        let flags = format!("--format {format} --threads 2");
        write(&dir, "whole", &flags).success();
        let largest = contents(&dir.path().join("whole/ends"));
        let largest = largest.iter().map(|(_, bytes)| bytes.len()).max().unwrap();
        // Files of more than so many blocks of 512 bytes are refused: the first that is large.
        let blocks = (largest / 512).max(1);
        let program = assert_cmd::cargo::cargo_bin("libration");
        let script = format!(
            "ulimit -f {blocks}; exec {} rollout --config set.toml --out part {flags}",
            program.display()
        );
        let mut limited = Command::new("bash");
        let run = limited.args(["-c", &script]).current_dir(dir.path()).assert();
        run.code(1).stderr(contains("cannot write part/").and(contains("too large")));
        let refused = write(&dir, "part", &flags).code(2);
        refused.stderr(contains("holds a data set; use --resume to resume it"));
        write(&dir, "part", &format!("{flags} --resume")).success();
        assert!(contents(&dir.path().join("whole")) == contents(&dir.path().join("part")));
    }
}

#[test]
fn what_cannot_be_is_refused_before_a_folder_is_made() {
    let dir = settings("num_envs = 0\n");
    let refused = |text: &str, more: &str| {
        fs::write(dir.path().join("set.toml"), text).unwrap();
        let run = write(&dir, "out", more).code(2).stdout(is_empty());
        assert!(!dir.path().join("out").exists());
        String::from_utf8(run.get_output().stderr.clone()).unwrap()
    };
    for (text, said) in [
        ("num_envs = 0", "`num_envs` is 0, but it must be 1 to 1000000000"),
        ("steps = -3", "`steps` is -3"),
        ("dtype = \"f16\"", "`dtype` is `f16`, but it must be `f32` or `f64`"),
        ("dt = 0", "`dt` is 0.0, but it must be"),
        ("integrator = \"verlet\"", "did you mean `velocity-verlet`?"),
        ("integrater = \"rk4\"", "unknown key `integrater`"),
        ("[system.kepler]", "does not have a single degree of freedom"),
        ("[system.pendulum]\nomega = 3", "unknown parameter `omega`"),
        ("[system.pendulum]\n[system.oscillator]", "must be one table"),
        ("[task.regulate]\nbound = -1", "`bound` is -1.0"),
        ("[task.fly]", "unknown variant `fly`"),
        ("[start]\nq = [1, 0]", "`start.q` is from 1.0 to 0.0, but it must rise"),
        (
            "[delays]\naction = [0, 50]",
            "is 50 s, 5000 steps of 0.01 s, but it must be at most 4096",
        ),
        ("[delays]\naction = 0.015", "is 0.015 s, 1.5 steps of 0.01 s, but it must be whole steps"),
        ("[delays]\nobservation = '-10ms'", "is -0.01 s, but it must be finite and at least 0"),
        ("[delays]\naction = [0.02, 0.01]", "is from 0.02 s to 0.01 s, but it must rise"),
        ("[delays]\naction = '2 steps'", "a text with a unit such as \"2ms\""),
        ("float = 'f64'", "did you mean `dtype`?"),
        ("environments = 3", "did you mean `num_envs`?"),
        ("limit = 3", "did you mean `max_episode_steps`?"),
        ("[chunk]\nenvironments = 3", "did you mean `num_envs`?"),
        ("[noise]\njitter = -0.1", "`noise.jitter` is -0.1"),
        ("[policy.linear]\nweights = [1]", "`weights` has 1 numbers, but it must have 2"),
        ("[policy.random]\nlow = 1\nhigh = 1", "`low` must be below `high`"),
        ("[chunk]\nsteps = 0", "`chunk.steps` is 0"),
        ("seed = \"x\"", "seed"),
        ("[policy.constant]\naction = 1e300", "constant action 0 is 1e300"),
    ] {
        let found = refused(text, "");
        assert!(found.contains(said), "{text}\n{found}");
    }
    let found = refused("", "--shard 3/2");
    assert!(found.contains("e.g. 2/3"), "{found}");
    let found = refused("", "--shard 2/2");
    assert!(
        found.contains("at most as many shards as groups of `chunk.num_envs` environments (1)"),
        "{found}"
    );
    assert!(refused("", "--transitions 0").contains("from 1 to 1e15"));
    let found = refused("num_envs = 1", "--transitions 1e15");
    assert!(found.contains("would take 1000000000000000 steps"), "{found}");
    let found = refused(
        "num_envs = 1000000\n[chunk]\nnum_envs = 1000000\nsteps = 1000000\n",
        "--transitions 1e12",
    );
    assert!(found.contains("GB of memory are needed"), "{found}");
    let many =
        "num_envs = 1000000000\nsteps = 1000000000000\n[chunk]\nnum_envs = 1000\nsteps = 100\n";
    let found = refused(many, "");
    assert!(
        found.contains("10000000000000000 chunks, of which a manifest may have 2236962"),
        "{found}"
    );
    assert!(refused("", "--format csv").contains("parquet"));
    fs::write(dir.path().join("set.toml"), b"\xff\xfe").unwrap();
    write(&dir, "out", "").code(2).stderr(contains("cannot read"));
    libration("rollout").assert().code(2).stderr(contains("--out"));
    libration("verify nowhere").assert().code(2).stderr(contains("holds no data set"));
}
