//! Every float type, two degrees of freedom, every layout and every kind of stores.

use bytemuck::Pod;
use half::f16;
use libration::ensemble::{All, Execution, InstructionSet};
use libration::integrator::{Integrator, SymplecticEuler, VelocityVerlet};
use libration::rl::policy::{Constant, Linear, Policy};
use libration::rl::start::{FixedStart, UniformStart};
use libration::rl::task::{Regulate, Task};
use libration::rl::{
    Environment, Environments, Episode, Layout, Plan, Rollout, Start, StepIndex, World, Writes,
};
use libration::system::{BaselineOnly, CommandedSystem, HenonHeiles, Oscillator};
use libration::{Float, State, System};

use crate::{executions, executions_on};

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

/// The environments of a system in two degrees of freedom.
fn environments<T, Sys>(
    system: Sys,
    task: Regulate,
    start: UniformStart<2>,
    limit: u32,
    count: usize,
    execution: Execution,
) -> Environments<T, impl World<T, 4, 2>, 4, 2>
where
    T: Float + Pod,
    Sys: System<T, 2> + Copy + Send + Sync,
{
    let environment = Environment::new(All(system), VelocityVerlet, 0.0625, task, start);
    Environments::new(environment.limit(limit), count, 5, execution).unwrap()
}

fn compare<T, Sys>(system: Sys, executions: impl IntoIterator<Item = Execution>)
where
    T: Float + Pod + PartialEq + core::fmt::Debug,
    Sys: System<T, 2> + Copy + Send + Sync,
{
    let lone: Vec<_> = (0..200).step_by(13).map(|n| (n, alone::<T>(n))).collect();
    let overs = |told: &[Told<T>]| told.iter().any(|now| now.3 == 1);
    assert!(lone.iter().any(|(_, told)| overs(told)), "some leave the bound");
    for execution in executions {
        for count in [64, 200] {
            for layout in [Layout::Interleaved, Layout::Planes] {
                for writes in [Writes::Plain, Writes::Past] {
                    let limit = LIMIT as u32;
                    let mut all =
                        environments::<T, _>(system, TASK, START, limit, count, execution.clone());
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
    compare(system::<f16>(), executions());
    compare(system::<f64>(), executions());
    // `bits.rs` compares instruction sets in this type.
    compare(BaselineOnly(system::<f32>()), executions_on(InstructionSet::Baseline));
}

#[test]
fn short_floats_stay_as_near_to_long_ones_as_their_digits() {
    // The test above has shown that environments do what they do alone.
    for n in 0..20 {
        let wide = alone::<f64>(n);
        let error = |short: Vec<[f64; 4]>| {
            let episode = wide.iter().take_while(|now| now.3 + now.4 == 0).take(32);
            let errors = episode.zip(&short).flat_map(|(wide, short)| {
                wide.0.iter().zip(short).map(|(a, b)| (a - b).abs()).collect::<Vec<_>>()
            });
            errors.fold(0.0, f64::max)
        };
        let half = alone::<f16>(n).iter().map(|now| now.0.map(f64::from)).collect();
        let single = alone::<f32>(n).iter().map(|now| now.0.map(f64::from)).collect();
        // Numbers of size 1 over 32 steps keep some digits of 24 bits, and of 11.
        for (error, bound) in [(error(single), 1e-5), (error(half), 0.05)] {
            assert!(error > 0.0 && error < bound, "{n}: {error}");
        }
    }
}

#[test]
fn a_short_float_holds_the_return_of_a_long_episode() {
    // A spring, and an action of 1 that costs 1.
    let system = HenonHeiles { lambda: f16::ZERO };
    let task = Regulate { position: 0.0, velocity: 0.0, effort: 1.0, bound: f64::INFINITY };
    let rest = State { q: [0.0; 2], v: [0.0; 2] };
    let start = UniformStart(rest, rest);
    let mut all = environments::<f16, _>(system, task, start, 5000, 3, Execution::serial());
    let mut rollout = Rollout::new(Plan::new(5000, 3).truncated()).unwrap();
    all.rollout(Linear { weights: [[0.0; 4]; 2], bias: [1.0, 0.0] }, &mut rollout).unwrap();
    assert_eq!(rollout.finals().len(), 3);
    // From 2048 on a sum of ones stands still in this type.
    assert!(rollout.finals().iter().all(|end| end.episode_return == -5000.0));
}

/// Shows the time and the position; pays as much as it can, and is never over.
#[derive(Clone, Copy)]
struct Timed;

impl Task<f16, 1, 2> for Timed {
    const TIMED: bool = true;

    fn observe(&self, time: f16, state: &State<f16, 1>) -> [f16; 2] {
        [time, state.q[0]]
    }

    fn reward(&self, _: f16, _: &State<f16, 1>, _: &[f16; 1], _: &State<f16, 1>) -> f16 {
        f16::MAX
    }

    fn terminated(&self, _: f16, _: &State<f16, 1>) -> bool {
        false
    }
}

/// What 64 free environments of that task do in so many steps from this position and velocity.
fn timed(start: f64, dt: f64, horizon: usize) -> Rollout<f16, 2, 1> {
    let start = FixedStart(State { q: [start], v: [start] });
    let free = All(BaselineOnly(Oscillator { omega2: f16::ZERO }));
    let environment = Environment::new(free, SymplecticEuler, dt, Timed, start);
    let mut all = Environments::new(environment, 64, 0, Execution::serial()).unwrap();
    let mut rollout = Rollout::new(Plan::new(horizon, 64)).unwrap();
    all.rollout(Constant([0.0]), &mut rollout).unwrap();
    rollout
}

#[test]
fn short_floats_know_how_late_it_is() {
    // Beyond 2048, an f16 does not hold every number of steps.
    let rollout = timed(0.0, 0.01, 3000);
    for t in 0..3000 {
        assert_eq!(rollout.seen(t, 0)[0], f16::from_f64(0.01 * t as f64), "{t}");
    }
}

#[test]
fn what_is_finite_is_not_lost_however_large() {
    // Of no two of these numbers there is a sum in this type.
    assert!(timed(40_000.0, 1e-7, 3).finals().is_empty());
}
