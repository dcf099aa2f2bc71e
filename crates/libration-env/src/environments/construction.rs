//! Construction of environments: float type and task are dispatched here, outside all loops.

use bytemuck::Pod;
use libration::control::ControlError;
use libration::control::clock::{Jittered, Skewed};
use libration::ensemble::{All, Execution};
use libration::rl::sensor::Noisy;
use libration::rl::start::UniformStart;
use libration::rl::{
    Environment, EnvironmentError, Environments, ProgramEnvironment, ProgramEnvironments,
};
use libration::{Elementary, Float, State, rl};

use super::system::EnvironmentSystem;
use super::{AnyEnvironments, EnvironmentSettings, Task};

/// The first environment and their number, the seed and the execution.
pub type Selection<'a> = ([usize; 2], u64, &'a Execution);

/// A float type whose environment kernels are compiled in this crate.
pub trait EnvironmentFloat: Float + Elementary + Pod {
    /// Environments of a system of the catalogue.
    ///
    /// # Errors
    /// If the settings are invalid.
    fn catalogued(
        settings: &EnvironmentSettings,
        which: Selection<'_>,
    ) -> Result<Box<dyn AnyEnvironments<Self>>, EnvironmentError>;

    /// Environments by programs.
    ///
    /// # Errors
    /// If the definition is invalid.
    fn by_program(
        definition: ProgramEnvironment,
        which: Selection<'_>,
    ) -> Result<Box<dyn AnyEnvironments<Self>>, EnvironmentError>;
}

macro_rules! environment_floats {
    ($($float:ident)*) => {$(
        // Not generic, so that it is compiled in this crate.
        impl EnvironmentFloat for $float {
            fn catalogued(
                settings: &EnvironmentSettings,
                which: Selection<'_>,
            ) -> Result<Box<dyn AnyEnvironments<Self>>, EnvironmentError> {
                match settings.task {
                    Task::Regulate(task) => settings.build::<$float, _, 2>(task, which),
                    Task::SwingUp(task) => settings.build::<$float, _, 3>(task, which),
                    Task::Track(task) => settings.build::<$float, _, 4>(task, which),
                }
            }

            fn by_program(
                definition: ProgramEnvironment,
                ([first, len], seed, execution): Selection<'_>,
            ) -> Result<Box<dyn AnyEnvironments<Self>>, EnvironmentError> {
                let execution = execution.clone();
                let all = ProgramEnvironments::<$float>::shard(definition, first, len, seed, execution)?;
                Ok(Box::new(all))
            }
        }
    )*};
}

environment_floats!(f32 f64);

impl EnvironmentSettings {
    fn build<T: Float + Elementary + Pod, K: rl::Task<T, 1, O> + 'static, const O: usize>(
        &self,
        task: K,
        ([first, len], seed, execution): Selection<'_>,
    ) -> Result<Box<dyn AnyEnvironments<T>>, EnvironmentError> {
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
