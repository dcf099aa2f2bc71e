//! Controllers between the actions of a task and the inputs of a system.

use super::definitions::{is_name, is_reserved};
use super::equations::define_values;
use super::program::Program;
use super::program_builder::ProgramBuilder;
use super::task_scope::{define_new, scope, value};
use super::{
    Definitions, EquationError, EquationErrorKind, Equations, Expression, TaskDefinitions,
};

/// The time since the observation to which the actions respond in the expressions of an inner controller.
const AGE: &str = "age";

/// The commands of an inner controller.
pub(super) fn program(
    task: &TaskDefinitions,
    definitions: &Definitions,
    equations: &Equations,
) -> Result<Option<Program>, EquationError> {
    let fault = |key: &str, kind| EquationError { key: key.to_owned(), span: None, kind };
    if task.inner.is_empty() && task.targets.is_empty() {
        return Ok(None);
    }
    if task.targets.is_empty() {
        let reason =
            "is commanded by an inner controller without targets; expected names of actions";
        let kind = EquationErrorKind::Coordinate { name: task.inner[0].0.clone(), reason };
        return Err(fault("task.inner", kind));
    }
    let degrees = equations.degrees();
    let mut builder = ProgramBuilder::default();
    let state = builder.inputs(2 * degrees.len());
    let varied = builder.inputs(definitions.varied.len());
    let actions = builder.inputs(task.targets.len());
    let age = builder.input();
    let mut resolver = scope(builder, definitions, equations, (&state, &varied))?;
    define_new(&mut resolver, AGE, age, "task.inner")?;
    for (i, target) in task.targets.iter().enumerate() {
        let taken = resolver.defines(target) || definitions.inputs.contains(target);
        let reason = if !is_name(target) {
            "no name"
        } else if is_reserved(target) {
            "a name of the language"
        } else if taken || task.targets[..i].contains(target) {
            "given twice"
        } else {
            continue;
        };
        let kind = EquationErrorKind::Name { name: target.clone(), reason };
        return Err(fault("task.targets", kind));
    }
    define_values(&mut resolver, &task.targets, &actions);
    for (name, _) in &task.inner {
        if !definitions.inputs.contains(name) {
            let known = definitions.inputs.clone();
            let kind = EquationErrorKind::UnknownName { name: name.clone(), known };
            return Err(fault(&format!("task.inner.{name}"), kind));
        }
    }
    let mut outputs = Vec::with_capacity(definitions.inputs.len());
    for input in &definitions.inputs {
        let Some((_, text)) = task.inner.iter().find(|(name, _)| name == input) else {
            let reason = "has no command of the inner controller; expected one for each input";
            let kind = EquationErrorKind::Coordinate { name: input.clone(), reason };
            return Err(fault("task.inner", kind));
        };
        let key = format!("task.inner.{input}");
        outputs.push(value(&mut resolver, &key, text, Expression::parse)?);
    }
    Ok(Some(resolver.builder.finish(&outputs)))
}
