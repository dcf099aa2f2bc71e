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
use super::weights_table::{Weights, WeightsTable};
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

/// Weights of a regulator and noise of the measurements.
#[derive(Clone, Debug, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct LqgTable {
    states: Option<Weights>,
    outputs: Option<Weights>,
    inputs: Weights,
    /// The variances of the noise of a sample.
    measurement: Weights,
}

const LQR_KEYS: [&str; 3] =
    ["controller.lqr.states", "controller.lqr.outputs", "controller.lqr.inputs"];
const LQG_KEYS: [&str; 3] =
    ["controller.lqg.states", "controller.lqg.outputs", "controller.lqg.inputs"];

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
            LinearControllerTable::Lqr(weights) => {
                let weights = weights.cost(LQR_KEYS, plant)?;
                let solution = plant.design_regulator(&weights, period);
                let gain = solution.map_err(|error| design_fault("controller.lqr", &error))?.gain;
                Ok(state_feedback(plant, gain, Some(weights), "LQR, designed"))
            }
            LinearControllerTable::Lqg(LqgTable { states, outputs, inputs, measurement }) => {
                let [states, outputs] = [states.clone(), outputs.clone()];
                let weights = WeightsTable { states, outputs, inputs: inputs.clone() };
                let weights = weights.cost(LQG_KEYS, plant)?;
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
