//! The simulator under audit, in names and numbers.

use libration::linear::{MOST_STATES, Matrix, Signal};
use libration_report::notation::plural;
use serde::Deserialize;
use thiserror::Error;

use crate::OperatingPoint;

/// What is known of a simulator before its first step.
#[derive(Clone, Debug)]
pub struct Subject {
    /// Its name, such as that of a file.
    pub title: String,
    /// Names and units of the states.
    pub states: Vec<Signal>,
    /// Names and units of the actions; there may be none.
    pub inputs: Vec<Signal>,
    /// The state at which the step is linearised.
    pub state: Vec<f64>,
    /// The action there.
    pub action: Vec<f64>,
    /// Typical deviations of the states.
    pub state_scale: Vec<f64>,
    /// Typical deviations of the actions.
    pub action_scale: Vec<f64>,
    /// The length of a step, in s.
    pub dt: f64,
    /// Whether the simulator has this step only.
    pub has_fixed_dt: bool,
    /// Whether the author of the simulator says that the state is an equilibrium, or that it is none.
    pub equilibrium: Option<bool>,
    /// Whether the author of the simulator says that the system conserves its energy.
    pub is_conservative: bool,
    /// The states that are a position and its velocity, if the simulator knows them.
    pub pairs: Option<Vec<(usize, usize)>>,
    /// The inertia of the velocities of the pairs, if the simulator knows it.
    pub mass: Option<Matrix>,
    /// Damping of each velocity of the pairs that an integrator may treat implicitly, such as that of joints.
    pub joint_damping: Option<Vec<f64>>,
    /// The integrator in the words of the simulator.
    pub integrator: Option<String>,
    /// The simulator with its version, such as `MuJoCo 4.0.0`, if it is known.
    pub version: Option<String>,
    /// Facts that a reader must know, such as contacts.
    pub notes: Vec<String>,
    /// What ends the validity of the result, such as contacts that change.
    pub validity: Vec<String>,
    /// Matrices of the step by the simulator's own derivatives, and their source.
    pub reference: Option<Reference>,
    /// Delays of the actions in s that the simulator states; empty if it states none.
    pub stated_delays: Vec<f64>,
    /// Inputs that the audit sets past the way of commands, so that their lateness is not that of commands.
    pub direct_inputs: Vec<String>,
    /// Inputs whose lateness the adapter of the simulator measures: discrete ones, and those whose delay varies at random.
    pub measured_inputs: Vec<MeasuredDelay>,
    /// The age of observations, if it changes from step to step.
    pub measured_observation: Option<MeasuredDelay>,
    /// Results that the adapter could not repeat, if there are any.
    pub stray_results: Option<StrayResults>,
    /// The parts of the simulator that are not audited, such as wrappers.
    pub not_examined: Vec<String>,
    /// Recordings of the simulator that should have the same bits.
    pub recordings: Vec<Recording>,
    /// Where the state is from a requested one from which it was searched for.
    pub operating_point: Option<OperatingPoint>,
    /// The command that repeats the audit.
    pub invocation: String,
}

/// A lateness that the adapter of a simulator measures, by single calls that differ from all others.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MeasuredDelay {
    /// The name of the input, or of the observation.
    pub name: String,
    /// Steps by which a command is used late, or by which the observation is older than the state, on average.
    pub late_steps: f64,
    /// The standard error of this mean.
    pub late_steps_error: f64,
    /// The largest number of steps.
    pub most_steps: f64,
    /// The number of calls that differed.
    pub calls: usize,
    /// The number of these that no result shows.
    pub unseen: usize,
    /// Whether the delay changes from step to step.
    pub varies: bool,
}

/// Results that differ from those of all other calls with the same state and action, after no change of either.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StrayResults {
    /// The number of these results.
    pub strays: usize,
    /// The number of calls.
    pub calls: usize,
}

/// Two recordings that should have the same bits.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Recording {
    /// How the second differs from the first, in words.
    pub name: String,
    /// The lengths of the axes: steps, perhaps environments, and components.
    pub shape: Vec<usize>,
    /// The numbers of the first.
    pub first: Vec<f64>,
    /// The numbers of the second.
    pub second: Vec<f64>,
}

/// Matrices of a step by a simulator's own derivatives.
#[derive(Clone, Debug)]
pub struct Reference {
    /// The function that computed them.
    pub source: String,
    /// Whether they have rounding errors only, as those of automatic differentiation do.
    pub is_exact: bool,
    /// States × states.
    pub a: Matrix,
    /// States × inputs.
    pub b: Matrix,
}

/// A value of a subject that is not allowed.
#[derive(Clone, Debug, Error, PartialEq)]
#[error("`{field}` {problem}; expected {expected}")]
pub struct SubjectError {
    /// The field.
    pub field: &'static str,
    /// What is wrong with it, with its value: `has 1 name`, `is 0 s`.
    pub problem: String,
    /// What is allowed.
    pub expected: String,
}

