//! Tables of weights, and of variances.

use libration::linear::{CostWeights, LinearPlant, Matrix};
use serde::Deserialize;

use super::plant_table::{Rows, matrix};
use crate::{Fault, Number};

/// Weights of a regulator: matrices, or their diagonals. Those of states and outputs add up.
#[derive(Clone, Debug, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct WeightsTable {
    /// Of the states.
    pub states: Option<Weights>,
    /// Of the outputs.
    pub outputs: Option<Weights>,
    /// Of the inputs.
    pub inputs: Weights,
}

impl WeightsTable {
    /// The weights of states and inputs of a plant. The keys are those of states, outputs and inputs.
    ///
    /// # Errors
    /// [`Fault`]: weights that do not fit, none of states and outputs, or weights of outputs that show the inputs.
    pub fn cost(
        &self,
        [states, outputs, inputs]: [&'static str; 3],
        plant: &LinearPlant,
    ) -> Result<CostWeights, Fault> {
        let [n, m, p] = [&plant.states, &plant.inputs, &plant.outputs].map(Vec::len);
        let of_states = self.states.as_ref().map(|own| own.matrix(states, "states", n));
        let of_outputs = self.outputs.as_ref().map(|own| own.matrix(outputs, "outputs", p));
        let inputs = self.inputs.matrix(inputs, "inputs", m)?;
        let (of_states, of_outputs) = (of_states.transpose()?, of_outputs.transpose()?);
        let Some(of_outputs) = of_outputs else {
            let missing = "there are no weights of `states` or `outputs`; expected one of them";
            let states = of_states.ok_or_else(|| Fault::new(states, missing))?;
            return Ok(CostWeights { states, inputs });
        };
        if [of_outputs.rows(), of_outputs.columns()] != [p; 2] {
            let (rows, columns) = (of_outputs.rows(), of_outputs.columns());
            let message = format!("`outputs` is {rows} × {columns}; expected {p} × {p}");
            return Err(Fault::new(outputs, message));
        }
        if let Some(own) = of_states.as_ref().filter(|own| [own.rows(), own.columns()] != [n; 2]) {
            let message =
                format!("`states` is {} × {}; expected {n} × {n}", own.rows(), own.columns());
            return Err(Fault::new(states, message));
        }
        if plant.d.largest() > 0.0 {
            let message = "`outputs` are weighted, but inputs act on them directly (`d`); expected weights of `states`";
            return Err(Fault::new(outputs, message));
        }
        let mut form = plant.c.transposed().congruence(&of_outputs);
        if let Some(states) = of_states {
            form.add_scaled(1.0, &states);
        }
        Ok(CostWeights { states: form, inputs })
    }
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
