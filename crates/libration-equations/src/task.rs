//! Tasks of environments from text.

use super::definitions::{MAX_EXPRESSIONS, is_name};
use super::equations::{define_parameters, define_states, define_values};
use super::parser::name_before;
use super::program::{Operation, Program, ValueId};
use super::program_builder::ProgramBuilder;
use super::resolver::Resolver;
use super::{
    Definitions, Degree, EquationError, EquationErrorKind, Equations, Expression, ExpressionError,
};

/// The task of environments of a system as its author writes it.
///
/// Expressions have the names of the system, and `t` for the time since the episode began.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TaskDefinitions {
    /// The observed numbers: expressions of a state.
    pub observe: Vec<String>,
    /// The reward of a step: an expression of the state after it, the inputs during it, and by `before(x)` of the state before it.
    pub reward: String,
    /// Comparisons of expressions of the state after a step, one of which ends an episode.
    pub terminated: Vec<String>,
    /// States by name, and what each step of the integrator replaces them by: expressions of the state after it, of the inputs, of the
    /// length `dt` of the step in seconds, and by `before(x)` of the state before it.
    pub project: Vec<(String, String)>,
    /// The names of actions that are targets of an inner controller; empty where actions are the inputs of the system.
    pub targets: Vec<String>,
    /// Inputs by name, and the command of the inner controller: an expression of the state and of targets.
    pub inner: Vec<(String, String)>,
}

impl TaskDefinitions {
    /// The names of the actions on a system.
    pub fn actions<'a>(&'a self, definitions: &'a Definitions) -> &'a [String] {
        if self.targets.is_empty() { &definitions.inputs } else { &self.targets }
    }
}

/// A task as programs.
#[derive(Clone, Debug, PartialEq)]
pub struct TaskPrograms {
    /// From positions, velocities, parameters that vary and the time since the episode began to the observed numbers.
    pub observation: Program,
    /// From positions and velocities before a step, inputs and parameters that vary, positions and velocities after it, and the time
    /// after it, to the reward, and to 1 where the episode terminates, else 0.
    pub verdict: Program,
    /// From positions and velocities after a step of the integrator, inputs and parameters that vary, the length of the step, and
    /// positions and velocities before it, to those that take the place of the former.
    pub projection: Option<Program>,
    /// From positions, velocities, parameters that vary and actions to the inputs of the system that are no parameters.
    pub inner: Option<Program>,
    /// The number of targets of the inner controller.
    pub targets: usize,
}

impl TaskPrograms {
    /// The task of these definitions on a system with its definitions.
    ///
    /// # Errors
    /// [`EquationError`]: the first expression that is wrong, by keys as `task.observe.0`, `task.reward.0`, `task.terminated.0`,
    /// `task.project.x` and `task.inner.u`.
    pub fn new(
        task: &TaskDefinitions,
        definitions: &Definitions,
        equations: &Equations,
    ) -> Result<Self, EquationError> {
        for (key, texts) in [("observe", &task.observe), ("terminated", &task.terminated)] {
            if texts.len() > MAX_EXPRESSIONS {
                let kind = EquationErrorKind::Expressions(texts.len());
                return Err(EquationError { key: format!("task.{key}"), span: None, kind });
            }
        }
        Ok(TaskPrograms {
            observation: observation(task, definitions, equations)?,
            verdict: verdict(task, definitions, equations)?,
            projection: projection(task, definitions, equations)?,
            inner: inner(task, definitions, equations)?,
            targets: task.targets.len(),
        })
    }
}

fn observation(
    task: &TaskDefinitions,
    definitions: &Definitions,
    equations: &Equations,
) -> Result<Program, EquationError> {
    let mut builder = ProgramBuilder::default();
    let state = builder.inputs(2 * equations.degrees().len());
    let varied = builder.inputs(definitions.varied.len());
    let time = builder.input();
    let mut resolver = scope(builder, definitions, equations, (&state, &varied))?;
    resolver.define("t", 0, time);
    let outputs = values(&mut resolver, "observe", &task.observe, Expression::parse)?;
    Ok(resolver.builder.finish(&outputs))
}

