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
    let lie = contains("differs from the numbers of the settings");
    verify("--replay").code(1).stderr(lie);
    fs::write(&manifest, text.replace("\"version\":\"0", "\"version\":\"7")).unwrap();
    verify("--replay").code(2).stderr(contains("was written by version"));
    fs::write(&manifest, text.replace("\"omega2\":9.81", "\"omega2\":9.8")).unwrap();
    verify("--replay").code(1).stderr(contains("differs from the numbers"));
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
        said.contains("chunk 000005-00000005: set/manifest.jsonl lists it after the last"),
        "{said}"
    );
    fs::write(dir.path().join("set/reward/zzz.npy"), b"").unwrap();
    let said = verified(&lines);
    assert!(said.contains("set/reward/zzz.npy is not in the manifest"), "{said}");
}

/// Episodes of 64 environments in two chunks.
pub(crate) const EPISODES: &str = "\
num_envs = 64
steps = 100
max_episode_steps = 30
[chunk]
steps = 50
[start]
q = [-1.0, 1.0]
[policy.random]
";

/// Every third file but the manifest: its middle byte flipped (if `flips`), cut off, or gone.
fn damage(folder: &Path, flips: bool) -> usize {
    let files = contents(folder).into_iter().filter(|(name, _)| name != "manifest.jsonl");
    let mut count = 0;
    for (i, (name, mut bytes)) in files.enumerate().filter(|(i, _)| i % 3 == 1) {
        let (path, middle) = (folder.join(name), bytes.len() / 2);
        match i % 9 {
            1 if flips => {
                bytes[middle] ^= 0x10;
                fs::write(path, bytes).unwrap();
            }
            1 | 4 => fs::write(path, &bytes[..middle]).unwrap(),
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
        let broken = damage(&path, true);
        let named = verify("verify set").code(1).stdout(is_empty());
        let said = String::from_utf8(named.get_output().stderr.clone()).unwrap();
        assert_eq!(said.lines().count(), broken + 1, "{said}");
        assert!(said.contains("help: `libration verify --repair set`"), "{said}");
        let repaired = verify("verify set --repair")
            .success()
            .stdout(contains("with the checksums of the manifest"));
        let said = String::from_utf8(repaired.get_output().stderr.clone()).unwrap();
        assert_eq!(said.matches("repaired: chunk 0000").count(), broken, "{said}");
        assert!(contents(&path) == whole, "{format}");
        damage(&path, true);
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
            // What a disk without room leaves; a changed byte is for `verify`.
            damage(&path, false);
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
    let cannot = "cannot be repaired: the settings give other bytes";
    let run = libration("verify set --repair").current_dir(dir.path()).assert().code(1);
    run.stderr(
        contains(said).and(contains(cannot)).and(contains("repaired: chunk 000001-00000004")),
    );
    assert!(other.exists());
    assert_eq!(fs::read(&path).unwrap(), good);
    fs::write(&manifest, text.replace("\"version\":\"0", "\"version\":\"7")).unwrap();
    let run = libration("verify set --repair").current_dir(dir.path()).assert().code(2);
    run.stderr(contains("was written by version"));
}

#[test]
fn a_length_that_the_settings_do_not_lead_to_is_never_called_repaired() {
    let dir = settings(SETTINGS);
    write(&dir, "set", "--format npy").success();
    let manifest = dir.path().join("set/manifest.jsonl");
    let text = fs::read_to_string(&manifest).unwrap();
    let path = dir.path().join("set/reward/000003-00000002.npy");
    let good = fs::read(&path).unwrap();
    let sum = libration_data::checksum([&good[..]]);
    let told = |bytes: usize| format!("\"blake3\":\"{sum}\",\"bytes\":{bytes}");
    let lie = text.replace(&told(good.len()), &told(good.len() + 1));
    assert_ne!(lie, text);
    fs::write(&manifest, &lie).unwrap();
    let [found, other] = [good.len(), good.len() + 1];
    let said = || {
        contains(format!("has {found} bytes; the manifest says {other}"))
            .and(contains("cannot be repaired: the settings give other bytes"))
    };
    let run = libration("verify set --repair").current_dir(dir.path()).assert().code(1);
    run.stdout(is_empty()).stderr(said().and(contains("repaired: chunk").not()));
    write(&dir, "set", "--format npy --resume").code(1).stderr(said());
    assert_eq!(fs::read(&path).unwrap(), good);
    assert_eq!(fs::read_to_string(&manifest).unwrap(), lie);
}

#[cfg(unix)]
#[test]
fn what_is_no_regular_file_is_not_read_but_replaced() {
    use std::os::unix::fs::symlink;
    use std::process;
    use std::time::Duration;

    let dir = settings(SETTINGS);
    write(&dir, "set", "--format npy").success();
    let path = dir.path().join("set");
    let whole = contents(&path);
    let [zeros, pipe] =
        ["reward", "action"].map(|name| path.join(name).join("000001-00000003.npy"));
    let replace = || {
        [&zeros, &pipe].into_iter().for_each(|path| fs::remove_file(path).unwrap());
        symlink("/dev/zero", &zeros).unwrap();
        assert!(process::Command::new("mkfifo").arg(&pipe).status().unwrap().success());
    };
    let run = |words: &str| {
        libration(words).current_dir(dir.path()).timeout(Duration::from_secs(60)).assert()
    };
    replace();
    let help = contains("help: `libration verify --repair set`");
    let named = run("verify set").code(1).stderr(help);
    let said = String::from_utf8(named.get_output().stderr.clone()).unwrap();
    assert_eq!(said.matches("000001-00000003.npy is not a regular file").count(), 2, "{said}");
    run("verify set --repair").success();
    assert!(contents(&path) == whole);
    assert!(!zeros.is_symlink());
    replace();
    run("--quiet rollout --config set.toml --out set --format npy --resume").success();
    assert!(contents(&path) == whole);
}

#[test]
fn a_folder_in_the_place_of_a_file_is_named_and_left() {
    let dir = settings(SETTINGS);
    write(&dir, "set", "--format npy").success();
    let path = dir.path().join("set/reward/000001-00000003.npy");
    fs::remove_file(&path).unwrap();
    fs::create_dir(&path).unwrap();
    let verify = |words: &str| libration(words).current_dir(dir.path()).assert().code(1);
    let said = || contains("000001-00000003.npy is a folder; expected a file");
    verify("verify set").stderr(said().and(contains("--repair").not()));
    let cannot = || said().and(contains("cannot be repaired; help: remove it first"));
    verify("verify set --repair").stdout(is_empty()).stderr(cannot());
    write(&dir, "set", "--format npy --resume").code(1).stderr(cannot());
    assert!(path.is_dir());
    fs::remove_dir(&path).unwrap();
    libration("verify set --repair").current_dir(dir.path()).assert().success();
}

#[test]
fn a_manifest_whose_chunks_are_not_the_first_in_order_is_not_said_to_be_continued() {
    let dir = settings(SETTINGS);
    write(&dir, "set", "--format npy").success();
    let path = dir.path().join("set");
    let whole = contents(&path);
    let manifest = path.join("manifest.jsonl");
    let text = fs::read_to_string(&manifest).unwrap();
    let lines: Vec<&str> = text.lines().collect();
    let mut without = lines.clone();
    without.remove(2);
    let mut swapped = lines.clone();
    swapped.swap(2, 3);
    for lines in [without, swapped] {
        fs::write(&manifest, lines.join("\n") + "\n").unwrap();
        let what = "cannot be continued: chunk 000000-00000002 is in the place of 000000-00000001";
        let said = || contains(what).and(contains("help: delete line 3 and all lines after it"));
        let run = libration("verify set").current_dir(dir.path()).assert().code(1);
        run.stderr(said().and(contains("is unfinished").not()));
        let resumed = write(&dir, "set", "--format npy --resume").code(2);
        resumed.stderr(said().and(contains("the manifest of set")).and(contains("settings").not()));
        // The advice leads to the whole data set.
        fs::write(&manifest, lines[..2].join("\n") + "\n").unwrap();
        write(&dir, "set", "--format npy --resume").success();
        assert!(contents(&path) == whole);
    }
    // A chunk after the last is one that stands nowhere.
    let more = lines[30].replace("\"chunk\":\"000005-00000004\"", "\"chunk\":\"000006-00000000\"");
    fs::write(&manifest, text.clone() + &more + "\n").unwrap();
    let resumed = write(&dir, "set", "--format npy --resume").code(2);
    resumed.stderr(contains("chunk 000006-00000000 is after the last chunk"));
}
