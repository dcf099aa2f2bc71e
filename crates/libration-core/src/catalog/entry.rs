//! Entries of the catalogue: a system and its parameters.

use core::array::from_fn;
use core::fmt;
use core::ops::RangeInclusive;

use super::{AnySystem, CatalogError};
use crate::State;

/// The values that a parameter may take. Infinities and NaN are never allowed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Allowed {
    /// Greater than zero.
    Positive,
    /// Zero or greater.
    NonNegative,
    /// Any finite number.
    Finite,
}

impl Allowed {
    /// Whether `value` is allowed.
    pub fn admits(self, value: f64) -> bool {
        value.is_finite()
            && match self {
                Allowed::Positive => value > 0.0,
                Allowed::NonNegative => value >= 0.0,
                Allowed::Finite => true,
            }
    }
}

impl fmt::Display for Allowed {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Allowed::Positive => "finite and greater than 0",
            Allowed::NonNegative => "finite and at least 0",
            Allowed::Finite => "finite",
        })
    }
}

/// A parameter of a system.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parameter {
    /// Name on the command line and in configurations.
    pub name: &'static str,
    /// Unit of its value.
    pub unit: &'static str,
    /// A description in one line.
    pub summary: &'static str,
    /// The value that it has where none is given.
    pub default: f64,
    /// The values that it may take.
    pub allowed: Allowed,
}

/// A kind of system.
#[derive(Debug)]
pub struct Entry {
    /// Name on the command line and in configurations.
    pub name: &'static str,
    /// A description in one line.
    pub summary: &'static str,
    /// The numbers of degrees of freedom in which it exists.
    pub dimensions: RangeInclusive<usize>,
    /// The parameters that it takes.
    pub parameters: &'static [Parameter],
    /// Default initial positions in the lowest dimension, never empty.
    pub q: &'static [f64],
    /// Default initial velocities in the lowest dimension, never empty.
    pub v: &'static [f64],
    /// The system with these values.
    pub(super) build: fn(&Values<'_>) -> Result<AnySystem, CatalogError>,
}

impl Entry {
    /// The default start in `D` dimensions, or none if the system does not exist in `D`.
    ///
    /// Further dimensions repeat the coordinates of the lowest.
    pub fn start<const D: usize>(&self) -> Option<State<f64, D>> {
        let repeated = |x: &[f64]| from_fn(|i| x[i % x.len()]);
        self.dimensions.contains(&D).then(|| State { q: repeated(self.q), v: repeated(self.v) })
    }

    /// The error of asking for this system in a dimension in which it does not exist.
    pub fn wrong_dimension(&self, dimension: usize) -> CatalogError {
        CatalogError::Dimension { system: self.name, dimension, allowed: self.dimensions.clone() }
    }

    /// Checks each given value separately.
    pub(super) fn resolve<'a>(
        &'static self,
        given: &'a [(impl AsRef<str>, f64)],
    ) -> Result<Values<'a>, CatalogError> {
        let system = self.name;
        let mut values = Values { entry: self, given: Vec::with_capacity(given.len()) };
        for (name, value) in given {
            let (name, value) = (name.as_ref(), *value);
            let Some(parameter) = self.parameters.iter().find(|p| p.name == name) else {
                let name = name.to_owned();
                return Err(CatalogError::UnknownParameter {
                    system,
                    name,
                    known: self.parameters,
                });
            };
            if values.given(parameter).is_some() {
                return Err(CatalogError::Repeated { system, name: parameter.name });
            }
            let allowed = parameter.allowed;
            if !allowed.admits(value) {
                let name = parameter.name;
                return Err(CatalogError::Value { system, name, value, allowed });
            }
            values.given.push((name, value));
        }
        Ok(values)
    }
}

/// The parameters that a caller gave, each known to the system and allowed.
#[derive(Debug)]
pub(super) struct Values<'a> {
    /// The system that they are for.
    pub(super) entry: &'static Entry,
    given: Vec<(&'a str, f64)>,
}

impl Values<'_> {
    /// The value that was given.
    pub(super) fn given(&self, parameter: &Parameter) -> Option<f64> {
        self.given.iter().find(|(name, _)| *name == parameter.name).map(|&(_, value)| value)
    }

    /// The value that was given, or the default.
    pub(super) fn get(&self, parameter: &Parameter) -> f64 {
        self.given(parameter).unwrap_or(parameter.default)
    }
}
