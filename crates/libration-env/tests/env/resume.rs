//! Tests of data sets that are interrupted, resumed and joined.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};

use libration::ensemble::Execution;
use libration_env::dataset::{
    DataFormat, DatasetError, JoinJob, Monitor, Transfer, VerifyOptions, WriteJob, join, parse,
    verify, write,
};

/// Three groups of eight chunks; episodes go over several chunks.
const SETTINGS: &str = "\
seed = 3
num_envs = 40
steps = 160
max_episode_steps = 50
[chunk]
num_envs = 16
steps = 20
[start]
q = [-1.0, 1.0]
[policy.random]
[delays]
action = [0.0, 0.03]
[noise]
jitter = 0.1
observation = 0.01
";

const STATE: &str = "resume.state";

/// Counts transitions that were written and chunks that were computed again; stops after as many transitions.
struct Watch {
    most: u64,
    written: AtomicU64,
    recomputed: AtomicU64,
}

impl Watch {
    fn until(most: u64) -> Self {
        let [written, recomputed] = [0, 0].map(AtomicU64::new);
        Watch { most, written, recomputed }
    }
}

impl Monitor for Watch {
    fn on_written(&self, transitions: u64, _: u64) {
        self.written.fetch_add(transitions, Ordering::Relaxed);
    }

    fn on_present(&self, _: u64, _: u64) {}

    fn on_recomputed(&self) {
        self.recomputed.fetch_add(1, Ordering::Relaxed);
    }

    fn should_stop(&self) -> bool {
        self.written.load(Ordering::Relaxed) >= self.most
    }
}

/// Writes a shard until `most` transitions are there, and gives how many chunks were computed again.
fn write_until(
    most: u64,
    (text, format, shard): (&str, DataFormat, [usize; 2]),
    out: &Path,
) -> (Result<(), DatasetError>, u64) {
    let dataset = parse(text, "set.toml").unwrap();
    let execution = Execution::serial();
    let job = WriteJob { dataset: &dataset, format, shard, out, resume: true, execution };
    let watch = Watch::until(most);
    let written = write(&job, &watch).map(drop);
    (written, watch.recomputed.into_inner())
}

fn write_whole(what: (&str, DataFormat, [usize; 2]), out: &Path) -> u64 {
    let (written, recomputed) = write_until(u64::MAX, what, out);
    written.unwrap();
    recomputed
}

/// The path of each file within a folder, and its bytes.
fn contents(folder: &Path) -> Vec<(PathBuf, Vec<u8>)> {
    let (mut found, mut folders) = (Vec::new(), vec![folder.to_owned()]);
    while let Some(inner) = folders.pop() {
        for entry in fs::read_dir(inner).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
            } else {
                let bytes = fs::read(&path).unwrap();
                found.push((path.strip_prefix(folder).unwrap().to_owned(), bytes));
            }
        }
    }
    found.sort();
    found
}

#[test]
fn a_resumed_data_set_goes_on_from_its_state_with_the_bytes_of_one_that_was_not_interrupted() {
    // A state is written when the chunks since the last one hold as much: where all groups have 16 environments, chunks of 5760 bytes
    // and states of 5712, after each. In a group of 8 chunks have 2880 bytes, so it is after every second.
    for (environments, most) in [(48, 0), (40, 1)] {
        let settings = SETTINGS.replace("num_envs = 40", &format!("num_envs = {environments}"));
        for format in DataFormat::ALL {
            let dir = tempfile::tempdir().unwrap();
            let [whole, part] = ["whole", "part"].map(|name| dir.path().join(name));
            let what = (&settings[..], format, [1, 1]);
            write_whole(what, &whole);
            // Of Minari the state has the open episodes too.
            let most = if format == DataFormat::Minari { 4 } else { most };
            // Within a group, again and again.
            let (mut written, mut turns) = (Err(DatasetError::Interrupted), 0);
            while written.is_err() {
                let (now, recomputed) = write_until(700, what, &part);
                assert!(recomputed <= most, "{environments} {} {recomputed}", format.name());
                (written, turns) = (now, turns + 1);
            }
            assert!(turns > 3, "{turns}");
            assert!(contents(&part) == contents(&whole), "{environments} {}", format.name());
        }
    }
}

