//! Settings of environments of any system.

use libration::Method;
use libration::rl::EnvironmentError;

use super::{
    AnyEnvironments, EnvironmentFloat, EnvironmentSettings, EquationEnvironment, Selection,
};

/// The settings of environments of the catalogue or of a system by equations.
#[derive(Clone, Debug, PartialEq)]
pub enum AnyEnvironmentSettings {
    /// Of the catalogue.
    Catalogued(Box<EnvironmentSettings>),
    /// By equations.
    Equations(Box<EquationEnvironment>),
}

impl AnyEnvironmentSettings {
    /// The environments.
    ///
    /// # Errors
    /// If the settings are invalid.
    pub fn build<T: EnvironmentFloat>(
        &self,
        which: Selection<'_>,
    ) -> Result<Box<dyn AnyEnvironments<T>>, EnvironmentError> {
        match self {
            AnyEnvironmentSettings::Catalogued(settings) => T::catalogued(settings, which),
            AnyEnvironmentSettings::Equations(settings) => {
                T::by_program(settings.definition.clone(), which)
            }
        }
    }

    /// Names and units of the observations.
    pub fn observed(&self) -> Vec<(String, String)> {
        match self {
            AnyEnvironmentSettings::Catalogued(settings) => {
                let owned = |(name, unit): (&str, &str)| (name.to_owned(), unit.to_owned());
                settings.observed().into_iter().map(owned).collect()
            }
            AnyEnvironmentSettings::Equations(settings) => settings.observed(),
        }
    }

    /// Names and units of the actions.
    pub fn actions(&self) -> Vec<(String, String)> {
        match self {
            AnyEnvironmentSettings::Catalogued(settings) => {
                vec![("u0".to_owned(), settings.units()[2].to_owned())]
            }
            AnyEnvironmentSettings::Equations(settings) => settings.actions(),
        }
    }

    /// The largest sizes of the observations: 1 for cosines and sines without noise, else infinite.
    pub fn bounds(&self) -> Vec<f64> {
        let (exact, names) = match self {
            AnyEnvironmentSettings::Catalogued(settings) => {
                (settings.noise.observation.rms() == 0.0, self.observed())
            }
            // An expression of cosines has any size.
            AnyEnvironmentSettings::Equations(_) => (false, self.observed()),
        };
        let circle = |name: &str| exact && (name.starts_with("cos_") || name.starts_with("sin_"));
        let bound = |(name, _): &(String, String)| if circle(name) { 1.0 } else { f64::INFINITY };
        names.iter().map(bound).collect()
    }

    /// The name of system and task.
    pub fn name(&self) -> String {
        match self {
            AnyEnvironmentSettings::Catalogued(settings) => {
                format!("{}-{}", settings.system.any().name(), settings.task.name())
            }
            AnyEnvironmentSettings::Equations(settings) => {
                let letter = |c: char| if c.is_ascii_alphanumeric() { c } else { '-' };
                settings.system.name.chars().map(letter).collect()
            }
        }
    }

    /// The integrator.
    pub fn method(&self) -> Method {
        match self {
            AnyEnvironmentSettings::Catalogued(settings) => settings.method,
            AnyEnvironmentSettings::Equations(settings) => settings.definition.method,
        }
    }

    /// The caveat about the integrator on the system, if there is one.
    pub fn caveat(&self) -> Option<String> {
        match self {
            AnyEnvironmentSettings::Catalogued(settings) => {
                settings.system.any().caveat(settings.method)
            }
            AnyEnvironmentSettings::Equations(_) => None,
        }
    }
}
