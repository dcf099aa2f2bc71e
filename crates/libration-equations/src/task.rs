//! Tasks of environments from text.

use super::definitions::MAX_EXPRESSIONS;
use super::equations::{define_parameters, define_states, define_values};
use super::parser::name_before;
use super::program::{Operation, Program, ValueId};
use super::program_builder::ProgramBuilder;
use super::resolver::Resolver;
use super::{
    Definitions, EquationError, EquationErrorKind, Equations, Expression, ExpressionError,
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
}

/// A task as programs.
#[derive(Clone, Debug, PartialEq)]
pub struct TaskPrograms {
    /// From positions, velocities and the time since the episode began to the observed numbers.
    pub observation: Program,
    /// From positions and velocities before a step, inputs, positions and velocities after it, and the time after it, to the reward,
    /// and to 1 where the episode terminates, else 0.
    pub verdict: Program,
}

impl TaskPrograms {
    /// The task of these definitions on a system with its definitions.
    ///
    /// # Errors
    /// [`EquationError`]: the first expression that is wrong, by keys as `task.observe.0`, `task.reward.0` and `task.terminated.0`.
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
    let time = builder.input();
    let mut resolver = scope(builder, definitions, equations, &state, time)?;
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
    let commands = builder.inputs(definitions.inputs.len());
    let after = builder.inputs(2 * degrees.len());
    let time = builder.input();
    // An episode ends by a state alone: in this scope there are no commands.
    let mut resolver = scope(builder, definitions, equations, &after, time)?;
    let conditions =
        values(&mut resolver, "terminated", &task.terminated, Expression::parse_condition)?;
    let mut over = resolver.builder.constant(0.0);
    for condition in conditions {
        let sides = [over, condition, condition, over];
        over = resolver.builder.value(Operation::Choice(false, sides));
    }
    let mut resolver = scope(resolver.builder, definitions, equations, &after, time)?;
    define_values(&mut resolver, &definitions.inputs, &commands);
    define_states(&mut resolver, degrees, before.split_at(degrees.len()), name_before);
    let reward = core::slice::from_ref(&task.reward);
    let reward = values(&mut resolver, "reward", reward, Expression::parse)?;
    Ok(resolver.builder.finish(&[reward[0], over]))
}

/// The names of a system whose state and time are these values.
fn scope(
    builder: ProgramBuilder,
    definitions: &Definitions,
    equations: &Equations,
    state: &[ValueId],
    time: ValueId,
) -> Result<Resolver, EquationError> {
    let mut resolver = Resolver::new(builder);
    define_parameters(&mut resolver, &definitions.parameters);
    let degrees = equations.degrees();
    define_states(&mut resolver, degrees, state.split_at(degrees.len()), str::to_owned);
    resolver.define("t", 0, time);
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
    let value = |(i, text): (usize, &String)| {
        let key = format!("task.{key}.{i}");
        let expression =
            parse(text).map_err(|error| EquationError::of_expression(key.clone(), error))?;
        resolver.evaluate(&key, &expression).map_err(|error| match error.key == key {
            true => error,
            // The definitions of the system are right, but for inputs that are no names here.
            false => {
                let kind = EquationErrorKind::NeedsInput(error.key);
                EquationError { key: key.clone(), span: None, kind }
            }
        })
    };
    texts.iter().enumerate().map(value).collect()
}
