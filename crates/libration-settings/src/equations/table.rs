//! The table `[system]` of a file with equations.

use std::collections::BTreeMap;
use std::ops::Range;

use libration::equations::{Definitions, Degree, EquationError, Equations};
use serde::Deserialize;
use toml::Spanned;

use super::expression_error::inside;
use super::task::TaskTable;
use crate::{Number, suggestions};

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct File {
    pub(super) system: Table,
    pub(super) task: Option<TaskTable>,
}

/// The table `[system]`.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Table {
    pub(super) name: String,
    #[serde(default)]
    pub(super) description: String,
    #[serde(default)]
    coordinates: Vec<Spanned<String>>,
    #[serde(default)]
    parameters: BTreeMap<Spanned<String>, Parameter>,
    #[serde(default)]
    inputs: Vec<Spanned<String>>,
    #[serde(default, rename = "let")]
    parts: BTreeMap<Spanned<String>, Spanned<String>>,
    #[serde(default)]
    acceleration: BTreeMap<Spanned<String>, Spanned<String>>,
    #[serde(default)]
    rate: BTreeMap<Spanned<String>, Spanned<String>>,
    energy: Option<Spanned<String>>,
    #[serde(default)]
    units: BTreeMap<Spanned<String>, String>,
    #[serde(default)]
    start: BTreeMap<Spanned<String>, Spanned<Number>>,
}

/// A number, or a number with its unit.
#[derive(Deserialize)]
#[serde(untagged, expecting = "expected a number, or a table with `value` and `unit`")]
enum Parameter {
    Value(Number),
    WithUnit { value: Number, unit: String },
}

impl Table {
    pub(super) fn definitions(&self) -> (Definitions, Vec<String>) {
        let texts = |table: &BTreeMap<Spanned<String>, Spanned<String>>| {
            // In the order of the file.
            let mut pairs: Vec<_> = table.iter().collect();
            pairs.sort_by_key(|(name, _)| name.span().start);
            let text = |(name, text): (&Spanned<String>, &Spanned<String>)| {
                (name.get_ref().clone(), text.get_ref().clone())
            };
            pairs.into_iter().map(text).collect()
        };
        let names = |names: &[Spanned<String>]| -> Vec<String> {
            names.iter().map(|name| name.get_ref().clone()).collect()
        };
        let parameter = |(name, parameter): (&Spanned<String>, &Parameter)| {
            let (value, unit) = match parameter {
                Parameter::Value(value) => (value.0, ""),
                Parameter::WithUnit { value, unit } => (value.0, unit.as_str()),
            };
            ((name.get_ref().clone(), value), unit.to_owned())
        };
        let (parameters, units) = self.parameters.iter().map(parameter).unzip();
        let definitions = Definitions {
            coordinates: names(&self.coordinates),
            accelerations: texts(&self.acceleration),
            rates: texts(&self.rate),
            parts: texts(&self.parts),
            parameters,
            varied: Vec::new(),
            inputs: names(&self.inputs),
            energy: self.energy.as_ref().map(|text| text.get_ref().clone()),
        };
        (definitions, units)
    }

    /// The place in the file of an error within an expression.
    pub(super) fn place(&self, error: &EquationError, text: &str) -> Option<Range<usize>> {
        let value = match error.key.split_once('.') {
            Some(("let", name)) => find(&self.parts, name),
            Some(("acceleration", name)) => find(&self.acceleration, name),
            Some(("rate", name)) => find(&self.rate, name),
            _ => self.energy.as_ref(),
        }?;
        inside(value, error, text)
    }

