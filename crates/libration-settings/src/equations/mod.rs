//! Systems by their equations, in files.

mod catalogue;
mod expression_error;
mod start;
mod table;
mod task;

pub use catalogue::StartError;
pub use expression_error::explanation;
pub(crate) use expression_error::{help, inside};
use libration::AnySystem;
use libration::analysis::rate_derivative;
use libration::catalog::Actuation;
use libration::equations::{Definitions, Degree, Equations};
use libration::linear::Matrix;
use table::{File, TIME};
pub use task::EquationTask;

use crate::{Document, SettingsError, suggestions};

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
    /// The states by name.
    pub states: Vec<NamedState>,
    /// The unit of each parameter, in the order of the definitions; empty without one.
    pub units: Vec<String>,
    /// The unit of each input; empty without one.
    pub input_units: Vec<String>,
    /// The unit of the energy; empty without one.
    pub energy_unit: String,
    /// The unit of time: `s`, or `1` of equations without units.
    pub time_unit: String,
    /// Initial positions of all degrees of freedom.
    pub q: Vec<f64>,
    /// Initial velocities of all degrees of freedom.
    pub v: Vec<f64>,
    /// The task of environments, if the file has one.
    pub task: Option<EquationTask>,
    /// The system of the catalogue that these are the equations of, compiled with the same bits; none of other equations.
    pub twin: Option<Twin>,
}

/// A compiled system with the same bits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Twin {
    /// The system.
    pub system: AnySystem,
    /// The quantity of its commands.
    pub actuation: Actuation,
}

/// A coordinate, a velocity or a state of first order.
#[derive(Clone, Debug, PartialEq)]
pub struct NamedState {
    /// The place among all positions and velocities.
    pub place: usize,
    /// The name; that of a velocity has a prime.
    pub name: String,
    /// The unit; empty without one.
    pub unit: String,
    /// The value at the start.
    pub start: f64,
}

/// Whether the text of a TOML file has a table `[system]` with equations.
pub fn is_system(text: &str) -> bool {
    let table: Option<toml::Table> = toml::from_str(text).ok();
    let system = table.as_ref().and_then(|table| table.get("system"));
    ["coordinates", "acceleration", "rate"].iter().any(|key| {
        system.and_then(toml::Value::as_table).is_some_and(|system| system.contains_key(*key))
    })
}

impl EquationSystem {
    /// Reads a system from the text of a file, with other values of some parameters; `file` is its name in messages.
    ///
    /// # Errors
    /// The first key or expression that is wrong.
    pub fn parse(text: &str, file: &str, set: &[(String, f64)]) -> Result<Self, SettingsError> {
        EquationSystem::parse_varied(text, file, set, &[])
    }

    /// Reads a system of which these parameters are inputs of its programs, after all others.
    ///
    /// # Errors
    /// As for [`parse`](Self::parse).
    pub fn parse_varied(
        text: &str,
        file: &str,
        set: &[(String, f64)],
        varied: &[String],
    ) -> Result<Self, SettingsError> {
        let document = Document::parse(text, file)?;
        let File { system, task } =
            toml::from_str(text).map_err(|error| document.explain(&error))?;
        let (mut definitions, units) = system.definitions();
        let unknown = |name: &str, definitions: &Definitions| {
            let known = definitions.parameters.iter().map(|(name, _)| name.as_str());
            let help = suggestions::suggest("parameters", name, known);
            let message = format!("unknown parameter `{name}` (--set)");
            let span = system.key_place("parameters");
            SettingsError::new(file, text, span, message, Some(help))
        };
        for (name, value) in set {
            match definitions.parameters.iter_mut().find(|(own, _)| own == name) {
                Some((_, own)) => *own = *value,
                None => return Err(unknown(name, &definitions)),
            }
        }
        for name in varied {
            if !definitions.vary(name) {
                return Err(unknown(name, &definitions));
            }
        }
        let equations = Equations::new(&definitions).map_err(|error| {
            let span = system.place(&error, text).unwrap_or_else(|| system.key_place(&error.key));
            let help = help(&error);
            SettingsError::new(file, text, span, error.to_string(), help)
        })?;
        let (q, v) = system
            .start(&equations)
            .map_err(|(span, message, help)| SettingsError::new(file, text, span, message, help))?;
        let known_units = system.units(&definitions);
        let known_units = known_units
            .map_err(|(span, message, help)| SettingsError::new(file, text, span, message, help))?;
        let unit = |name: &str| known_units.get(name).cloned().unwrap_or_default();
        let time_unit = known_units.get(TIME).map_or("s", String::as_str).to_owned();
        let states = named_states(&equations, (&q, &v), &unit, &time_unit);
        let input_units = definitions.inputs.iter().map(|name| unit(name)).collect();
        let energy_unit = unit("energy");
        let (name, description) = (system.name.clone(), system.description.clone());
        let mut read = EquationSystem {
            name,
            description,
            equations,
            definitions,
            states,
            units,
            input_units,
            energy_unit,
            time_unit,
            q,
            v,
            task: None,
            twin: None,
        };
        if varied.is_empty()
            && let Some((key, value)) = read.first_unbounded_rate()
        {
            let message = format!("{key} is {value} at the start; expected a finite number");
            let help = "choose another start or other parameters".to_owned();
            let span = system.key_place(&key);
            return Err(SettingsError::new(file, text, span, message, Some(help)));
        }
        if let Some(task) = task {
            let found = task.read(&read, text);
            read.task = Some(found.map_err(|(span, message, help)| {
                SettingsError::new(file, text, span, message, help)
            })?);
        }
        Ok(read)
    }
}

