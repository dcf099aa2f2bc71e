//! Sampling frequencies.

use libration::ensemble::Execution;
use libration::replay::{Batch, Capacity, Draw, Lookahead, Sequences};
use libration::rl::Autoreset;

use super::{Replay, SIZES, environments, filled, run};

const BATCHES: u64 = 4000;
const BATCH: usize = 64;

/// Pearson's statistic of counts beside expectations, in standard deviations from its mean: of χ² with `k` degrees of freedom the mean
/// is `k`, the variance `2k`, and beyond a few dozen it is nearly normal.
fn deviation(found: &[f64], expected: &[f64]) -> f64 {
    let terms = found.iter().zip(expected).map(|(f, e)| (f - e) * (f - e) / e);
    let degrees = found.len() as f64 - 1.0;
    (terms.sum::<f64>() - degrees) / (2.0 * degrees).sqrt()
}

/// How often each transition was drawn.
fn counts(replay: &Replay, mut draw: impl FnMut(Draw) -> Vec<u64>) -> Vec<f64> {
    let mut counts = vec![0.0; (replay.inserted() * 10) as usize];
    for number in 0..BATCHES {
        for at in draw(Draw { seed: 11, number }) {
            counts[at as usize] += 1.0;
        }
    }
    counts
}

#[test]
fn every_transition_is_as_likely_also_among_steps_that_are_none() {
    let serial = Execution::serial();
    for autoreset in [Autoreset::SameStep, Autoreset::Disabled] {
        let mut all = environments(autoreset, 10);
        let mut replay = Replay::new(SIZES, Capacity::new(40, 10)).unwrap();
        let (rollout, next) = run(&mut all, 40, Default::default());
        replay.insert(&rollout, &next, &serial).unwrap();
        // Under `Disabled` at most 7 of 40 steps are transitions.
        assert_eq!(replay.len() < 71, autoreset == Autoreset::Disabled, "{}", replay.len());
        let mut batch = Batch::<f32>::new(BATCH, SIZES);
        let counts = counts(&replay, |draw| {
            replay.sample(draw, Lookahead::default(), &mut batch.columns(), &serial).unwrap();
            batch.number.clone()
        });
        let (there, gone): (Vec<_>, Vec<_>) =
            counts.into_iter().enumerate().partition(|&(i, _)| replay.contains(i as u64));
        assert!(gone.iter().all(|&(_, count)| count == 0.0));
        let found: Vec<f64> = there.into_iter().map(|(_, count)| count).collect();
        let expected = vec![(BATCHES * BATCH as u64) as f64 / found.len() as f64; found.len()];
        let off = deviation(&found, &expected);
        assert!(off.abs() < 4.0, "{autoreset:?}: {off} standard deviations");
    }
}

#[test]
fn every_sequence_is_as_likely() {
    let replay = filled(Capacity::new(40, 10), 40);
    let mut to = Sequences::<f32>::new(BATCH, 9, SIZES);
    let counts = counts(&replay, |draw| {
        replay.sample_sequences(draw, &mut to, &Execution::serial()).unwrap();
        to.number.clone()
    });
    // The last 8 steps begin none.
    let (found, gone) = counts.split_at(32 * 10);
    assert!(gone.iter().all(|&count| count == 0.0));
    let expected = vec![(BATCHES * BATCH as u64) as f64 / 320.0; 320];
    let off = deviation(found, &expected);
    assert!(off.abs() < 4.0, "{off} standard deviations");
}

#[test]
fn transitions_are_drawn_in_proportion_to_a_power_of_their_priorities_and_weighed_by_its_inverse() {
    let serial = Execution::serial();
    let mut replay = filled(Capacity::new(40, 10).priorities(), 40);
    let numbers: Vec<u64> = (0..400).collect();
    let priorities: Vec<f32> = numbers.iter().map(|&i| (i % 5) as f32).collect();
    assert_eq!(replay.update(&numbers, &priorities, 0.6).unwrap(), 400);
    let weights: Vec<f64> = priorities.iter().map(|&p| f64::from(p).powf(0.6)).collect();
    let total: f64 = weights.iter().sum();
    let mut batch = Batch::<f32>::new(BATCH, SIZES);
    let counts = counts(&replay, |draw| {
        let drawn = Lookahead::default();
        replay.sample_prioritised(draw, drawn, 0.4, &mut batch.columns(), &serial).unwrap();
        // The largest importance is that of the least weight in the batch.
        let least = batch.number.iter().map(|&i| weights[i as usize]).fold(f64::MAX, f64::min);
        for (&i, &importance) in batch.number.iter().zip(&batch.weight) {
            let expected = (least / weights[i as usize]).powf(0.4);
            assert!((f64::from(importance) - expected).abs() < 1e-7, "{importance} {expected}");
        }
        batch.number.clone()
    });
    let drawn = (BATCHES * BATCH as u64) as f64;
    let pairs = counts.iter().zip(&weights);
    assert!(pairs.clone().all(|(&count, &weight)| weight > 0.0 || count == 0.0));
    let (found, expected): (Vec<f64>, Vec<f64>) =
        pairs.filter(|(_, w)| **w > 0.0).map(|(&c, w)| (c, drawn * w / total)).unzip();
    // One from each of as many equal parts: counts vary less than those of independent draws.
    let off = deviation(&found, &expected);
    assert!(off < 4.0, "{off} standard deviations");
}

#[test]
fn a_batch_follows_from_its_address_whatever_was_drawn_before_and_on_how_many_threads() {
    let replay = filled(Capacity::new(400, 10), 400);
    let three = Execution::serial().threads(3).unwrap();
    let sample = |number, execution: &Execution| {
        let mut batch = Batch::<f32>::new(40_000, SIZES);
        let draw = Draw { seed: 1, number };
        replay.sample(draw, Lookahead::default(), &mut batch.columns(), execution).unwrap();
        batch
    };
    let alone = sample(5, &Execution::serial());
    assert_ne!(sample(4, &three), alone);
    assert_eq!(sample(5, &three), alone);
    let mut sequences = [(); 2].map(|()| Sequences::<f32>::new(9000, 5, SIZES));
    for (to, execution) in sequences.iter_mut().zip([&Execution::serial(), &three]) {
        replay.sample_sequences(Draw { seed: 1, number: 9 }, to, execution).unwrap();
    }
    assert_eq!(sequences[0], sequences[1]);
}
