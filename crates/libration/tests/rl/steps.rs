//! Single steps have the bits of a rollout.

use libration::ensemble::Execution;
use libration::rl::{
    Autoreset, EnvironmentError, Environments, EpisodeEnd, Plan, Rollout, StepBuffers, World,
};

use crate::any_policy::sequence;
use crate::bits::EXPLORING;
use crate::{executions, perturbed, plain};

const STEPS: usize = 150;
const AUTORESETS: [Autoreset; 3] = [Autoreset::SameStep, Autoreset::NextStep, Autoreset::Disabled];

/// What so many steps lead to, all at once.
fn whole<E: World<f32, 2, 1>>(all: &mut Environments<f32, E, 2, 1>) -> Rollout<f32, 2, 1> {
    let plan = Plan::new(STEPS, all.len()).truncated().log_probabilities();
    let mut rollout = Rollout::new(plan).unwrap();
    all.rollout(EXPLORING, &mut rollout).unwrap();
    rollout
}

#[test]
fn to_act_step_by_step_is_to_do_so_at_once() {
    for autoreset in AUTORESETS {
        for count in [1, 64, 70, 600] {
            for execution in executions() {
                compare(perturbed(autoreset), count, &execution);
            }
            // Nobody looks before an action that was given.
            compare(plain().autoreset(autoreset), count, &executions()[0]);
        }
    }
}

fn compare<E: World<f32, 2, 1>>(world: E, count: usize, execution: &Execution) {
    let make = || Environments::new(world, count, 5, execution.clone()).unwrap();
    let (mut one, mut other) = (make(), make());
    let wanted = whole(&mut one);
    let mut finals: Vec<EpisodeEnd<f32, 2>> = Vec::new();
    let (mut seen, mut reward) = (vec![f32::NAN; 2 * count], vec![f32::NAN; count]);
    let (mut terminated, mut truncated) = (vec![9; count], vec![9; count]);
    for t in 0..STEPS {
        let row = t * count..(t + 1) * count;
        let to = StepBuffers {
            seen: &mut seen,
            reward: &mut reward,
            terminated: &mut terminated,
            truncated: &mut truncated,
        };
        let ends = other.act(sequence(&wanted.action()[row.clone()]), to).unwrap();
        finals.extend(ends.into_iter().map(|end| EpisodeEnd { step: t, ..end }));
        assert_eq!(reward, wanted.reward()[row.clone()]);
        assert_eq!(terminated, wanted.terminated()[row.clone()]);
        assert_eq!(truncated, wanted.truncated()[row]);
        if t + 1 < STEPS {
            assert_eq!(seen, wanted.observation()[2 * (t + 1) * count..][..2 * count]);
        }
    }
    assert_eq!(finals, wanted.finals());
    let mut next = vec![0.0; 2 * count];
    one.observe(&mut next).unwrap();
    assert_eq!(seen, next);
}

#[test]
fn a_rollout_that_is_filled_piece_by_piece_is_the_whole_one() {
    for autoreset in AUTORESETS {
        for execution in executions() {
            let make =
                || Environments::new(perturbed(autoreset), 70, 5, execution.clone()).unwrap();
            let (mut one, mut other) = (make(), make());
            // Some stand still when it begins.
            whole(&mut one);
            whole(&mut other);
            let wanted = whole(&mut one);
            let plan = wanted.plan();
            let mut found = Rollout::new(plan).unwrap();
            for rows in [0..1, 1..64, 64..64, 64..STEPS] {
                other.fill(EXPLORING, &mut found, rows).unwrap();
            }
            assert_eq!(found.observation(), wanted.observation());
            assert_eq!(found.log_probability(), wanted.log_probability());
            assert_eq!(found.reward(), wanted.reward());
            assert_eq!(found.finals(), wanted.finals());
            for (t, n) in (0..STEPS).flat_map(|t| (0..70).map(move |n| (t, n))) {
                assert_eq!(found.is_transition(t, n), wanted.is_transition(t, n));
            }
            let beyond = other.fill(EXPLORING, &mut found, 140..STEPS + 1).unwrap_err();
            assert_eq!(
                beyond.to_string(),
                "the number of steps to be filled is 151; it must be 150"
            );
        }
    }
}

#[test]
fn a_step_whose_room_is_for_more_or_fewer_is_refused_and_nothing_has_moved() {
    let mut all = Environments::new(plain(), 3, 0, executions().remove(0)).unwrap();
    let mut refused = |seen: &mut [f32], reward: &mut [f32], flags: &mut [u8], actions: &[f32]| {
        let mut other = vec![0; flags.len()];
        let to = StepBuffers { seen, reward, terminated: flags, truncated: &mut other };
        all.act(sequence(actions), to).unwrap_err()
    };
    for (error, name, found, wanted) in [
        (refused(&mut [0.0; 5], &mut [0.0; 3], &mut [0; 3], &[0.0; 3]), "observed numbers", 5, 6),
        (refused(&mut [0.0; 6], &mut [0.0; 4], &mut [0; 3], &[0.0; 3]), "rewards", 4, 3),
        (refused(&mut [0.0; 6], &mut [0.0; 3], &mut [0; 2], &[0.0; 3]), "termination flags", 2, 3),
        (refused(&mut [0.0; 6], &mut [0.0; 3], &mut [0; 3], &[0.0; 1]), "actions", 1, 3),
    ] {
        assert_eq!(error, EnvironmentError::Shape { name, found, wanted });
    }
    assert_eq!(all.step(), 0);
}
