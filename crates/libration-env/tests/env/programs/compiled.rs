//! Environments by compiled kernels.

use libration::control::clock::{Jittered, Skewed};
use libration::ensemble::All;
use libration::integrator::{Rk4, SymplecticEuler, VelocityVerlet, YOSHIDA4};
use libration::rl::sensor::Noisy;
use libration::rl::start::UniformStart;
use libration::rl::{Environment, Environments};
use libration::system::BaselineOnly;
use libration::{AnySystem, Integrator, Method, Model, State, System};
use libration_env::environments::{
    AnyEnvironments, EnvironmentFloat, EnvironmentSettings, Selection, Task,
};

/// Compiled environments of the engine, which know nothing of programs.
pub(super) fn compiled<T: EnvironmentFloat>(
    settings: &EnvironmentSettings,
    which: Selection<'_>,
) -> Box<dyn AnyEnvironments<T>> {
    match (settings.system.any(), settings.task) {
        (AnySystem::Oscillator(model), Task::Regulate(task)) => {
            of_system(Model::<1>::on::<T>(&model), task, settings, which)
        }
        (AnySystem::DampedOscillator(model), Task::Regulate(task)) => {
            of_system(Model::<1>::on::<T>(&model), task, settings, which)
        }
        (AnySystem::Pendulum(model), Task::SwingUp(task)) => {
            of_system(Model::<1>::on::<T>(&model), task, settings, which)
        }
        (AnySystem::Duffing(model), Task::Track(task)) => {
            of_system(Model::<1>::on::<T>(&model), task, settings, which)
        }
        other => panic!("no case is {other:?}"),
    }
}

fn of_system<T, S, K, const O: usize>(
    system: S,
    task: K,
    settings: &EnvironmentSettings,
    which: Selection<'_>,
) -> Box<dyn AnyEnvironments<T>>
where
    T: EnvironmentFloat,
    S: System<T, 1> + Copy + Send + Sync + 'static,
    K: libration::rl::Task<T, 1, O> + 'static,
{
    match settings.method {
        Method::VelocityVerlet => of_method(system, VelocityVerlet, task, settings, which),
        Method::Rk4 => of_method(system, Rk4, task, settings, which),
        Method::SymplecticEuler => of_method(system, SymplecticEuler, task, settings, which),
        Method::Yoshida4 => of_method(system, YOSHIDA4, task, settings, which),
        other => panic!("no setting has {other:?}"),
    }
}

fn of_method<T, S, M, K, const O: usize>(
    system: S,
    method: M,
    task: K,
    settings: &EnvironmentSettings,
    ([first, len], seed, execution): Selection<'_>,
) -> Box<dyn AnyEnvironments<T>>
where
    T: EnvironmentFloat,
    S: System<T, 1> + Copy + Send + Sync + 'static,
    M: Integrator + 'static,
    K: libration::rl::Task<T, 1, O> + 'static,
{
    let [q, v] = settings.start;
    let start = UniformStart(State { q: [q[0]], v: [v[0]] }, State { q: [q[1]], v: [v[1]] });
    let noise = settings.noise;
    let mut world = Environment::new(All(BaselineOnly(system)), method, settings.dt, task, start)
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
