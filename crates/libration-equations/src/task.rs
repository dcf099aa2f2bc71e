//! Tasks of environments from text.

use super::definitions::MAX_EXPRESSIONS;
use super::equations::{define_states, define_values};
use super::parser::name_before;
use super::program::{Operation, Program, ValueId};
use super::program_builder::ProgramBuilder;
use super::resolver::Resolver;
use super::task_scope::{scope, value};
use super::{
    Definitions, EquationError, EquationErrorKind, Equations, Expression, ExpressionError,
    TaskDefinitions, inner_controller, projection,
};

/// A task as programs.
#[derive(Clone, Debug, PartialEq)]
pub struct TaskPrograms {
    /// From positions, velocities, parameters that vary and the time since the episode began to the observed numbers.
    pub observation: Program,
    /// From positions and velocities before a step, inputs and parameters that vary, positions and velocities after it, and the time
    /// after it, to the reward, and to 1 where the episode terminates, else 0. The reward is NaN where an observed number after the step is
    /// not finite, or before it one that does not depend on time.
    pub verdict: Program,
    /// From positions and velocities after a step of the integrator, inputs and parameters that vary, the length of the step, and
    /// positions and velocities before it, to those that take the place of the former.
    pub projection: Option<Program>,
    /// From positions, velocities, parameters that vary, actions and their age to the inputs of the system that are no parameters.
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
        let observation = observation(task, definitions, equations)?;
        Ok(TaskPrograms {
            verdict: verdict(task, definitions, equations, &observation)?,
            observation,
            projection: projection::program(task, definitions, equations)?,
            inner: inner_controller::program(task, definitions, equations)?,
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
    observation: &Program,
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
    let mut reward = values(&mut resolver, "reward", reward, Expression::parse)?[0];
    let builder = &mut resolver.builder;
    let seen = |states: &[ValueId]| [states, &varied[..], &[time]].concat();
    let [seen_before, seen_after] =
        [&before, &after].map(|states| builder.inline(observation, &seen(states)));
    let clock = before.len() + varied.len();
    for i in (0..task.observe.len()).filter(|&i| observation.is_partial(i)) {
        // Before a step its time is another: what depends on it was that after the step before, but for the first.
        let at_start = (!observation.depends_on(i, clock)).then_some(seen_before[i]);
        for value in at_start.into_iter().chain([seen_after[i]]) {
            // Neither an infinite number nor NaN times zero is zero.
            let zero = builder.constant(0.0);
            let none = builder.value(Operation::Product(value, zero));
            reward = builder.value(Operation::Sum(reward, none));
        }
    }
    Ok(resolver.builder.finish(&[reward, over]))
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
