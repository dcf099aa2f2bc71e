//! Construction of environments: float type and task are dispatched here, outside all loops.

use bytemuck::Pod;
use libration::control::ControlError;
use libration::control::error::ensure;
use libration::ensemble::{All, Execution};
use libration::rl::start::UniformStart;
use libration::rl::{
    Environment, EnvironmentError, Environments, ProgramEnvironment, ProgramEnvironments,
};
use libration::{AnySystem, Elementary, Float, Method, Model, State, System, rl};

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
                settings.check::<$float>()?;
                // Ideal environments of the two tasks that most begin with are 1.7 to 3 times as fast by compiled kernels. All
                // others are by programs, which with noise reach half of that speed; so are steps of published tables, over whose
                // coefficients a kernel loops.
                match (settings.system.any(), settings.task) {
                    _ if matches!(settings.method, Method::Splitting(_) | Method::RungeKutta(_)) => {
                        Self::by_program(settings.by_program(), which)
                    }
                    (AnySystem::Oscillator(model), Task::Regulate(task)) if settings.noise.is_none() => {
                        settings.compiled(Model::<1>::on::<$float>(&model), task, which)
                    }
                    (AnySystem::Pendulum(model), Task::SwingUp(task)) if settings.noise.is_none() => {
                        settings.compiled(Model::<1>::on::<$float>(&model), task, which)
                    }
                    _ => Self::by_program(settings.by_program(), which),
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
    /// Checks the numbers in the float type that programs have as constants.
    fn check<T: Float + Elementary>(&self) -> Result<(), ControlError> {
        for (name, value) in self.system.any().parameters() {
            let allowed = "small enough for the float type";
            ensure(name, value, allowed, |value| T::from_f64(value).is_finite())?;
        }
        let allowed = "a finite number above 0 whose inverse is one in the float type";
        ensure("mass", self.actuation.mass(), allowed, |mass| {
            let mobility = T::from_f64(mass.recip());
            mobility > T::zero() && mobility.is_finite() && mass.is_finite()
        })?;
        match &self.task {
            Task::Regulate(task) => rl::Task::<T, 1, 2>::check(task),
            Task::SwingUp(task) => rl::Task::<T, 1, 3>::check(task),
            Task::Track(task) => rl::Task::<T, 1, 4>::check(task),
        }
    }

    /// Ideal environments by compiled kernels.
    fn compiled<T, S, K, const O: usize>(
        &self,
        system: S,
        task: K,
        ([first, len], seed, execution): Selection<'_>,
    ) -> Result<Box<dyn AnyEnvironments<T>>, EnvironmentError>
    where
        T: Float + Elementary + Pod,
        S: System<T, 1> + Copy + Send + Sync + 'static,
        K: rl::Task<T, 1, O> + 'static,
    {
        let [q, v] = self.start;
        let start = UniformStart(State { q: [q[0]], v: [v[0]] }, State { q: [q[1]], v: [v[1]] });
        let mut world = Environment::new(All(system), self.method, self.dt, task, start)
            .substeps(self.substeps)
            .autoreset(self.autoreset)
            .delays(self.delays)
            .saturation(self.saturation)
            .mass(self.actuation.mass());
        world.limit = self.limit;
        Ok(Box::new(Environments::shard(world, first, len, seed, execution.clone())?))
    }
}
