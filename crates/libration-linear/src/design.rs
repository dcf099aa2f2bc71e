//! Design of regulators and observers.

use thiserror::Error;

use crate::{
    DiscreteController, Discretisation, LinearPlant, Matrix, PlantMode, RegulatorProblem,
    RegulatorSolution, StepIntegrals, eigenvalues,
};

/// Error of a design.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum DesignError {
    /// A weight or an intensity has the wrong shape or is not symmetric and positive.
    #[error("`{what}` {why}")]
    Weight {
        /// The name of the matrix.
        what: &'static str,
        /// The error in words.
        why: String,
    },
    /// No feedback stabilises the plant.
    #[error("no feedback stabilises the plant: no input reaches {0}")]
    Unreachable(PlantMode),
    /// No observer sees the plant.
    #[error("no observer estimates the state: no output shows {0}")]
    Unobservable(PlantMode),
    /// The feedback of least cost is not stable.
    #[error(
        "the feedback of least cost does not stabilise {0}, which costs nothing; help: weight one of its states"
    )]
    Unseen(PlantMode),
    /// The Riccati equation was not solved.
    #[error(
        "the Riccati equation of the {0} has no solution that stabilises: in steps of this period a motion is out of reach, \
         or the loop of least cost is too close to the edge of stability"
    )]
    Unsettled(&'static str),
}

/// The weights of a cost rate: the forms of states and of inputs.
#[derive(Clone, Debug, PartialEq)]
pub struct CostWeights {
    /// States × states.
    pub states: Matrix,
    /// Inputs × inputs.
    pub inputs: Matrix,
}

impl CostWeights {
    /// The form of states and inputs.
    pub fn form(&self) -> Matrix {
        let n = self.states.rows();
        let size = n + self.inputs.rows();
        let mut form = Matrix::zeros(size, size);
        form.set_block((0, 0), &self.states);
        form.set_block((n, n), &self.inputs);
        form
    }

    /// Checks shapes, symmetry and signs.
    ///
    /// # Errors
    /// [`DesignError::Weight`].
    pub fn check(&self, plant: &LinearPlant) -> Result<(), DesignError> {
        let (n, m) = (plant.states.len(), plant.inputs.len());
        semidefinite(&self.states, "state weights", n, false)?;
        semidefinite(&self.inputs, "input weights", m, true)
    }
}

/// Whether a matrix is a covariance or a weight of size `n`.
fn semidefinite(
    matrix: &Matrix,
    what: &'static str,
    n: usize,
    definite: bool,
) -> Result<(), DesignError> {
    let wrong = |why: String| Err(DesignError::Weight { what, why });
    let (rows, columns) = (matrix.rows(), matrix.columns());
    if [rows, columns] != [n, n] {
        return wrong(format!("is {rows} × {columns}; expected {n} × {n}"));
    }
    if !matrix.is_finite() {
        return wrong("has an entry that is not finite; expected finite numbers".into());
    }
    let size = matrix.largest();
    let mut off = matrix.transposed();
    off.add_scaled(-1.0, matrix);
    if off.largest() > 1e-9 * size {
        return wrong("is not symmetric; expected a symmetric matrix".into());
    }
    let values = eigenvalues(matrix).unwrap_or_default();
    let least = values.iter().map(|value| value.re).fold(f64::INFINITY, f64::min);
    if definite && least <= 1e-14 * size {
        return wrong(format!("has the eigenvalue {least:e}; expected eigenvalues above 0"));
    }
    if least < -1e-12 * size {
        return wrong(format!("has the eigenvalue {least:e}; expected eigenvalues of at least 0"));
    }
    Ok(())
}

impl LinearPlant {
    /// A step of `period` seconds under held inputs; of a sampled plant its own step.
    pub fn step(&self, period: f64) -> Discretisation {
        match self.sampling_period {
            None => Discretisation::exact(&self.a, &self.b, period),
            Some(_) => Discretisation { phi: self.a.clone(), gamma: self.b.clone() },
        }
    }

