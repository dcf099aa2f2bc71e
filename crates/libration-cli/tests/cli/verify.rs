//! The command `verify`.

use std::fs;
use std::path::Path;

use predicates::prelude::PredicateBooleanExt;
use predicates::str::{contains, is_empty};

use crate::rollout::{SETTINGS, contents, libration, settings, write};

#[test]
fn a_flipped_bit_and_a_manifest_that_lies_are_found() {
    let dir = settings(SETTINGS);
    write(&dir, "set", "--format npy").success();
    let verify = |more: &str| {
        let words = format!("verify set {more}");
        libration(&words).current_dir(dir.path()).assert()
    };
    verify("").success();
    let path = dir.path().join("set/reward/000003-00000002.npy");
    let mut bytes = fs::read(&path).unwrap();
    let good = bytes.clone();
    bytes[5000] ^= 4;
    fs::write(&path, &bytes).unwrap();
    let said = contains("chunk 000003-00000002: set/reward/000003-00000002.npy has the checksum");
    verify("").code(1).stderr(said);
    // The manifest is made to agree with the wrong bytes: only who computes it again finds out.
    let manifest = dir.path().join("set/manifest.jsonl");
    let text = fs::read_to_string(&manifest).unwrap();
    let sum = |bytes: &[u8]| libration_data::checksum([bytes]);
    fs::write(&manifest, text.replace(&sum(&good), &sum(&bytes))).unwrap();
    verify("").success();
    let lie = contains("holds other numbers than the settings lead to");
    verify("--replay").code(1).stderr(lie);
    fs::write(&manifest, text.replace("\"version\":\"0", "\"version\":\"7")).unwrap();
    verify("--replay").code(2).stderr(contains("was written by version"));
    fs::write(&manifest, text.replace("\"omega2\":9.81", "\"omega2\":9.8")).unwrap();
    verify("--replay").code(1).stderr(contains("holds other numbers"));
    let resumed = write(&dir, "set", "--format npy --resume").code(2);
    resumed.stderr(contains("its data.system.pendulum.omega2 is 9.8; it must be 9.81"));
}

#[test]
fn a_data_set_that_lacks_chunks_or_has_others_does_not_pass() {
    let dir = settings(SETTINGS);
    write(&dir, "set", "--format npy").success();
    let manifest = dir.path().join("set/manifest.jsonl");
    let text = fs::read_to_string(&manifest).unwrap();
    let lines: Vec<&str> = text.lines().collect();
    let verified = |lines: &[&str]| {
        fs::write(&manifest, lines.join("\n") + "\n").unwrap();
        let refused = |more: &str| {
            let words = format!("verify set {more}");
            let run = libration(&words).current_dir(dir.path()).assert().code(1);
            String::from_utf8(run.get_output().stderr.clone()).unwrap()
        };
        let (plain, again) = (refused(""), refused("--replay"));
        assert_eq!(plain, again);
        plain
    };
    for count in [0, 1, 29] {
        let said = verified(&lines[..=count]);
        assert!(said.contains(&format!("is unfinished: {count} of 30 chunks")), "{said}");
    }
    let another =
        lines[30].replace("\"chunk\":\"000005-00000004\"", "\"chunk\":\"000005-00000005\"");
    let said = verified(&[&lines[..], &[&another]].concat());
    assert!(
        said.contains("chunk 000005-00000005: set/manifest.jsonl tells of it after the last"),
        "{said}"
    );
    fs::write(dir.path().join("set/reward/zzz.npy"), b"").unwrap();
    let said = verified(&lines);
    assert!(said.contains("set/reward/zzz.npy is not in the manifest"), "{said}");
}

/// Episodes of 64 environments in two chunks.
const EPISODES: &str = "\
environments = 64
steps = 100
limit = 30
[chunk]
steps = 50
[start]
q = [-1.0, 1.0]
[policy.random]
";

