//! Folders of data sets: interruptions, damage and foreign files.

use std::fs;
use std::path::Path;

use libration_data::{Comparison, DataError, Folder, Manifest, NewFile, verify};
use serde_json::{Map, Value, json};
use tempfile::TempDir;

fn map(value: Value) -> Map<String, Value> {
    match value {
        Value::Object(map) => map,
        other => panic!("{other}"),
    }
}

fn settings() -> Map<String, Value> {
    map(json!({ "schema": "test/1", "seed": 7, "system": { "mass": 1.0 } }))
}

/// Chunk `i`.
fn commit(folder: &mut Folder, i: usize) -> Result<(), DataError> {
    let [body, more] = [vec![i as u8; 1000 + i], vec![!(i as u8); 10]];
    let file = |kind: &str, body| NewFile {
        path: format!("{kind}/{i}.bin").into(),
        pieces: vec![b"head", body],
    };
    let files = [file("one", &body[..]), file("two", &more[..])];
    folder.commit(&format!("{i}"), map(json!({ "first": i })), &files)
}

/// All files of a folder with what they hold.
fn contents(folder: &Path) -> Vec<(String, Vec<u8>)> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        if path.is_dir() {
            found.extend(
                contents(&path).into_iter().map(|(n, bytes)| (format!("{name}/{n}"), bytes)),
            );
        } else {
            found.push((name, fs::read(&path).unwrap()));
        }
    }
    found.sort();
    found
}

/// A folder with so many chunks.
fn filled(count: usize) -> TempDir {
    let dir = TempDir::new().unwrap();
    let mut folder = Folder::open(&dir.path().join("set"), &settings(), false).unwrap();
    (0..count).for_each(|i| commit(&mut folder, i).unwrap());
    dir
}

fn refused(path: &Path, settings: &Map<String, Value>, resume: bool) -> String {
    Folder::open(path, settings, resume).map(drop).unwrap_err().to_string()
}

#[test]
fn a_manifest_cut_anywhere_and_parts_of_files_lead_to_the_same_bytes_in_the_end() {
    let whole = filled(5);
    let wanted = contents(&whole.path().join("set"));
    let text = fs::read(whole.path().join("set/manifest.jsonl")).unwrap();
    for len in (0..=text.len()).step_by(7).chain([text.len()]) {
        let dir = filled(5);
        let path = dir.path().join("set");
        fs::write(path.join("manifest.jsonl"), &text[..len]).unwrap();
        fs::write(path.join("one/9.bin.libration-part"), b"half of it").unwrap();
        let mut folder = Folder::open(&path, &settings(), true).unwrap();
        let lines = text[..len].iter().filter(|&&byte| byte == b'\n').count();
        assert_eq!(folder.manifest().chunks.len(), lines.saturating_sub(1));
        for i in folder.manifest().chunks.len()..5 {
            commit(&mut folder, i).unwrap();
        }
        drop(folder);
        let found = contents(&path);
        // Where not even the settings were told, nobody looks for parts.
        let found: Vec<_> =
            found.into_iter().filter(|(name, _)| !name.ends_with("-part")).collect();
        assert!(found == wanted, "cut at {len}");
        let manifest = Manifest::read(&path).unwrap();
        assert_eq!(verify(&path, &manifest, Comparison::Checksum, |_| true), []);
    }
}

