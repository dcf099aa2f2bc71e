//! Random numbers of an environment depend on its episode.

use libration::control::clock::Rates;
use libration::ensemble::Execution;
use libration::random::EPOCH;
use libration::rl::policy::{GaussianExploration, Linear};
use libration::rl::{
    Autoreset, EnvironmentError, Environments, Layout, Plan, Rollout, World, Writes,
};

use crate::any_policy::AnyPolicy;
use crate::bits::{EXPLORING, told};
use crate::scalar_reference::Told;
use crate::{executions, perturbed, plain};

/// The transitions of every environment, one after the other.
fn transitions(autoreset: Autoreset, limit: u32) -> Vec<Vec<Told>> {
    let world = perturbed(autoreset).limit(limit);
    let way = (Layout::Interleaved, Writes::Plain);
    // Energy is taken out: many episodes reach the limit.
    let policy = AnyPolicy::Exploration(GaussianExploration {
        policy: Linear { weights: [[-3.0, -0.5]], bias: [0.25] },
        sigma: [0.5],
    });
    let mut all = told(world, policy, 0..70, Execution::serial(), &[700], way);
    all.iter_mut().for_each(|told| told.retain(|now| now.moved));
    all
}

#[test]
fn an_environment_does_the_same_whatever_follows_its_episodes() {
    // Episodes that end before their clocks, their sensors and their policy draw by address again, and others.
    for limit in [60, EPOCH as u32 + 40] {
        let next = transitions(Autoreset::NextStep, limit);
        for (n, (same, next)) in
            transitions(Autoreset::SameStep, limit).iter().zip(&next).enumerate()
        {
            assert!(next.len() < same.len() && next.iter().any(|now| now.over + now.cut > 0));
            for (t, (same, next)) in same.iter().zip(next).enumerate() {
                assert_eq!(same, next, "{t} of {n}");
            }
        }
        let longest = |told: &Vec<Told>| {
            told.split(|now| now.over + now.cut > 0).map(<[Told]>::len).max().unwrap()
        };
        let longest = next.iter().map(longest).max().unwrap();
        assert_eq!(longest > EPOCH as usize, limit > EPOCH as u32, "{longest}");
    }
}

/// What is seen and paid in so many steps.
fn run<E: World<f32, 2, 1>>(all: &mut Environments<f32, E, 2, 1>, steps: usize) -> Vec<Vec<f32>> {
    let count = all.len();
    let mut rollout =
        Rollout::new(Plan::new(steps, count).truncated().log_probabilities()).unwrap();
    all.rollout(EXPLORING, &mut rollout).unwrap();
    let of = |n| {
        let at = (0..steps).flat_map(move |t| [(t, n)]);
        at.flat_map(|(t, n)| {
            let [q, v] = rollout.seen(t, n);
            [q, v, rollout.reward()[t * count + n]]
        })
    };
    (0..count).map(|n| of(n).collect()).collect()
}

#[test]
fn a_seed_of_its_own_makes_an_environment_the_first_of_a_batch() {
    for autoreset in [Autoreset::SameStep, Autoreset::NextStep] {
        let alone = |seed| {
            let world = perturbed(autoreset);
            run(&mut Environments::new(world, 1, seed, Execution::serial()).unwrap(), 150).remove(0)
        };
        for execution in executions() {
            let mut all =
                Environments::new(perturbed(autoreset), 70, 9, execution.clone()).unwrap();
            let mut rest = Environments::new(perturbed(autoreset), 70, 9, execution).unwrap();
            // In the middle of episodes, and between the words of what was drawn before.
            run(&mut all, 37);
            run(&mut rest, 37);
            let seeds: Vec<Option<u64>> = (0..70).map(|n| (n % 3 == 0).then_some(n * n)).collect();
            all.seed(&seeds).unwrap();
            let (found, rest) = (run(&mut all, 150), run(&mut rest, 150));
            for (n, seed) in seeds.into_iter().enumerate() {
                assert!(found[n] == seed.map_or_else(|| rest[n].clone(), alone), "{n}");
            }
        }
    }
}

#[test]
fn seeds_are_refused_where_there_are_not_as_many_or_clocks_are_listed_by_number() {
    let mut all = Environments::new(plain(), 3, 0, Execution::serial()).unwrap();
    let short = all.seed(&[None, Some(4)]).unwrap_err();
    assert_eq!(short.to_string(), "the number of seeds is 2; it must be 3");
    let rates = [1.0, 1.1, 0.9];
    let mut listed =
        Environments::new(plain().clock(Rates(&rates)), 3, 0, Execution::serial()).unwrap();
    assert_eq!(listed.seed(&[None; 3]), Err(EnvironmentError::Seeded));
}
