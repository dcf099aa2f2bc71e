//! Tables of controllers of linear plants.

use libration::linear::{
    ClockedController, CostWeights, DesignError, DiscreteController, LinearPlant, Matrix,
};
use serde::Deserialize;

use super::cascade_table::CascadeTable;
use super::design::Design;
use super::pid_table::{PidTable, pid};
use super::plant_table::{Rows, matrix};
use super::state_space_table::StateSpaceTable;
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
    /// The variances of the noise of a sample.
    measurement: Weights,
}

/// A symmetric matrix, or its diagonal.
#[derive(Clone, Debug, Deserialize, PartialEq)]
#[serde(untagged, expecting = "expected a list of numbers (the diagonal), or the rows of a matrix")]
pub enum Weights {
    /// The diagonal.
    Diagonal(Vec<Number>),
    /// All rows.
    Matrix(Rows),
}

impl Weights {
    /// The matrix; a diagonal has a number for each of `count` signals, which are `of`.
    ///
    /// # Errors
    /// [`Fault`]: a diagonal of another length, or rows of different lengths.
    pub fn matrix(&self, key: &'static str, of: &str, count: usize) -> Result<Matrix, Fault> {
        match self {
            Weights::Diagonal(entries) if entries.len() != count => {
                let (name, given) = (key.rsplit('.').next().unwrap_or(key), entries.len());
                let message = format!(
                    "`{name}` has {given} numbers; expected {count}, one for each of the {of}"
                );
                Err(Fault::new(key, message))
            }
            Weights::Diagonal(entries) => {
                Ok(Matrix::diagonal(&entries.iter().map(|x| x.0).collect::<Vec<_>>()))
            }
            Weights::Matrix(rows) => matrix(key, rows),
        }
    }
}

impl Weights {
    /// The variances of `count` noises that are independent of each other, one of each of the signals, which are `of`.
    ///
    /// # Errors
    /// [`Fault`]: as for [`Weights::matrix`], entries beside the diagonal, or a negative variance.
    pub fn variances(&self, key: &'static str, of: &str, count: usize) -> Result<Vec<f64>, Fault> {
        let covariance = self.matrix(key, of, count)?;
        let name = key.rsplit('.').next().unwrap_or(key);
        if [covariance.rows(), covariance.columns()] != [count; 2] {
            let (rows, columns) = (covariance.rows(), covariance.columns());
            let message = format!("`{name}` is {rows} × {columns}; expected {count} × {count}");
            return Err(Fault::new(key, message));
        }
        let variances: Vec<f64> = (0..count).map(|j| covariance[(j, j)]).collect();
        if covariance != Matrix::diagonal(&variances) {
            let message = format!(
                "`{name}` has entries beside its diagonal; expected variances of independent noises, one for each of the {of}"
            );
            return Err(Fault::new(key, message));
        }
        match variances.iter().position(|x| !(x.is_finite() && *x >= 0.0)) {
            None => Ok(variances),
            Some(j) => {
                let message = format!(
                    "`{name}` is {:?}; expected a finite variance of at least 0",
                    variances[j]
                );
                Err(Fault::at(key, j, message))
            }
        }
    }
}

impl LinearControllerTable {
    /// No controller: measurements without effect, and commands of zero.
    pub fn open_loop(plant: &LinearPlant) -> Self {
        let d = vec![vec![Number(0.0); plant.outputs.len()]; plant.inputs.len()];
        LinearControllerTable::StateSpace(StateSpaceTable::of_gain(d))
    }

    /// The controller of `plant` with a period of `period` seconds. Feedback of the state measures all states, the others measure the
    /// outputs.
    ///
    /// # Errors
    /// [`Fault`]: matrices that do not fit, or a design that fails.
    pub fn design(&self, plant: &LinearPlant, period: f64) -> Result<Design, Fault> {
        let [n, m, p] = [&plant.states, &plant.inputs, &plant.outputs].map(Vec::len);
        match self {
            LinearControllerTable::StateFeedback(table) => {
                let gain = matrix("controller.state-feedback.gain", &table.gain)?;
                if [gain.rows(), gain.columns()] != [m, n] {
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
                    states: states.matrix("controller.lqr.states", "states", n)?,
                    inputs: inputs.matrix("controller.lqr.inputs", "inputs", m)?,
                };
                let solution = plant.design_regulator(&weights, period);
                let gain = solution.map_err(|error| design_fault("controller.lqr", &error))?.gain;
                Ok(state_feedback(plant, gain, Some(weights), "LQR, designed"))
            }
            LinearControllerTable::Lqg(LqgTable { states, inputs, measurement }) => {
                let weights = CostWeights {
                    states: states.matrix("controller.lqg.states", "states", n)?,
                    inputs: inputs.matrix("controller.lqg.inputs", "inputs", m)?,
                };
                let variances =
                    measurement.variances("controller.lqg.measurement", "outputs", p)?;
                let noise = Matrix::diagonal(&variances);
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
                    measurement: variances,
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
    // Its C would be read as that of the controller.
    let ignores_outputs =
        plant.c != Matrix::identity(plant.states.len()) || plant.d.largest() > 0.0;
    let description = match ignores_outputs {
        true => format!("{kind}; it measures the states, not the outputs of the plant"),
        false => kind.to_owned(),
    };
    Design {
        plant: plant.clone().with_all_states_measured(),
        controllers: DiscreteController::gain(gain.scaled(-1.0)).into(),
        clocked: None,
        cascade: None,
        weights,
        gain: Some(gain),
        filter: None,
        measurement: vec![0.0; plant.states.len()],
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
