//! Errors of a replay buffer, and transitions that it does not store.

use libration::ensemble::Execution;
use libration::replay::{Batch, Capacity, Draw, Lookahead, ReplayBuffer, Sequences};
use libration::rl::policy::Constant;
use libration::rl::{Autoreset, Layout, Plan, Rollout};

use super::programs::programs;
use super::{Replay, SIZES, Source, environments, filled, run};

/// What is said.
fn said<X, E: ToString>(result: Result<X, E>) -> String {
    result.map(drop).map_err(|error| error.to_string()).unwrap_err()
}

#[test]
fn what_cannot_be_is_refused_with_the_name_the_value_and_what_is_allowed() {
    let serial = Execution::serial();
    let mut all = environments(Autoreset::SameStep, 3);
    let (rollout, next) = run(&mut all, 20, Default::default());
    let mut replay = Replay::new(SIZES, Capacity::new(30, 3)).unwrap();
    let mut batch = Batch::<f32>::new(4, SIZES);
    let (draw, ahead) = (Draw { seed: 0, number: 0 }, Lookahead::default());
    let empty = replay.sample(draw, ahead, &mut batch.columns(), &serial);
    assert!(said(empty).contains("no transitions to draw from"));
    let none = replay.sample_prioritised(draw, ahead, 0.5, &mut batch.columns(), &serial);
    assert!(said(none).contains("no priorities"));
    assert!(said(replay.update(&[], &[], 1.0)).contains("no priorities"));
    for (capacity, name) in [
        (Capacity::new(0, 3), "steps"),
        (Capacity::new(3, 0), "environments"),
        (Capacity::new(3, 3).ends(0), "ends"),
    ] {
        let found = said(Replay::new(SIZES, capacity));
        assert!(found.contains(&format!("the capacity is 0 {name}; it must be at least 1")));
    }
    let huge = said(Replay::new(SIZES, Capacity::new(usize::MAX - 1, usize::MAX)));
    assert!(huge.contains("memory"), "{huge}");
    let much = said(Replay::new(SIZES, Capacity::new(1 << 40, 3)));
    assert!(much.contains("memory"), "{much}");

    let other = Replay::new(SIZES, Capacity::new(30, 4)).unwrap().insert(&rollout, &next, &serial);
    assert!(said(other).contains("environments of the rollout is 3; it must be 4"));
    let other = replay.insert(&rollout, &next[1..], &serial);
    assert!(said(other).contains("is 5; it must be 6"));
    let mut short = Replay::new(SIZES, Capacity::new(19, 3)).unwrap();
    let found = said(short.insert(&rollout, &next, &serial));
    assert!(
        found.contains("steps of a rollout: 20 in one insertion; the capacity is 19"),
        "{found}"
    );
    let mut few = Replay::new(SIZES, Capacity::new(20, 3).ends(2)).unwrap();
    let found = said(few.insert(&rollout, &next, &serial));
    assert!(found.contains("ends of episodes") && few.is_empty(), "{found}");

    replay.insert(&rollout, &next, &serial).unwrap();
    let sequences = replay.sample_sequences(draw, &mut Sequences::new(2, 21, SIZES), &serial);
    assert!(said(sequences).contains("no sequences of so many steps"));
    let sequences = replay.sample_sequences(draw, &mut Sequences::new(2, 0, SIZES), &serial);
    assert!(said(sequences).contains("0 steps of a sequence"));
    let mut columns = batch.columns();
    columns.reward = &mut [];
    let ragged = replay.sample(draw, ahead, &mut columns, &serial);
    assert!(said(ragged).contains("rewards of the batch is 0; it must be 4"));
    for discount in [-0.1, 1.1, f64::NAN] {
        let ahead = Lookahead { steps: 1, discount };
        let found = said(replay.sample(draw, ahead, &mut batch.columns(), &serial));
        assert!(found.contains("discount is") && found.contains("from 0 to 1"), "{found}");
    }
    let ahead = Lookahead { steps: 0, discount: 0.5 };
    let found = said(replay.sample(draw, ahead, &mut batch.columns(), &serial));
    assert!(found.contains("0 steps to look ahead"), "{found}");
    // A batch of nothing is one.
    let nothing = &mut Batch::new(0, SIZES);
    replay.sample(draw, Lookahead::default(), &mut nothing.columns(), &serial).unwrap();
}

