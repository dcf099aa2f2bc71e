//! Searches for states of a system at which accelerations are zero.

use libration_equations::Dynamics;
use libration_linear::{Matrix, SingularValues, solve_matrix};

use super::conserved_sums::ConservedSums;
use super::equilibrium::jacobian;

/// Steps of each method.
const MOST_ITERATIONS: usize = 100;

/// Steps of the damped method, which is slow where derivatives vanish, and of the flow.
const MOST_DAMPED: usize = 300;

/// Halvings of a step, or changes of its damping.
const MOST_TRIALS: usize = 40;

/// The part of a coordinate, or of 1 if that is more, whose shift would cause the acceleration that an equilibrium may have left.
const TOLERANCE: f64 = 1e-8;

/// The part of the largest slope that is added where an equilibrium is not alone, such as that of a cart that may stand anywhere.
const DAMPING: f64 = 1e-10;

/// The damping of the damped method at first, and at least. With any in proportion to the residual the method ends quadratically, also at
/// a point of a continuum (J. Fan, Y. Yuan, Computing 74, 2005).
const FIRST_DAMPING: f64 = 1.0;
const LEAST_DAMPING: f64 = 1e-2;

/// The part of the largest singular value below which one does not tell where an equilibrium lies.
const SINGULAR: f64 = 1e-12;

/// The factor by which a step of Newton's method falls short of a root at which several derivatives vanish.
const MULTIPLE: f64 = 10.0;

/// The part of the scale that a step of the flow moves at most.
const FLOW_STEP: f64 = 0.1;

/// A search for an equilibrium from a start.
pub(crate) struct EquilibriumSearch<'a> {
    dynamics: &'a Dynamics,
    unknowns: &'a [usize],
    start: Vec<f64>,
    /// The largest coordinate at the start; 1 if all are zero.
    scale: f64,
    /// Sums of unknowns that keep their values, and these; with a factor that makes them comparable to accelerations.
    sums: Matrix,
    values: Vec<f64>,
}

impl<'a> EquilibriumSearch<'a> {
    pub(crate) fn new(dynamics: &'a Dynamics, start: &[f64], unknowns: &'a [usize]) -> Self {
        let most = unknowns.iter().map(|&i| start[i].abs()).fold(0.0, f64::max);
        EquilibriumSearch {
            dynamics,
            unknowns,
            start: start.to_vec(),
            scale: if most > 0.0 { most } else { 1.0 },
            sums: Matrix::zeros(0, unknowns.len()),
            values: Vec::new(),
        }
    }

    /// The same search from another place, with the larger scale of both.
    pub(crate) fn from(&self, start: &[f64]) -> Self {
        let search = EquilibriumSearch::new(self.dynamics, start, self.unknowns);
        EquilibriumSearch { scale: search.scale.max(self.scale), ..search }
    }

    /// A search among states with the values that conserved sums have at their start; none if no sum has an unknown.
    pub(crate) fn with_sums(mut self, sums: &ConservedSums) -> Option<Self> {
        let slopes = self.slopes_of(&self.jacobian(&self.start));
        let size = Some(slopes.row_sum_norm()).filter(|size| *size > 0.0 && size.is_finite());
        let factor = size.unwrap_or(1.0);
        let rows: Vec<(Vec<f64>, f64)> = sums
            .iter()
            .map(|sum| {
                let weight = |&place: &usize| factor * sum.weight(place);
                (self.unknowns.iter().map(weight).collect(), factor * sum.start)
            })
            .filter(|(row, _): &(Vec<f64>, f64)| row.iter().any(|x| *x != 0.0))
            .collect();
        self.sums = Matrix::from_fn(rows.len(), self.unknowns.len(), |i, j| rows[i].0[j]);
        self.values = rows.into_iter().map(|(_, value)| value).collect();
        (!self.values.is_empty()).then_some(self)
    }

    pub(crate) fn scale(&self) -> f64 {
        self.scale
    }

