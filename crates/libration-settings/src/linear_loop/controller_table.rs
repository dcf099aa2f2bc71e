//! Tables of controllers of linear plants.

use libration::linear::{
    ClockedController, ControllerSchedule, CostWeights, DesignError, DiscreteController,
    LinearPlant, Matrix,
};
use serde::Deserialize;

use super::cascade_table::{CascadeTable, Cascaded};
use super::pid_table::{PidTable, pid};
use super::plant_table::{Rows, matrix};
use crate::{Fault, Number};

/// A controller: one of the tables `[controller.…]`.
#[derive(Clone, Debug, Deserialize, PartialEq)]
#[serde(rename_all = "kebab-case")]
pub enum LinearControllerTable {
    /// `u = −K x` with the gain `K`, inputs × states.
    StateFeedback(StateFeedbackTable),
    /// The linear-quadratic regulator of the state.
    Lqr(WeightsTable),
    /// The regulator of a state that a Kalman filter estimates from the outputs.
    Lqg(LqgTable),
    /// `m' = A m + B y` and `u = C m + D y`.
    StateSpace(StateSpaceTable),
    /// PID controllers, each from an output to an input.
    Pid(Vec<PidTable>),
    /// An inner controller whose references an outer one computes.
    Cascade(Box<CascadeTable>),
}

/// State feedback.
#[derive(Clone, Debug, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct StateFeedbackTable {
    /// The gain, inputs × states.
    pub gain: Rows,
}

/// Weights of a regulator: a matrix, or its diagonal.
#[derive(Clone, Debug, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct WeightsTable {
    /// Of the states.
    pub states: Weights,
    /// Of the inputs.
    pub inputs: Weights,
}

/// Weights of a regulator and noise of the measurements.
#[derive(Clone, Debug, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct LqgTable {
    states: Weights,
    inputs: Weights,
    /// The covariance of the noise of a sample, or its diagonal.
    measurement: Weights,
}

/// A controller in state space.
#[derive(Clone, Debug, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct StateSpaceTable {
    #[serde(default)]
    a: Rows,
    #[serde(default)]
    b: Rows,
    #[serde(default)]
    c: Rows,
    d: Rows,
}

/// A symmetric matrix, or its diagonal.
#[derive(Clone, Debug, Deserialize, PartialEq)]
#[serde(untagged)]
pub enum Weights {
    /// The diagonal.
    Diagonal(Vec<Number>),
    /// All rows.
    Matrix(Rows),
}

impl Weights {
    /// The matrix.
    ///
    /// # Errors
    /// [`Fault`]: rows of different lengths.
    pub fn matrix(&self, key: &'static str) -> Result<Matrix, Fault> {
        match self {
            Weights::Diagonal(entries) => {
                Ok(Matrix::diagonal(&entries.iter().map(|x| x.0).collect::<Vec<_>>()))
            }
            Weights::Matrix(rows) => matrix(key, rows),
        }
    }
}

/// A controller and what its design knows.
#[derive(Clone, Debug)]
pub struct Design {
    /// The plant with the outputs that the controller measures.
    pub plant: LinearPlant,
    /// The controller, or the schedule of a cascade.
    pub controllers: ControllerSchedule,
    /// The controller with a measured clock; none if it uses no time, and of a cascade.
    pub clocked: Option<ClockedController>,
    /// The rates and references of a cascade.
    pub cascade: Option<Cascaded>,
    /// The weights of the design.
    pub weights: Option<CostWeights>,
    /// The gain of the state or its estimate.
    pub gain: Option<Matrix>,
    /// The gain of the estimator.
    pub filter: Option<Matrix>,
    /// The variances of the measurements.
    pub measurement: Vec<f64>,
    /// The controller in words.
    pub description: String,
}

