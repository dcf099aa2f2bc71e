//! Systems by their equations, in files.

use std::collections::BTreeMap;
use std::ops::Range;

use libration::equations::{
    Definitions, Degree, EquationError, EquationErrorKind, Equations, ExpressionErrorKind, Function,
};
use serde::Deserialize;
use toml::Spanned;

use crate::{Document, Number, SettingsError, suggestions};

/// A system by its equations, with its parameters and start.
#[derive(Clone, Debug, PartialEq)]
pub struct EquationSystem {
    /// The name in messages.
    pub name: String,
    /// A description in one sentence; empty without one.
    pub description: String,
    /// The equations.
    pub equations: Equations,
    /// The texts of the equations.
    pub definitions: Definitions,
    /// The unit of each parameter, in the order of the definitions; empty without one.
    pub units: Vec<String>,
    /// Initial positions of all degrees of freedom.
    pub q: Vec<f64>,
    /// Initial velocities of all degrees of freedom.
    pub v: Vec<f64>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    system: Table,
}

/// The table `[system]`.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Table {
    name: String,
    #[serde(default)]
    description: String,
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
    start: BTreeMap<Spanned<String>, Spanned<Number>>,
}

/// A number, or a number with its unit.
#[derive(Deserialize)]
#[serde(untagged, expecting = "expected a number, or a table with `value` and `unit`")]
enum Parameter {
    Value(Number),
    WithUnit { value: Number, unit: String },
}

impl EquationSystem {
    /// Reads a system from the text of a file, with other values of some parameters; `file` is its name in messages.
    ///
    /// # Errors
    /// The first key or expression that is wrong.
    pub fn parse(text: &str, file: &str, set: &[(String, f64)]) -> Result<Self, SettingsError> {
        let document = Document::parse(text, file)?;
        let File { system } = toml::from_str(text).map_err(|error| document.explain(&error))?;
        let (mut definitions, units) = system.definitions();
        for (name, value) in set {
            let parameters = &mut definitions.parameters;
            let Some((_, own)) = parameters.iter_mut().find(|(own, _)| own == name) else {
                let known = parameters.iter().map(|(name, _)| name.as_str());
                let help = suggestions::suggest("parameters", name, known);
                let message = format!("unknown parameter `{name}` (--set)");
                let span = system.key_place("parameters");
                return Err(SettingsError::new(file, text, span, message, Some(help)));
            };
            *own = *value;
        }
        let equations = Equations::new(&definitions).map_err(|error| {
            let span = system.place(&error, text).unwrap_or_else(|| system.key_place(&error.key));
            let help = help(&error);
            SettingsError::new(file, text, span, error.to_string(), help)
        })?;
        let (q, v) = system
            .start(&equations)
            .map_err(|(span, message, help)| SettingsError::new(file, text, span, message, help))?;
        let (name, description) = (system.name, system.description);
        Ok(EquationSystem { name, description, equations, definitions, units, q, v })
    }
}

impl Table {
    fn definitions(&self) -> (Definitions, Vec<String>) {
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
            inputs: names(&self.inputs),
            energy: self.energy.as_ref().map(|text| text.get_ref().clone()),
        };
        (definitions, units)
    }

    /// The place in the file of an error within an expression.
    fn place(&self, error: &EquationError, text: &str) -> Option<Range<usize>> {
        let inside = error.span.clone()?;
        let value = match error.key.split_once('.') {
            Some(("let", name)) => find(&self.parts, name),
            Some(("acceleration", name)) => find(&self.acceleration, name),
            Some(("rate", name)) => find(&self.rate, name),
            _ => self.energy.as_ref(),
        }?;
        let span = value.span();
        let raw = text.get(span.clone())?;
        // An escape is longer in the file than in the expression.
        let quotes = raw.find(value.get_ref().as_str())?;
        Some(span.start + quotes + inside.start..span.start + quotes + inside.end)
    }

    /// The place of a key.
    fn key_place(&self, key: &str) -> Range<usize> {
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

    /// Positions and velocities at the start; those that are not given are zero, and the velocity of time is 1.
    fn start(&self, equations: &Equations) -> Result<(Vec<f64>, Vec<f64>), Wrong> {
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

/// A place in the file, a message and a suggestion.
type Wrong = (Range<usize>, String, Option<String>);

fn find<'a>(
    table: &'a BTreeMap<Spanned<String>, Spanned<String>>,
    name: &str,
) -> Option<&'a Spanned<String>> {
    table.iter().find(|(known, _)| known.get_ref() == name).map(|(_, text)| text)
}

/// A suggestion for a name that does not exist.
fn help(error: &EquationError) -> Option<String> {
    match &error.kind {
        EquationErrorKind::UnknownName { name, known } => {
            Some(suggestions::suggest("names", name, known.iter().map(String::as_str)))
        }
        EquationErrorKind::Expression(error) => match &error.kind {
            ExpressionErrorKind::UnknownFunction { name } => {
                let functions = Function::ALL.map(Function::name);
                let near = suggestions::nearest(name, functions)?;
                Some(format!("did you mean `{near}`?"))
            }
            _ => None,
        },
        _ => None,
    }
}