    /// The covariance of what the noise adds in a step.
    pub fn step_noise(&self, period: f64) -> Matrix {
        let intensity = self.g.congruence(&Matrix::identity(self.g.columns()));
        if self.sampling_period.is_some() {
            return intensity;
        }
        let size = self.states.len() + self.inputs.len();
        let none = Matrix::zeros(size, size);
        StepIntegrals::new(&self.a, &self.b, &intensity, &none, period).noise
    }

    /// The linear-quadratic regulator with a period of `period` seconds: the gain `K` of `u = −Kx` that minimises the integral of the
    /// cost rate over continuous time, with inputs that act at once and are held. Of a sampled plant the cost is a sum.
    ///
    /// # Errors
    /// [`DesignError`].
    pub fn design_regulator(
        &self,
        weights: &CostWeights,
        period: f64,
    ) -> Result<RegulatorSolution, DesignError> {
        weights.check(self)?;
        let problem = self.regulator_problem(weights, period);
        let hidden = self.unreachable_mode();
        // Doubling loses digits where the cost-to-go has entries of very different sizes; Newton's iteration restores them.
        let solution = problem
            .stabilising(hidden.is_some())
            .map(|solution| problem.improve(solution.gain.clone()).unwrap_or(solution));
        solution.ok_or_else(|| match (hidden, self.mode_without_cost(&weights.states)) {
            (Some(mode), _) => DesignError::Unreachable(mode),
            (None, Some(mode)) => DesignError::Unseen(mode),
            (None, None) => DesignError::Unsettled("regulator"),
        })
    }

    /// The regulator problem in steps of `period` seconds, with the cost rate integrated over each step.
    pub fn regulator_problem(&self, weights: &CostWeights, period: f64) -> RegulatorProblem {
        let Discretisation { phi, gamma } = self.step(period);
        let (n, m) = (self.states.len(), self.inputs.len());
        let cost = match self.sampling_period {
            Some(_) => weights.form(),
            None => {
                let none = Matrix::zeros(n, n);
                StepIntegrals::new(&self.a, &self.b, &none, &weights.form(), period).cost
            }
        };
        RegulatorProblem {
            a: phi,
            b: gamma,
            q: cost.block((0, 0), (n, n)),
            s: cost.block((0, n), (n, m)),
            r: cost.block((n, n), (m, m)),
        }
    }

    /// The stationary Kalman filter with a period of `period` seconds: the gain `L` by which the error of the predicted measurement
    /// corrects the estimate, for measurement noise of covariance `noise` at each sample.
    ///
    /// # Errors
    /// [`DesignError`].
    pub fn design_filter(&self, noise: &Matrix, period: f64) -> Result<Matrix, DesignError> {
        semidefinite(noise, "measurement noise", self.outputs.len(), true)?;
        let Discretisation { phi, .. } = self.step(period);
        // The dual of the regulator: X is the covariance of the predicted state.
        let problem = RegulatorProblem {
            a: phi.transposed(),
            b: self.c.transposed(),
            q: self.step_noise(period),
            s: Matrix::zeros(self.states.len(), self.outputs.len()),
            r: noise.clone(),
        };
        let hidden = self.unobservable_mode();
        let solution = problem.stabilising(hidden.is_some());
        let failed = hidden.map_or(DesignError::Unsettled("filter"), DesignError::Unobservable);
        let covariance = solution.ok_or(failed)?.cost;
        let moved = &self.c * &covariance;
        let innovation = (&moved * &self.c.transposed()).plus(noise);
        let gain = crate::solve_matrix(&innovation, &moved);
        gain.map(|gain| gain.transposed()).ok_or(DesignError::Unsettled("filter"))
    }

