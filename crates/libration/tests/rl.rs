//! Environments and their rollouts.

#![allow(clippy::unwrap_used)]

use libration::ensemble::{All, Each, Execution, InstructionSet};
use libration::integrator::{Rk4, SymplecticEuler};
use libration::rl::policy::{Constant, Linear};
use libration::rl::start::{At, Between};
use libration::rl::task::{Regulate, SwingUp};
use libration::rl::{
    Environment, Environments, Layout, Plan, Policy, Rollout, Start, Task, Writes,
};
use libration::system::{Held, Oscillator, Pendulum};
use libration::{Integrator, State};

const SPRING: Oscillator<f32> = Oscillator { omega2: 10.0 };
const TASK: Regulate = Regulate { position: 1.0, velocity: 0.1, effort: 0.01, bound: 1.2 };
const ANYWHERE: Between<1> = Between(State { q: [-1.0], v: [-2.0] }, State { q: [1.0], v: [2.0] });
const POLICY: Linear<2, 1> = Linear { weights: [[-3.0, 0.5]], bias: [0.25] };

/// Energy is pumped in, so that some episodes end at the bound before the limit of 60 steps.
fn shaken() -> Environment<All<Oscillator<f32>>, SymplecticEuler, Regulate, Between<1>> {
    Environment {
        systems: All(SPRING),
        method: SymplecticEuler,
        dt: 0.02,
        substeps: 3,
        task: TASK,
        start: ANYWHERE,
        limit: Some(60),
    }
}

/// What one environment does, step by step, in scalars: seen, done, paid, over, cut off.
type Told = ([f32; 2], [f32; 1], f32, u8, u8);

fn alone(n: u64, seed: u64, steps: usize) -> Vec<Told> {
    let environment = shaken();
    let Environment { method, dt, substeps, task, start, limit, .. } = environment;
    let (mut episode, mut age) = (0, 0);
    let mut state: State<f32, 1> = start.draw(seed, n, episode);
    let mut told = Vec::new();
    for step in 0..steps {
        let seen = Task::<f32, 1, 2>::observe(&task, &state);
        let place = libration::rl::Place { environment: n as usize, step: step as u64 };
        let action: [f32; 1] = POLICY.act(place, &seen);
        let system = Held { system: SPRING, command: action };
        let next = (0..substeps).fold(state, |s, _| method.step(&system, s, dt as f32));
        let reward = Task::<f32, 1, 2>::reward(&task, &state, &action, &next);
        let over = Task::<f32, 1, 2>::terminated(&task, &next);
        age += 1;
        let cut = age >= limit.unwrap();
        told.push((seen, action, reward, u8::from(over), u8::from(cut)));
        state = next;
        if over || cut {
            (episode, age) = (episode + 1, 0);
            state = start.draw(seed, n, episode);
        }
    }
    told
}

fn executions() -> Vec<Execution> {
    let sets = InstructionSet::available().flat_map(|set| [1, 2, 3].map(|threads| (set, threads)));
    sets.map(|(set, threads)| {
        let execution = Execution::serial().threads(threads).unwrap().worth(1);
        execution.instructions(set).unwrap()
    })
    .collect()
}