#[test]
fn a_state_that_is_torn_foreign_or_ahead_is_not_used_and_what_it_would_give_is_computed_again() {
    let dir = tempfile::tempdir().unwrap();
    let at = |name: &str| dir.path().join(name);
    let what = (SETTINGS, DataFormat::Npy, [1, 1]);
    write_whole(what, &at("whole"));
    assert!(!at("whole").join(STATE).exists());
    let stopped = |name: &str, text: &str| {
        let (written, _) = write_until(1500, (text, DataFormat::Npy, [1, 1]), &at(name));
        assert!(matches!(written, Err(DatasetError::Interrupted)));
        fs::read(at(name).join(STATE)).unwrap()
    };
    let foreign = stopped("foreign", &SETTINGS.replace("seed = 3", "seed = 4"));
    let own = stopped("own", SETTINGS);
    let mut flipped = own.clone();
    flipped[own.len() / 2] ^= 1;
    let cases = [
        ("torn", Some(own[..own.len() / 2].to_vec())),
        ("flipped", Some(flipped)),
        ("foreign", Some(foreign)),
        ("empty", Some(Vec::new())),
        ("missing", None),
        ("ahead", Some(own)),
    ];
    for (name, state) in cases {
        let path = at(&format!("{name} state"));
        stopped(path.file_name().unwrap().to_str().unwrap(), SETTINGS);
        fs::remove_file(path.join(STATE)).unwrap();
        if let Some(state) = &state {
            fs::write(path.join(STATE), state).unwrap();
        }
        if name == "ahead" {
            let manifest = path.join("manifest.jsonl");
            let text = fs::read_to_string(&manifest).unwrap();
            let kept: Vec<_> = text.lines().take(3).collect();
            fs::write(&manifest, kept.join("\n") + "\n").unwrap();
        }
        let recomputed = write_whole(what, &path);
        assert!(recomputed > 0, "{name}");
        assert!(contents(&path) == contents(&at("whole")), "{name}");
    }
}

#[test]
fn an_unfinished_data_set_has_no_flaw_for_its_state() {
    let dir = tempfile::tempdir().unwrap();
    let out = dir.path().join("set");
    let (written, _) = write_until(700, (SETTINGS, DataFormat::Npy, [1, 1]), &out);
    assert!(written.is_err() && out.join(STATE).exists());
    let flaws =
        |out: &Path| verify(out, VerifyOptions::default(), &Watch::until(u64::MAX)).unwrap().flaws;
    let found = flaws(&out);
    assert!(found.len() == 1 && found[0].what.contains("is unfinished"), "{found:?}");
    let state = fs::read(out.join(STATE)).unwrap();
    write_whole((SETTINGS, DataFormat::Npy, [1, 1]), &out);
    // Killed before it was removed.
    fs::write(out.join(STATE), state).unwrap();
    assert_eq!(flaws(&out), []);
    write_whole((SETTINGS, DataFormat::Npy, [1, 1]), &out);
    assert!(!out.join(STATE).exists());
}

/// Writes shards `1/of` to `of/of` and gives their folders.
fn shards(dir: &Path, text: &str, of: usize) -> Vec<PathBuf> {
    let part = |i: usize| {
        let out = dir.join(format!("{i}-of-{of}"));
        write_whole((text, DataFormat::Parquet, [i, of]), &out);
        out
    };
    (1..=of).map(part).collect()
}

fn joined(parts: &[PathBuf], out: &Path, transfer: Transfer) -> Result<(), DatasetError> {
    let job = JoinJob { parts, out, transfer, resume: false };
    join(&job, &Watch::until(u64::MAX)).map(drop)
}

