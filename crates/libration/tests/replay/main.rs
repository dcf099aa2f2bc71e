//! Replay buffers.

#![allow(clippy::unwrap_used)]

mod faults;
mod memory;
mod model;
mod naive_buffer;
mod programs;
mod sampling_frequencies;
mod sum_tree;

use libration::State;
use libration::ensemble::{All, Execution};
use libration::integrator::SymplecticEuler;
use libration::replay::{Capacity, ReplayBuffer};
use libration::rl::policy::Random;
use libration::rl::start::UniformStart;
use libration::rl::task::Regulate;
use libration::rl::{Autoreset, Environment, Environments, Layout, Plan, Rollout, RolloutTensors};
use libration::system::{BaselineOnly, Oscillator};

const SPRING: Oscillator<f32> = Oscillator { omega2: 10.0 };
/// Actions of a few units throw it out before the time limit, now and then.
const TASK: Regulate = Regulate { position: 1.0, velocity: 0.1, effort: 0.01, bound: 1.2 };
const ANYWHERE: UniformStart<1> =
    UniformStart(State { q: [-1.0], v: [-2.0] }, State { q: [1.0], v: [2.0] });

/// On one instruction set: no test of buffers compares them, and a kernel is compiled for each.
type System = BaselineOnly<Oscillator<f32>>;
type World = Environment<System, All<System>, SymplecticEuler, Regulate, UniformStart<1>>;
type Replay = ReplayBuffer<f32>;

/// Numbers of observations and actions of the spring.
const SIZES: [usize; 2] = [2, 1];

fn environments(autoreset: Autoreset, count: usize) -> Environments<f32, World, 2, 1> {
    let world = Environment::new(All(BaselineOnly(SPRING)), SymplecticEuler, 0.06, TASK, ANYWHERE);
    let world = world.limit(7).autoreset(autoreset);
    Environments::new(world, count, 7, Execution::serial()).unwrap()
}

/// What they do, and what they see after it.
fn run(
    all: &mut Environments<f32, World, 2, 1>,
    steps: usize,
    layout: Layout,
) -> (Rollout<f32, 2, 1>, Vec<f32>) {
    let plan = Plan::new(steps, all.len()).truncated().layout(layout);
    let mut rollout = Rollout::new(plan).unwrap();
    all.rollout(Random::between([-4.0], [4.0]), &mut rollout).unwrap();
    let mut next = vec![0.0; 2 * all.len()];
    all.observe(&mut next).unwrap();
    (rollout, next)
}

/// Environments of any kind.
trait Source {
    fn reset(&mut self, which: &[bool]);

    /// What they do in so many steps, and what they see after it.
    fn run(&mut self, steps: usize, layout: Layout) -> (Box<dyn RolloutTensors<f32>>, Vec<f32>);
}

impl Source for Environments<f32, World, 2, 1> {
    fn reset(&mut self, which: &[bool]) {
        Environments::reset(self, which).unwrap();
    }

    fn run(&mut self, steps: usize, layout: Layout) -> (Box<dyn RolloutTensors<f32>>, Vec<f32>) {
        let (rollout, next) = run(self, steps, layout);
        (Box::new(rollout), next)
    }
}

/// A buffer for so many steps that was filled with as many as were ever to be.
fn filled(capacity: Capacity, steps: usize) -> Replay {
    let mut all = environments(Autoreset::SameStep, capacity.environments);
    let mut replay = Replay::new(SIZES, capacity).unwrap();
    let (rollout, next) = run(&mut all, steps, Layout::Interleaved);
    replay.insert(&rollout, &next, &Execution::serial()).unwrap();
    replay
}
