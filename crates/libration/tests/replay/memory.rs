//! The memory of a replay buffer after its process ended.

use libration::ensemble::Execution;
use libration::random::philox4x32;
use libration::replay::{Batch, Capacity, Draw, Lookahead, ReplayBuffer, ReplayError};
use libration::rl::Autoreset;
use memmap2::MmapMut;

use super::{Replay, SIZES, environments, filled, run};

/// Every field of these small buffers is a page; the first is the header.
const PAGE: usize = 4096;

/// Memory with these bytes.
fn mapped(bytes: &[u8]) -> MmapMut {
    let mut map = MmapMut::map_anon(bytes.len()).unwrap();
    map.copy_from_slice(bytes);
    map
}

/// What finds its bytes.
pub(crate) fn reopened(replay: &Replay) -> Result<Replay, ReplayError> {
    Replay::open(mapped(replay.bytes()), replay.sizes())
}

/// A batch of it.
fn batch(replay: &Replay) -> Batch<f32> {
    numbered(replay, 3)
}

fn numbered(replay: &Replay, number: u64) -> Batch<f32> {
    let mut batch = Batch::new(100, SIZES);
    let draw = Draw { seed: 2, number };
    replay.sample(draw, Lookahead::default(), &mut batch.columns(), &Execution::serial()).unwrap();
    batch
}

#[test]
fn a_process_that_dies_at_any_write_loses_nothing_that_was_inserted_before() {
    let serial = Execution::serial();
    let capacity = Capacity::new(9, 3).ends(6).priorities();
    let mut all = environments(Autoreset::SameStep, 3);
    let mut replay = Replay::new(SIZES, capacity).unwrap();
    for _ in 0..5 {
        let (rollout, next) = run(&mut all, 2, Default::default());
        replay.insert(&rollout, &next, &serial).unwrap();
    }
    all.reset(&[true, false, true]).unwrap();
    let before = replay.bytes().to_vec();
    let steps = replay.inserted() - replay.steps()..replay.inserted();
    let there = Replay::open(mapped(&before), SIZES).unwrap();
    let drawn: Vec<_> = (0..30).map(|number| numbered(&there, number)).collect();
    let one = |number: u64| {
        let find = |batch: &Batch<f32>| {
            batch.number.iter().position(|&i| i == number).map(|i| entry(batch, i))
        };
        drawn.iter().find_map(find).unwrap()
    };
    let known: Vec<_> = (steps.start * 3..steps.end * 3).map(one).collect();
    let (rollout, next) = run(&mut all, 2, Default::default());
    replay.insert(&rollout, &next, &serial).unwrap();
    let after = replay.bytes();
    // Of the two records the newer one came last. The older one is that of the room that was made and of what the reset parted; what
    // it counts, the ends on the last two pages, was written before it. With all else in the pages before, any part may have been.
    let words = |at: usize| u64::from_le_bytes(after[at..at + 8].try_into().unwrap());
    let older = if words(512) < words(1024) { 512 } else { 1024 };
    let mut dead = before.clone();
    dead[older..older + 64].copy_from_slice(&after[older..older + 64]);
    dead[6 * PAGE..].copy_from_slice(&after[6 * PAGE..]);
    let mut unmarked = dead.clone();
    // Marks of what the reset parted, in the last row, were set before that row's successor was written.
    dead[4 * PAGE + 27..][..3].copy_from_slice(&after[4 * PAGE + 27..][..3]);
    assert!(unmarked != dead);
    // Who died before they were set parts nothing twice, and nothing but what it parted before.
    for _ in 0..2 {
        let mut again = Replay::open(mapped(&unmarked), SIZES).unwrap();
        again.insert(&rollout, &next, &serial).unwrap();
        for number in 0..30 {
            assert_eq!(numbered(&again, number), numbered(&replay, number));
        }
        reopened(&again).unwrap();
        // Or it died again, with one of the marks.
        let first =
            (0..3).find(|i| unmarked[4 * PAGE + 27 + i] != dead[4 * PAGE + 27 + i]).unwrap();
        unmarked[4 * PAGE + 27 + first] = dead[4 * PAGE + 27 + first];
    }
    let changed: Vec<usize> = (PAGE..6 * PAGE).filter(|&i| dead[i] != after[i]).collect();
    assert!(changed.len() > 50, "{}", changed.len());
    for cut in 0..2 * changed.len() as u32 {
        let mut torn = dead.clone();
        for (k, &i) in changed.iter().enumerate() {
            let random = philox4x32([cut, k as u32, 0, 0], [7, 7])[0].is_multiple_of(2);
            // Up to somewhere, or scattered.
            let written = if cut % 2 == 0 { k < cut as usize / 2 } else { random };
            torn[i] = if written { after[i] } else { dead[i] };
        }
        let found = Replay::open(mapped(&torn), SIZES).unwrap();
        assert_eq!((found.inserted(), found.steps()), (steps.end, replay.steps() - 2));
        let drawn = batch(&found);
        for (i, number) in drawn.number.iter().enumerate() {
            let was = &known[(number - steps.start * 3) as usize];
            assert_eq!(&entry(&drawn, i), was, "transition {number}, {cut}");
        }
    }
}

