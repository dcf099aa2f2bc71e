//! Systems that advice is about.

use libration::catalog::Actuation;
use libration::ensemble::{AnyEnsemble, BatchFloat, EnsembleError, Execution};
use libration::{AnySystem, Method, Model, System, with_system};
use libration_settings::equations::EquationSystem;
use libration_settings::units::{self, Units};

/// A system of the catalogue or by its equations.
#[derive(Clone, Debug, PartialEq)]
pub enum AdvisedSystem {
    /// Of the catalogue.
    Catalogued {
        /// The system.
        system: AnySystem,
        /// The quantity of its commands, and so the units of gains and limits of commands.
        actuation: Actuation,
    },
    /// By equations. The start of requests is that of the system.
    Equations {
        /// The system.
        system: Box<EquationSystem>,
        /// The options of the command line that stand for it, such as `--system mine.toml`.
        options: String,
    },
}

impl From<AnySystem> for AdvisedSystem {
    /// A system of the catalogue under accelerations.
    fn from(system: AnySystem) -> Self {
        AdvisedSystem::Catalogued { system, actuation: Actuation::Acceleration }
    }
}

impl AdvisedSystem {
    /// The name.
    pub fn name(&self) -> &str {
        match self {
            AdvisedSystem::Catalogued { system, .. } => system.name(),
            AdvisedSystem::Equations { system, .. } => &system.name,
        }
    }

    /// The quantity of commands.
    pub(super) fn actuation(&self) -> Actuation {
        match self {
            AdvisedSystem::Catalogued { actuation, .. } => *actuation,
            AdvisedSystem::Equations { .. } => Actuation::Acceleration,
        }
    }

    /// The units of states, commands and gains.
    pub(super) fn units(&self) -> Units {
        match self {
            AdvisedSystem::Catalogued { system, actuation } => units::of(*system, *actuation),
            AdvisedSystem::Equations { .. } => Units::default(),
        }
    }

    /// The parameters with their values.
    pub(super) fn parameters(&self) -> Vec<(&str, f64)> {
        match self {
            AdvisedSystem::Catalogued { system, actuation } => actuation.parameters(*system),
            AdvisedSystem::Equations { system, .. } => {
                let own = &system.definitions.parameters;
                own.iter().map(|(name, value)| (name.as_str(), *value)).collect()
            }
        }
    }

    /// The options of the command line for the system and its start.
    pub(super) fn options(&self, q: &[f64], v: &[f64]) -> String {
        let list = |x: &[f64]| x.iter().map(f64::to_string).collect::<Vec<_>>().join(",");
        match self {
            AdvisedSystem::Catalogued { .. } => {
                format!("{} --q {} --v {}", self.name_and_parameters(), list(q), list(v))
            }
            AdvisedSystem::Equations { options, .. } => options.clone(),
        }
    }

    /// The options of the command line for the system.
    pub(super) fn name_and_parameters(&self) -> String {
        match self {
            AdvisedSystem::Catalogued { system, .. } => {
                let each = self.parameters().into_iter();
                let set: String = each.map(|(name, x)| format!(" --set {name}={x}")).collect();
                format!("--system {}{set}", system.name())
            }
            AdvisedSystem::Equations { options, .. } => options.clone(),
        }
    }

    /// The caveat about an integrator, if there is one.
    pub(super) fn caveat(&self, method: Method) -> Option<String> {
        match self {
            AdvisedSystem::Catalogued { system, .. } => system.caveat(method),
            AdvisedSystem::Equations { .. } => None,
        }
    }

    /// Whether accelerations depend on positions alone.
    pub(super) fn is_positional(&self, dimension: usize) -> bool {
        fn of<const D: usize, M: Model<D>>(_: &M) -> bool {
            <M::On<f64> as System<f64, D>>::POSITIONAL
        }
        match self {
            AdvisedSystem::Catalogued { system, .. } => {
                with_system!(*system, dimension, |model, D| of::<D, _>(&model), false)
            }
            AdvisedSystem::Equations { system, .. } => system.equations.dynamics().is_positional(),
        }
    }

    /// An ensemble of `count` trajectories from one start.
    pub(super) fn ensemble<T: BatchFloat>(
        &self,
        count: usize,
        execution: Execution,
        start: &[f64],
    ) -> Result<Box<dyn AnyEnsemble<T>>, EnsembleError> {
        let of = |_: usize, i: usize| T::from_f64(start.get(i).copied().unwrap_or_default());
        match self {
            AdvisedSystem::Catalogued { system, .. } => {
                T::ensemble(*system, start.len() / 2, count, execution, &of)
            }
            AdvisedSystem::Equations { system, .. } => {
                T::program_ensemble(system.equations.dynamics(), count, execution, &of)
            }
        }
    }

    /// The numbers that an environment shows, and its commands.
    pub(super) fn sizes(&self, degrees: usize) -> [usize; 2] {
        match self {
            AdvisedSystem::Catalogued { .. } => [2 * degrees, degrees],
            AdvisedSystem::Equations { system, .. } => {
                [system.states.len(), system.equations.inputs().len()]
            }
        }
    }
}