/// Every third file but the manifest: its middle byte flipped, cut off, or gone.
fn damage(folder: &Path) -> usize {
    let files = contents(folder).into_iter().filter(|(name, _)| name != "manifest.jsonl");
    let mut count = 0;
    for (i, (name, mut bytes)) in files.enumerate().filter(|(i, _)| i % 3 == 1) {
        let (path, middle) = (folder.join(name), bytes.len() / 2);
        match i % 9 {
            1 => {
                bytes[middle] ^= 0x10;
                fs::write(path, bytes).unwrap();
            }
            4 => fs::write(path, &bytes[..middle]).unwrap(),
            _ => fs::remove_file(path).unwrap(),
        }
        count += 1;
    }
    count
}

#[test]
fn broken_chunks_are_named_with_the_command_that_computes_them_again_byte_for_byte() {
    for (format, text) in [("npy", SETTINGS), ("parquet", SETTINGS), ("minari", EPISODES)] {
        let dir = settings(text);
        write(&dir, "set", &format!("--format {format}")).success();
        let path = dir.path().join("set");
        let whole = contents(&path);
        let verify = |words: &str| libration(words).current_dir(dir.path()).assert();
        let broken = damage(&path);
        let named = verify("verify set").code(1).stdout(is_empty());
        let said = String::from_utf8(named.get_output().stderr.clone()).unwrap();
        assert_eq!(said.lines().count(), broken + 1, "{said}");
        assert!(said.contains("help: `libration verify --repair set`"), "{said}");
        let repaired =
            verify("verify set --repair").success().stdout(contains("as the manifest says"));
        let said = String::from_utf8(repaired.get_output().stderr.clone()).unwrap();
        assert_eq!(said.matches("repaired: chunk 0000").count(), broken, "{said}");
        assert!(contents(&path) == whole, "{format}");
        damage(&path);
        verify("--quiet verify set --repair --threads 1").success().stderr(is_empty());
        assert!(contents(&path) == whole, "{format}");
    }
}

#[test]
fn a_resumed_run_repairs_what_is_broken_before_it_goes_on() {
    for (format, text) in [("npy", SETTINGS), ("parquet", SETTINGS), ("minari", EPISODES)] {
        let dir = settings(text);
        let flags = format!("--format {format}");
        write(&dir, "set", &flags).success();
        let path = dir.path().join("set");
        let whole = contents(&path);
        let manifest = path.join("manifest.jsonl");
        let text = fs::read_to_string(&manifest).unwrap();
        let lines: Vec<&str> = text.lines().collect();
        // Finished, and interrupted after half of its chunks.
        for kept in [lines.len(), 1 + lines.len() / 2] {
            fs::write(&manifest, lines[..kept].join("\n") + "\n").unwrap();
            damage(&path);
            write(&dir, "set", &format!("{flags} --resume")).success().stderr(is_empty());
            assert!(contents(&path) == whole, "{format} {kept}");
        }
    }
}

#[test]
fn what_the_settings_do_not_lead_to_is_left_as_it_is_and_said() {
    let dir = settings(SETTINGS);
    write(&dir, "set", "--format npy").success();
    let path = dir.path().join("set/reward/000003-00000002.npy");
    let good = fs::read(&path).unwrap();
    let other = dir.path().join("set/action/000001-00000004.npy");
    fs::remove_file(&other).unwrap();
    // The manifest wants bytes that nothing computes.
    let manifest = dir.path().join("set/manifest.jsonl");
    let text = fs::read_to_string(&manifest).unwrap();
    let sum = |bytes: &[u8]| libration_data::checksum([bytes]);
    fs::write(&manifest, text.replace(&sum(&good), &sum(b"other"))).unwrap();
    let said = "set/reward/000003-00000002.npy has the checksum";
    let cannot = "cannot be repaired: the settings lead to other bytes";
    let run = libration("verify set --repair").current_dir(dir.path()).assert().code(1);
    run.stderr(
        contains(said).and(contains(cannot)).and(contains("repaired: chunk 000001-00000004")),
    );
    assert!(other.exists());
    assert_eq!(fs::read(&path).unwrap(), good);
    let resumed = write(&dir, "set", "--format npy --resume").code(1);
    resumed.stderr(contains(said).and(contains(cannot)));
    fs::write(&manifest, text.replace("\"version\":\"0", "\"version\":\"7")).unwrap();
    let run = libration("verify set --repair").current_dir(dir.path()).assert().code(2);
    run.stderr(contains("was written by version"));
}
