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

/// Compiled environments of the engine, which know nothing of programs; none if the kernel is compiled for the other float only.
///
/// A kernel takes a second to compile: each system has half of the methods in one float and half of them in the other.
pub(super) fn compiled<T: EnvironmentFloat>(
    settings: &EnvironmentSettings,
    which: Selection<'_>,
) -> Option<Box<dyn AnyEnvironments<T>>> {
    match (settings.system.any(), settings.task) {
        (AnySystem::Oscillator(model), Task::Regulate(task)) => {
            of_system::<T, _, _, _, true>(Model::<1>::on::<T>(&model), task, settings, which)
        }
        (AnySystem::DampedOscillator(model), Task::Regulate(task)) => {
            of_system::<T, _, _, _, false>(Model::<1>::on::<T>(&model), task, settings, which)
        }
        (AnySystem::Pendulum(model), Task::SwingUp(task)) => {
            of_system::<T, _, _, _, true>(Model::<1>::on::<T>(&model), task, settings, which)
        }
        (AnySystem::Duffing(model), Task::Track(task)) => {
            of_system::<T, _, _, _, false>(Model::<1>::on::<T>(&model), task, settings, which)
        }
        other => panic!("no case is {other:?}"),
    }
}

fn of_system<T, S, K, const O: usize, const EVEN: bool>(
    system: S,
    task: K,
    settings: &EnvironmentSettings,
    which: Selection<'_>,
) -> Option<Box<dyn AnyEnvironments<T>>>
where
    T: EnvironmentFloat,
    S: System<T, 1> + Copy + Send + Sync + 'static,
    K: libration::rl::Task<T, 1, O> + 'static,
{
    if const { (size_of::<T>() == 4) == EVEN } {
        match settings.method {
            Method::VelocityVerlet => {
                Some(of_method(system, VelocityVerlet, task, settings, which))
            }
            Method::SymplecticEuler => {
                Some(of_method(system, SymplecticEuler, task, settings, which))
            }
            _ => None,
        }
    } else {
        match settings.method {
            Method::Rk4 => Some(of_method(system, Rk4, task, settings, which)),
            Method::Yoshida4 => Some(of_method(system, YOSHIDA4, task, settings, which)),
            _ => None,
        }
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
