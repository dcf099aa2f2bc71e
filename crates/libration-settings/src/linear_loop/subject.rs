//! Systems that can be linearised.

use std::path::Path;

use libration::analysis::{ConservedSum, conserved_sums};
use libration::equations::{Degree, Dynamics};
use libration::linear::Signal;
use libration::{AnySystem, catalog};

use super::operating_point::ADDED;
use crate::equations::EquationSystem;
use crate::{Fault, suggestions, units};

/// Whether a name is that of a file of equations.
pub(super) fn is_file(name: &str) -> bool {
    Path::new(name).extension().is_some_and(|end| end.eq_ignore_ascii_case("toml"))
}

/// A system that can be linearised.
pub(super) struct Subject {
    pub(super) name: String,
    pub(super) dynamics: Dynamics,
    /// Names and units of positions, velocities and inputs; those of time and of what means nothing have no name.
    pub(super) signals: Vec<Signal>,
    /// Positions, velocities and inputs at which the search begins.
    pub(super) start: Vec<f64>,
    /// Weighted sums of states that the motion from the start of a file conserves.
    pub(super) sums: Vec<ConservedSum>,
    /// The places of coordinates and states of first order.
    pub(super) unknowns: Vec<usize>,
    /// The places of the states of the plant.
    pub(super) states: Vec<usize>,
    /// Whether some of them are states of first order.
    pub(super) has_first_order_states: bool,
    /// An input divided by this is that of the dynamics.
    pub(super) mass: f64,
}

impl Subject {
    pub(super) fn of_catalogue(
        name: &str,
        parameters: &[(String, f64)],
        dimension: Option<usize>,
    ) -> Result<Self, Fault> {
        let (system, actuation) = catalog::build(name, parameters).map_err(|error| {
            let unknown = matches!(error, catalog::CatalogError::UnknownSystem { .. });
            let key = if unknown { "system.linear.of" } else { "system.linear.parameters" };
            let help = match unknown {
                true => " It may also be a file NAME.toml with equations.",
                false => "",
            };
            Fault::new(key, format!("{error}{}{help}", suggestions::catalog_help(&error)))
        })?;
        if matches!(system, AnySystem::DrivenOscillator(_)) {
            return Err(depends_on_time(name));
        }
        let origin = vec![0.0; dimension.unwrap_or(*system.entry().dimensions.start())];
        let built = (system, actuation);
        let of_equations = EquationSystem::of_catalogue(built, Some(&origin), Some(&origin))
            .map_err(|error| Fault::new("system.linear.at", error.to_string()))?;
        let mut subject = Subject::of_equations(&of_equations)?;
        let states = subject.signals.len() - subject.dynamics.degrees();
        let commands = subject.signals[states..].iter_mut().enumerate();
        for (i, command) in commands {
            let number = if subject.unknowns.len() == 1 { String::new() } else { i.to_string() };
            let unit = units::of(system, actuation).command;
            *command = Signal::new(&format!("{}{number}", actuation.name()), unit);
        }
        // The search covers all equilibria, not those that a motion reaches.
        Ok(Subject { sums: Vec::new(), mass: actuation.mass(), ..subject })
    }

    pub(super) fn of_file(path: &str, parameters: &[(String, f64)]) -> Result<Self, Fault> {
        Subject::of_equations(&Subject::system_of_file(path, parameters)?)
    }

    pub(super) fn system_of_file(
        path: &str,
        parameters: &[(String, f64)],
    ) -> Result<EquationSystem, Fault> {
        let wrong =
            |why: String| Fault::new("system.linear.of", format!("cannot use `{path}`: {why}"));
        let text = crate::read_text(Path::new(path)).map_err(|error| wrong(error.to_string()))?;
        EquationSystem::parse(&text, path, parameters).map_err(|error| wrong(error.sentence()))
    }

    pub(super) fn of_equations(system: &EquationSystem) -> Result<Self, Fault> {
        let degrees = system.equations.degrees();
        // An energy may depend on time where the motion does not.
        let time = degrees.iter().position(|degree| *degree == Degree::Time);
        let mut in_use = system.equations.dynamics().accelerations().inputs_in_use();
        if time.is_some_and(|time| in_use.any(|input| input == time)) {
            return Err(depends_on_time(&system.name));
        }
        let dynamics = match system.equations.inputs().is_empty() {
            true => system.equations.dynamics().with_added_accelerations(),
            false => system.equations.dynamics().clone(),
        };
        let d = degrees.len();
        // Of a state of first order the position means nothing.
        let mut signals = vec![Signal::new("", ""); 2 * d];
        for state in &system.states {
            signals[state.place] = Signal::new(&state.name, &state.unit);
        }
        let inputs = system.equations.inputs().iter().zip(&system.input_units);
        signals.extend(inputs.map(|(name, unit)| Signal::new(name, unit)));
        if system.equations.inputs().is_empty() {
            let added = degrees.iter().zip(&signals[d..2 * d]).map(|(degree, velocity)| {
                let unit = match velocity.unit.as_str() {
                    "" => String::new(),
                    unit => format!("{unit}/s"),
                };
                match degree {
                    Degree::Coordinate(name) => Signal::new(&format!("{name}''{ADDED}"), &unit),
                    Degree::State(name) => Signal::new(&format!("{name}'{ADDED}"), &unit),
                    Degree::Time => Signal::new("", ""),
                }
            });
            let added: Vec<Signal> = added.collect();
            signals.extend(added);
        }
        let states: Vec<usize> = system.states.iter().map(|state| state.place).collect();
        let sums = conserved_sums(system.equations.dynamics(), &system.start(), &states);
        let mut start = system.q.clone();
        start.extend(degrees.iter().zip(&system.v).map(|(degree, &v)| match degree {
            Degree::State(_) => v,
            Degree::Coordinate(_) | Degree::Time => 0.0,
        }));
        start.resize(signals.len(), 0.0);
        let unknown = |(i, degree): (usize, &Degree)| match degree {
            Degree::State(_) => Some(d + i),
            Degree::Coordinate(_) => Some(i),
            Degree::Time => None,
        };
        Ok(Subject {
            name: system.name.clone(),
            dynamics,
            signals,
            start,
            sums,
            unknowns: degrees.iter().enumerate().filter_map(unknown).collect(),
            states,
            has_first_order_states: degrees.iter().any(|d| matches!(d, Degree::State(_))),
            mass: 1.0,
        })
    }
}

fn depends_on_time(name: &str) -> Fault {
    let message = format!("`{name}` depends on time, so it has no equilibrium");
    Fault::new("system.linear.of", message)
}
