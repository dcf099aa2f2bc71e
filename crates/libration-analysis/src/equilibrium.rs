//! Equilibria of systems that are known when the program runs.

use libration_core::number::Dual;
use libration_equations::Dynamics;
use libration_linear::{Matrix, solve_matrix};

/// Steps of Newton's method.
const MOST_ITERATIONS: usize = 100;

/// The part of a coordinate, or of 1 if that is more, whose shift would cause the acceleration that an equilibrium may have left.
const TOLERANCE: f64 = 1e-8;

/// The part of the largest slope that is added where an equilibrium is not alone, such as that of a cart that may stand anywhere.
const DAMPING: f64 = 1e-10;

/// A state at which the accelerations are zero.
#[derive(Clone, Debug, PartialEq)]
pub struct Equilibrium {
    /// Positions, velocities and inputs.
    pub state: Vec<f64>,
    /// The largest absolute acceleration there.
    pub residual: f64,
    /// The derivatives of the accelerations there: degrees of freedom × (positions, velocities and inputs).
    pub jacobian: Matrix,
}

impl Equilibrium {
    /// The equilibrium at which Newton's method ends that begins at `start`: positions, velocities and inputs. It changes the
    /// entries in `unknowns`; its steps are halved until they improve. Derivatives are exact.
    ///
    /// # Errors
    /// The last state, if no shift of the unknowns by 10⁻⁸ of the larger of 1 and their values causes the acceleration that is
    /// left.
    pub fn near(
        dynamics: &Dynamics,
        start: &[f64],
        unknowns: &[usize],
    ) -> Result<Equilibrium, Equilibrium> {
        let mut accelerations = dynamics.accelerations().on::<f64>();
        let mut left = |state: &[f64]| -> Vec<f64> { accelerations.run(state).collect() };
        // Where an acceleration is not defined, nothing is at rest.
        let size = |x: &f64| if x.is_nan() { f64::INFINITY } else { x.abs() };
        let largest = |rest: &[f64]| rest.iter().map(size).fold(0.0, f64::max);
        let mut state = start.to_vec();
        let mut rest = left(&state);
        for _ in 0..MOST_ITERATIONS {
            let all = jacobian(dynamics, &state);
            let slopes = Matrix::from_fn(rest.len(), unknowns.len(), |i, j| all[(i, unknowns[j])]);
            let Some(step) = newton_step(&slopes, &rest) else { break };
            let size = largest(&rest);
            let improved = (0..40).find_map(|halvings| {
                let factor = 0.5_f64.powi(halvings);
                let mut tried = state.clone();
                unknowns.iter().zip(&step).for_each(|(&j, step)| tried[j] += factor * step);
                let rest = left(&tried);
                (largest(&rest) < size).then_some((tried, rest))
            });
            let Some(better) = improved else { break };
            (state, rest) = better;
        }
        let jacobian = jacobian(dynamics, &state);
        let shift = |i: usize| -> f64 {
            unknowns.iter().map(|&j| jacobian[(i, j)].abs() * state[j].abs().max(1.0)).sum()
        };
        let rests = (0..rest.len()).all(|i| rest[i].abs() <= TOLERANCE * shift(i));
        let found = Equilibrium { state, residual: largest(&rest), jacobian };
        if rests { Ok(found) } else { Err(found) }
    }
}

/// The derivatives of the accelerations by positions, velocities and inputs, exact to rounding: degrees of freedom × inputs of the
/// program.
pub fn jacobian(dynamics: &Dynamics, at: &[f64]) -> Matrix {
    let mut accelerations = dynamics.accelerations().on::<Dual<f64>>();
    let mut jacobian = Matrix::zeros(dynamics.degrees(), at.len());
    let mut inputs: Vec<Dual<f64>> = at.iter().map(|&x| Dual::constant(x)).collect();
    for j in 0..at.len() {
        inputs[j] = Dual::variable(at[j]);
        for (i, acceleration) in accelerations.run(&inputs).enumerate() {
            jacobian[(i, j)] = acceleration.du;
        }
        inputs[j] = Dual::constant(at[j]);
    }
    jacobian
}

/// The derivative of the rate of coordinate `row` of positions and velocities by entry `column` of positions, velocities and inputs,
/// from the derivatives of the accelerations.
pub fn rate_derivative(jacobian: &Matrix, row: usize, column: usize) -> f64 {
    let degrees = jacobian.rows();
    match row.checked_sub(degrees) {
        Some(row) => jacobian[(row, column)],
        // The rate of a position is its velocity.
        None => f64::from(u8::from(column == row + degrees)),
    }
}

/// The step that makes `rest` zero where it is linear; the shortest where there are many, to the damping.
fn newton_step(slopes: &Matrix, rest: &[f64]) -> Option<Vec<f64>> {
    let right = Matrix::from_fn(rest.len(), 1, |i, _| -rest[i]);
    let (rows, columns) = (slopes.rows(), slopes.columns());
    let alone = if rows == columns { solve_matrix(slopes, &right) } else { None };
    let step = match alone {
        Some(step) => step,
        None => {
            let transposed = slopes.transposed();
            let mut normal = &transposed * slopes;
            let most = (0..columns).map(|i| normal[(i, i)]).fold(0.0, f64::max);
            (0..columns).for_each(|i| normal[(i, i)] += DAMPING * most);
            solve_matrix(&normal, &(&transposed * &right))?
        }
    };
    let step: Vec<f64> = (0..columns).map(|i| step[(i, 0)]).collect();
    step.iter().all(|x| x.is_finite()).then_some(step)
}
