//! A system as its author writes it.

use std::collections::HashSet;

use super::parser::BEFORE;
use super::{EquationError, EquationErrorKind, Expression, Function};

/// The most degrees of freedom of a system.
pub const MAX_DEGREES: usize = 256;

/// The most parts, parameters and inputs of a system.
pub const MAX_DEFINITIONS: usize = 1000;

/// The most observed numbers and the most comparisons of a task.
pub const MAX_EXPRESSIONS: usize = 1000;

/// The equations of a system, as text.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Definitions {
    /// Coordinates, in the order of the state. Each has an acceleration.
    pub coordinates: Vec<String>,
    /// The acceleration of each coordinate, by its name.
    pub accelerations: Vec<(String, String)>,
    /// States of first order and their rates.
    pub rates: Vec<(String, String)>,
    /// Named parts of expressions.
    pub parts: Vec<(String, String)>,
    /// Parameters with their values.
    pub parameters: Vec<(String, f64)>,
    /// Parameters without a value: inputs of the programs, after `inputs`.
    pub varied: Vec<String>,
    /// Inputs, such as the force of a controller.
    pub inputs: Vec<String>,
    /// The energy.
    pub energy: Option<String>,
}

impl Definitions {
    /// Makes a parameter an input of the programs, the last so far. Returns whether there is such a parameter.
    pub fn vary(&mut self, name: &str) -> bool {
        let place = self.parameters.iter().position(|(own, _)| own == name);
        self.varied.extend(place.map(|place| self.parameters.remove(place).0));
        place.is_some()
    }

    /// Checks names and numbers, but no expression.
    pub(crate) fn check(&self) -> Result<(), EquationError> {
        let degrees = self.coordinates.len() + self.rates.len();
        if degrees == 0 || degrees > MAX_DEGREES {
            return Err(fault("coordinates", EquationErrorKind::Degrees(degrees)));
        }
        let parameters = self.parameters.len() + self.varied.len();
        let others = self.parts.len() + parameters + self.inputs.len();
        if others > MAX_DEFINITIONS {
            return Err(fault("let", EquationErrorKind::Definitions(others)));
        }
        let mut taken = HashSet::new();
        for (key, name) in self.names() {
            let reason = if !is_name(name) {
                "no name"
            } else if is_reserved(name) {
                "a name of the language"
            } else if (key == "coordinates" || key.starts_with("rate.")) && is_column(name) {
                "the name of a column of each trajectory"
            } else if !taken.insert(name) {
                "given twice"
            } else {
                continue;
            };
            return Err(fault(&key, EquationErrorKind::Name { name: name.into(), reason }));
        }
        for name in &self.coordinates {
            if !self.accelerations.iter().any(|(other, _)| other == name) {
                let (name, reason) =
                    (name.clone(), "has no acceleration; expected one for each coordinate");
                return Err(fault("acceleration", EquationErrorKind::Coordinate { name, reason }));
            }
        }
        for (i, (name, _)) in self.accelerations.iter().enumerate() {
            let reason = if !self.coordinates.contains(name) {
                "is no coordinate; expected one of `coordinates`"
            } else if self.accelerations[..i].iter().any(|(other, _)| other == name) {
                "has two accelerations; expected one"
            } else {
                continue;
            };
            let kind = EquationErrorKind::Coordinate { name: name.clone(), reason };
            return Err(fault(&format!("acceleration.{name}"), kind));
        }
        for (name, value) in &self.parameters {
            if !value.is_finite() {
                let kind = EquationErrorKind::Parameter { name: name.clone(), value: *value };
                return Err(fault(&format!("parameters.{name}"), kind));
            }
        }
        Ok(())
    }

    /// All names that the definitions give, each with its key.
    fn names(&self) -> impl Iterator<Item = (String, &str)> {
        let coordinates = self.coordinates.iter().map(|name| ("coordinates".into(), name.as_str()));
        let rates = self.rates.iter().map(|(name, _)| (format!("rate.{name}"), name.as_str()));
        let inputs = self.inputs.iter().map(|name| ("inputs".into(), name.as_str()));
        let parameters =
            self.parameters.iter().map(|(name, _)| (format!("parameters.{name}"), name.as_str()));
        let varied = self.varied.iter().map(|name| (format!("parameters.{name}"), name.as_str()));
        let parts = self.parts.iter().map(|(name, _)| (format!("let.{name}"), name.as_str()));
        coordinates.chain(rates).chain(inputs).chain(parameters).chain(varied).chain(parts)
    }

    /// The parsed expressions of parts, accelerations, rates and the energy.
    pub(crate) fn parse(&self) -> Result<Vec<NamedExpression<'_>>, EquationError> {
        let tables = [
            ("let", 0, &self.parts),
            ("acceleration", 2, &self.accelerations),
            ("rate", 1, &self.rates),
        ];
        let named = tables.into_iter().flat_map(|(table, primes, texts)| {
            texts.iter().map(move |(name, text)| {
                (name.as_str(), primes, format!("{table}.{name}"), text.as_str())
            })
        });
        let energy = self.energy.iter().map(|text| (ENERGY, 0, "energy".to_owned(), text.as_str()));
        named
            .chain(energy)
            .map(|(name, primes, key, text)| {
                let expression = Expression::parse(text)
                    .map_err(|error| EquationError::of_expression(key.clone(), error))?;
                Ok(NamedExpression { name, primes, key, expression })
            })
            .collect()
    }
}

/// The name of the energy among expressions, which no expression can have.
pub(crate) const ENERGY: &str = "";

/// An expression with the name that it defines.
pub(crate) struct NamedExpression<'a> {
    pub(crate) name: &'a str,
    pub(crate) primes: usize,
    /// The key of its text, as in `acceleration.theta`.
    pub(crate) key: String,
    pub(crate) expression: Expression,
}

fn fault(key: &str, kind: EquationErrorKind) -> EquationError {
    EquationError { key: key.into(), span: None, kind }
}

pub(crate) fn is_name(name: &str) -> bool {
    let begins = name.starts_with(|c: char| c.is_ascii_alphabetic() || c == '_');
    begins && name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_')
}

/// Whether a column of each trajectory has the name.
fn is_column(name: &str) -> bool {
    ["step", "trajectory", "energy"].contains(&name)
}

/// Whether a name has a meaning in every expression.
pub(super) fn is_reserved(name: &str) -> bool {
    ["t", "pi", "if", BEFORE].contains(&name) || Function::from_name(name).is_some()
}
