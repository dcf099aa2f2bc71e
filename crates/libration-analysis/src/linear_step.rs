//! Steps of one integrator on a linear plant.

use std::sync::OnceLock;

use libration_core::integrator::ImplicitIntegrator;
use libration_core::system::{ImplicitSystem, StageCoefficients, solve_motion, solve_stage_motion};
use libration_core::{AnyMethod, Float, State, System};
use libration_linear::{MOST_STATES, Matrix};

use super::LinearStepper;
use super::factorisation::Factorisation;

/// Half of the most states: the degrees of freedom of the phase space in which plants are stepped.
const HALF: usize = MOST_STATES / 2;

/// Steps of one integrator and one length on a linear plant, in floats of type `S`.
#[derive(Clone, Debug)]
pub struct StepOn<'a, S> {
    stepper: &'a LinearStepper,
    rates: Vec<S>,
    method: AnyMethod,
    dt: S,
    /// The equations that were solved first. A step has up to two different ones.
    equations: [OnceLock<(Vec<S>, Factorisation<S>)>; 2],
}

impl<'a, S: Float> StepOn<'a, S> {
    pub(crate) fn new(stepper: &'a LinearStepper, method: AnyMethod, dt: f64) -> Self {
        StepOn {
            stepper,
            rates: stepper.rates.entries().iter().map(|&x| S::from_f64(x)).collect(),
            method,
            dt: S::from_f64(dt),
            equations: [OnceLock::new(), OnceLock::new()],
        }
    }

    /// One step from the states `x`, each rounded to `S`.
    pub fn step(&self, x: &[f64]) -> Vec<f64> {
        let LinearStepper { order, positions, .. } = self.stepper;
        let mut state = State::<S, HALF>::origin();
        for (place, &i) in order.iter().enumerate() {
            *at_place(&mut state, place, *positions) = S::from_f64(x[i]);
        }
        let mut state = ImplicitIntegrator::step(self.method, self, state, self.dt);
        let mut next = vec![0.0; x.len()];
        for (place, &i) in order.iter().enumerate() {
            next[i] = at_place(&mut state, place, *positions).to_f64();
        }
        next
    }

    /// The matrix of a step, states × states: the step from each unit vector.
    pub fn update_matrix(&self) -> Matrix {
        let n = self.stepper.order.len();
        let unit = |j: usize| (0..n).map(|i| f64::from(u8::from(i == j))).collect::<Vec<f64>>();
        let columns: Vec<Vec<f64>> = (0..n).map(|j| self.step(&unit(j))).collect();
        Matrix::from_fn(n, n, |i, j| columns[j][i])
    }

    /// The same less the identity: of a short step in floats of more bits than `f64` nothing cancels.
    pub fn deviation_matrix(&self) -> Matrix {
        let LinearStepper { order, positions, .. } = self.stepper;
        let n = order.len();
        let mut matrix = Matrix::zeros(n, n);
        for (column, &j) in order.iter().enumerate() {
            let mut state = State::<S, HALF>::origin();
            *at_place(&mut state, column, *positions) = S::one();
            let mut state = ImplicitIntegrator::step(self.method, self, state, self.dt);
            let own = at_place(&mut state, column, *positions);
            *own = *own - S::one();
            for (row, &i) in order.iter().enumerate() {
                matrix[(i, j)] = at_place(&mut state, row, *positions).to_f64();
            }
        }
        matrix
    }

    /// The rates of the places `places` of the phase space.
    fn rates_of(&self, state: &State<S, HALF>, places: core::ops::Range<usize>) -> [S; HALF] {
        let n = self.stepper.order.len();
        let positions = self.stepper.positions;
        let mut rates = [S::zero(); HALF];
        for (rate, row) in rates.iter_mut().zip(places) {
            let row = &self.rates[row * n..(row + 1) * n];
            let (of_q, of_v) = row.split_at(positions);
            let terms = of_q.iter().zip(&state.q).chain(of_v.iter().zip(&state.v));
            *rate = terms.fold(S::zero(), |sum, (&a, &x)| sum + a * x);
        }
        rates
    }
}

/// The coordinate of a place of the phase space.
fn at_place<S>(state: &mut State<S, HALF>, place: usize, positions: usize) -> &mut S {
    if place < positions { &mut state.q[place] } else { &mut state.v[place - positions] }
}

impl<S: Float> System<S, HALF> for StepOn<'_, S> {
    const BASELINE_ONLY: bool = true;

    fn acceleration(&self, state: &State<S, HALF>) -> [S; HALF] {
        self.rates_of(state, self.stepper.positions..self.stepper.order.len())
    }

    fn rate(&self, state: State<S, HALF>) -> State<S, HALF> {
        let q = match self.stepper.is_mechanical {
            true => state.v,
            false => self.rates_of(&state, 0..self.stepper.positions),
        };
        State { q, v: self.acceleration(&state) }
    }
}

