//! Projections of the states after steps.

use super::equations::{define_states, define_values};
use super::parser::name_before;
use super::program::Program;
use super::program_builder::ProgramBuilder;
use super::task_scope::{define_new, scope, value};
use super::{
    Definitions, Degree, EquationError, EquationErrorKind, Equations, Expression, TaskDefinitions,
};

/// The length of a step of the integrator in the expressions of a projection.
const TIME_STEP: &str = "dt";

/// What takes the place of a state after a step of the integrator.
pub(super) fn program(
    task: &TaskDefinitions,
    definitions: &Definitions,
    equations: &Equations,
) -> Result<Option<Program>, EquationError> {
    if task.project.is_empty() {
        return Ok(None);
    }
    let degrees = equations.degrees();
    let mut builder = ProgramBuilder::default();
    let after = builder.inputs(2 * degrees.len());
    let commands = builder.inputs(definitions.inputs.len());
    let varied = builder.inputs(definitions.varied.len());
    let dt = builder.input();
    let before = builder.inputs(2 * degrees.len());
    let mut resolver = scope(builder, definitions, equations, (&after, &varied))?;
    define_values(&mut resolver, &definitions.inputs, &commands);
    define_states(&mut resolver, degrees, before.split_at(degrees.len()), name_before);
    define_new(&mut resolver, TIME_STEP, dt, &format!("task.project.{}", task.project[0].0))?;
    let places = places(degrees);
    let mut outputs = after;
    for (name, text) in &task.project {
        let key = format!("task.project.{name}");
        let Some((_, place)) = places.iter().find(|(known, _)| known == name) else {
            let known = places.into_iter().map(|(name, _)| name).collect();
            let kind = EquationErrorKind::UnknownName { name: name.clone(), known };
            return Err(EquationError { key, span: None, kind });
        };
        outputs[*place] = value(&mut resolver, &key, text, Expression::parse)?;
    }
    Ok(Some(resolver.builder.finish(&outputs)))
}

/// The states by name, with their places among positions and velocities.
fn places(degrees: &[Degree]) -> Vec<(String, usize)> {
    let place = |(i, degree): (usize, &Degree)| match degree {
        Degree::Coordinate(name) => {
            vec![(name.clone(), i), (format!("{name}'"), degrees.len() + i)]
        }
        Degree::State(name) => vec![(name.clone(), degrees.len() + i)],
        Degree::Time => Vec::new(),
    };
    degrees.iter().enumerate().flat_map(place).collect()
}