#[test]
fn priorities_that_cannot_be_change_none_and_those_of_what_has_gone_are_passed_over() {
    let mut replay = filled(Capacity::new(20, 3).priorities(), 20);
    let total = replay.total_weight();
    for (numbers, priorities, exponent, what) in [
        (vec![0, 1], vec![2.0, f32::NAN], 1.0, "priority 1 is NaN"),
        (vec![0, 1], vec![2.0, -1.0], 1.0, "priority 1 is -1"),
        (vec![0, 1], vec![2.0, f32::INFINITY], 1.0, "priority 1 is inf"),
        (vec![0, 1], vec![2.0, 1e38], 9.0, "priority 1 is"),
        (
            vec![0, 60],
            vec![2.0, 2.0],
            1.0,
            "transition 1 is 60; it must be a number from a batch, below 60",
        ),
        (vec![0, 1], vec![2.0], 1.0, "priorities is 1; it must be 2"),
        (vec![0], vec![2.0], -1.0, "exponent of priorities is -1"),
    ] {
        let found = said(replay.update(&numbers, &priorities, exponent));
        assert!(found.contains(what), "{found}");
        assert_eq!(replay.total_weight(), total);
    }
    let mut all = environments(Autoreset::SameStep, 3);
    let (rollout, next) = run(&mut all, 5, Default::default());
    replay.insert(&rollout, &next, &Execution::serial()).unwrap();
    // Steps 0 to 4 have gone.
    assert_eq!(replay.update(&[0, 14, 15, 74, 15], &[9.0, 9.0, 3.0, 5.0, 4.0], 1.0), Ok(3));
    assert_eq!([14, 15, 74].map(|i| replay.weight(i)), [None, Some(4.0), Some(5.0)]);
    assert_eq!(replay.total_weight(), total - 2.0 + 4.0 + 5.0);
    // What comes now counts as the largest of all.
    replay.insert(&rollout, &next, &Execution::serial()).unwrap();
    assert_eq!(replay.weight(75), Some(5.0));
}

#[test]
fn a_lost_environment_leaves_no_transition_and_nothing_that_is_no_number() {
    let serial = Execution::serial();
    for autoreset in [Autoreset::SameStep, Autoreset::NextStep, Autoreset::Disabled] {
        let mut all = environments(autoreset, 3);
        let mut rollout = Rollout::new(Plan::new(6, 3).truncated()).unwrap();
        let mut replay = Replay::new(SIZES, Capacity::new(12, 3).ends(36).priorities()).unwrap();
        let mut next = [0.0; 6];
        all.rollout(Constant([3e38]), &mut rollout).unwrap();
        all.observe(&mut next).unwrap();
        assert!(rollout.finals().iter().any(|end| end.lost));
        replay.insert(&rollout, &next, &serial).unwrap();
        all.reset(&[true; 3]).unwrap();
        let (rollout, next) = run(&mut all, 6, Default::default());
        replay.insert(&rollout, &next, &serial).unwrap();
        let mut batch = Batch::<f32>::new(500, SIZES);
        let (draw, ahead) = (Draw { seed: 0, number: 0 }, Lookahead { steps: 3, discount: 0.9 });
        for prioritised in [false, true] {
            let columns = &mut batch.columns();
            match prioritised {
                false => replay.sample(draw, ahead, columns, &serial),
                true => replay.sample_prioritised(draw, ahead, 0.5, columns, &serial),
            }
            .unwrap();
            let numbers = batch.observation.iter().chain(&batch.next_observation);
            assert!(numbers.chain(&batch.reward).all(|x| x.is_finite()), "{autoreset:?}");
            assert!(batch.number.iter().all(|&i| replay.contains(i)));
        }
    }
}

#[test]
fn a_buffer_of_wider_numbers_and_more_dimensions_keeps_them() {
    use libration::State;
    use libration::ensemble::All;
    use libration::integrator::VelocityVerlet;
    use libration::rl::policy::Random;
    use libration::rl::start::FixedStart;
    use libration::rl::task::Regulate;
    use libration::rl::{Environment, Environments};
    use libration::system::{BaselineOnly, HenonHeiles};

    let task = Regulate { position: 1.0, velocity: 0.1, effort: 0.0, bound: 10.0 };
    let start = FixedStart(State { q: [0.1, 0.2], v: [0.0, 0.1] });
    let system = All(BaselineOnly(HenonHeiles { lambda: 1.0 }));
    let world = Environment::new(system, VelocityVerlet, 0.01, task, start).limit(50);
    let mut all = Environments::<f64, _, 4, 2>::new(world, 70, 1, Execution::serial()).unwrap();
    for layout in [Layout::Interleaved, Layout::Planes] {
        let mut rollout = Rollout::new(Plan::new(120, 70).truncated().layout(layout)).unwrap();
        all.rollout(Random::between([-1.0; 2], [1.0; 2]), &mut rollout).unwrap();
        let mut next = vec![0.0; 70 * 4];
        all.observe(&mut next).unwrap();
        let mut replay = ReplayBuffer::<f64>::new([4, 2], Capacity::new(120, 70)).unwrap();
        replay.insert(&rollout, &next, &Execution::serial()).unwrap();
        let mut batch = Batch::new(1000, replay.sizes());
        let (draw, serial) = (Draw { seed: 0, number: 0 }, Execution::serial());
        replay.sample(draw, Lookahead::default(), &mut batch.columns(), &serial).unwrap();
        for (i, &number) in batch.number.iter().enumerate() {
            let (t, n) = ((number / 70) as usize, (number % 70) as usize);
            assert_eq!(batch.observation[4 * i..][..4], rollout.seen(t, n));
            assert_eq!(batch.action[2 * i..][..2], rollout.done(t, n));
            assert_eq!(batch.reward[i], rollout.reward()[t * 70 + n]);
            let end = rollout.finals().iter().find(|end| (end.step, end.environment) == (t, n));
            let last = t + 1 == 120;
            let after = end.map(|end| end.observation);
            let after = after.unwrap_or_else(|| {
                if last {
                    core::array::from_fn(|k| next[n * 4 + k])
                } else {
                    rollout.seen(t + 1, n)
                }
            });
            assert_eq!(batch.next_observation[4 * i..][..4], after);
        }
    }
}