impl<S: Float> StepOn<'_, S> {
    /// Solves `x − Cx = right`, where `C` has the entries `change` and is known by its `parts`.
    fn solve(&self, parts: Vec<S>, change: impl Fn(usize, usize) -> S, right: &mut [S]) {
        let n = right.len();
        let new = || {
            let unit = |i: usize, j: usize| if i == j { S::one() } else { S::zero() };
            let places = (0..n).flat_map(|i| (0..n).map(move |j| (i, j)));
            let matrix = places.map(|(i, j)| unit(i, j) - change(i, j)).collect();
            (parts.clone(), Factorisation::new(matrix, n))
        };
        for place in &self.equations {
            let (of, known) = place.get_or_init(new);
            if *of == parts {
                return known.solve(right);
            }
        }
        new().1.solve(right);
    }

    /// The entry of `A`.
    fn entry(&self, i: usize, j: usize) -> S {
        self.rates[i * self.stepper.order.len() + j]
    }

    /// The accelerations of a mechanical plant with implicit springs for `of_q` and implicit dampers for `of_v`.
    fn solve_mechanical(&self, of_q: S, of_v: S, mut right: [S; HALF]) -> [S; HALF] {
        let d = self.stepper.positions;
        let change = |i, j| of_q * self.entry(d + i, j) + of_v * self.entry(d + i, d + j);
        self.solve(vec![S::zero(), of_q, of_v], change, &mut right[..d]);
        right
    }
}

/// Equations are solved with pivots, so that plants of any kind lose no digits: only a step that is recorded or runs in a batch has a
/// fixed order.
impl<S: Float> ImplicitSystem<S, HALF> for StepOn<'_, S> {
    fn acceleration_derivative(&self, _: &State<S, HALF>, direction: &State<S, HALF>) -> [S; HALF] {
        self.acceleration(direction)
    }

    fn solve_damping(&self, _: &State<S, HALF>, h: S, right: [S; HALF]) -> [S; HALF] {
        self.solve_mechanical(S::zero(), h, right)
    }

    fn solve_damping_and_stiffness(&self, _: &State<S, HALF>, h: S, right: [S; HALF]) -> [S; HALF] {
        self.solve_mechanical(h * h, h, right)
    }

    fn solve_rate(&self, at: &State<S, HALF>, h: S, right: State<S, HALF>) -> State<S, HALF> {
        let LinearStepper { positions, is_mechanical, order, .. } = self.stepper;
        if *is_mechanical {
            return solve_motion(self, at, h, right);
        }
        let n = order.len();
        let mut x: Vec<S> = right.q[..*positions].to_vec();
        x.extend(&right.v[..n - positions]);
        self.solve(vec![S::one(), h, h], |i, j| h * self.entry(i, j), &mut x);
        let mut solution = State::origin();
        for (place, x) in x.into_iter().enumerate() {
            *at_place(&mut solution, place, *positions) = x;
        }
        solution
    }

    fn solve_stage_accelerations<const N: usize>(
        &self,
        _: &[State<S, HALF>; N],
        of: StageCoefficients<'_, S, N>,
        mut right: [[S; HALF]; N],
    ) -> [[S; HALF]; N] {
        let d = self.stepper.positions;
        let parts = of.of_q.iter().chain(of.of_v).flatten().copied().collect();
        let change = |row: usize, column: usize| {
            let ((i, row), (k, column)) = ((row / d, row % d), (column / d, column % d));
            of.of_q[i][k] * self.entry(d + row, column)
                + of.of_v[i][k] * self.entry(d + row, d + column)
        };
        let mut x: Vec<S> = right.iter().flat_map(|stage| &stage[..d]).copied().collect();
        self.solve(parts, change, &mut x);
        for (stage, x) in right.iter_mut().zip(x.chunks_exact(d)) {
            stage[..d].copy_from_slice(x);
        }
        right
    }

    fn solve_stages<const N: usize>(
        &self,
        at: &[State<S, HALF>; N],
        h: &[[S; N]; N],
        right: [State<S, HALF>; N],
    ) -> [State<S, HALF>; N] {
        let LinearStepper { positions, is_mechanical, order, .. } = self.stepper;
        if *is_mechanical {
            return solve_stage_motion(self, at, h, right);
        }
        let n = order.len();
        let of_stage =
            |stage: &State<S, HALF>| [&stage.q[..*positions], &stage.v[..n - positions]].concat();
        let mut x: Vec<S> = right.iter().flat_map(of_stage).collect();
        let change =
            |row: usize, column: usize| h[row / n][column / n] * self.entry(row % n, column % n);
        self.solve(h.as_flattened().to_vec(), change, &mut x);
        let mut solution = [State::origin(); N];
        for (place, x) in x.into_iter().enumerate() {
            *at_place(&mut solution[place / n], place % n, *positions) = x;
        }
        solution
    }
}

#[cfg(test)]
mod tests;