#[test]
fn every_flipped_bit_missing_file_and_lie_of_the_manifest_is_named() {
    let dir = filled(3);
    let path = dir.path().join("set");
    let manifest = Manifest::read(&path).unwrap();
    let file = path.join("one/1.bin");
    let good = fs::read(&file).unwrap();
    for bit in (0..8 * good.len()).step_by(611) {
        let mut bad = good.clone();
        bad[bit / 8] ^= 1 << (bit % 8);
        fs::write(&file, bad).unwrap();
        let flaws = verify(&path, &manifest, Comparison::Checksum, |_| true);
        assert_eq!(flaws.len(), 1);
        assert_eq!((flaws[0].chunk.as_str(), flaws[0].path.to_str()), ("1", Some("one/1.bin")));
        assert!(flaws[0].what.contains("checksum"), "{}", flaws[0].what);
    }
    // The length alone says nothing of the bytes, and a file of another length need not be read.
    fs::write(&file, vec![0; good.len()]).unwrap();
    assert_eq!(verify(&path, &manifest, Comparison::Length, |_| true), []);
    fs::write(&file, &good[1..]).unwrap();
    let flaws = verify(&path, &manifest, Comparison::Length, |_| true);
    assert!(flaws[0].what.contains("1004 bytes; the manifest says 1005"), "{flaws:?}");
    assert!(
        verify(&path, &manifest, Comparison::Checksum, |_| true)[0]
            .what
            .contains("1004 bytes; the manifest says 1005")
    );
    fs::remove_file(&file).unwrap();
    assert!(
        verify(&path, &manifest, Comparison::Checksum, |_| true)[0].what.contains("cannot be read")
    );
    // The caller may stop early: the first chunk is sound.
    assert_eq!(verify(&path, &manifest, Comparison::Checksum, |_| false), []);
    let mut seen = Vec::new();
    verify(&path, &manifest, Comparison::Checksum, |bytes| {
        seen.push(bytes);
        true
    });
    // Four bytes of a head and the body, in two files.
    assert_eq!(seen, [1018, 2037, 3057]);
    assert_eq!(manifest.bytes(), 3057);

    let text = fs::read_to_string(path.join("manifest.jsonl")).unwrap();
    for (from, to, said) in [
        ("one/1.bin", "../1.bin", "line 3 of"),
        ("one/1.bin", "/etc/passwd", "which is not in the folder"),
        ("\"chunk\":\"1\"", "\"chunk\":\"0\"", "repeats chunk 0"),
        ("\"chunk\":\"1\"", "\"chunk\":1", "is not a chunk"),
        ("{\"schema\"", "[\"schema\"", "has no settings"),
        ("\"bytes\"", "\"sizes\"", "is not a chunk"),
    ] {
        fs::write(path.join("manifest.jsonl"), text.replace(from, to)).unwrap();
        let error = Manifest::read(&path).unwrap_err().to_string();
        assert!(error.contains(said), "{error}");
        assert!(refused(&path, &settings(), true).contains(said));
    }
}

#[test]
fn a_folder_with_something_else_in_it_is_refused_and_left_as_it_was() {
    let dir = filled(2);
    let path = dir.path().join("set");
    let before = contents(&path);
    assert!(refused(&path, &settings(), false).contains("use --resume to resume it"));
    let mut other = settings();
    other["system"]["mass"] = json!(2.0);
    let found = refused(&path, &other, true);
    assert!(found.contains("its system.mass is 1.0; it must be 2.0"), "{found}");
    let mut more = settings();
    more.insert("limit".into(), json!(3));
    assert!(refused(&path, &more, true).contains("its limit is missing; it must be 3"));
    let open = Folder::open(&path, &settings(), true).unwrap();
    assert!(refused(&path, &settings(), true).contains("another process is using"));
    drop(open);
    assert!(contents(&path) == before);

    let strange = TempDir::new().unwrap();
    fs::write(strange.path().join("thesis.tex"), b"mine").unwrap();
    let found = refused(strange.path(), &settings(), true);
    assert!(found.contains("holds thesis.tex, which is not part of a data set"), "{found}");
    assert_eq!(contents(strange.path()).len(), 1);
    // A manifest of somebody else, whose only line has no end.
    let theirs = TempDir::new().unwrap();
    fs::write(theirs.path().join("manifest.jsonl"), b"{\"mine\": 1}").unwrap();
    for resume in [false, true] {
        let found = refused(theirs.path(), &settings(), resume);
        assert!(found.contains("holds another manifest.jsonl"), "{found}");
    }
    assert_eq!(contents(theirs.path())[0].1, b"{\"mine\": 1}");
    let file = strange.path().join("thesis.tex");
    assert!(refused(&file, &settings(), false).contains("cannot create"));
    assert!(matches!(Manifest::read(strange.path()), Err(DataError::Missing(_))));
}

#[test]
fn what_cannot_be_written_costs_nothing_that_was() {
    let dir = filled(2);
    let path = dir.path().join("set");
    let before = contents(&path);
    // Where a folder ought to be there is a file.
    let mut folder = Folder::open(&path, &settings(), true).unwrap();
    let body = [b"head".as_slice()];
    let bad = NewFile { path: "manifest.jsonl/2.bin".into(), pieces: body.to_vec() };
    let error = folder.commit("2", Map::new(), &[bad]).unwrap_err().to_string();
    assert!(error.contains("cannot create"), "{error}");
    assert!(contents(&path) == before);
    commit(&mut folder, 2).unwrap();
    drop(folder);
    let whole = filled(3);
    assert!(contents(&path) == contents(&whole.path().join("set")));
}