    pub(crate) fn unknowns(&self) -> &'a [usize] {
        self.unknowns
    }

    pub(crate) fn jacobian(&self, state: &[f64]) -> Matrix {
        jacobian(self.dynamics, state)
    }

    /// The distance from the start.
    pub(crate) fn distance(&self, state: &[f64]) -> f64 {
        let squares = self.unknowns.iter().map(|&i| (state[i] - self.start[i]).powi(2));
        squares.sum::<f64>().sqrt()
    }

    /// The largest absolute acceleration. Where one is not defined, nothing is at rest.
    pub(crate) fn residual(&self, state: &[f64]) -> f64 {
        let size = |x: f64| if x.is_nan() { f64::INFINITY } else { x.abs() };
        self.accelerations(state).into_iter().map(size).fold(0.0, f64::max)
    }

    fn accelerations(&self, state: &[f64]) -> Vec<f64> {
        self.dynamics.accelerations().on::<f64>().run(state).collect()
    }

    /// Accelerations and the excess of sums.
    fn left(&self, state: &[f64]) -> Vec<f64> {
        let mut left = self.accelerations(state);
        let unknowns: Vec<f64> = self.unknowns.iter().map(|&i| state[i]).collect();
        let sums = self.sums.apply(&unknowns);
        left.extend(sums.iter().zip(&self.values).map(|(sum, value)| sum - value));
        left
    }

    /// The derivatives of accelerations and sums by the unknowns, from those by all entries of the state.
    pub(crate) fn slopes_of(&self, jacobian: &Matrix) -> Matrix {
        let d = jacobian.rows();
        Matrix::from_fn(d + self.sums.rows(), self.unknowns.len(), |i, j| {
            if i < d { jacobian[(i, self.unknowns[j])] } else { self.sums[(i - d, j)] }
        })
    }

    fn slopes(&self, state: &[f64]) -> Matrix {
        self.slopes_of(&self.jacobian(state))
    }

    /// Whether no shift of the unknowns by a small part causes what is left.
    pub(crate) fn rests(&self, state: &[f64]) -> bool {
        let (left, slopes) = (self.left(state), self.slopes(state));
        let shift = |i: usize| -> f64 {
            let terms = self.unknowns.iter().enumerate();
            terms.map(|(j, &place)| slopes[(i, j)].abs() * state[place].abs().max(1.0)).sum()
        };
        (0..left.len()).all(|i| left[i].abs() <= TOLERANCE * shift(i))
    }

    /// The end of Newton's method, whose steps are halved until they improve.
    pub(crate) fn newton(&self, start: &[f64]) -> Vec<f64> {
        let mut state = start.to_vec();
        let mut size = self.residual(&state);
        for _ in 0..MOST_ITERATIONS {
            let Some(step) = newton_step(&self.slopes(&state), &self.left(&state)) else { break };
            let improved = (0..MOST_TRIALS).find_map(|halvings| {
                let tried = self.moved(&state, &step, 0.5_f64.powi(halvings as i32));
                let own = self.residual(&tried);
                (own < size).then_some((tried, own))
            });
            let Some(better) = improved else { break };
            (state, size) = better;
        }
        state
    }

    /// The end of the method of Levenberg and Marquardt: its steps are the shortest that help, so it ends at a near point of a continuum,
    /// and does not follow directions in which almost nothing changes.
    pub(crate) fn damped(&self, start: &[f64]) -> Vec<f64> {
        let scale = self.scale();
        let norm = |x: &[f64]| x.iter().map(|x| x * x).sum::<f64>().sqrt();
        let mut state = start.to_vec();
        let mut left = self.left(&state);
        let mut damping = FIRST_DAMPING;
        for _ in 0..MOST_DAMPED {
            let slopes = self.slopes(&state);
            let size = norm(&left);
            let Some(values) = SingularValues::of(&slopes) else { break };
            let most = values.values.first().copied().unwrap_or(0.0);
            if !(size > 0.0 && size.is_finite() && most > 0.0) {
                break;
            }
            let along = values.left.transposed().apply(&left);
            let mut improved = None;
            for _ in 0..MOST_TRIALS {
                let added = damping * most * size / scale;
                let part = |k: usize| {
                    let value = values.values[k];
                    -value * along[k] / (value * value + added)
                };
                let parts: Vec<f64> = (0..along.len()).map(part).collect();
                let tried = self.moved(&state, &values.right.apply(&parts), 1.0);
                let rest = self.left(&tried);
                let change = size - norm(&rest);
                let expected = size - norm(&linear(&slopes, &values.right.apply(&parts), &left));
                if change > 0.0 {
                    if change > 0.75 * expected {
                        damping = (damping / 4.0).max(LEAST_DAMPING);
                    } else if change < 0.25 * expected {
                        damping *= 4.0;
                    }
                    improved = Some((tried, rest));
                    break;
                }
                damping *= 4.0;
            }
            let Some((better, rest)) = improved else { break };
            (state, left) = (better, rest);
        }
        state
    }

    /// Where the start ends whose velocities are always taken away: along `ẋ = a(x, 0)`, in implicit steps that grow as the motion fades
    /// (C. T. Kelley, D. E. Keyes, SIAM Journal on Numerical Analysis 35, 1998). They keep linear sums.
    pub(crate) fn flow(&self) -> Vec<f64> {
        let n = self.unknowns.len();
        let d = self.dynamics.degrees();
        let mut state = self.start.clone();
        let rates =
            |all: &[f64]| -> Vec<f64> { self.unknowns.iter().map(|p| all[p % d]).collect() };
        let mut time = f64::NAN;
        for _ in 0..MOST_DAMPED {
            let all = self.jacobian(&state);
            let own = Matrix::from_fn(n, n, |i, j| all[(self.unknowns[i] % d, self.unknowns[j])]);
            let size = own.row_sum_norm();
            if !(size > 0.0 && size.is_finite()) {
                break;
            }
            if time.is_nan() {
                time = FLOW_STEP / size;
            }
            let right = rates(&self.accelerations(&state));
            let right = Matrix::from_fn(n, 1, |i, _| right[i]);
            let most =
                FLOW_STEP * self.unknowns.iter().fold(self.scale(), |a, &i| a.max(state[i].abs()));
            let step = (0..4 * MOST_TRIALS).find_map(|_| {
                let matrix = Matrix::identity(n).scaled(time.recip()).plus(&own.scaled(-1.0));
                let step = solve_matrix(&matrix, &right);
                let step = step.filter(|step| step.is_finite() && step.largest() <= most);
                if step.is_none() {
                    time *= 0.5;
                }
                step
            });
            let Some(step) = step else { break };
            if step.largest() < 0.3 * most {
                time = (2.0 * time).min(1e12 / size);
            }
            let step: Vec<f64> = (0..n).map(|i| step[(i, 0)]).collect();
            let next = self.moved(&state, &step, 1.0);
            if next == state || !self.residual(&next).is_finite() {
                break;
            }
            state = next;
        }
        state
    }

    /// The distance from an end of the search within which the equilibrium lies.
    pub(crate) fn uncertainty(&self, state: &[f64]) -> f64 {
        let size = self.unknowns.iter().map(|&i| state[i].abs()).fold(0.0, f64::max);
        let rounding = 2.0 * f64::EPSILON * size;
        let Some(values) = SingularValues::of(&self.slopes(state)) else { return rounding };
        let along = values.left.transposed().apply(&self.left(state));
        let known = values.rank(SINGULAR);
        let squares = (0..known).map(|k| (along[k] / values.values[k]).powi(2));
        MULTIPLE * squares.sum::<f64>().sqrt() + rounding
    }

    fn moved(&self, state: &[f64], step: &[f64], factor: f64) -> Vec<f64> {
        let mut moved = state.to_vec();
        self.unknowns.iter().zip(step).for_each(|(&place, step)| moved[place] += factor * step);
        moved
    }
}

/// What is left after a step where the slopes hold.
fn linear(slopes: &Matrix, step: &[f64], left: &[f64]) -> Vec<f64> {
    slopes.apply(step).iter().zip(left).map(|(change, left)| change + left).collect()
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
