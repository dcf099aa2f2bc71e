//! Data sets and reports of others: links that lead out of them, and what is no regular file.

use std::fs;
use std::os::unix::fs::symlink;
use std::path::Path;
use std::process;
use std::time::Duration;

use assert_cmd::assert::Assert;
use predicates::prelude::PredicateBooleanExt;
use predicates::str::contains;
use serde_json::Value;
use tempfile::TempDir;

use super::rollout::{contents, libration, settings, write};

/// Two groups of two environments, in two chunks each.
const SMALL: &str = "\
num_envs = 4
steps = 6
[chunk]
num_envs = 2
steps = 3
[system.pendulum]
omega2 = 9.81
[task.track]
amplitude = 0.5
[policy.random]
low = -1.0
high = 1.0
";

/// Runs a command in a folder, which must end by itself.
fn run(dir: &TempDir, words: &str) -> Assert {
    libration(words).current_dir(dir.path()).timeout(Duration::from_secs(60)).assert()
}

fn resume(dir: &TempDir, out: &str) -> Assert {
    run(dir, &format!("--quiet rollout --config set.toml --out {out} --format npy --resume"))
}

fn make_pipe(path: &Path) {
    let _ = fs::remove_file(path);
    assert!(process::Command::new("mkfifo").arg(path).status().unwrap().success());
}

#[test]
fn nothing_is_written_through_a_linked_folder() {
    let dir = settings(SMALL);
    write(&dir, "set", "--format npy").success();
    let set = dir.path().join("set");
    let outside = dir.path().join("outside");
    fs::rename(set.join("reward"), &outside).unwrap();
    symlink(&outside, set.join("reward")).unwrap();
    for name in ["000000-00000000.npy", "000001-00000001.npy"] {
        fs::write(outside.join(name), "mine").unwrap();
    }
    let before = contents(&outside);
    let link = || contains("is in `reward`, which is a link; expected a folder");
    run(&dir, "verify set").code(1).stderr(link());
    run(&dir, "verify set --repair").code(1).stderr(link().and(contains("help: remove it first")));
    resume(&dir, "set").code(1).stderr(link());
    run(&dir, "join set --out joined").code(2).stderr(link());
    assert!(contents(&outside) == before);
    // A folder that is not there yet, in the place of a link to nowhere.
    let manifest = set.join("manifest.jsonl");
    let head = fs::read_to_string(&manifest).unwrap().lines().next().unwrap().to_owned();
    let fresh = dir.path().join("fresh");
    fs::create_dir(&fresh).unwrap();
    fs::write(fresh.join("manifest.jsonl"), head + "\n").unwrap();
    symlink(&outside, fresh.join("action")).unwrap();
    resume(&dir, "fresh").code(1).stderr(contains("action: it is a link; expected a folder"));
    assert!(contents(&outside) == before);
}

#[test]
fn a_linked_manifest_and_linked_parts_of_files_are_never_written() {
    let dir = settings(SMALL);
    write(&dir, "set", "--format npy").success();
    let set = dir.path().join("set");
    let target = dir.path().join("target");
    // A link to nowhere, in a folder that is empty otherwise.
    let empty = dir.path().join("empty");
    fs::create_dir(&empty).unwrap();
    symlink(&target, empty.join("manifest.jsonl")).unwrap();
    for more in ["", "--resume"] {
        write(&dir, "empty", more)
            .code(2)
            .stderr(contains("it is a link; expected a regular file"));
    }
    run(&dir, "join set --out empty").code(2).stderr(contains("it is a link"));
    assert!(!target.exists());
    // A manifest elsewhere.
    let manifest = set.join("manifest.jsonl");
    fs::rename(&manifest, &target).unwrap();
    symlink(&target, &manifest).unwrap();
    let before = fs::read(&target).unwrap();
    resume(&dir, "set").code(2).stderr(contains("it is a link"));
    assert_eq!(fs::read(&target).unwrap(), before);
    fs::remove_file(&manifest).unwrap();
    fs::rename(&target, &manifest).unwrap();
    // The name that a file has until it is whole.
    fs::write(&target, "mine").unwrap();
    let file = set.join("reward/000000-00000000.npy");
    let good = fs::read(&file).unwrap();
    fs::write(&file, "damaged").unwrap();
    symlink(&target, set.join("reward/000000-00000000.npy.libration-part")).unwrap();
    run(&dir, "verify set --repair").success();
    assert_eq!(fs::read(&file).unwrap(), good);
    assert_eq!(fs::read_to_string(&target).unwrap(), "mine");
    assert!(!file.is_symlink());
}

