//! The bits of an environment do not depend on the execution.

use std::collections::HashMap;
use std::ops::Range;

use libration::ensemble::Execution;
use libration::rl::policy::{GaussianExploration, Linear, Random};
use libration::rl::{Autoreset, Environments, Layout, Plan, Policy, Rollout, Task, World, Writes};

use crate::any_policy::AnyPolicy;
use crate::scalar_reference::{Told, alone};
use crate::{chosen, executions, ideal, perturbed, plain};

pub(crate) const POLICY: Linear<2, 1> = Linear { weights: [[-3.0, 0.5]], bias: [0.25] };
pub(crate) const EXPLORING: AnyPolicy<'_> =
    AnyPolicy::Exploration(GaussianExploration { policy: POLICY, sigma: [0.5] });

/// What these environments tell of so many steps, in as many rollouts as there are horizons.
pub(crate) fn told<E: World<f32, 2, 1>, P: Policy<f32, 2, 1>>(
    world: E,
    policy: P,
    which: Range<usize>,
    execution: Execution,
    horizons: &[usize],
    (layout, writes): (Layout, Writes),
) -> Vec<Vec<Told>> {
    let count = which.len();
    let mut all = Environments::shard(world, which.start, count, 9, execution).unwrap();
    let mut told: Vec<Vec<Told>> = vec![Vec::new(); count];
    for &horizon in horizons {
        let plan = Plan::new(horizon, count).truncated().log_probabilities();
        let mut rollout = Rollout::new(plan.layout(layout).writes(writes)).unwrap();
        all.rollout(policy, &mut rollout).unwrap();
        let ends: HashMap<_, _> =
            rollout.finals().iter().map(|end| ((end.step, end.environment), end)).collect();
        for (n, told) in told.iter_mut().enumerate() {
            told.extend((0..horizon).map(|t| {
                let at = t * count + n;
                let end = ends.get(&(t, n));
                Told {
                    seen: rollout.seen(t, n),
                    action: rollout.done(t, n),
                    log_probability: rollout.log_probability()[at],
                    reward: rollout.reward()[at],
                    over: rollout.terminated()[at],
                    cut: rollout.truncated()[at],
                    moved: rollout.is_transition(t, n),
                    last: end.map(|end| end.observation),
                }
            }));
        }
    }
    told
}

/// Compares some of `count` environments with what each does alone, and counts the episodes that end before their limit.
fn compare<E: World<f32, 2, 1>, P: Policy<f32, 2, 1>>(world: E, policy: P) -> usize {
    const STEPS: usize = 300;
    let mut ends = 0;
    let wanted = |n, count| alone(&world, policy, (n, count), 9, STEPS as u64);
    let lone: HashMap<_, _> = (0..600).step_by(41).map(|n| (n, wanted(n, 600))).collect();
    for execution in executions() {
        for (count, layout, writes) in [
            (1, Layout::Planes, Writes::Past),
            (77, Layout::Interleaved, Writes::Past),
            (512, Layout::Interleaved, Writes::Past),
            (600, Layout::Planes, Writes::Plain),
        ] {
            let horizons = [1, 130, STEPS - 131];
            let found =
                told(world, policy, 0..count, execution.clone(), &horizons, (layout, writes));
            for n in (0..count).step_by(41) {
                for (t, (found, wanted)) in found[n].iter().zip(&lone[&n]).enumerate() {
                    assert_eq!(found, wanted, "{n} of {count} at {t}, {layout:?} {execution:?}");
                }
                ends += lone[&n].iter().filter(|now| now.moved && now.over == 1).count();
            }
        }
    }
    ends
}

#[test]
fn an_ideal_environment_does_what_it_does_alone_whatever_runs_beside_it_and_however() {
    assert!(compare(ideal(), POLICY) > 100, "some episodes end before their limit");
    // On one instruction set: the others differ only in the words that are drawn, which the test below compares.
    assert!(compare(plain(), Random::between([-9.0], [9.0])) > 100, "so they do by accident");
}

#[test]
fn so_does_one_with_delays_jitter_skew_noise_variation_and_exploration_under_every_autoreset() {
    for autoreset in [Autoreset::SameStep, Autoreset::NextStep, Autoreset::Disabled] {
        let ends = compare(perturbed(autoreset), EXPLORING);
        assert!(ends > 50, "some episodes end before their limit: {ends} {autoreset:?}");
    }
}

#[test]
fn an_environment_whose_integrator_is_chosen_when_it_runs_does_what_it_does_alone() {
    use libration::Method::{ExplicitEuler, Rk4, VelocityVerlet, Yoshida4};
    for method in [ExplicitEuler, VelocityVerlet, Rk4, Yoshida4] {
        assert!(compare(chosen(method), EXPLORING) > 50, "some episodes end before their limit");
    }
}

#[test]
fn shards_of_any_size_do_what_all_do_together() {
    let (world, policy) = (perturbed(Autoreset::SameStep), EXPLORING);
    let how = (Layout::Interleaved, Writes::Plain);
    let whole = told(world, policy, 0..400, Execution::serial(), &[270], how);
    for which in [0..1, 1..64, 64..100, 100..399, 399..400] {
        let shard = told(world, policy, which.clone(), Execution::serial(), &[70, 200], how);
        assert_eq!(shard, whole[which]);
    }
}

#[test]
fn a_step_is_the_same_by_the_short_way_as_by_the_long() {
    let how = (Layout::Interleaved, Writes::Plain);
    let short = told(ideal(), POLICY, 0..100, Execution::serial(), &[200], how);
    // One of many policies is not brief, but says the same.
    let long = AnyPolicy::Linear(POLICY);
    const { assert!(!<AnyPolicy<'_> as Policy<f32, 2, 1>>::CLOSED_FORM) };
    let long = told(plain(), long, 0..100, Execution::serial(), &[200], how);
    assert_eq!(short, long);
}

#[test]
fn a_look_from_outside_sees_what_the_next_step_does() {
    let world = perturbed(Autoreset::SameStep);
    for execution in executions() {
        let mut all = Environments::new(world, 200, 3, execution).unwrap();
        for horizon in [1, 254, 1, 1, 20] {
            let mut seen = vec![0.0; 400];
            all.observe(&mut seen).unwrap();
            let mut rollout = Rollout::new(Plan::new(horizon, 200).truncated()).unwrap();
            all.rollout(AnyPolicy::Linear(POLICY), &mut rollout).unwrap();
            assert_eq!(rollout.observation()[..400], seen);
        }
    }
    let mut all = Environments::new(world, 100, 3, Execution::serial()).unwrap();
    // The noise is there.
    let state = all.state(5).unwrap();
    let mut seen = vec![0.0; 200];
    all.observe(&mut seen).unwrap();
    assert_ne!(seen[10..12], Task::<f32, 1, 2>::observe(&crate::TASK, 0.0, &state));
}