impl Subject {
    /// A subject with numbered names, unit scales and no further knowledge.
    pub fn new(title: &str, state: Vec<f64>, action: Vec<f64>, dt: f64) -> Self {
        let scale = |values: &[f64]| values.iter().map(|x| x.abs().max(1.0)).collect();
        Subject {
            title: title.to_owned(),
            states: Signal::numbered("x", state.len()),
            inputs: Signal::numbered("u", action.len()),
            state_scale: scale(&state),
            action_scale: scale(&action),
            state,
            action,
            dt,
            has_fixed_dt: false,
            equilibrium: None,
            is_conservative: false,
            pairs: None,
            mass: None,
            joint_damping: None,
            integrator: None,
            version: None,
            notes: Vec::new(),
            validity: Vec::new(),
            reference: None,
            stated_delays: Vec::new(),
            direct_inputs: Vec::new(),
            measured_inputs: Vec::new(),
            measured_observation: None,
            stray_results: None,
            not_examined: Vec::new(),
            recordings: Vec::new(),
            operating_point: None,
            invocation: String::new(),
        }
    }

    /// Checks all values.
    ///
    /// # Errors
    /// The first value that is not allowed.
    pub fn check(&self) -> Result<(), SubjectError> {
        let (n, m) = (self.state.len(), self.action.len());
        let error = |field, problem: String, expected: String| {
            Err(SubjectError { field, problem, expected })
        };
        let has = |count: usize, thing: &str| format!("has {}", plural(count, thing));
        let name = |signals: &[Signal], i: usize| {
            signals.get(i).map_or_else(|| (i + 1).to_string(), |signal| signal.name.clone())
        };
        if !(1..=MOST_STATES).contains(&n) {
            return error("state", has(n, "number"), format!("1 to {MOST_STATES} numbers"));
        }
        if m > MOST_STATES {
            return error("action", has(m, "number"), format!("at most {MOST_STATES}"));
        }
        if !(self.dt.is_finite() && self.dt > 0.0) {
            return error("dt", format!("is {} s", self.dt), "a finite number above 0".into());
        }
        let finite = "finite numbers".to_owned();
        for (field, values, names) in
            [("state", &self.state, &self.states), ("action", &self.action, &self.inputs)]
        {
            if let Some(i) = values.iter().position(|x| !x.is_finite()) {
                return error(field, format!("is {} for `{}`", values[i], name(names, i)), finite);
            }
        }
        for (field, values, names, count) in [
            ("state_scale", &self.state_scale, &self.states, n),
            ("action_scale", &self.action_scale, &self.inputs, m),
        ] {
            if values.len() != count {
                return error(field, has(values.len(), "number"), format!("{count}"));
            }
            if let Some(i) = values.iter().position(|x| !(x.is_finite() && *x > 0.0)) {
                let problem = format!("is {} for `{}`", values[i], name(names, i));
                return error(field, problem, "finite numbers above 0".into());
            }
        }
        for (field, names, count) in [("states", &self.states, n), ("inputs", &self.inputs, m)] {
            if names.len() != count {
                let expected = format!("{count}, one for each");
                return error(field, has(names.len(), "name"), expected);
            }
            for (i, name) in names.iter().enumerate() {
                if names[..i].iter().any(|other| other.name == name.name) {
                    let expected = "different names".to_owned();
                    return error(field, format!("has `{}` twice", name.name), expected);
                }
            }
        }
        if let Some(&(i, j)) = self.pairs.iter().flatten().find(|(i, j)| *i >= n || *j >= n) {
            return error("pairs", format!("has ({i}, {j})"), format!("numbers below {n}"));
        }
        if let (Some(mass), Some(pairs)) = (&self.mass, &self.pairs) {
            let size = pairs.len();
            if (mass.rows(), mass.columns()) != (size, size) {
                let found = format!("is {} × {}", mass.rows(), mass.columns());
                return error("mass", found, format!("{size} × {size}"));
            }
        }
        if !self.stated_delays.is_empty() && self.stated_delays.len() != m {
            let found = has(self.stated_delays.len(), "number");
            return error("stated_delays", found, format!("{m}, one for each action"));
        }
        for recording in &self.recordings {
            let count: usize = recording.shape.iter().product();
            for numbers in [&recording.first, &recording.second] {
                if numbers.len() != count {
                    let expected = format!("{count}, the product of `shape`");
                    return error("recordings", has(numbers.len(), "number"), expected);
                }
            }
        }
        if let (Some(damping), Some(pairs)) = (&self.joint_damping, &self.pairs)
            && damping.len() != pairs.len()
        {
            let expected = format!("{}, one for each pair", pairs.len());
            return error("joint_damping", has(damping.len(), "number"), expected);
        }
        Ok(())
    }

    /// Whether the simulator is MuJoCo.
    pub(crate) fn is_mujoco(&self) -> bool {
        self.version.as_ref().is_some_and(|version| version.starts_with("MuJoCo"))
    }

    /// The name of state `i` with its unit.
    pub(crate) fn state_name(&self, i: usize) -> String {
        with_unit(&self.states[i])
    }
}

/// The name of a signal with its unit.
pub(crate) fn with_unit(Signal { name, unit }: &Signal) -> String {
    if unit.is_empty() { name.clone() } else { format!("{name} ({unit})") }
}