#[test]
fn linked_files_are_joined_as_files() {
    let dir = settings(SMALL);
    write(&dir, "whole", "--format npy").success();
    for i in 1..=2 {
        write(&dir, &format!("part-{i}"), &format!("--format npy --shard {i}/2")).success();
    }
    let part = dir.path().join("part-1/reward");
    let store = dir.path().join("part-1-store");
    fs::create_dir(&store).unwrap();
    for (i, name) in ["000000-00000000.npy", "000000-00000001.npy"].into_iter().enumerate() {
        fs::rename(part.join(name), store.join(name)).unwrap();
        let relative = Path::new("../../part-1-store").join(name);
        let absolute = store.join(name);
        symlink(if i == 0 { &relative } else { &absolute }, part.join(name)).unwrap();
    }
    run(&dir, "join part-1 part-2 --out joined --link").success();
    fs::remove_dir_all(&store).unwrap();
    let joined = dir.path().join("joined");
    assert!(contents(&joined) == contents(&dir.path().join("whole")));
    assert!(!joined.join("reward/000000-00000000.npy").is_symlink());
    run(&dir, "verify joined").success();
}

#[test]
fn a_pipe_or_a_device_in_the_place_of_a_file_is_refused_at_once() {
    let dir = settings(SMALL);
    write(&dir, "set", "--format npy").success();
    let manifest = dir.path().join("set/manifest.jsonl");
    let irregular = || contains("it is not a regular file");
    let refused = || {
        run(&dir, "verify set").code(2).stderr(irregular());
        run(&dir, "verify set --repair").code(2).stderr(irregular());
        run(&dir, "join set --out joined").code(2).stderr(irregular());
    };
    make_pipe(&manifest);
    refused();
    resume(&dir, "set").code(2).stderr(irregular());
    fs::remove_file(&manifest).unwrap();
    symlink("/dev/zero", &manifest).unwrap();
    refused();
    // A report.
    let out = dir.path().join("report");
    fs::create_dir(&out).unwrap();
    make_pipe(&out.join("results.json"));
    for words in ["compare report report", "compare report/results.json report"] {
        run(&dir, words).code(2).stderr(irregular());
    }
    run(&dir, "verify report").code(2).stderr(contains("holds no data set"));
    libration("lab spectrum --effort quick --out report")
        .current_dir(dir.path())
        .timeout(Duration::from_secs(120))
        .assert()
        .success();
    let results = fs::read_to_string(out.join("results.json")).unwrap();
    let results: Value = serde_json::from_str(&results).unwrap();
    let file = results["studies"][0]["data"][0]["file"].as_str().unwrap();
    make_pipe(&out.join(file));
    run(&dir, "verify report").code(1).stderr(irregular());
}

#[test]
fn a_shard_whose_manifest_says_what_the_settings_do_not_is_not_joined() {
    let dir = settings(SMALL);
    write(&dir, "set", "--format npy").success();
    let manifest = dir.path().join("set/manifest.jsonl");
    let text = fs::read_to_string(&manifest).unwrap();
    let join = |change: &dyn Fn(&mut Value)| {
        let mut lines: Vec<Value> =
            text.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
        change(&mut lines[2]);
        let lines: String = lines.iter().map(|line| format!("{line}\n")).collect();
        fs::write(&manifest, lines).unwrap();
        run(&dir, "join set --out joined")
    };
    for (key, value) in [
        ("transitions", u64::MAX.into()),
        ("transitions", 5.into()),
        ("transitions", "6".into()),
        ("seed", 9.into()),
        ("steps", serde_json::json!([3, 7])),
        ("environments", serde_json::json!([0, 3])),
        ("ends", 7.into()),
        ("ends", Value::Null),
        ("mine", 1.into()),
    ] {
        let said =
            contains(format!("line 3 of its manifest has another `{key}` than the settings"));
        join(&|line| line["holds"][key] = value.clone()).code(2).stderr(said);
        assert!(!dir.path().join("joined").exists());
    }
    let removed = |line: &mut Value| drop(line["holds"].as_object_mut().unwrap().remove("ends"));
    join(&removed).code(2).stderr(contains("another `ends`"));
    let named = |name: &'static str| move |line: &mut Value| line["files"][0]["path"] = name.into();
    join(&named("manifest.jsonl")).code(2).stderr(contains("line 3 of"));
    let said = contains("line 3 of").and(contains("has a name with a control character"));
    join(&named("reward/a\r\nerror: forged")).code(2).stderr(said.and(contains("\nerror:").not()));
    // A sum of lengths beyond 64 bits.
    let long = |line: &mut Value| {
        for file in line["files"].as_array_mut().unwrap() {
            file["bytes"] = u64::MAX.into();
        }
    };
    join(&long).code(2).stderr(contains("the manifest says 18446744073709551615"));
    run(&dir, "verify set").code(1).stderr(contains("this is a bug").not());
    join(&|_| ()).success();
}
