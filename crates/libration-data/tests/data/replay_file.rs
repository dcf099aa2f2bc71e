//! Replay buffers in files.

use std::fs;

use libration::State;
use libration::ensemble::Execution;
use libration::replay::Capacity;
use libration::rl::policy::Random;
use libration::rl::start::UniformStart;
use libration::rl::{Environments, Plan, Rollout};
use libration_data::ReplayFile;
use tempfile::TempDir;

use super::spring::world;

type Kept = ReplayFile<f32>;

/// Numbers of observations and actions.
const SIZES: [usize; 2] = [2, 1];

/// Inserts so many rollouts of five steps.
fn fill(replay: &mut Kept, rollouts: usize) {
    let start = State { q: [1.0], v: [0.0] };
    let world = world(0.01, 10.0, UniformStart(start, start));
    let mut all = Environments::new(world, 8, 1, Execution::serial()).unwrap();
    let mut rollout = Rollout::new(Plan::new(5, 8).truncated()).unwrap();
    let mut next = [0.0; 16];
    for _ in 0..rollouts {
        all.rollout(Random::between([-1.0], [1.0]), &mut rollout).unwrap();
        all.observe(&mut next).unwrap();
        replay.insert(&rollout, &next, &Execution::serial()).unwrap();
    }
}

#[test]
fn what_was_inserted_is_found_in_the_file_again() {
    let dir = TempDir::new().unwrap();
    let path = dir.path().join("replay");
    let mut replay = Kept::create(&path, SIZES, Capacity::new(20, 8).priorities()).unwrap();
    fill(&mut replay, 7);
    replay.flush().unwrap();
    let (bytes, len) = (replay.bytes().to_vec(), replay.len());
    let again = Kept::create(&path, SIZES, Capacity::new(20, 8)).map(drop).unwrap_err().to_string();
    assert!(again.contains("cannot create"), "{again}");
    let locked = Kept::open(&path, SIZES).map(drop).unwrap_err().to_string();
    assert!(locked.contains("another process is using"), "{locked}");
    drop(replay);
    let opened = Kept::open(&path, SIZES).unwrap();
    assert_eq!((opened.len(), opened.inserted(), opened.steps()), (len, 35, 20));
    assert!(opened.bytes() == bytes);
}

#[test]
fn a_file_of_something_else_is_refused_and_stays_as_it_was() {
    let dir = TempDir::new().unwrap();
    let path = dir.path().join("replay");
    let refused = || Kept::open(&path, SIZES).map(drop).unwrap_err().to_string();
    assert!(refused().contains("cannot open"));
    for bytes in [&b""[..], b"thesis", &[7; 9000]] {
        fs::write(&path, bytes).unwrap();
        let error = refused();
        assert!(
            error.contains("replay")
                && (error.contains("its beginning") || error.contains("its length")),
            "{error}"
        );
        assert_eq!(fs::read(&path).unwrap(), bytes);
    }
    fs::remove_file(&path).unwrap();
    drop(ReplayFile::<f64>::create(&path, SIZES, Capacity::new(20, 8)).unwrap());
    assert!(refused().contains("the float type is f64; it must be f32"));
    fs::remove_file(&path).unwrap();
    drop(Kept::create(&path, [6, 2], Capacity::new(20, 8)).unwrap());
    assert!(refused().contains("6 numbers seen, 2 done; it must be 2 numbers seen, 1 done"));
}