impl LinearControllerTable {
    /// The controller of `plant` with a period of `period` seconds. Feedback of the state measures all states, the others measure the
    /// outputs.
    ///
    /// # Errors
    /// [`Fault`]: matrices that do not fit, or a design that fails.
    pub fn design(&self, plant: &LinearPlant, period: f64) -> Result<Design, Fault> {
        match self {
            LinearControllerTable::StateFeedback(table) => {
                let gain = matrix("controller.state-feedback.gain", &table.gain)?;
                let shape = [plant.inputs.len(), plant.states.len()];
                if [gain.rows(), gain.columns()] != shape {
                    let [m, n] = shape;
                    let message = format!(
                        "`gain` is {} × {}; expected {m} × {n}: inputs × states",
                        gain.rows(),
                        gain.columns()
                    );
                    return Err(Fault::new("controller.state-feedback.gain", message));
                }
                Ok(state_feedback(plant, gain, None, "state feedback"))
            }
            LinearControllerTable::Lqr(WeightsTable { states, inputs }) => {
                let weights = CostWeights {
                    states: states.matrix("controller.lqr.states")?,
                    inputs: inputs.matrix("controller.lqr.inputs")?,
                };
                let solution = plant.design_regulator(&weights, period);
                let gain = solution.map_err(|error| design_fault("controller.lqr", &error))?.gain;
                Ok(state_feedback(plant, gain, Some(weights), "LQR, designed"))
            }
            LinearControllerTable::Lqg(LqgTable { states, inputs, measurement }) => {
                let weights = CostWeights {
                    states: states.matrix("controller.lqg.states")?,
                    inputs: inputs.matrix("controller.lqg.inputs")?,
                };
                let noise = measurement.matrix("controller.lqg.measurement")?;
                let wrong = |error: DesignError| design_fault("controller.lqg", &error);
                let gain = plant.design_regulator(&weights, period).map_err(wrong)?.gain;
                let filter = plant.design_filter(&noise, period).map_err(wrong)?;
                let of_length = {
                    let (plant, gain, filter) = (plant.clone(), gain.clone(), filter.clone());
                    move |seconds| plant.timed_feedback(&gain, &filter, seconds)
                };
                Ok(Design {
                    plant: plant.clone(),
                    controllers: plant.estimated_feedback(&gain, &filter, period).into(),
                    clocked: Some(ClockedController::new(period, of_length)),
                    cascade: None,
                    weights: Some(weights),
                    gain: Some(gain),
                    filter: Some(filter),
                    measurement: (0..noise.rows()).map(|j| noise[(j, j)]).collect(),
                    description:
                        "LQG, designed: a regulator of a state that a Kalman filter estimates"
                            .into(),
                })
            }
            LinearControllerTable::StateSpace(table) => table.design(plant),
            LinearControllerTable::Pid(tables) => pid(tables, plant, period),
            LinearControllerTable::Cascade(table) => table.design(plant, period),
        }
    }
}

fn state_feedback(
    plant: &LinearPlant,
    gain: Matrix,
    weights: Option<CostWeights>,
    kind: &str,
) -> Design {
    Design {
        plant: plant.clone().with_all_states_measured(),
        controllers: DiscreteController::gain(gain.scaled(-1.0)).into(),
        clocked: None,
        cascade: None,
        weights,
        gain: Some(gain),
        filter: None,
        measurement: vec![0.0; plant.states.len()],
        description: kind.to_owned(),
    }
}

impl StateSpaceTable {
    fn design(&self, plant: &LinearPlant) -> Result<Design, Fault> {
        let key = |name: &str| match name {
            "a" => "controller.state-space.a",
            "b" => "controller.state-space.b",
            "c" => "controller.state-space.c",
            _ => "controller.state-space.d",
        };
        let shape = [plant.inputs.len(), plant.outputs.len()];
        let controller = self.controller(key, shape, ["inputs", "outputs"])?;
        let memory = self.a.len();
        Ok(by_outputs(plant, controller.into(), format!("a controller of {memory} states")))
    }

    /// The number of its commands.
    pub(super) fn commands(&self) -> usize {
        self.d.len()
    }

    /// The controller of so many commands and measurements, which are the `sides`. `key` has the key of a matrix.
    pub(super) fn controller(
        &self,
        key: impl Fn(&str) -> &'static str,
        [commands, measurements]: [usize; 2],
        [to, from]: [&str; 2],
    ) -> Result<DiscreteController, Fault> {
        let of = |name: &str, rows: &Rows, shape: [usize; 2], side: String| {
            let found = match rows.is_empty() {
                true => Matrix::zeros(shape[0], shape[1]),
                false => matrix(key(name), rows)?,
            };
            match [found.rows(), found.columns()] == shape {
                true => Ok(found),
                false => {
                    let (rows, columns) = (found.rows(), found.columns());
                    let [wanted, of_each] = shape;
                    let message = format!(
                        "`{name}` is {rows} × {columns}; expected {wanted} × {of_each}: {side}"
                    );
                    Err(Fault::new(key(name), message))
                }
            }
        };
        let memory = self.a.len();
        Ok(DiscreteController {
            a: of("a", &self.a, [memory; 2], "memory × memory".into())?,
            b: of("b", &self.b, [memory, measurements], format!("memory × {from}"))?,
            c: of("c", &self.c, [commands, memory], format!("{to} × memory"))?,
            d: of("d", &self.d, [commands, measurements], format!("{to} × {from}"))?,
        })
    }
}

pub(super) fn by_outputs(
    plant: &LinearPlant,
    controllers: ControllerSchedule,
    description: String,
) -> Design {
    Design {
        plant: plant.clone(),
        controllers,
        clocked: None,
        cascade: None,
        weights: None,
        gain: None,
        filter: None,
        measurement: vec![0.0; plant.outputs.len()],
        description,
    }
}

fn design_fault(table: &'static str, error: &DesignError) -> Fault {
    let key = match (table, error) {
        ("controller.lqr", DesignError::Weight { what: "state weights", .. }) => {
            "controller.lqr.states"
        }
        ("controller.lqr", DesignError::Weight { .. }) => "controller.lqr.inputs",
        (_, DesignError::Weight { what: "state weights", .. }) => "controller.lqg.states",
        (_, DesignError::Weight { what: "measurement noise", .. }) => "controller.lqg.measurement",
        (_, DesignError::Weight { .. }) => "controller.lqg.inputs",
        _ => table,
    };
    Fault::new(key, error.to_string())
}