    /// The controller `u = −K x̂` with the state estimated by the filter of gain `L`.
    ///
    /// Its memory is the state that it predicts for the next sample and, of a plant with a direct path, the last command:
    /// `x̂ = x̃ + L(y − Cx̃ − Du₋)`, `x̃' = Φx̂ + Γu`.
    pub fn estimated_feedback(
        &self,
        gain: &Matrix,
        filter: &Matrix,
        period: f64,
    ) -> DiscreteController {
        let Discretisation { phi, gamma } = self.step(period);
        let (n, m) = (self.states.len(), self.inputs.len());
        let direct = if self.d.largest() > 0.0 { m } else { 0 };
        // x̂ over the memory and the measurement.
        let mut estimate = Matrix::zeros(n, n + direct);
        let mut kept = Matrix::identity(n);
        kept.add_scaled(-1.0, &(filter * &self.c));
        estimate.set_block((0, 0), &kept);
        if direct > 0 {
            estimate.set_block((0, n), &(filter * &self.d).scaled(-1.0));
        }
        let closed = {
            let mut closed = phi;
            closed.add_scaled(-1.0, &(&gamma * gain));
            closed
        };
        let c = (gain * &estimate).scaled(-1.0);
        let d = (gain * filter).scaled(-1.0);
        let mut a = Matrix::zeros(n + direct, n + direct);
        a.set_block((0, 0), &(&closed * &estimate));
        let mut b = Matrix::zeros(n + direct, self.outputs.len());
        b.set_block((0, 0), &(&closed * filter));
        if direct > 0 {
            a.set_block((n, 0), &c);
            b.set_block((n, 0), &d);
        }
        DiscreteController { a, b, c, d }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn double_integrator() -> LinearPlant {
        let a = Matrix::from_rows(&[[0.0, 1.0], [0.0, 0.0]]).unwrap();
        let b = Matrix::from_rows(&[[0.0], [1.0]]).unwrap();
        LinearPlant::new(a, b, Matrix::identity(2), Matrix::zeros(2, 1)).unwrap()
    }

    #[test]
    fn the_regulator_of_a_plant_is_that_of_continuous_time_as_the_period_vanishes() {
        // Of a double integrator with weights (1, 0) and 1: K = (1, √2), whatever book.
        let weights =
            CostWeights { states: Matrix::diagonal(&[1.0, 0.0]), inputs: Matrix::identity(1) };
        let off = |period: f64| {
            let gain = double_integrator().design_regulator(&weights, period).unwrap().gain;
            (gain[(0, 0)] - 1.0).abs().max((gain[(0, 1)] - 2.0_f64.sqrt()).abs())
        };
        // The error is of first order in the period.
        assert!(off(1e-4) < 1.1e-4 && (off(1e-2) / off(1e-3) - 10.0).abs() < 0.2);
    }

    #[test]
    fn weights_that_cannot_be_and_motions_out_of_reach_are_refused_by_name() {
        let plant = double_integrator();
        let refused = |states: Matrix, inputs: Matrix| {
            let weights = CostWeights { states, inputs };
            plant.design_regulator(&weights, 0.1).unwrap_err().to_string()
        };
        let two = Matrix::identity(2);
        assert!(
            refused(Matrix::identity(3), Matrix::identity(1)).contains("is 3 × 3; expected 2 × 2")
        );
        assert!(refused(two.clone(), Matrix::zeros(1, 1)).contains("eigenvalues above 0"));
        assert!(refused(two.scaled(-1.0), Matrix::identity(1)).contains("of at least 0"));
        let skewed = Matrix::from_rows(&[[1.0, 0.5], [0.0, 1.0]]).unwrap();
        assert!(refused(skewed, Matrix::identity(1)).contains("not symmetric"));
        // A rate alone is weighted: the position drifts.
        let message = refused(Matrix::diagonal(&[0.0, 1.0]), Matrix::identity(1));
        assert!(message.contains("does not stabilise the mode of x1"), "{message}");
        let noise = Matrix::identity(1);
        let rate = LinearPlant {
            c: Matrix::from_rows(&[[0.0, 1.0]]).unwrap(),
            d: Matrix::zeros(1, 1),
            outputs: crate::Signal::numbered("y", 1),
            ..double_integrator()
        };
        let message = rate.design_filter(&noise, 0.1).unwrap_err().to_string();
        assert!(message.contains("no output shows the mode of x1"), "{message}");
    }
}