impl EquationSystem {
    /// Positions and velocities at the start.
    pub fn initial_state(&self) -> Vec<f64> {
        self.q.iter().chain(&self.v).copied().collect()
    }

    /// Positions and velocities at the start, and the inputs, which are zero.
    pub fn start(&self) -> Vec<f64> {
        let mut start = self.initial_state();
        start.resize(start.len() + self.equations.inputs().len(), 0.0);
        start
    }

    /// The first acceleration or rate that is not finite at the start: its key and its value. Nothing can move from there.
    fn first_unbounded_rate(&self) -> Option<(String, f64)> {
        let program = self.equations.dynamics().accelerations();
        let values = program.on::<f64>().run(&self.start()).collect::<Vec<_>>();
        let degrees = self.equations.degrees().iter().zip(values);
        let (degree, value) = degrees.into_iter().find(|(_, value)| !value.is_finite())?;
        let key = match degree {
            Degree::Coordinate(name) => format!("acceleration.{name}"),
            Degree::State(name) => format!("rate.{name}"),
            Degree::Time => "time".to_owned(),
        };
        Some((key, value))
    }

    /// The derivatives of the rates of the [states](EquationSystem::states) by the states, from those of the accelerations by
    /// positions, velocities and inputs.
    pub fn state_matrix(&self, jacobian: &Matrix) -> Matrix {
        let place = |i: usize| self.states[i].place;
        Matrix::from_fn(self.states.len(), self.states.len(), |i, j| {
            rate_derivative(jacobian, place(i), place(j))
        })
    }
}

/// Coordinates, then velocities and states of first order.
fn named_states(
    equations: &Equations,
    (q, v): (&[f64], &[f64]),
    unit: &dyn Fn(&str) -> String,
    time_unit: &str,
) -> Vec<NamedState> {
    let degrees = equations.degrees();
    let position = |(i, degree): (usize, &Degree)| match degree {
        Degree::Coordinate(name) => {
            Some(NamedState { place: i, name: name.clone(), unit: unit(name), start: q[i] })
        }
        Degree::State(_) | Degree::Time => None,
    };
    let rate = |unit: String| match (unit.as_str(), time_unit) {
        ("", _) | (_, "1") => unit,
        _ => format!("{unit}/{time_unit}"),
    };
    let velocity = |(i, degree): (usize, &Degree)| {
        let (name, unit) = match degree {
            Degree::Coordinate(name) => (format!("{name}'"), rate(unit(name))),
            Degree::State(name) => (name.clone(), unit(name)),
            Degree::Time => return None,
        };
        Some(NamedState { place: degrees.len() + i, name, unit, start: v[i] })
    };
    let positions = degrees.iter().enumerate().filter_map(position);
    positions.chain(degrees.iter().enumerate().filter_map(velocity)).collect()
}