/// What there is of a transition.
fn entry(batch: &Batch<f32>, i: usize) -> ([[f32; 2]; 2], [f32; 2], [u8; 2]) {
    let seen =
        [&batch.observation, &batch.next_observation].map(|all| [all[2 * i], all[2 * i + 1]]);
    let flags = [batch.terminated[i], batch.truncated[i]];
    (seen, [batch.action[i], batch.reward[i]], flags)
}

fn sizes(numbers: &[f32]) -> Vec<f32> {
    numbers.iter().map(|x| x.abs()).collect()
}

#[test]
fn what_is_opened_goes_on_as_if_it_had_never_been_closed() {
    let serial = Execution::serial();
    let mut all = environments(Autoreset::SameStep, 3);
    let mut kept = Replay::new(SIZES, Capacity::new(9, 3).priorities()).unwrap();
    let mut opened = reopened(&kept).unwrap();
    for number in 0..40 {
        let (rollout, next) = run(&mut all, 2, Default::default());
        for replay in [&mut kept, &mut opened] {
            replay.insert(&rollout, &next, &serial).unwrap();
            let draw = Draw { seed: 1, number };
            let mut batch = Batch::<f32>::new(8, SIZES);
            let columns = &mut batch.columns();
            replay.sample_prioritised(draw, Lookahead::default(), 0.4, columns, &serial).unwrap();
            replay.update(&batch.number, &sizes(&batch.reward), 0.6).unwrap();
        }
        assert_eq!(batch(&kept), batch(&opened));
        assert_eq!(kept.total_weight().to_bits(), opened.total_weight().to_bits());
        opened = reopened(&opened).unwrap();
        assert_eq!(kept.bytes()[PAGE..], opened.bytes()[PAGE..], "{number}");
    }
}

#[test]
fn memory_of_something_else_and_damaged_memory_are_refused() {
    let replay = filled(Capacity::new(20, 3), 20);
    let bytes = replay.bytes();
    let refused = |change: &dyn Fn(&mut Vec<u8>)| {
        let mut bytes = bytes.to_vec();
        change(&mut bytes);
        Replay::open(mapped(&bytes), SIZES).map(drop).unwrap_err().to_string()
    };
    for (said, found) in [
        ("its beginning is another", refused(&|bytes| bytes[0] ^= 1)),
        ("its version is 2; it must be 1", refused(&|bytes| bytes[8] ^= 3)),
        ("its description", refused(&|bytes| bytes[41] ^= 1)),
        ("neither record", refused(&|bytes| bytes[512..1536].fill(0))),
        ("bytes of", refused(&|bytes| bytes.truncate(5 * PAGE))),
        ("its length is 100 bytes", refused(&|bytes| bytes.truncate(100))),
        ("its last observation is missing", refused(&|bytes| bytes[4 * PAGE] |= 4)),
        ("counts", refused(&|bytes| bytes[4 * PAGE] |= 8)),
        ("is in an invalid place", refused(&|bytes| bytes[5 * PAGE..][..8].fill(0xff))),
    ] {
        assert!(found.contains(said), "{found}");
    }
    let wide = ReplayBuffer::<f64>::open(mapped(bytes), SIZES).map(drop).unwrap_err().to_string();
    assert!(wide.contains("the float type is f32; it must be f64"), "{wide}");
    for (sizes, wanted) in [([3, 1], "3 numbers seen, 1 done"), ([2, 2], "2 numbers seen, 2 done")]
    {
        let other = Replay::open(mapped(bytes), sizes).map(drop).unwrap_err().to_string();
        let expected = format!("2 numbers seen, 1 done; it must be {wanted}");
        assert!(other.contains(&expected), "{other}");
    }
}
