//! Environments by compiled kernels.

use libration::control::clock::{Jittered, Skewed};
use libration::ensemble::All;
use libration::rl::sensor::Noisy;
use libration::rl::start::UniformStart;
use libration::rl::{Environment, Environments, Task};
use libration::system::{BaselineOnly, DampedOscillator, Duffing, Oscillator, Pendulum};
use libration::{AnySystem, Model, State, System};
use libration_env::environments::{
    AnyEnvironments, EnvironmentFloat, EnvironmentSettings, Selection, Task as AnyTask,
};

/// The systems of the cases. A kernel takes a second to compile: one for each task and float serves all systems and integrators.
#[derive(Clone, Copy)]
enum Plant<T> {
    Damped(DampedOscillator<T>),
    Duffing(Duffing<T>),
    Oscillator(Oscillator<T>),
    Pendulum(Pendulum<T>),
}

impl<T: EnvironmentFloat> System<T, 1> for Plant<T> {
    #[inline(always)]
    fn acceleration(&self, state: &State<T, 1>) -> [T; 1] {
        match self {
            Plant::Damped(system) => system.acceleration(state),
            Plant::Duffing(system) => system.acceleration(state),
            Plant::Oscillator(system) => system.acceleration(state),
            Plant::Pendulum(system) => system.acceleration(state),
        }
    }
}

/// Compiled environments of the engine, which know nothing of programs.
pub(super) fn compiled<T: EnvironmentFloat>(
    settings: &EnvironmentSettings,
    which: Selection<'_>,
) -> Box<dyn AnyEnvironments<T>> {
    let plant = match settings.system.any() {
        AnySystem::DampedOscillator(model) => Plant::Damped(Model::<1>::on::<T>(&model)),
        AnySystem::Duffing(model) => Plant::Duffing(Model::<1>::on::<T>(&model)),
        AnySystem::Oscillator(model) => Plant::Oscillator(Model::<1>::on::<T>(&model)),
        AnySystem::Pendulum(model) => Plant::Pendulum(Model::<1>::on::<T>(&model)),
        other => panic!("no case is {other:?}"),
    };
    match settings.task {
        AnyTask::Regulate(task) => of_task::<T, _, _>(plant, task, settings, which),
        AnyTask::SwingUp(task) => of_task::<T, _, _>(plant, task, settings, which),
        AnyTask::Track(task) => of_task::<T, _, _>(plant, task, settings, which),
    }
}

fn of_task<T, K, const O: usize>(
    plant: Plant<T>,
    task: K,
    settings: &EnvironmentSettings,
    ([first, len], seed, execution): Selection<'_>,
) -> Box<dyn AnyEnvironments<T>>
where
    T: EnvironmentFloat,
    K: Task<T, 1, O> + 'static,
{
    let [q, v] = settings.start;
    let start = UniformStart(State { q: [q[0]], v: [v[0]] }, State { q: [q[1]], v: [v[1]] });
    let (noise, method) = (settings.noise, settings.method);
    let mut world = Environment::new(All(BaselineOnly(plant)), method, settings.dt, task, start)
        .substeps(settings.substeps)
        .autoreset(settings.autoreset)
        .delays(settings.delays)
        .saturation(settings.saturation)
        .mass(settings.actuation.mass())
        .clock((Skewed(noise.skew), Jittered(noise.jitter)))
        .sensor(Noisy([noise.observation; O]));
    world.limit = settings.limit;
    Box::new(Environments::shard(world, first, len, seed, execution.clone()).unwrap())
}
