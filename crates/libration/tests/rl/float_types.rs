//! Every float type, two degrees of freedom, every layout and every kind of stores.

use bytemuck::Pod;
use half::f16;
use libration::ensemble::All;
use libration::integrator::{Integrator, VelocityVerlet};
use libration::rl::policy::{Linear, Policy};
use libration::rl::start::UniformStart;
use libration::rl::task::{Regulate, Task};
use libration::rl::{
    Environment, Environments, Episode, Layout, Plan, Rollout, Start, StepIndex, Writes,
};
use libration::system::{BaselineOnly, CommandedSystem, HenonHeiles};
use libration::{Float, State};

use crate::executions;

#[test]
fn a_short_float_holds_the_return_of_a_long_episode() {
    use libration::ensemble::Execution;
    use libration::rl::policy::Constant;
    use libration::rl::start::FixedStart;
    use libration::system::Oscillator;

    let free = All(Oscillator { omega2: f16::ZERO });
    let task = Regulate { position: 1.0, velocity: 0.0, effort: 0.0, bound: 2.0 };
    let start = FixedStart(State { q: [1.0], v: [0.0] });
    let world = Environment::new(free, VelocityVerlet, 0.01, task, start).limit(5000);
    let mut all = Environments::<f16, _, 2, 1>::new(world, 3, 0, Execution::serial()).unwrap();
    let mut rollout = Rollout::new(Plan::new(5000, 3).truncated()).unwrap();
    all.rollout(Constant([0.0]), &mut rollout).unwrap();
    // From 2048 on a sum of ones stands still in this type.
    assert!(rollout.finals().iter().all(|end| end.episode_return == -5000.0));
}

const POLICY: Linear<4, 2> =
    Linear { weights: [[-1.0, 0.25, -0.5, 0.0], [0.5, -2.0, 0.0, -0.75]], bias: [0.125, -0.25] };
const TASK: Regulate = Regulate { position: 1.0, velocity: 0.5, effort: 0.125, bound: 0.75 };
const START: UniformStart<2> =
    UniformStart(State { q: [-0.5; 2], v: [-1.0; 2] }, State { q: [0.5; 2], v: [1.0; 2] });
const LIMIT: u64 = 40;
const STEPS: usize = 90;

fn system<T: Float>() -> HenonHeiles<T> {
    HenonHeiles { lambda: T::one() }
}

/// What an environment sees, does and is paid, and whether it is over or cut off.
type Told<T> = ([T; 4], [T; 2], T, u8, u8);

/// What environment `n` does, in a loop of scalars.
fn alone<T: Float>(n: usize) -> Vec<Told<T>> {
    let start = |number| START.draw(Episode { seed: 5, environment: n as u64, number });
    let place = StepIndex { environment: n, environments: n + 1, step: 0, row: 0 };
    let (mut state, mut number, mut taken): (State<T, 2>, u64, u64) = (start(0), 0, 0);
    (0..STEPS)
        .map(|_| {
            let seen = TASK.observe(T::zero(), &state);
            let action = POLICY.act(place, &seen, &mut || 0).action;
            let held = CommandedSystem { system: system::<T>(), command: action };
            let after = VelocityVerlet.step(&held, state, T::from_f64(0.0625));
            taken += 1;
            let reward = Task::<T, 2, 4>::reward(&TASK, T::zero(), &state, &action, &after);
            let over = Task::<T, 2, 4>::terminated(&TASK, T::zero(), &after);
            let cut = taken == LIMIT;
            state = after;
            if over || cut {
                (number, taken) = (number + 1, 0);
                state = start(number);
            }
            (seen, action, reward, over.into(), cut.into())
        })
        .collect()
}

fn compare<T: Float + Pod + PartialEq + core::fmt::Debug>() {
    let lone: Vec<_> = (0..200).step_by(13).map(|n| (n, alone::<T>(n))).collect();
    let overs = |told: &[Told<T>]| told.iter().any(|now| now.3 == 1);
    assert!(lone.iter().any(|(_, told)| overs(told)), "some leave the bound");
    for execution in executions() {
        for count in [64, 200] {
            for layout in [Layout::Interleaved, Layout::Planes] {
                for writes in [Writes::Plain, Writes::Past] {
                    let environment =
                        Environment::new(All(system::<T>()), VelocityVerlet, 0.0625, TASK, START)
                            .limit(LIMIT as u32);
                    let mut all =
                        Environments::new(environment, count, 5, execution.clone()).unwrap();
                    let plan = Plan::new(STEPS, count).truncated().layout(layout).writes(writes);
                    let mut rollout: Rollout<T, 4, 2> = Rollout::new(plan).unwrap();
                    all.rollout(POLICY, &mut rollout).unwrap();
                    for (n, told) in lone.iter().filter(|(n, _)| *n < count) {
                        for (t, &wanted) in told.iter().enumerate() {
                            let at = t * count + n;
                            let flags = (rollout.terminated()[at], rollout.truncated()[at]);
                            let (seen, done) = (rollout.seen(t, *n), rollout.done(t, *n));
                            let found = (seen, done, rollout.reward()[at], flags.0, flags.1);
                            assert_eq!(found, wanted, "{n} at {t} {layout:?} {writes:?}");
                        }
                    }
                }
            }
        }
    }
}

#[test]
fn two_degrees_of_freedom_in_every_float_type_do_what_they_do_alone() {
    compare::<f16>();
    compare::<f32>();
    compare::<f64>();
}

#[test]
fn short_floats_know_how_late_it_is() {
    #[derive(Clone, Copy)]
    struct Now;
    impl Task<f16, 2, 1> for Now {
        const TIMED: bool = true;
        fn observe(&self, time: f16, _: &State<f16, 2>) -> [f16; 1] {
            [time]
        }
        fn reward(&self, _: f16, _: &State<f16, 2>, _: &[f16; 2], _: &State<f16, 2>) -> f16 {
            f16::ZERO
        }
        fn terminated(&self, _: f16, _: &State<f16, 2>) -> bool {
            false
        }
    }
    let start =
        UniformStart(State { q: [0.0; 2], v: [0.0; 2] }, State { q: [0.0; 2], v: [0.0; 2] });
    let environment =
        Environment::new(All(BaselineOnly(system::<f16>())), VelocityVerlet, 0.01, Now, start);
    let mut all = Environments::new(environment, 64, 0, Default::default()).unwrap();
    // Beyond 2048, an f16 does not hold every number of steps.
    let mut rollout: Rollout<f16, 1, 2> = Rollout::new(Plan::new(3000, 64)).unwrap();
    all.rollout(libration::rl::policy::Constant([0.0; 2]), &mut rollout).unwrap();
    for t in 0..3000 {
        assert_eq!(rollout.seen(t, 0), [f16::from_f64(0.01 * t as f64)], "{t}");
    }
}