fn verdict(
    task: &TaskDefinitions,
    definitions: &Definitions,
    equations: &Equations,
) -> Result<Program, EquationError> {
    let degrees = equations.degrees();
    let mut builder = ProgramBuilder::default();
    let before = builder.inputs(2 * degrees.len());
    let actions = task.actions(definitions);
    let commands = builder.inputs(actions.len());
    let varied = builder.inputs(definitions.varied.len());
    let after = builder.inputs(2 * degrees.len());
    let time = builder.input();
    // An episode ends by a state alone: in this scope there are no commands.
    let mut resolver = scope(builder, definitions, equations, (&after, &varied))?;
    resolver.define("t", 0, time);
    let conditions =
        values(&mut resolver, "terminated", &task.terminated, Expression::parse_condition)?;
    let mut over = resolver.builder.constant(0.0);
    for condition in conditions {
        let sides = [over, condition, condition, over];
        over = resolver.builder.value(Operation::Choice(false, sides));
    }
    let mut resolver = scope(resolver.builder, definitions, equations, (&after, &varied))?;
    resolver.define("t", 0, time);
    define_values(&mut resolver, actions, &commands);
    define_states(&mut resolver, degrees, before.split_at(degrees.len()), name_before);
    let reward = core::slice::from_ref(&task.reward);
    let reward = values(&mut resolver, "reward", reward, Expression::parse)?;
    Ok(resolver.builder.finish(&[reward[0], over]))
}

/// What takes the place of a state after a step of the integrator.
fn projection(
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
    if resolver.defines(TIME_STEP) {
        let reason = "the length of a step in `project`";
        let kind = EquationErrorKind::Name { name: TIME_STEP.into(), reason };
        let key = format!("task.project.{}", task.project[0].0);
        return Err(EquationError { key, span: None, kind });
    }
    resolver.define(TIME_STEP, 0, dt);
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

/// The commands of an inner controller.
fn inner(
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
    let mut resolver = scope(builder, definitions, equations, (&state, &varied))?;
    for (i, target) in task.targets.iter().enumerate() {
        let taken = resolver.defines(target) || definitions.inputs.contains(target);
        let reason = if !is_name(target) {
            "no name"
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

/// The length of a step of the integrator in the expressions of a projection.
const TIME_STEP: &str = "dt";

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

/// The names of a system with these states and parameters that vary.
fn scope(
    builder: ProgramBuilder,
    definitions: &Definitions,
    equations: &Equations,
    (state, varied): (&[ValueId], &[ValueId]),
) -> Result<Resolver, EquationError> {
    let mut resolver = Resolver::new(builder);
    define_parameters(&mut resolver, &definitions.parameters);
    define_values(&mut resolver, &definitions.varied, varied);
    let degrees = equations.degrees();
    define_states(&mut resolver, degrees, state.split_at(degrees.len()), str::to_owned);
    for own in definitions.parse()? {
        resolver.define_expression(own);
    }
    Ok(resolver)
}

/// The values of the texts of a key, in order.
fn values(
    resolver: &mut Resolver,
    key: &str,
    texts: &[String],
    parse: fn(&str) -> Result<Expression, ExpressionError>,
) -> Result<Vec<ValueId>, EquationError> {
    let value =
        |(i, text): (usize, &String)| value(resolver, &format!("task.{key}.{i}"), text, parse);
    texts.iter().enumerate().map(value).collect()
}

/// The value of a text.
fn value(
    resolver: &mut Resolver,
    key: &str,
    text: &str,
    parse: fn(&str) -> Result<Expression, ExpressionError>,
) -> Result<ValueId, EquationError> {
    let expression =
        parse(text).map_err(|error| EquationError::of_expression(key.to_owned(), error))?;
    resolver.evaluate(key, &expression).map_err(|error| match error.key == key {
        true => error,
        // The definitions of the system are right, but for inputs that are no names here.
        false => {
            let kind = EquationErrorKind::NeedsInput(error.key);
            EquationError { key: key.to_owned(), span: None, kind }
        }
    })
}
