//! State files.

use std::fs;

use libration::State;
use libration::checkpoint::Checkpoint;
use libration::ensemble::{All, Ensemble, Execution};
use libration::integrator::VelocityVerlet;
use libration::system::{BaselineOnly, Pendulum};
use libration_data::{Durability, load_state, save_state};
use serde_json::{Value, json};
use tempfile::TempDir;

/// On one instruction set: a kernel is compiled for each.
const PENDULUM: All<BaselineOnly<Pendulum<f32>>> = All(BaselineOnly(Pendulum { omega2: 9.81 }));

fn swings(count: usize) -> Ensemble<f32, 1> {
    let start = |n: usize| State { q: [0.01 * n as f32], v: [0.0] };
    Ensemble::from_fn(count, Execution::serial(), start).unwrap()
}

#[test]
fn a_state_goes_through_a_file_with_its_note() {
    let dir = TempDir::new().unwrap();
    let path = dir.path().join("swings.state");
    let mut one = swings(100);
    one.advance(VelocityVerlet, PENDULUM, All(0.01), 77).unwrap();
    let note = json!({ "of": "a test" });
    save_state(&path, &one, &note, Durability::System).unwrap();
    let mut other = swings(100);
    assert_eq!(load_state(&path, &mut other).unwrap(), note);
    assert!(other.to_bytes() == one.to_bytes());
    // Only the file itself stays.
    assert_eq!(fs::read_dir(dir.path()).unwrap().count(), 1);
}

#[test]
fn a_file_that_is_cut_off_changed_of_another_version_or_of_something_else_is_refused() {
    let dir = TempDir::new().unwrap();
    let path = dir.path().join("swings.state");
    save_state(&path, &swings(100), &Value::Null, Durability::System).unwrap();
    let good = fs::read(&path).unwrap();
    let mut other = swings(100);
    other.advance(VelocityVerlet, PENDULUM, All(0.01), 5).unwrap();
    let before = other.to_bytes();
    let mut refused = |bytes: &[u8]| {
        fs::write(&path, bytes).unwrap();
        let error = load_state(&path, &mut other).unwrap_err().to_string();
        assert!(other.to_bytes() == before);
        assert!(error.contains("swings.state"), "{error}");
        error
    };
    for len in (0..good.len()).step_by(29) {
        let error = refused(&good[..len]);
        assert!(
            ["truncated", "not a state file"].iter().any(|said| error.contains(said)),
            "{len}: {error}"
        );
    }
    for at in (0..good.len()).step_by(13) {
        let mut bad = good.clone();
        bad[at] ^= 0x10;
        let error = refused(&bad);
        assert!(error.contains("checksum") || error.contains("not a state file"), "{at}: {error}");
    }
    let changed = |from: &str, to: &str| {
        let at = good.windows(from.len()).position(|bytes| bytes == from.as_bytes()).unwrap();
        let mut bytes = good[..good.len() - 64].to_vec();
        bytes[at..at + from.len()].copy_from_slice(to.as_bytes());
        let sum = libration_data::checksum([&bytes[..]]);
        [bytes, sum.into_bytes()].concat()
    };
    let version = format!("\"version\":\"{}\"", env!("CARGO_PKG_VERSION"));
    let newer = format!("\"version\":\"9{}\"", &env!("CARGO_PKG_VERSION")[1..]);
    assert!(refused(&changed(&version, &newer)).contains("version 9.1.0 wrote it"));
    assert!(refused(&changed("\"format\":1", "\"format\":2")).contains("in format 2"));
    let error = refused(&changed("\"ensemble\"", "\"octopus!\""));
    assert!(error.contains("its kind is octopus!; it must be ensemble"), "{error}");
    fs::remove_file(&path).unwrap();
    let error = load_state(&path, &mut swings(1)).unwrap_err().to_string();
    assert!(error.contains("cannot read"), "{error}");
}
