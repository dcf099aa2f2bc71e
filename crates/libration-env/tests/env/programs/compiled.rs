//! Environments by compiled kernels.

use libration::control::clock::{Jittered, Skewed};
use libration::ensemble::All;
use libration::rl::sensor::Noisy;
use libration::rl::start::UniformStart;
use libration::rl::{Environment, Environments, ProgramEnvironment, Task};
use libration::system::{BaselineOnly, DampedOscillator, Duffing, Oscillator, Pendulum};
use libration::{AnySystem, Model, State, System};
use libration_env::environments::{
    AnyEnvironments, EnvironmentFloat, EnvironmentSettings, EnvironmentSubject, Selection,
    Task as AnyTask,
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
    let EnvironmentSubject::Catalogue(catalogue) = &settings.subject else {
        panic!("no case is by equations")
    };
    let plant = match catalogue.system() {
        AnySystem::DampedOscillator(model) => Plant::Damped(Model::<1>::on::<T>(&model)),
        AnySystem::Duffing(model) => Plant::Duffing(Model::<1>::on::<T>(&model)),
        AnySystem::Oscillator(model) => Plant::Oscillator(Model::<1>::on::<T>(&model)),
        AnySystem::Pendulum(model) => Plant::Pendulum(Model::<1>::on::<T>(&model)),
        other => panic!("no case is {other:?}"),
    };
    let mass = catalogue.actuation.mass();
    match catalogue.task {
        AnyTask::Regulate(task) => {
            of_task::<T, _, _>(plant, task, (&settings.definition, mass), which)
        }
        AnyTask::SwingUp(task) => {
            of_task::<T, _, _>(plant, task, (&settings.definition, mass), which)
        }
        AnyTask::Track(task) => {
            of_task::<T, _, _>(plant, task, (&settings.definition, mass), which)
        }
    }
}

fn of_task<T, K, const O: usize>(
    plant: Plant<T>,
    task: K,
    (definition, mass): (&ProgramEnvironment, f64),
    ([first, len], seed, execution): Selection<'_>,
) -> Box<dyn AnyEnvironments<T>>
where
    T: EnvironmentFloat,
    K: Task<T, 1, O> + 'static,
{
    let [q, v] = definition.start[..] else { panic!("one degree of freedom") };
    let start = UniformStart(State { q: [q[0]], v: [v[0]] }, State { q: [q[1]], v: [v[1]] });
    let &ProgramEnvironment { method, dt, substeps, autoreset, delays, skew, jitter, .. } =
        definition;
    let mut world = Environment::new(All(BaselineOnly(plant)), method, dt, task, start)
        .substeps(substeps)
        .autoreset(autoreset)
        .delays(delays)
        .saturation(definition.saturation[0].as_constant().unwrap())
        .mass(mass)
        .clock((Skewed(skew), Jittered(jitter)))
        .sensor(Noisy([definition.noise[0]; O]));
    world.limit = definition.limit;
    Box::new(Environments::shard(world, first, len, seed, execution.clone()).unwrap())
}