#[test]
fn an_environment_does_what_it_does_alone_whatever_runs_beside_it_and_however() {
    const STEPS: usize = 150;
    let mut ends = 0;
    for execution in executions() {
        for count in [1, 77, 512, 1300] {
            for (layout, writes) in
                [(Layout::Interleaved, Writes::Past), (Layout::Planes, Writes::Plain)]
            {
                let mut all = Environments::new(shaken(), count, 9, execution.clone()).unwrap();
                // In two calls.
                let mut told: Vec<Vec<Told>> = vec![Vec::new(); count];
                for horizon in [100, STEPS - 100] {
                    let mut rollout = Rollout::new(horizon, count, true, layout, writes).unwrap();
                    all.rollout(POLICY, &mut rollout).unwrap();
                    for (n, told) in told.iter_mut().enumerate() {
                        told.extend((0..horizon).map(|t| {
                            let at = t * count + n;
                            let (over, cut) = (rollout.terminated()[at], rollout.truncated()[at]);
                            (
                                rollout.seen(t, n),
                                rollout.done(t, n),
                                rollout.reward()[at],
                                over,
                                cut,
                            )
                        }));
                    }
                }
                for n in (0..count).step_by(41) {
                    let wanted = alone(n as u64, 9, STEPS);
                    ends += wanted.iter().filter(|(.., over, _)| *over == 1).count();
                    assert_eq!(told[n], wanted, "{n} of {count} {layout:?} {execution:?}");
                }
            }
        }
    }
    assert!(ends > 100, "some episodes end before their limit: {ends}");
}

#[test]
fn an_episode_that_ends_is_kept_with_what_was_seen_last_and_what_it_paid() {
    let mut all = Environments::new(shaken(), 200, 4, Execution::serial()).unwrap();
    let mut rollout = Rollout::new(130, 200, true, Layout::Planes, Writes::Plain).unwrap();
    all.rollout(POLICY, &mut rollout).unwrap();
    let flags = (0..130 * 200).filter(|&at| rollout.terminated()[at] + rollout.truncated()[at] > 0);
    assert_eq!(
        rollout.finals().iter().map(|end| end.step * 200 + end.environment).collect::<Vec<_>>(),
        flags.collect::<Vec<_>>()
    );
    for end in rollout.finals() {
        let steps = end.step + 1 - end.length as usize..=end.step;
        let paid = steps.clone().map(|t| rollout.reward()[t * 200 + end.environment]);
        assert_eq!(end.episode_return, paid.fold(0.0, |sum, reward| sum + reward));
        // The next episode begins elsewhere.
        if end.step + 1 < 130 {
            assert_ne!(rollout.seen(end.step + 1, end.environment), end.observation);
        }
        let over = rollout.terminated()[end.step * 200 + end.environment] == 1;
        assert_eq!(over, end.observation[0].abs() > 1.2);
        assert!(end.length <= 60 && (over || end.length == 60));
    }
}

#[test]
fn what_is_no_longer_finite_is_over_and_begins_again() {
    // Beyond z = 2 symplectic Euler grows without end.
    let environment = Environment {
        systems: All(SPRING),
        method: SymplecticEuler,
        dt: 1e6,
        substeps: 1,
        task: Regulate { bound: f64::INFINITY, ..TASK },
        start: At(State { q: [1.0], v: [0.0] }),
        limit: None,
    };
    let mut all = Environments::new(environment, 3, 0, Execution::serial()).unwrap();
    let mut rollout = Rollout::new(20, 3, false, Layout::Interleaved, Writes::Plain).unwrap();
    all.rollout(Constant([0.0]), &mut rollout).unwrap();
    assert!(rollout.finals().len() >= 3);
    assert!(rollout.observation().iter().all(|x| x.is_finite()));
    assert!(rollout.truncated().is_empty());
}

