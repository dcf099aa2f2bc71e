//! Systems by equations in Python.

use libration_analyze::SystemSummary;
use libration_settings::SettingsError;
use libration_settings::equations::{EquationSystem, EquationTask};
use libration_settings::linear_loop::{OperatingPoint, linearised_equations};
use pyo3::prelude::*;
use serde_json::json;

use crate::error::{keywords, value_error};
use crate::linear_plant::{Names, Rows as MatrixRows, names, rows as rows_of};
use crate::request::{SystemRequest, of_catalogue};

/// The text of a file of equations, its name in messages, and other values of parameters.
pub(crate) type EquationText = (String, String, Vec<(String, f64)>);

pub(crate) fn equations((text, file, set): &EquationText) -> PyResult<EquationSystem> {
    EquationSystem::parse(text, file, set).map_err(located)
}

/// The description of a system: its equations, or its name in the catalogue.
#[derive(FromPyObject)]
pub(crate) enum Description {
    Equations(EquationText),
    Name(SystemRequest),
}

/// A description of a system, and initial positions and velocities in place of its own.
pub(crate) type AnySystem = (Description, Option<Vec<f64>>, Option<Vec<f64>>);

/// The system with its start, whatever describes it.
pub(crate) fn any_system((description, q, v): &AnySystem) -> PyResult<EquationSystem> {
    let (q, v) = (q.as_deref(), v.as_deref());
    match description {
        Description::Equations(text) => {
            let mut system = equations(text)?;
            system.begin_at(q, v, &[]).map_err(|error| value_error(keywords(&error)))?;
            Ok(system)
        }
        Description::Name(name) => of_catalogue(name, q, v),
    }
}

/// The system with parameters that vary.
pub(crate) fn varied(
    (text, file, set): &EquationText,
    varied: &[String],
) -> PyResult<EquationSystem> {
    EquationSystem::parse_varied(text, file, set, varied).map_err(located)
}

/// The task of a text with a table `[task]`.
pub(crate) fn task(text: &str, system: &EquationSystem) -> PyResult<EquationTask> {
    EquationTask::parse(text, "task", system).map_err(located)
}

/// An exception that shows the line: the texts of expressions are somewhere in it.
fn located(error: SettingsError) -> PyErr {
    value_error(error.to_string())
}

/// Returns what is known of a system, as JSON.
#[pyfunction]
pub(crate) fn _equation_summary(system: EquationText) -> PyResult<String> {
    Ok(json!(SystemSummary::new(&equations(&system)?)).to_string())
}

/// Matrices and names of a plant, the states and commands of its equilibrium, and the acceleration that is left there.
type PlantAtEquilibrium = ([MatrixRows; 5], Names, [Vec<f64>; 2], f64);

/// Returns the matrices and names of the plant at the equilibrium near the start, and the states and commands there.
#[pyfunction]
pub(crate) fn _equation_plant(system: EquationText) -> PyResult<PlantAtEquilibrium> {
    let found = linearised_equations(&equations(&system)?);
    let (plant, OperatingPoint { states, commands, residual, .. }) =
        found.map_err(|fault| value_error(fault.message))?;
    let matrices = [&plant.a, &plant.b, &plant.c, &plant.d, &plant.g];
    // Velocities are zero.
    let at = |name: &str| states.iter().find(|s| s.name == name).map_or(0.0, |s| s.value);
    let x = plant.states.iter().map(|signal| at(&signal.name)).collect();
    let u = commands.iter().map(|command| command.value).collect();
    Ok((matrices.map(rows_of), names(&plant), [x, u], residual))
}
