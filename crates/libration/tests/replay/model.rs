//! A replay buffer against a naive one, over random operations.

use core::ops::Range;

use libration::ensemble::Execution;
use libration::random::philox4x32;
use libration::replay::{Batch, Capacity, Draw, Lookahead, Sequences};
use libration::rl::{Autoreset, Layout};

use super::naive_buffer::Naive;
use super::programs::programs;
use super::{Replay, SIZES, Source, environments};

const ENVIRONMENTS: usize = 3;
const BATCH: usize = 4;

/// Numbers below others, one after the other.
struct Dice(u64);

impl Dice {
    fn below(&mut self, count: u64) -> u64 {
        self.0 += 1;
        let [a, b, ..] = philox4x32([self.0 as u32, (self.0 >> 32) as u32, 0, 0], [1, 2]);
        (u64::from(a) << 32 | u64::from(b)) % count
    }
}

/// Performs the operations with these numbers on both buffers, and requires the same results.
fn compare(mut all: impl Source, sizes: [usize; 2], operations: Range<u64>) {
    let serial = Execution::serial();
    let capacity = Capacity::new(12, ENVIRONMENTS).ends(8).priorities();
    let mut replay = Replay::new(sizes, capacity).unwrap();
    let mut naive = Naive::new(capacity);
    let (mut dice, count) = (Dice(operations.start), operations.end - operations.start);
    let mut batch = Batch::<f32>::new(BATCH, sizes);
    for number in operations {
        let draw = Draw { seed: 3, number };
        match dice.below(20) {
            0 | 1 => {
                let layout = [Layout::Interleaved, Layout::Planes][dice.below(2) as usize];
                let steps = 1 + dice.below(3) as usize;
                let (rollout, next) = all.run(steps, layout);
                let inserted = replay.insert(&*rollout, &next, &serial);
                // So many ends at once there is no room for.
                if rollout.ended() > capacity.ends {
                    inserted.unwrap_err();
                    continue;
                }
                inserted.unwrap();
                naive.insert(&*rollout, &next);
            }
            2 => {
                let which: Vec<bool> = (0..ENVIRONMENTS).map(|_| dice.below(2) == 0).collect();
                all.reset(&which);
            }
            3 => {
                // A copy of the bytes is the same buffer.
                replay = super::memory::reopened(&replay).unwrap();
            }
            4..8 => {
                let mut to = Sequences::new(2, 1 + dice.below(5) as usize, sizes);
                match replay.sample_sequences(draw, &mut to, &serial) {
                    Ok(()) => same_sequences(&naive, &to, sizes),
                    Err(_) => assert!(!begins(&naive, to.steps)),
                }
            }
            8..12 if !replay.is_empty() => {
                let drawn = Lookahead::default();
                let sampled =
                    replay.sample_prioritised(draw, drawn, 0.5, &mut batch.columns(), &serial);
                if replay.total_weight() == 0.0 {
                    sampled.unwrap_err();
                    continue;
                }
                sampled.unwrap();
                assert!(batch.number.iter().all(|&i| naive.get(i).unwrap().weight > 0.0));
                let priorities: Vec<f32> = (0..BATCH).map(|_| dice.below(4) as f32).collect();
                replay.update(&batch.number, &priorities, 2.0).unwrap();
                for (&i, priority) in batch.number.iter().zip(&priorities) {
                    naive.weigh(i, f64::from(*priority).powi(2));
                }
            }
            12 => {
                let total: f64 = naive.all().map(|(_, transition)| transition.weight).sum();
                // Squares of small whole numbers: sums of them are exact.
                assert_eq!(replay.total_weight(), total, "operation {number}");
                assert_eq!([replay.len(), replay.steps()], [naive.len(), naive.steps()]);
                let [first, end] = [naive.first, naive.first + naive.steps()];
                let n = ENVIRONMENTS as u64;
                for number in first.saturating_sub(2) * n..(end + 2) * n {
                    let there = naive.get(number);
                    assert_eq!(replay.contains(number), there.is_some());
                    assert_eq!(replay.weight(number), there.map(|there| there.weight));
                }
            }
            _ => {
                let ahead = Lookahead { steps: 1 + dice.below(4) as usize, discount: 0.5 };
                let sampled = replay.sample(draw, ahead, &mut batch.columns(), &serial);
                assert_eq!(sampled.is_err(), naive.len() == 0);
                if sampled.is_ok() {
                    same_batch(&naive, &batch, sizes, ahead);
                }
            }
        }
    }
    assert!(naive.first > count / 20, "the ring went round {} times", naive.first / 12);
}

