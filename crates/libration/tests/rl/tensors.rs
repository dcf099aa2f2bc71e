//! The memory of rollouts.

use libration::State;
use libration::ensemble::{All, Execution, PerTrajectory};
use libration::integrator::{Integrator, Rk4};
use libration::rl::policy::Constant;
use libration::rl::start::FixedStart;
use libration::rl::task::{Regulate, Sine, SwingUp, Track};
use libration::rl::{Autoreset, Environment, Environments, Plan, Rollout};
use libration::system::{BaselineOnly, CommandedSystem, Oscillator, Pendulum};

use crate::any_policy::AnyPolicy;

#[test]
fn each_environment_has_its_own_system_and_tasks_see_what_they_say() {
    let systems: Vec<BaselineOnly<Pendulum<f64>>> =
        (0..70).map(|n| BaselineOnly(Pendulum { omega2: 1.0 + f64::from(n) })).collect();
    let (task, start) =
        (SwingUp { velocity: 0.1, effort: 0.0 }, FixedStart(State { q: [0.5], v: [0.0] }));
    let environment = Environment::new(PerTrajectory(&systems), Rk4, 0.05, task, start).substeps(2);
    let mut all = Environments::new(environment, 70, 0, Execution::serial()).unwrap();
    let mut rollout = Rollout::new(Plan::new(10, 70)).unwrap();
    all.rollout(Constant([0.125]), &mut rollout).unwrap();
    let mut seen = vec![0.0; 70 * 3];
    all.observe(&mut seen).unwrap();
    for (n, &system) in systems.iter().enumerate() {
        let held = CommandedSystem { system, command: [0.125] };
        let start = State { q: [0.5], v: [0.0] };
        let after = |steps| (0..steps).fold(start, |s, _| Rk4.step(&held, s, 0.05));
        let state = after(20);
        assert_eq!(all.state(n), Some(state));
        let (cosine, sine, velocity) = (seen[3 * n], seen[3 * n + 1], seen[3 * n + 2]);
        // From the top: at rest below it is −1 and 0.
        let close = |a: f64, b: f64| (a - b).abs() < 1e-15;
        assert!(close(cosine, -state.q[0].cos()) && close(sine, -state.q[0].sin()), "{n}");
        assert_eq!(velocity, state.v[0]);
        // The last action pays for what it found.
        let (found, paid) = (after(18), rollout.reward()[9 * 70 + n]);
        let wanted = -found.q[0].cos() - 1.0 - 0.1 * found.v[0] * found.v[0];
        assert!((paid - wanted).abs() < 1e-14, "{n} {paid}");
    }
}

#[test]
fn a_reference_is_seen_and_paid_for_at_the_time_of_the_episode() {
    let reference = Sine { amplitude: 0.5, angular_frequency: 3.0, phase: 0.25 };
    let regulate = Regulate { position: 2.0, velocity: 0.5, effort: 0.0, bound: 0.75 };
    let (task, start) = (Track { reference, regulate }, FixedStart(State { q: [0.0], v: [0.0] }));
    let system = Oscillator { omega2: 1.0_f64 };
    for autoreset in [Autoreset::SameStep, Autoreset::NextStep, Autoreset::Disabled] {
        let environment = Environment::new(All(BaselineOnly(system)), Rk4, 0.05, task, start)
            .substeps(2)
            .limit(11)
            .autoreset(autoreset);
        let mut all = Environments::new(environment, 70, 0, Execution::serial()).unwrap();
        let mut rollout: Rollout<f64, 4, 1> = Rollout::new(Plan::new(40, 70).truncated()).unwrap();
        all.rollout(Constant([0.5]), &mut rollout).unwrap();
        let (mut taken, mut stands) = (0, false);
        for t in 0..40 {
            let at = |taken: i32| {
                let (time, amplitude) = (0.1 * f64::from(taken), 0.5);
                let angle = 3.0 * time + 0.25;
                [amplitude * angle.sin(), amplitude * 3.0 * angle.cos()]
            };
            let [q, v, seen @ ..] = rollout.seen(t, 69);
            // The sine is good to some last places.
            let near = |a: f64, b: f64| (a - b).abs() < 1e-14;
            assert!(seen.iter().zip(at(taken)).all(|(&a, b)| near(a, b)), "{t} {autoreset:?}");
            if stands {
                assert_eq!(rollout.reward()[t * 70 + 69], 0.0);
                if autoreset == Autoreset::NextStep {
                    (taken, stands) = (0, false);
                }
                continue;
            }
            let held = CommandedSystem { system, command: [0.5] };
            let after = (0..2).fold(State { q: [q], v: [v] }, |s, _| Rk4.step(&held, s, 0.05));
            taken += 1;
            let [q, v] = at(taken);
            let (q, v) = (after.q[0] - q, after.v[0] - v);
            assert!(near(rollout.reward()[t * 70 + 69], -(2.0 * q * q + 0.5 * v * v)), "{t}");
            assert_eq!(rollout.terminated()[t * 70 + 69] == 1, q.abs() > 0.75, "{t}");
            if rollout.terminated()[t * 70 + 69] + rollout.truncated()[t * 70 + 69] > 0 {
                stands = autoreset != Autoreset::SameStep;
                taken = if stands { taken } else { 0 };
            }
        }
        assert!(!rollout.finals().is_empty());
    }
}