#[test]
fn joined_shards_are_the_data_set_of_one_run_byte_for_byte_in_any_order_linked_or_copied() {
    let dir = tempfile::tempdir().unwrap();
    let whole = dir.path().join("whole");
    write_whole((SETTINGS, DataFormat::Parquet, [1, 1]), &whole);
    for (of, transfer) in [(1, Transfer::Copy), (2, Transfer::Link), (3, Transfer::Copy)] {
        let mut parts = shards(dir.path(), SETTINGS, of);
        parts.reverse();
        let out = dir.path().join(format!("joined {of}"));
        joined(&parts, &out, transfer).unwrap();
        assert!(contents(&out) == contents(&whole), "{of}");
        let execution = Execution::serial();
        let how = VerifyOptions { replay: Some(&execution), repair: None };
        assert_eq!(verify(&out, how, &Watch::until(u64::MAX)).unwrap().flaws, []);
        parts.iter().for_each(|part| fs::remove_dir_all(part).unwrap());
        assert!(contents(&out) == contents(&whole), "{of}");
    }
}

#[test]
fn an_interrupted_join_is_resumed() {
    let dir = tempfile::tempdir().unwrap();
    let [whole, out] = ["whole", "joined"].map(|name| dir.path().join(name));
    write_whole((SETTINGS, DataFormat::Parquet, [1, 1]), &whole);
    let parts = shards(dir.path(), SETTINGS, 3);
    let job = JoinJob { parts: &parts, out: &out, transfer: Transfer::Link, resume: true };
    let stopped = join(&job, &Watch::until(1));
    assert!(matches!(stopped, Err(DatasetError::Interrupted)));
    let refused = joined(&parts, &out, Transfer::Link).unwrap_err().to_string();
    assert!(refused.contains("--resume"), "{refused}");
    join(&job, &Watch::until(u64::MAX)).unwrap();
    assert!(contents(&out) == contents(&whole));
}

#[test]
fn what_is_not_a_whole_data_set_is_refused_before_anything_is_written() {
    let dir = tempfile::tempdir().unwrap();
    let out = dir.path().join("joined");
    let parts = shards(dir.path(), SETTINGS, 3);
    let halves = shards(dir.path(), SETTINGS, 2);
    let refused = |parts: &[PathBuf], wanted: &str| {
        for transfer in [Transfer::Copy, Transfer::Link] {
            let error = joined(parts, &out, transfer).unwrap_err().to_string();
            assert!(error.contains(wanted), "{error}");
            assert!(!out.exists(), "{wanted}");
        }
    };
    let pick = |which: &[usize]| which.iter().map(|&i| parts[i].clone()).collect::<Vec<_>>();
    refused(&[], "there are none");
    refused(&pick(&[0, 2]), "group 1 of environments: in none of the folders");
    refused(&pick(&[0]), "groups 1 to 2 of environments: in none");
    refused(&pick(&[0, 1, 2, 1]), "group 1 of environments is in");
    refused(
        &[parts[0].clone(), halves[1].clone(), parts[1].clone()],
        "group 1 of environments is in",
    );
    let other = shards(&dir.path().join("other"), &SETTINGS.replace("seed = 3", "seed = 4"), 3);
    refused(
        &[parts[0].clone(), other[1].clone(), parts[2].clone()],
        "data.seed is 4; it must be 3",
    );
    refused(&[parts[0].clone(), dir.path().join("nothing")], "holds no data set");
    let within = parts[0].join("data");
    let error = joined(&parts, &within, Transfer::Link).unwrap_err().to_string();
    assert!(error.contains("contains the output folder") && !within.exists(), "{error}");
    let stopped = dir.path().join("stopped");
    write_until(100, (SETTINGS, DataFormat::Parquet, [2, 3]), &stopped).0.unwrap_err();
    refused(&[parts[0].clone(), stopped, parts[2].clone()], "is unfinished:");
    let file = parts[1].join("ends/000001-00000003.parquet");
    let bytes = fs::read(&file).unwrap();
    fs::write(&file, &bytes[1..]).unwrap();
    refused(&parts, "verify --repair");
    // Another byte is seen when the file is read.
    let mut other = bytes.clone();
    other[bytes.len() / 2] ^= 1;
    fs::write(&file, other).unwrap();
    let error = joined(&parts, &out, Transfer::Copy).unwrap_err().to_string();
    assert!(error.contains("000001-00000003.parquet: it has the checksum"), "{error}");
}