fn same_batch(naive: &Naive, batch: &Batch<f32>, sizes: [usize; 2], ahead: Lookahead) {
    let [observations, actions] = sizes;
    for (i, &number) in batch.number.iter().enumerate() {
        let there = naive.get(number).unwrap();
        // Halves: powers of the discount are exact, and sums are formed in the same order.
        let (paid, last, taken) = naive.ahead(number, ahead.steps, ahead.discount as f32);
        assert_eq!(row(&batch.observation, i, observations), there.seen);
        assert_eq!(row(&batch.action, i, actions), there.done);
        assert_eq!(row(&batch.next_observation, i, observations), last.next, "{number}");
        assert_eq!(batch.reward[i], paid, "{number}");
        assert_eq!((batch.terminated[i] == 1, batch.truncated[i] == 1), (last.over, last.cut));
        let discount = if last.over { 0.0 } else { 0.5_f32.powi(taken as i32) };
        assert_eq!((batch.discount[i], batch.weight[i]), (discount, 1.0));
    }
}

/// Row `i` of so many numbers each.
fn row(numbers: &[f32], i: usize, width: usize) -> &[f32] {
    &numbers[i * width..][..width]
}

/// Whether a sequence of so many steps begins with a transition.
fn begins(naive: &Naive, steps: usize) -> bool {
    let end = (naive.first + naive.steps() + 1).saturating_sub(steps as u64) * ENVIRONMENTS as u64;
    naive.all().any(|(number, _)| number < end)
}

fn same_sequences(naive: &Naive, found: &Sequences<f32>, [observations, actions]: [usize; 2]) {
    for (i, &number) in found.number.iter().enumerate() {
        let (mut goes_on, mut next) = (true, None);
        for t in 0..found.steps {
            let (at, number) = (i * found.steps + t, number + (t * ENVIRONMENTS) as u64);
            let there = naive.get(number);
            goes_on &= there.is_some();
            assert_eq!(row(&found.observation, at, observations), naive.seen(number));
            assert_eq!(found.mask[at] == 1, goes_on);
            if let Some(there) = there {
                assert_eq!(row(&found.action, at, actions), there.done);
                assert_eq!(found.reward[at], there.paid);
                let flags = (found.terminated[at] == 1, found.truncated[at] == 1);
                assert_eq!(flags, (there.over, there.cut));
                next = if goes_on { Some(&there.next) } else { next };
                goes_on &= !there.parted;
            }
        }
        assert_eq!(row(&found.next_observation, i, observations), next.unwrap());
    }
}

#[test]
fn three_hundred_thousand_random_operations_find_what_a_list_of_everything_finds() {
    let ways = [Autoreset::SameStep, Autoreset::NextStep, Autoreset::Disabled];
    std::thread::scope(|scope| {
        for autoreset in ways {
            let all = environments(autoreset, ENVIRONMENTS);
            let first = autoreset as u64 * 100_000;
            scope.spawn(move || compare(all, SIZES, first..first + 100_000));
        }
    });
}

#[test]
fn buffers_of_any_width_find_what_a_list_of_everything_finds() {
    let ways = [Autoreset::SameStep, Autoreset::NextStep, Autoreset::Disabled];
    for (sizes, autoreset) in
        [[6, 1], [5, 3], [1, 1], [3, 9]].into_iter().zip(ways.into_iter().cycle())
    {
        compare(programs(autoreset, ENVIRONMENTS, sizes), sizes, 0..20_000);
    }
}
