//! Construction of environments: float type and task are dispatched here, outside all loops.

use bytemuck::Pod;
use libration::control::ControlError;
use libration::control::clock::{Jittered, Skewed};
use libration::ensemble::{All, Execution};
use libration::rl::sensor::Noisy;
use libration::rl::start::UniformStart;
use libration::rl::task::{Regulate, Sine, SwingUp, Track};
use libration::rl::{Environment, EnvironmentError, Environments};
use libration::{Elementary, Float, State, rl};

use super::system::EnvironmentSystem;
use super::{AnyEnvironments, EnvironmentSettings, Task};

/// An operation on environments with any number of observations.
pub trait EnvironmentsVisitor<T> {
    /// The result of the operation.
    type Output;

    /// Runs the operation.
    fn visit<const O: usize>(self, all: Box<dyn AnyEnvironments<T, O>>) -> Self::Output;
}

/// Environments of one task, or the error of their settings.
type EnvironmentsResult<T, const O: usize> =
    Result<Box<dyn AnyEnvironments<T, O>>, EnvironmentError>;

/// The first environment and their number, the seed and the execution.
type Selection<'a> = ([usize; 2], u64, &'a Execution);

/// A float type whose environment kernels are compiled in this crate.
pub trait EnvironmentFloat: Float + Elementary + Pod {
    /// Environments of the task to rest at the origin.
    ///
    /// # Errors
    /// If the settings are invalid; likewise below.
    fn regulate(
        settings: &EnvironmentSettings,
        task: Regulate,
        which: Selection<'_>,
    ) -> EnvironmentsResult<Self, 2>;

    /// Environments of the task to swing a pendulum up.
    fn swing_up(
        settings: &EnvironmentSettings,
        task: SwingUp,
        which: Selection<'_>,
    ) -> EnvironmentsResult<Self, 3>;

    /// Environments of the task to track a sine.
    fn track(
        settings: &EnvironmentSettings,
        task: Track<Sine>,
        which: Selection<'_>,
    ) -> EnvironmentsResult<Self, 4>;
}

macro_rules! environment_floats {
    ($($float:ident)*) => {$(
        // Not generic, so that it is compiled in this crate.
        impl EnvironmentFloat for $float {
            fn regulate(settings: &EnvironmentSettings, task: Regulate, which: Selection<'_>) -> EnvironmentsResult<Self, 2> {
                settings.build(task, which)
            }

            fn swing_up(settings: &EnvironmentSettings, task: SwingUp, which: Selection<'_>) -> EnvironmentsResult<Self, 3> {
                settings.build(task, which)
            }

            fn track(settings: &EnvironmentSettings, task: Track<Sine>, which: Selection<'_>) -> EnvironmentsResult<Self, 4> {
                settings.build(task, which)
            }
        }
    )*};
}

environment_floats!(f32 f64);

impl EnvironmentSettings {
    /// Builds `len` environments from number `first` on, at their start, and runs an operation on them.
    ///
    /// # Errors
    /// If the settings are invalid.
    pub fn with<T: EnvironmentFloat, V: EnvironmentsVisitor<T>>(
        &self,
        [first, len]: [usize; 2],
        seed: u64,
        execution: &Execution,
        visit: V,
    ) -> Result<V::Output, EnvironmentError> {
        let which = ([first, len], seed, execution);
        Ok(match self.task {
            Task::Regulate(task) => visit.visit(T::regulate(self, task, which)?),
            Task::SwingUp(task) => visit.visit(T::swing_up(self, task, which)?),
            Task::Track(task) => visit.visit(T::track(self, task, which)?),
        })
    }

    fn build<T: Float + Elementary + Pod, K: rl::Task<T, 1, O> + 'static, const O: usize>(
        &self,
        task: K,
        ([first, len], seed, execution): Selection<'_>,
    ) -> EnvironmentsResult<T, O> {
        for (name, value) in self.system.any().parameters() {
            if !T::from_f64(value).is_finite() {
                let allowed = "small enough for the float type";
                return Err(ControlError { name, index: None, value, allowed }.into());
            }
        }
        let [q, v] = self.start;
        let start = UniformStart(State { q: [q[0]], v: [v[0]] }, State { q: [q[1]], v: [v[1]] });
        let plant = EnvironmentSystem::<T>::new(self.system);
        let mut world = Environment::new(All(plant), self.method, self.dt, task, start)
            .substeps(self.substeps)
            .autoreset(self.autoreset)
            .delays(self.delays)
            .saturation(self.saturation)
            .mass(self.actuation.mass());
        world.limit = self.limit;
        if self.noise.is_none() {
            return Ok(Box::new(Environments::shard(world, first, len, seed, execution.clone())?));
        }
        let clock = (Skewed(self.noise.skew), Jittered(self.noise.jitter));
        let world = world.clock(clock).sensor(Noisy([self.noise.observation; O]));
        Ok(Box::new(Environments::shard(world, first, len, seed, execution.clone())?))
    }
}
