//! Replay files of processes that are killed during an insertion.
//!
//! `LIBRATION_KILLS` is the number of kills; `cargo xtask torture` sets 50.

use std::collections::VecDeque;
use std::io::{BufRead, BufReader, Write};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::thread::sleep;
use std::time::Duration;

use libration::State;
use libration::ensemble::Execution;
use libration::replay::{Batch, Capacity, Draw, Lookahead};
use libration::rl::policy::Random;
use libration::rl::start::UniformStart;
use libration::rl::{Environments, Plan, Rollout, World};
use libration_data::ReplayFile;
use tempfile::TempDir;

use super::spring::world;

const FILE: &str = "LIBRATION_TEST_REPLAY";
const COUNT: usize = 16;
const STEPS: usize = 5;

/// What is inserted, one after the other; every tenth time some environments are reset.
struct Source<E: World<f32, 2, 1>> {
    all: Environments<f32, E, 2, 1>,
    turn: usize,
}

fn source() -> Source<impl World<f32, 2, 1>> {
    let start = UniformStart(State { q: [-1.0], v: [-2.0] }, State { q: [1.0], v: [2.0] });
    let all = Environments::new(world(0.05, 1.3, start), COUNT, 3, Execution::serial()).unwrap();
    Source { all, turn: 0 }
}

impl<E: World<f32, 2, 1>> Source<E> {
    fn next(&mut self) -> (Rollout<f32, 2, 1>, Vec<f32>) {
        self.turn += 1;
        if self.turn.is_multiple_of(10) {
            let which: Vec<bool> = (0..COUNT).map(|n| (n + self.turn).is_multiple_of(3)).collect();
            self.all.reset(&which).unwrap();
        }
        let mut rollout = Rollout::new(Plan::new(STEPS, COUNT).truncated()).unwrap();
        self.all.rollout(Random::between([-3.0], [3.0]), &mut rollout).unwrap();
        let mut next = vec![0.0; 2 * COUNT];
        self.all.observe(&mut next).unwrap();
        (rollout, next)
    }
}

fn capacity() -> Capacity {
    Capacity::new(8 * STEPS, COUNT).ends(200).priorities()
}

/// In a process of its own: inserts until it is killed, and says after each rollout how many it were.
#[test]
fn the_process_that_is_killed() {
    let Some(path) = std::env::var_os(FILE).map(PathBuf::from) else { return };
    let mut replay = match path.exists() {
        true => ReplayFile::<f32>::open(&path, [2, 1]).unwrap(),
        false => ReplayFile::create(&path, [2, 1], capacity()).unwrap(),
    };
    let mut source = source();
    let there = replay.inserted() as usize / STEPS;
    (0..there).for_each(|_| drop(source.next()));
    for turn in there + 1.. {
        let (rollout, next) = source.next();
        replay.insert(&rollout, &next, &Execution::serial()).unwrap();
        println!("inserted {turn}");
        std::io::stdout().flush().unwrap();
    }
}

/// Lets a process insert for a while, and kills it; gives the last number that it told.
fn killed(path: &Path, after: Duration) -> usize {
    let mut child = Command::new(std::env::current_exe().unwrap())
        .args(["--exact", "kills::the_process_that_is_killed", "--nocapture"])
        .env(FILE, path)
        .stdout(Stdio::piped())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    let mut lines = BufReader::new(child.stdout.take().unwrap()).lines();
    let mut told = 0;
    let mut read = |line: Result<String, _>| {
        let turn = line.ok().and_then(|line: String| line.strip_prefix("inserted ")?.parse().ok());
        told = turn.unwrap_or(told);
        turn.is_some()
    };
    // It has begun.
    while !lines.next().is_none_or(&mut read) {}
    sleep(after);
    child.kill().unwrap();
    for line in lines {
        read(line);
    }
    child.wait().unwrap();
    told
}

#[test]
fn nothing_that_was_reported_as_inserted_is_lost_however_often_its_process_is_killed() {
    let kills = std::env::var("LIBRATION_KILLS").ok().and_then(|n| n.parse().ok()).unwrap_or(5);
    let dir = TempDir::new().unwrap();
    let path = dir.path().join("replay");
    let mut source = source();
    let mut kept: VecDeque<(Rollout<f32, 2, 1>, Vec<f32>)> = VecDeque::new();
    let mut turns = 0;
    for kill in 0..kills {
        let told = killed(&path, Duration::from_micros(500 + 977 * (kill * kill % 41)));
        let replay = ReplayFile::<f32>::open(&path, [2, 1]).unwrap();
        let there = replay.inserted() as usize / STEPS;
        assert!(there == told || there == told + 1, "{there} are there, {told} were told");
        for _ in turns..there {
            kept.push_back(source.next());
            if kept.len() > 10 {
                kept.pop_front();
            }
        }
        turns = there;
        // At most one rollout had to go for the one that did not come.
        assert!(replay.steps() as usize >= (there.min(7)) * STEPS, "{} steps", replay.steps());
        let mut batch = Batch::new(4000, [2, 1]);
        let draw = Draw { seed: 1, number: kill };
        let serial = Execution::serial();
        replay.sample(draw, Lookahead::default(), &mut batch.columns(), &serial).unwrap();
        for (i, &number) in batch.number.iter().enumerate() {
            let (step, n) = (number as usize / COUNT, number as usize % COUNT);
            let (rollout, next) = &kept[kept.len() + step / STEPS - turns];
            let t = step % STEPS;
            assert_eq!(batch.observation[2 * i..][..2], rollout.seen(t, n));
            assert_eq!(batch.action[i..][..1], rollout.done(t, n));
            assert_eq!(batch.reward[i], rollout.reward()[t * COUNT + n]);
            let end = rollout.finals().iter().find(|end| (end.step, end.environment) == (t, n));
            let after = match end {
                Some(end) => end.observation,
                None if t + 1 < STEPS => rollout.seen(t + 1, n),
                None => [next[2 * n], next[2 * n + 1]],
            };
            assert_eq!(batch.next_observation[2 * i..][..2], after, "{step} {n}");
        }
    }
    assert!(turns > kills as usize);
}
