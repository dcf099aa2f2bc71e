//! The command `verify`.

use std::fs;

use predicates::str::contains;

use crate::rollout::{SETTINGS, libration, settings, write};

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
