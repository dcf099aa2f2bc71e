//! Settings of environments of any system.

use libration::Method;
use libration::control::Jitter;
use libration::rl::{Delays, EnvironmentError, ProgramEnvironment};
use libration_settings::equations::{EquationSystem, EquationTask};

use super::{AnyEnvironments, CatalogueTask, EnvironmentFloat, Selection};

/// The settings of environments, except their float type.
#[derive(Clone, Debug, PartialEq)]
pub struct EnvironmentSettings {
    /// The system and its task.
    pub subject: EnvironmentSubject,
    /// The environments by programs.
    pub definition: ProgramEnvironment,
}

/// A system and its task, as they are stated.
#[derive(Clone, Debug, PartialEq)]
pub enum EnvironmentSubject {
    /// By their names.
    Catalogue(CatalogueTask),
    /// By equations.
    Equations(Box<EquationSubject>),
}

/// A system by equations and its task by expressions.
#[derive(Clone, Debug, PartialEq)]
pub struct EquationSubject {
    /// The system.
    pub system: EquationSystem,
    /// The text of its file.
    pub text: String,
    /// Other values of some of its parameters.
    pub parameters: Vec<(String, f64)>,
    /// The task.
    pub task: EquationTask,
}

/// Noise of clocks and sensors.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Noise {
    /// The law of `ε` in `Δt·(1 + ε)`, drawn per step of the integrator.
    pub jitter: Jitter,
    /// The law of `δ` in `Δt·(1 + δ)`, drawn per episode.
    pub skew: Jitter,
    /// The law of the noise of each observation, in its unit.
    pub observation: Jitter,
}

impl Noise {
    /// The noise of environments whose observations have the same law.
    pub fn of(definition: &ProgramEnvironment) -> Self {
        let ProgramEnvironment { jitter, skew, ref noise, .. } = *definition;
        let observation = noise.first().copied().unwrap_or(Jitter::Gaussian(0.0));
        Noise { jitter, skew, observation }
    }

    /// Whether there is none.
    pub fn is_none(&self) -> bool {
        [self.jitter, self.skew, self.observation].iter().all(|law| law.rms() == 0.0)
    }
}

impl EnvironmentSettings {
    /// Ideal environments of a task of the catalogue, whose actions are held for one step of `dt` seconds.
    pub fn of_catalogue(task: CatalogueTask, method: Method, dt: f64) -> Self {
        let definition = task.definition(method, dt);
        EnvironmentSettings { subject: EnvironmentSubject::Catalogue(task), definition }
    }

    /// The environments.
    ///
    /// # Errors
    /// If the settings are invalid.
    pub fn build<T: EnvironmentFloat>(
        &self,
        which: Selection<'_>,
    ) -> Result<Box<dyn AnyEnvironments<T>>, EnvironmentError> {
        T::build(self, which)
    }

    /// Whether nothing is drawn, so that all environments under a fixed policy are the same.
    pub fn draws_nothing(&self) -> bool {
        let Delays { observation, action } = self.definition.delays;
        Noise::of(&self.definition).is_none()
            && self.definition.start.iter().all(|[low, high]| low == high)
            && [observation, action].iter().all(|[least, most]| least == most)
    }

    /// Names and units of the observations; `"1"` where no unit is known.
    pub fn observed(&self) -> Vec<(String, String)> {
        match &self.subject {
            EnvironmentSubject::Catalogue(task) => task.observed(),
            EnvironmentSubject::Equations(subject) => {
                named(&subject.task.definitions.observe, &subject.task.units)
            }
        }
    }

    /// Names and units of the actions; `"1"` where no unit is known.
    pub fn actions(&self) -> Vec<(String, String)> {
        match &self.subject {
            EnvironmentSubject::Catalogue(task) => {
                vec![("u0".to_owned(), task.units()[2].to_owned())]
            }
            EnvironmentSubject::Equations(subject) => {
                match subject.task.definitions.targets.as_slice() {
                    [] => named(subject.system.equations.inputs(), &subject.system.input_units),
                    targets => named(targets, &vec![String::new(); targets.len()]),
                }
            }
        }
    }

    /// The largest sizes of the observations: 1 for cosines and sines without noise, else infinite.
    pub fn bounds(&self) -> Vec<f64> {
        // An expression of cosines has any size.
        let is_exact = matches!(self.subject, EnvironmentSubject::Catalogue(_))
            && Noise::of(&self.definition).observation.rms() == 0.0;
        let circle =
            |name: &str| is_exact && (name.starts_with("cos_") || name.starts_with("sin_"));
        let bound = |(name, _): &(String, String)| if circle(name) { 1.0 } else { f64::INFINITY };
        self.observed().iter().map(bound).collect()
    }

    /// The name of system and task.
    pub fn name(&self) -> String {
        match &self.subject {
            EnvironmentSubject::Catalogue(task) => {
                format!("{}-{}", task.system().name(), task.task.name())
            }
            EnvironmentSubject::Equations(subject) => {
                let letter = |c: char| if c.is_ascii_alphanumeric() { c } else { '-' };
                subject.system.name.chars().map(letter).collect()
            }
        }
    }

    /// The caveat about the integrator on the system, if there is one.
    pub fn caveat(&self) -> Option<String> {
        match &self.subject {
            EnvironmentSubject::Catalogue(task) => task.system().caveat(self.definition.method),
            EnvironmentSubject::Equations(_) => None,
        }
    }
}

fn named(names: &[String], units: &[String]) -> Vec<(String, String)> {
    let unit = |unit: &String| if unit.is_empty() { "1".to_owned() } else { unit.clone() };
    names.iter().zip(units).map(|(name, own)| (name.clone(), unit(own))).collect()
}