    /// The place of a key.
    pub(super) fn key_place(&self, key: &str) -> Range<usize> {
        let (table, name) = key.split_once('.').unwrap_or((key, ""));
        let of = |table: &BTreeMap<Spanned<String>, Spanned<String>>| {
            let known = table.keys().find(|known| known.get_ref() == name);
            known.map(Spanned::span)
        };
        let place = match table {
            "let" => of(&self.parts),
            "acceleration" => of(&self.acceleration),
            "rate" => of(&self.rate),
            "parameters" => {
                self.parameters.keys().find(|known| known.get_ref() == name).map(Spanned::span)
            }
            "inputs" => self.inputs.first().map(Spanned::span),
            _ => self.coordinates.first().map(Spanned::span),
        };
        place.unwrap_or_default()
    }

    /// Units by name: of coordinates, states of first order, inputs, the energy, and of time `t`.
    pub(super) fn units(
        &self,
        definitions: &Definitions,
    ) -> Result<BTreeMap<String, String>, Wrong> {
        let states = definitions.rates.iter().map(|(name, _)| name);
        let known: Vec<&str> = definitions
            .coordinates
            .iter()
            .chain(states)
            .chain(&definitions.inputs)
            .map(String::as_str)
            .chain(definitions.energy.as_ref().map(|_| "energy"))
            .chain([TIME])
            .collect();
        for (name, unit) in &self.units {
            if unit.chars().any(char::is_control) {
                let message = format!(
                    "the unit of `{}` is {unit:?}; expected text on one line",
                    name.get_ref()
                );
                return Err((name.span(), message, None));
            }
            if !known.contains(&name.get_ref().as_str()) {
                let help = suggestions::suggest("names", name.get_ref(), known.iter().copied());
                let message = format!("nothing with a unit has the name `{}`", name.get_ref());
                return Err((name.span(), message, Some(help)));
            }
        }
        Ok(self.units.iter().map(|(name, unit)| (name.get_ref().clone(), unit.clone())).collect())
    }

    /// Positions and velocities at the start; those that are not given are zero, and the velocity of time is 1.
    pub(super) fn start(&self, equations: &Equations) -> Result<(Vec<f64>, Vec<f64>), Wrong> {
        let degrees = equations.degrees();
        let (mut q, mut v) = (vec![0.0; degrees.len()], vec![0.0; degrees.len()]);
        let mut known = Vec::new();
        for (i, degree) in degrees.iter().enumerate() {
            match degree {
                Degree::Coordinate(name) => known.extend([name.clone(), format!("{name}'")]),
                Degree::State(name) => known.push(name.clone()),
                Degree::Time => v[i] = 1.0,
            }
        }
        for (name, value) in &self.start {
            let is = |degree: &Degree, place: &str| match degree {
                Degree::Coordinate(own) | Degree::State(own) => own == place,
                Degree::Time => false,
            };
            let (plain, primed) = match name.get_ref().strip_suffix('\'') {
                Some(plain) => (plain, true),
                None => (name.get_ref().as_str(), false),
            };
            let x = value.get_ref().0;
            if !x.is_finite() {
                let message =
                    format!("`{}` starts at {x}; expected a finite number", name.get_ref());
                return Err((value.span(), message, None));
            }
            let place = degrees.iter().position(|degree| is(degree, plain));
            match place.map(|i| (i, &degrees[i])) {
                Some((i, Degree::Coordinate(_))) if primed => v[i] = x,
                Some((i, Degree::Coordinate(_))) => q[i] = x,
                Some((i, Degree::State(_))) if !primed => v[i] = x,
                _ => {
                    let known = known.iter().map(String::as_str);
                    let help = suggestions::suggest("states", name.get_ref(), known);
                    return Err((
                        name.span(),
                        format!("unknown state `{}`", name.get_ref()),
                        Some(help),
                    ));
                }
            }
        }
        Ok((q, v))
    }
}

/// The name of time.
pub(super) const TIME: &str = "t";

/// A place in the file, a message and a suggestion.
pub(super) type Wrong = (Range<usize>, String, Option<String>);

fn find<'a>(
    table: &'a BTreeMap<Spanned<String>, Spanned<String>>,
    name: &str,
) -> Option<&'a Spanned<String>> {
    table.iter().find(|(known, _)| known.get_ref() == name).map(|(_, text)| text)
}
