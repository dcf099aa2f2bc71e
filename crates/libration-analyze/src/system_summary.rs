//! Summaries of systems.

use std::collections::BTreeMap;

use libration::analysis::jacobian;
use libration::equations::{Degree, TaskDefinitions};
use libration::linear::eigenvalues;
use libration_settings::equations::{EquationSystem, EquationTask, NamedState};
use serde::Serialize;

/// The properties of a system that follow from its equations.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SystemSummary {
    /// The name.
    pub name: String,
    /// The description; empty without one.
    pub description: String,
    /// The states with their values at the start.
    pub states: Vec<SummaryState>,
    /// The parameters in the order of their names.
    pub parameters: Vec<SummaryParameter>,
    /// The names of the inputs.
    pub inputs: Vec<String>,
    /// Whether no acceleration depends on a velocity.
    pub positional: bool,
    /// Whether an equation depends on time.
    pub time_dependent: bool,
    /// The degree of the equations as polynomials of the states; none if they are no polynomials.
    pub polynomial_degree: Option<u32>,
    /// Whether the accelerations have derivatives everywhere.
    pub smooth: bool,
    /// Whether there is an energy.
    pub energy: bool,
    /// Number of operations of an evaluation of all accelerations.
    pub operations: usize,
    /// The largest absolute rate of a velocity or a state of first order at the start.
    pub rate_at_start: f64,
    /// The eigenvalues of the equations, linearised at the start, in 1/s: real and imaginary parts, slowest first. None where a
    /// derivative is not finite.
    pub eigenvalues_at_start: Option<Vec<[f64; 2]>>,
    /// The task of environments, if the file has one.
    pub task: Option<SummaryTask>,
}

/// A task of environments.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SummaryTask {
    /// The observed numbers.
    pub observe: Vec<String>,
    /// The reward.
    pub reward: String,
    /// The conditions that end an episode.
    pub terminated: Vec<String>,
    /// The range of each state at the start, by name.
    pub start: BTreeMap<String, [f64; 2]>,
    /// What takes the place of states after a step of the integrator, by name.
    pub project: BTreeMap<String, String>,
    /// The commands of discrete actions; empty for commands of any value.
    pub actions: Vec<f64>,
    /// The names of actions that are targets of the inner controller.
    pub targets: Vec<String>,
    /// The commands of the inner controller by input.
    pub inner: BTreeMap<String, String>,
    /// The period of the inner controller in seconds.
    pub inner_period: Option<f64>,
}

impl SummaryTask {
    fn new(system: &EquationSystem, task: &EquationTask) -> Self {
        let TaskDefinitions { observe, reward, terminated, project, targets, inner } =
            task.definitions.clone();
        let range = |state: &NamedState| (state.name.clone(), task.start[state.place]);
        let start = system.states.iter().map(range).collect();
        let project = project.into_iter().collect();
        SummaryTask {
            observe,
            reward,
            terminated,
            start,
            project,
            actions: task.levels.clone(),
            targets,
            inner: inner.into_iter().collect(),
            inner_period: task.inner_period,
        }
    }
}

/// A state.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SummaryState {
    /// The name; that of a velocity has a prime.
    pub name: String,
    /// The unit; empty without one.
    pub unit: String,
    /// The value at the start.
    pub start: f64,
}

/// A parameter.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SummaryParameter {
    /// The name.
    pub name: String,
    /// The value.
    pub value: f64,
    /// The unit; empty without one.
    pub unit: String,
}

impl SystemSummary {
    /// The summary of a system.
    pub fn new(system: &EquationSystem) -> Self {
        let equations = &system.equations;
        let degrees = equations.degrees();
        let states = system.states.iter().map(|state| SummaryState {
            name: state.name.clone(),
            unit: state.unit.clone(),
            start: state.start,
        });
        let parameters = system.definitions.parameters.iter().zip(&system.units);
        let parameter = |((name, value), unit): (&(String, f64), &String)| SummaryParameter {
            name: name.clone(),
            value: *value,
            unit: unit.clone(),
        };
        let mut parameters: Vec<SummaryParameter> = parameters.map(parameter).collect();
        parameters.sort_by(|a, b| a.name.cmp(&b.name));
        let rates: Vec<f64> =
            equations.dynamics().accelerations().on::<f64>().run(&system.start()).collect();
        SystemSummary {
            name: system.name.clone(),
            description: system.description.clone(),
            states: states.collect(),
            parameters,
            inputs: equations.inputs().to_vec(),
            positional: equations.dynamics().is_positional(),
            time_dependent: degrees.contains(&Degree::Time),
            polynomial_degree: equations.polynomial_degree(),
            smooth: equations.dynamics().accelerations().is_smooth(),
            energy: equations.dynamics().energy().is_some(),
            operations: equations.dynamics().accelerations().operations(),
            rate_at_start: rates.iter().fold(0.0, |most, rate| f64::max(most, rate.abs())),
            eigenvalues_at_start: eigenvalues_at(system, &system.start()),
            task: system.task.as_ref().map(|task| SummaryTask::new(system, task)),
        }
    }
}

/// The eigenvalues of the equations, linearised at the start.
fn eigenvalues_at(system: &EquationSystem, start: &[f64]) -> Option<Vec<[f64; 2]>> {
    let jacobian = jacobian(system.equations.dynamics(), start);
    let mut values: Vec<[f64; 2]> = eigenvalues(&system.state_matrix(&jacobian))?
        .into_iter()
        .map(|value| [value.re, value.im])
        .collect();
    values.sort_by(|a, b| a[0].hypot(a[1]).total_cmp(&b[0].hypot(b[1])));
    Some(values)
}