#[test]
fn a_rollout_of_other_sizes_is_refused_by_what_differs_and_changes_nothing() {
    let serial = Execution::serial();
    let mut replay = Replay::new([5, 3], Capacity::new(12, 3).ends(36).priorities()).unwrap();
    let (rollout, next) = programs(Autoreset::SameStep, 3, [5, 3]).run(9, Layout::Planes);
    replay.insert(&*rollout, &next, &serial).unwrap();
    let before = replay.bytes().to_vec();
    for (sizes, text) in [
        ([6, 3], "the number of observed numbers of the rollout is 6; it must be 5"),
        ([4, 3], "the number of observed numbers of the rollout is 4; it must be 5"),
        ([5, 2], "the number of actions of the rollout is 2; it must be 3"),
    ] {
        let (rollout, next) = programs(Autoreset::SameStep, 3, sizes).run(9, Layout::Interleaved);
        assert_eq!(said(replay.insert(&*rollout, &next, &serial)), text);
        assert!(replay.bytes() == before);
    }
    let (rollout, next) = run(&mut environments(Autoreset::SameStep, 3), 9, Layout::Interleaved);
    let text = "the number of observed numbers of the rollout is 2; it must be 5";
    assert_eq!(said(replay.insert(&rollout, &next, &serial)), text);
    assert!(replay.bytes() == before);
}

#[test]
fn a_buffer_without_observations_or_actions_is_refused() {
    for (sizes, name) in [([0, 1], "observations"), ([1, 0], "actions")] {
        let text = format!("the capacity is 0 {name}; it must be at least 1");
        assert_eq!(said(Replay::new(sizes, Capacity::new(3, 3))), text);
    }
    let huge = said(Replay::new([usize::MAX; 2], Capacity::new(3, 3)));
    assert!(huge.contains("memory"), "{huge}");
}

#[test]
fn a_batch_of_other_sizes_is_refused_before_anything_is_written() {
    let serial = Execution::serial();
    let replay = filled(Capacity::new(20, 3).priorities(), 20);
    let (draw, ahead) = (Draw { seed: 0, number: 0 }, Lookahead::default());
    for (sizes, text) in [
        ([3, 1], "the number of observations of the batch is 12; it must be 8"),
        ([2, 2], "the number of actions of the batch is 8; it must be 4"),
    ] {
        let mut batch = Batch::<f32>::new(4, sizes);
        let before = batch.clone();
        let drawn = replay.sample(draw, ahead, &mut batch.columns(), &serial);
        assert_eq!(said(drawn), text);
        let drawn = replay.sample_prioritised(draw, ahead, 0.5, &mut batch.columns(), &serial);
        assert_eq!(said(drawn), text);
        assert_eq!(batch, before);
    }
    let mut batch = Batch::<f32>::new(4, SIZES);
    batch.next_observation.pop();
    let drawn = replay.sample(draw, ahead, &mut batch.columns(), &serial);
    assert_eq!(said(drawn), "the number of next observations of the batch is 7; it must be 8");
    for (sizes, text) in [
        ([3, 1], "the number of observations of the sequences is 30; it must be 20"),
        ([2, 2], "the number of actions of the sequences is 20; it must be 10"),
    ] {
        let mut sequences = Sequences::<f32>::new(2, 5, sizes);
        let before = sequences.clone();
        assert_eq!(said(replay.sample_sequences(draw, &mut sequences, &serial)), text);
        assert_eq!(sequences, before);
    }
}
