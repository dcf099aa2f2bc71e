//! A subject as JSON, as simulators in other processes and languages describe themselves.

use libration::linear::{Matrix, Signal};
use libration_report::printable::printable;
use serde::Deserialize;
use serde::de::DeserializeOwned;
use serde_json::Value;
use thiserror::Error;

use crate::{
    MeasuredDelay, OperatingPoint, Recording, Reference, StrayResults, Subject, SubjectError,
};

/// The description of a simulator.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Description {
    title: String,
    state: Vec<f64>,
    #[serde(default)]
    action: Vec<f64>,
    dt: f64,
    /// Names with units in parentheses.
    states: Option<Vec<String>>,
    inputs: Option<Vec<String>>,
    state_scale: Option<Vec<f64>>,
    action_scale: Option<Vec<f64>>,
    #[serde(default)]
    fixed_dt: bool,
    equilibrium: Option<bool>,
    #[serde(default)]
    conservative: bool,
    /// Pairs of a position and its velocity.
    pairs: Option<Vec<(usize, usize)>>,
    mass: Option<Vec<Vec<f64>>>,
    joint_damping: Option<Vec<f64>>,
    integrator: Option<String>,
    /// The simulator and its version.
    version: Option<String>,
    #[serde(default)]
    notes: Vec<String>,
    #[serde(default)]
    validity: Vec<String>,
    reference: Option<ReferenceDescription>,
    #[serde(default)]
    stated_delays: Vec<f64>,
    #[serde(default)]
    direct_inputs: Vec<String>,
    #[serde(default)]
    measured_inputs: Vec<MeasuredDelay>,
    measured_observation: Option<MeasuredDelay>,
    stray_results: Option<StrayResults>,
    #[serde(default)]
    not_examined: Vec<String>,
    #[serde(default)]
    recordings: Vec<Recording>,
    operating_point: Option<OperatingPoint>,
    /// Whether the simulator computes energies.
    #[serde(default)]
    pub energy: bool,
    #[serde(default)]
    invocation: String,
}

#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct ReferenceDescription {
    source: String,
    #[serde(default)]
    exact: bool,
    a: Vec<Vec<f64>>,
    b: Vec<Vec<f64>>,
}

/// A description that cannot be used.
#[derive(Debug, Error)]
pub enum DescriptionError {
    /// It is no JSON, or a key is wrong.
    #[error("the description is invalid: {0}")]
    Json(#[from] serde_json::Error),
    /// A value is not allowed.
    #[error(transparent)]
    Subject(#[from] SubjectError),
}

/// Parses JSON whose strings are names and notes of somebody else's file: they become text within a line of output.
///
/// # Errors
/// It is no JSON, or a key is wrong.
pub fn parse_printable<T: DeserializeOwned>(text: &str) -> Result<T, serde_json::Error> {
    let mut value: Value = serde_json::from_str(text)?;
    make_printable(&mut value);
    serde_json::from_value(value)
}

fn make_printable(value: &mut Value) {
    match value {
        Value::String(text) => *text = printable(text).into_owned(),
        Value::Array(values) => values.iter_mut().for_each(make_printable),
        Value::Object(values) => values.values_mut().for_each(make_printable),
        Value::Null | Value::Bool(_) | Value::Number(_) => {}
    }
}

impl Description {
    /// Reads a description.
    ///
    /// # Errors
    /// It is no JSON, or a key is wrong.
    pub fn parse(text: &str) -> Result<Self, DescriptionError> {
        Ok(parse_printable(text)?)
    }

    /// The subject.
    ///
    /// # Errors
    /// A value is not allowed.
    pub fn subject(self) -> Result<Subject, DescriptionError> {
        let mut subject = Subject::new(&self.title, self.state, self.action, self.dt);
        let signals = |names: &[String]| names.iter().map(|name| Signal::parse(name)).collect();
        if let Some(names) = &self.states {
            subject.states = signals(names);
        }
        if let Some(names) = &self.inputs {
            subject.inputs = signals(names);
        }
        if let Some(scale) = self.state_scale {
            subject.state_scale = scale;
        }
        if let Some(scale) = self.action_scale {
            subject.action_scale = scale;
        }
        let (n, m) = (subject.state.len(), subject.action.len());
        if let Some(mass) = &self.mass {
            subject.mass = Some(matrix("mass", mass, (mass.len(), mass.len()))?);
        }
        if let Some(ReferenceDescription { source, exact, a, b }) = self.reference {
            let (a, b) = (matrix("reference.a", &a, (n, n))?, matrix("reference.b", &b, (n, m))?);
            subject.reference = Some(Reference { source, is_exact: exact, a, b });
        }
        subject.has_fixed_dt = self.fixed_dt;
        subject.equilibrium = self.equilibrium;
        subject.is_conservative = self.conservative;
        subject.pairs = self.pairs;
        subject.joint_damping = self.joint_damping;
        subject.integrator = self.integrator;
        subject.version = self.version.filter(|version| !version.is_empty());
        subject.notes = self.notes;
        subject.stated_delays = self.stated_delays;
        subject.direct_inputs = self.direct_inputs;
        subject.measured_inputs = self.measured_inputs;
        subject.measured_observation = self.measured_observation;
        subject.stray_results = self.stray_results;
        subject.not_examined = self.not_examined;
        subject.validity = self.validity;
        subject.recordings = self.recordings;
        subject.operating_point = self.operating_point;
        subject.invocation = self.invocation;
        subject.check()?;
        Ok(subject)
    }
}

fn matrix(
    field: &'static str,
    rows: &[Vec<f64>],
    (count, columns): (usize, usize),
) -> Result<Matrix, SubjectError> {
    let fits = rows.len() == count && rows.iter().all(|row| row.len() == columns);
    match fits && rows.iter().flatten().all(|x| x.is_finite()) {
        true => Ok(Matrix::from_fn(count, columns, |i, j| rows[i][j])),
        false => Err(SubjectError {
            field,
            problem: format!("has {} rows of {:?} numbers", rows.len(), rows.first().map(Vec::len)),
            expected: format!("{count} × {columns} finite numbers"),
        }),
    }
}
