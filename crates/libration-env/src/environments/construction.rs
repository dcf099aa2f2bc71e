//! Construction of environments: float type and task are dispatched here, outside all loops.

use bytemuck::Pod;
use libration::catalog::Actuation;
use libration::control::ControlError;
use libration::control::error::ensure;
use libration::ensemble::{All, Execution};
use libration::rl::start::UniformStart;
use libration::rl::{
    Environment, EnvironmentError, Environments, EpisodeNumber, ErrorScale, ProgramEnvironment,
    ProgramEnvironments,
};
use libration::{AnySystem, Elementary, Float, Method, Model, State, System, rl};

use super::{AnyEnvironments, CatalogueTask, EnvironmentSettings, EnvironmentSubject, Noise, Task};

/// The first environment and their number, the seed and the execution.
pub type Selection<'a> = ([usize; 2], u64, &'a Execution);

/// A float type whose environment kernels are compiled in this crate.
pub trait EnvironmentFloat: Float + Elementary + Pod {
    /// Environments of these settings.
    ///
    /// # Errors
    /// If the settings are invalid.
    fn build(
        settings: &EnvironmentSettings,
        which: Selection<'_>,
    ) -> Result<Box<dyn AnyEnvironments<Self>>, EnvironmentError>;

    /// The same by programs, whatever compiled kernels there are.
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
            fn build(
                settings: &EnvironmentSettings,
                which: Selection<'_>,
            ) -> Result<Box<dyn AnyEnvironments<Self>>, EnvironmentError> {
                let EnvironmentSettings { subject, definition } = settings;
                if let EnvironmentSubject::Catalogue(catalogue) = subject {
                    catalogue.check::<$float>()?;
                    // Ideal environments of the two tasks that most begin with are 1.7 to 3 times as fast by compiled kernels. All
                    // others are by programs, which with noise reach half of that speed.
                    match (catalogue.system(), catalogue.task) {
                        _ if !has_kernels(definition) => {}
                        (AnySystem::Oscillator(model), Task::Regulate(task)) => {
                            let system = Model::<1>::on::<$float>(&model);
                            return compiled(definition, catalogue.actuation, system, task, which);
                        }
                        (AnySystem::Pendulum(model), Task::SwingUp(task)) => {
                            let system = Model::<1>::on::<$float>(&model);
                            return compiled(definition, catalogue.actuation, system, task, which);
                        }
                        _ => {}
                    }
                }
                Self::by_program(definition.clone(), which)
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

/// Whether compiled kernels have all that is defined: steps of published tables, over whose coefficients they loop, are slower than programs.
fn has_kernels(definition: &ProgramEnvironment) -> bool {
    let is_table = matches!(definition.method, Method::Splitting(_) | Method::RungeKutta(_));
    let ProgramEnvironment { lengths, answers, levels, parameters, saturation, .. } = definition;
    let is_plain = lengths.is_empty() && answers.is_none() && levels.is_empty();
    let is_constant = parameters.is_empty() && saturation.iter().all(|x| x.as_constant().is_some());
    let has_scale = definition.error_scale != ErrorScale::default() || definition.inner_steps != 1;
    Noise::of(definition).is_none() && !is_table && is_plain && is_constant && !has_scale
}

impl CatalogueTask {
    /// Checks the numbers in the float type that programs have as constants.
    fn check<T: Float + Elementary>(&self) -> Result<(), ControlError> {
        for (name, value) in self.system().parameters() {
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
}

/// Ideal environments by compiled kernels.
fn compiled<T, S, K, const O: usize>(
    definition: &ProgramEnvironment,
    actuation: Actuation,
    system: S,
    task: K,
    ([first, len], seed, execution): Selection<'_>,
) -> Result<Box<dyn AnyEnvironments<T>>, EnvironmentError>
where
    T: Float + Elementary + Pod,
    S: System<T, 1> + Copy + Send + Sync + 'static,
    K: rl::Task<T, 1, O> + 'static,
{
    // One degree of freedom has a position, a velocity and a command.
    let range = |i: usize| definition.start.get(i).copied().unwrap_or_default();
    let [q, v] = [range(0), range(1)];
    let most = definition.saturation.first().and_then(EpisodeNumber::as_constant);
    let start = UniformStart(State { q: [q[0]], v: [v[0]] }, State { q: [q[1]], v: [v[1]] });
    let mut world = Environment::new(All(system), definition.method, definition.dt, task, start)
        .substeps(definition.substeps)
        .autoreset(definition.autoreset)
        .delays(definition.delays)
        .saturation(most.unwrap_or(f64::INFINITY))
        .mass(actuation.mass());
    world.limit = definition.limit;
    Ok(Box::new(Environments::shard(world, first, len, seed, execution.clone())?))
}
