//! Beginnings and ends of episodes.

use libration::State;
use libration::ensemble::{All, Execution};
use libration::integrator::SymplecticEuler;
use libration::rl::start::UniformStart;
use libration::rl::task::Regulate;
use libration::rl::{Autoreset, Delays, Environment, Environments, Layout, Plan, Rollout};
use libration::system::BaselineOnly;

use crate::any_policy::{AnyPolicy, sequence};
use crate::bits::POLICY;
use crate::{SPRING, TASK, ideal, perturbed, plain};

#[test]
fn an_episode_that_ends_is_kept_with_what_was_seen_last_and_what_it_paid() {
    let mut all = Environments::new(ideal(), 200, 4, Execution::serial()).unwrap();
    let mut rollout = Rollout::new(Plan::new(130, 200).truncated().layout(Layout::Planes)).unwrap();
    all.rollout(POLICY, &mut rollout).unwrap();
    let flags = (0..130 * 200).filter(|&at| rollout.terminated()[at] + rollout.truncated()[at] > 0);
    assert_eq!(
        rollout.finals().iter().map(|end| end.step * 200 + end.environment).collect::<Vec<_>>(),
        flags.collect::<Vec<_>>()
    );
    for end in rollout.finals() {
        let steps: Vec<usize> = (end.step + 1 - end.length as usize..=end.step).collect();
        let paid = |t: &usize| rollout.reward()[t * 200 + end.environment];
        let sums = steps.chunk_by(|a, b| a / 32 == b / 32);
        let sums = sums.map(|steps| f64::from(steps.iter().map(paid).fold(0.0, |a, b| a + b)));
        assert_eq!(end.episode_return, sums.fold(0.0, |a, b| a + b));
        // The next episode begins elsewhere.
        if end.step + 1 < 130 {
            assert_ne!(rollout.seen(end.step + 1, end.environment), end.observation);
        }
        let over = rollout.terminated()[end.step * 200 + end.environment] == 1;
        assert_eq!(over, end.observation[0].abs() > 1.2);
        assert!(end.length <= 60 && (over || end.length == 60) && !end.lost);
    }
}

#[test]
fn what_is_no_longer_finite_is_over_pays_nothing_and_begins_again() {
    // Beyond z = 2 symplectic Euler grows without end.
    let task = Regulate { bound: f64::INFINITY, ..TASK };
    let at = State { q: [1.0], v: [0.0] };
    let start = UniformStart(at, at);
    let environment =
        Environment::new(All(BaselineOnly(SPRING)), SymplecticEuler, 1e6, task, start);
    let mut all = Environments::new(environment, 3, 0, Execution::serial()).unwrap();
    let mut rollout = Rollout::new(Plan::new(20, 3)).unwrap();
    all.rollout(AnyPolicy::constant(0.0), &mut rollout).unwrap();
    assert!(rollout.finals().len() >= 3 && rollout.finals().iter().all(|end| end.lost));
    assert!(rollout.observation().iter().all(|x| x.is_finite()));
    for end in rollout.finals() {
        assert_eq!(rollout.reward()[end.step * 3 + end.environment], 0.0);
    }
    assert!(rollout.truncated().is_empty());
}

#[test]
fn an_action_or_a_reward_that_is_no_number_ends_the_episode_of_its_environment_and_touches_no_other()
 {
    let run = |bad: Option<f32>, delays| {
        let environment = plain().delays(delays);
        let mut all = Environments::new(environment, 70, 1, Execution::serial()).unwrap();
        let mut actions = vec![0.5_f32; 70 * 6];
        bad.into_iter().for_each(|action| actions[2 * 70 + 33] = action);
        let mut rollout = Rollout::new(Plan::new(6, 70).truncated()).unwrap();
        all.rollout(sequence(&actions), &mut rollout).unwrap();
        rollout
    };
    // Also where its effect would come later.
    let delays = [Delays::default(), Delays::of(0, 2)];
    // The square of the second is infinite, and so would its price be.
    for (delays, action) in delays.into_iter().flat_map(|d| [(d, f32::NAN), (d, 1e20)]) {
        let (good, bad) = (run(None, delays), run(Some(action), delays));
        for t in 0..6 {
            for n in (0..70).filter(|&n| n != 33) {
                assert_eq!(good.seen(t, n), bad.seen(t, n));
                assert_eq!(good.reward()[t * 70 + n], bad.reward()[t * 70 + n]);
            }
        }
        let end = bad.finals().iter().find(|end| end.environment == 33 && end.lost).unwrap();
        assert_eq!(end.step, 2);
        assert_eq!(bad.terminated()[2 * 70 + 33], 1);
        assert!(bad.reward().iter().chain(bad.observation()).all(|x| x.is_finite()));
    }
}

#[test]
fn what_is_lost_is_seen_so_in_no_transition_and_begins_again() {
    for autoreset in [Autoreset::NextStep, Autoreset::Disabled] {
        let mut all =
            Environments::new(plain().autoreset(autoreset), 70, 1, Execution::serial()).unwrap();
        let mut actions = vec![0.5_f32; 70 * 6];
        actions[2 * 70 + 33] = f32::INFINITY;
        let mut rollout = Rollout::new(Plan::new(6, 70).truncated()).unwrap();
        all.rollout(sequence(&actions), &mut rollout).unwrap();
        assert!(rollout.finals().iter().any(|end| end.lost && end.environment == 33));
        assert!(rollout.reward().iter().all(|reward| reward.is_finite()));
        for (t, n) in (0..6).flat_map(|t| (0..70).map(move |n| (t, n))) {
            let seen = rollout.seen(t, n).iter().all(|x| x.is_finite());
            assert!(seen || (n == 33 && !rollout.is_transition(t, n)), "{t} {n} {autoreset:?}");
        }
        // Lost in the third step, it stands in the fourth, and then begins again or waits.
        let moves = [3, 4].map(|t| rollout.is_transition(t, 33));
        assert_eq!(moves, [false, autoreset == Autoreset::NextStep]);
        if autoreset == Autoreset::Disabled {
            all.reset(&[true; 70]).unwrap();
            all.rollout(sequence(&[0.5; 70 * 6]), &mut rollout).unwrap();
            assert!(rollout.observation().iter().all(|x| x.is_finite()));
        }
    }
}

#[test]
fn what_stands_still_waits_for_its_reset_and_nothing_else_does() {
    let world = perturbed(Autoreset::Disabled);
    let mut all = Environments::new(world, 100, 3, Execution::serial()).unwrap();
    let mut rollout = Rollout::new(Plan::new(80, 100).truncated()).unwrap();
    all.rollout(AnyPolicy::Linear(POLICY), &mut rollout).unwrap();
    // After 60 actions at the latest each has ended, once.
    assert_eq!(rollout.finals().len(), 100);
    assert!((0..100).all(|n| !rollout.is_transition(79, n)));
    let states: Vec<_> = (0..100).map(|n| all.state(n)).collect();
    let which: Vec<bool> = (0..100).map(|n| n % 3 == 0).collect();
    all.reset(&which).unwrap();
    all.rollout(AnyPolicy::Linear(POLICY), &mut rollout).unwrap();
    for (n, &again) in which.iter().enumerate() {
        assert_eq!(rollout.is_transition(0, n), again, "{n}");
        assert_eq!(all.state(n) == states[n], !again, "{n}");
    }
    assert!(rollout.finals().iter().all(|end| which[end.environment]));
    let short = all.reset(&[true]).unwrap_err().to_string();
    assert_eq!(short, "the number of reset flags is 1; it must be 100");
}