#[test]
fn a_plan_counts_the_bytes_of_table_9_11() {
    // Environments, horizon, and the source's column “MB”, which are MiB.
    for (environments, horizon, mebibytes) in
        [(256, 512, 2.125), (1024, 512, 8.5), (2048, 1024, 34.0), (4096, 1024, 68.0)]
    {
        let plan = Plan::new(horizon, environments);
        assert_eq!(plan.bytes_each(2, 1, 4), 17);
        assert_eq!(plan.bytes(2, 1, 4) as f64 / f64::from(1 << 20), mebibytes);
    }
    let plan = Plan::new(3, 5).truncated().log_probabilities().values();
    let fields = [
        ("observation", 32),
        ("action", 16),
        ("reward", 8),
        ("terminated", 1),
        ("truncated", 1),
        ("log_probability", 8),
        ("value", 8),
    ];
    assert_eq!((plan.fields(4, 2, 8), plan.bytes(4, 2, 8)), (fields, 74 * 15));
}

#[test]
fn what_the_near_caches_hold_is_written_through_them_and_what_they_do_not_past_them() {
    use libration::rl::Writes;
    let bytes = Plan::new(512, 1024).bytes(2, 1, 4);
    let cache = 512 * 1024 * 17;
    assert_eq!(
        [cache, cache - 1].map(|cache| Writes::suited(bytes, cache)),
        [Writes::Plain, Writes::Past]
    );
}

#[test]
fn values_have_their_room_and_nobody_else_writes_there() {
    let mut rollout = Rollout::<f32, 2, 1>::new(Plan::new(4, 64).values()).unwrap();
    rollout.value_mut().fill(2.5);
    let mut all = Environments::new(crate::plain(), 64, 0, Execution::serial()).unwrap();
    let refused = all.rollout(AnyPolicy::constant(0.0), &mut rollout).unwrap_err().to_string();
    assert_eq!(
        refused,
        "the environments have a time limit: the rollout requires the field `truncated`"
    );
    let mut rollout = Rollout::new(Plan::new(4, 64).truncated().values()).unwrap();
    rollout.value_mut().fill(2.5);
    all.rollout(AnyPolicy::constant(0.0), &mut rollout).unwrap();
    assert!(rollout.value().iter().all(|&value| value == 2.5));
    assert!(rollout.reward().iter().any(|&reward| reward != 0.0));
}

/// What the definition says, environment by environment, in the widest sums.
fn advantages(
    rollout: &Rollout<f32, 2, 1>,
    next: &[f32],
    last: &[f32],
    [gamma, lambda]: [f64; 2],
) -> Vec<f64> {
    let Plan { horizon, environments, .. } = rollout.plan();
    let mut all = vec![0.0; horizon * environments];
    for (n, &next) in next.iter().enumerate() {
        let (mut carried, mut worth) = (0.0, f64::from(next));
        for t in (0..horizon).rev() {
            let at = t * environments + n;
            let value = f64::from(rollout.value()[at]);
            if rollout.is_transition(t, n) {
                let end =
                    rollout.finals().iter().position(|end| (end.step, end.environment) == (t, n));
                if let Some(end) = end {
                    let over = rollout.terminated()[at] == 1;
                    (carried, worth) = (0.0, if over { 0.0 } else { f64::from(last[end]) });
                }
                let error = f64::from(rollout.reward()[at]) + gamma * worth - value;
                all[at] = error + gamma * lambda * carried;
            }
            (carried, worth) = (all[at], value);
        }
    }
    all
}

#[test]
fn advantages_are_those_of_the_definition_under_every_autoreset() {
    use libration::rl::{Discounts, Estimates};
    for autoreset in [Autoreset::SameStep, Autoreset::NextStep, Autoreset::Disabled] {
        let environment = crate::ideal().autoreset(autoreset);
        let mut all = Environments::new(environment, 90, 6, Execution::serial()).unwrap();
        let plan = Plan::new(100, 90).truncated().values();
        let mut rollout = Rollout::new(plan).unwrap();
        // In the second of both some have ended before.
        all.rollout(crate::bits::POLICY, &mut rollout).unwrap();
        all.rollout(crate::bits::POLICY, &mut rollout).unwrap();
        let number = |k: usize| ((k * 37 % 101) as f32 - 50.0) / 25.0;
        rollout.value_mut().iter_mut().enumerate().for_each(|(k, value)| *value = number(k));
        let next: Vec<f32> = (0..90).map(|k| number(k + 7)).collect();
        let last: Vec<f32> = (0..rollout.finals().len()).map(|k| number(k + 13)).collect();
        let wanted = advantages(&rollout, &next, &last, [0.99, 0.95]);
        let (rewards, errors) = (0.99, 0.95);
        for execution in crate::executions() {
            let mut estimates = Estimates::new(plan).unwrap();
            let discounts = Discounts { rewards, errors };
            estimates.fill(discounts, &rollout, &next, &last, &execution).unwrap();
            for (at, wanted) in wanted.iter().enumerate() {
                let (t, n) = (at / 90, at % 90);
                let (found, value) = (f64::from(estimates.advantage()[at]), rollout.value()[at]);
                // Some hundred roundings of numbers up to some ten.
                assert!((found - wanted).abs() < 1e-4, "{t} {n} {found} {wanted} {autoreset:?}");
                let whole =
                    if rollout.is_transition(t, n) { found + f64::from(value) } else { 0.0 };
                assert!((f64::from(estimates.returns()[at]) - whole).abs() < 1e-5);
            }
        }
        let mut estimates = Estimates::new(plan).unwrap();
        let mut told = |next: &[f32], rewards| {
            let discounts = Discounts { rewards, errors };
            let serial = Execution::serial();
            estimates.fill(discounts, &rollout, next, &last, &serial).unwrap_err().to_string()
        };
        assert_eq!(
            told(&next[1..], 0.9),
            "the number of values after the last step is 89; it must be 90"
        );
        assert_eq!(told(&next, 1.5), "discount of rewards is 1.5; it must be from 0 to 1");
    }
}