#[test]
fn each_environment_has_its_own_system_and_tasks_see_what_they_say() {
    let systems: Vec<Pendulum<f64>> =
        (0..70).map(|n| Pendulum { omega2: 1.0 + f64::from(n) }).collect();
    let environment = Environment {
        systems: Each(&systems),
        method: Rk4,
        dt: 0.05,
        substeps: 2,
        task: SwingUp { velocity: 0.1, effort: 0.0 },
        start: At(State { q: [0.5], v: [0.0] }),
        limit: None,
    };
    let mut all = Environments::new(environment, 70, 0, Execution::serial()).unwrap();
    let mut rollout = Rollout::new(10, 70, false, Layout::Interleaved, Writes::Plain).unwrap();
    all.rollout(Constant([0.125]), &mut rollout).unwrap();
    for (n, &system) in systems.iter().enumerate() {
        let held = Held { system, command: [0.125] };
        let state = (0..20).fold(State { q: [0.5], v: [0.0] }, |s, _| Rk4.step(&held, s, 0.05));
        assert_eq!(all.state(n), Some(state));
        let [cosine, sine, velocity] = all.observation(n).unwrap();
        // From the top: at rest below it is −1 and 0.
        let close = |a: f64, b: f64| (a - b).abs() < 1e-15;
        assert!(close(cosine, -state.q[0].cos()) && close(sine, -state.q[0].sin()), "{n}");
        assert_eq!(velocity, state.v[0]);
        let paid = rollout.reward()[9 * 70 + n];
        assert!((paid - (cosine - 1.0 - 0.1 * velocity * velocity)).abs() < 1e-14, "{n} {paid}");
    }
}

#[test]
fn a_plan_counts_the_bytes_of_table_9_11() {
    // Environments, horizon, and the source's column “MB”, which are MiB.
    for (environments, horizon, mebibytes) in
        [(256, 512, 2.125), (1024, 512, 8.5), (2048, 1024, 34.0), (4096, 1024, 68.0)]
    {
        let plan: Plan = Rollout::<f32, 2, 1>::plan(horizon, environments, false);
        assert_eq!(plan.bytes_each(), 17);
        assert_eq!(plan.bytes() as f64 / f64::from(1 << 20), mebibytes);
    }
    let plan = Rollout::<f64, 4, 2>::plan(3, 5, true);
    let fields =
        [("observation", 32), ("action", 16), ("reward", 8), ("terminated", 1), ("truncated", 1)];
    assert_eq!((plan.fields(), plan.bytes()), (fields, 58 * 15));
    assert_eq!(
        [58 * 15, 58 * 15 - 1].map(|cache| plan.writes(cache)),
        [Writes::Plain, Writes::Past]
    );
}

#[test]
fn what_cannot_be_is_refused_in_words() {
    let serial = Execution::serial;
    let made = |environment, count| {
        Environments::<f32, _, _, _, _, _, 2, 1>::new(environment, count, 0, serial())
    };
    let told = |environment| made(environment, 2).map(|_| ()).unwrap_err().to_string();
    assert_eq!(
        told(Environment { dt: -1.0, ..shaken() }),
        "the time step is -1 s; it must be above 0"
    );
    assert_eq!(
        told(Environment { substeps: 0, ..shaken() }),
        "there are 0 substeps; there must be at least 1"
    );
    let backwards = Between(ANYWHERE.1, ANYWHERE.0);
    assert_eq!(
        told(Environment { start: backwards, ..shaken() }),
        "width of the start 0 is -2; it must be a finite number of at least 0"
    );
    let mut two = made(shaken(), 2).unwrap();
    let rollout =
        |count, truncated| Rollout::new(4, count, truncated, Layout::Planes, Writes::Plain);
    let other = two.rollout(POLICY, &mut rollout(3, true).unwrap()).unwrap_err().to_string();
    assert!(other.contains("3 environments of the rollout for 2"), "{other}");
    let unsaid = two.rollout(POLICY, &mut rollout(2, false).unwrap()).unwrap_err().to_string();
    assert!(unsaid.contains("`truncated`"), "{unsaid}");
    let large =
        Rollout::<f32, 2, 1>::new(usize::MAX / 4, 1 << 20, true, Layout::Planes, Writes::Past);
    assert!(large.map(|_| ()).unwrap_err().to_string().contains("memory"));
    // None of them is no trouble.
    let mut none = made(shaken(), 0).unwrap();
    none.rollout(POLICY, &mut rollout(0, true).unwrap()).unwrap();
    let mut short = Rollout::new(0, 2, true, Layout::Interleaved, Writes::Past).unwrap();
    two.rollout(POLICY, &mut short).unwrap();
    assert_eq!(two.step(), 0);
}
