//! Rates of the state at any point, from steps that get shorter and shorter.

use core::cell::RefCell;

use libration::linear::{MOST_STATES, Matrix, solve_matrix};
use libration::system::{ImplicitSystem, StageCoefficients};
use libration::{State, System};

use crate::BlackBoxError;
use crate::differences::{Jacobian, jacobian};
use crate::flow::limit_of_halved;
use crate::prober::{Prober, row};

/// Half of the most states: the degrees of freedom in which integrators step.
pub(crate) const HALF: usize = MOST_STATES / 2;
/// The longest step is the subject's over 2 to this power.
const FIRST: i32 = 3;
/// Steps from which a rate is extrapolated.
const LEVELS: i32 = 6;

type Point = State<f64, HALF>;

/// A black box as a system of equations that integrators step: its rates are the limit of `(step(x, h) − x)/h`.
pub(crate) struct NumericalSystem<'p, 'b> {
    prober: RefCell<&'p mut Prober<'b>>,
    /// Positions and velocities; none: all states are of first order.
    pairs: Option<Vec<(usize, usize)>>,
    outcome: RefCell<Outcome>,
    /// The first point at which derivatives were taken: each implicit method begins with it.
    start: RefCell<Option<(Vec<f64>, Jacobian)>>,
}

/// The largest estimated error of a rate in units of the scales, or the failure of the simulator.
#[derive(Default)]
struct Outcome {
    error: f64,
    failure: Option<BlackBoxError>,
}

impl<'p, 'b> NumericalSystem<'p, 'b> {
    pub(crate) fn new(prober: &'p mut Prober<'b>, pairs: Option<Vec<(usize, usize)>>) -> Self {
        NumericalSystem {
            prober: RefCell::new(prober),
            pairs,
            outcome: RefCell::default(),
            start: RefCell::default(),
        }
    }

    /// The largest error of a rate since the last call, or the failure of the simulator.
    pub(crate) fn take_error(&self) -> Result<f64, BlackBoxError> {
        let outcome = self.outcome.take();
        outcome.failure.map_or(Ok(outcome.error), Err)
    }

    /// The states as a point of phase space.
    pub(crate) fn point(&self, x: &[f64]) -> Point {
        let mut state = State::origin();
        for (place, (q, v)) in self.places(x.len()).into_iter().enumerate() {
            state.q[place] = x[q];
            if let Some(v) = v {
                state.v[place] = x[v];
            }
        }
        state
    }

    /// The point of phase space as states.
    pub(crate) fn values(&self, state: &Point, count: usize) -> Vec<f64> {
        let mut x = vec![0.0; count];
        for (place, (q, v)) in self.places(count).into_iter().enumerate() {
            x[q] = state.q[place];
            if let Some(v) = v {
                x[v] = state.v[place];
            }
        }
        x
    }

    /// The states at each place of phase space. States of first order fill the positions, then the velocities.
    fn places(&self, count: usize) -> Vec<(usize, Option<usize>)> {
        match &self.pairs {
            Some(pairs) => pairs.iter().map(|&(q, v)| (q, Some(v))).collect(),
            None => {
                let half = count.div_ceil(2);
                (0..half).map(|i| (i, Some(half + i).filter(|v| *v < count))).collect()
            }
        }
    }

    fn count(&self) -> usize {
        self.prober.borrow().subject.state.len()
    }

    fn rates_at(&self, state: &Point) -> Point {
        let x = self.values(state, self.count());
        let found = rates(&mut self.prober.borrow_mut(), &row(&x));
        match found {
            Ok((rates, error)) => {
                self.note(error);
                self.point(rates.row(0))
            }
            Err(failure) => {
                self.outcome.borrow_mut().failure.get_or_insert(failure);
                State { q: [f64::NAN; HALF], v: [f64::NAN; HALF] }
            }
        }
    }

    fn note(&self, error: f64) {
        let mut outcome = self.outcome.borrow_mut();
        outcome.error = outcome.error.max(error);
    }

    /// The derivatives of the rates at `at` along all states, states × states, and their errors.
    fn derivatives(&self, at: &Point) -> Option<Jacobian> {
        let x = self.values(at, self.count());
        let known = self.start.borrow();
        if let Some((_, found)) = known.as_ref().filter(|(start, _)| *start == x) {
            return Some(found.clone());
        }
        drop(known);
        let mut prober = self.prober.borrow_mut();
        let scale = prober.subject.state_scale.clone();
        let found =
            jacobian(|points| rates(&mut prober, points).map(|found| found.0), &x, &scale, 0.0);
        match found {
            Ok(found) => {
                self.start.borrow_mut().get_or_insert_with(|| (x, found.clone()));
                Some(found)
            }
            Err(failure) => {
                self.outcome.borrow_mut().failure.get_or_insert(failure);
                None
            }
        }
    }

    /// The `x` with `x − Wx = right` for the entries of `W` from those of the derivatives.
    fn solve(
        &self,
        at: &Point,
        right: Vec<f64>,
        entry: impl Fn(&Matrix, usize, usize) -> f64,
    ) -> Vec<f64> {
        self.solve_coupled(&[*at], right, |of, _, i, j| entry(of, i, j))
    }

    /// The same for coupled stages, the derivatives of a row taken at its stage. `entry` takes a row's stage and a column's.
    fn solve_coupled(
        &self,
        at: &[Point],
        right: Vec<f64>,
        entry: impl Fn(&Matrix, [usize; 2], usize, usize) -> f64,
    ) -> Vec<f64> {
        let size = right.len();
        let found: Option<Vec<Jacobian>> = at.iter().map(|at| self.derivatives(at)).collect();
        let Some(found) = found else { return vec![f64::NAN; size] };
        let block = size / at.len();
        let entry = |of: fn(&Jacobian) -> &Matrix, i: usize, j: usize| {
            let stages = [i / block, j / block];
            entry(of(&found[i / block]), stages, i % block, j % block)
        };
        let matrix = Matrix::from_fn(size, size, |i, j| {
            f64::from(u8::from(i == j)) - entry(|of| &of.values, i, j)
        });
        let column = Matrix::from_fn(size, 1, |i, _| right[i]);
        let Some(solution) = solve_matrix(&matrix, &column) else { return vec![f64::NAN; size] };
        let solution = solution.entries().to_vec();
        // What errors of the derivatives do to the right side.
        let error = |i: usize| {
            (0..size).map(|j| (entry(|of| &of.errors, i, j) * solution[j]).abs()).sum::<f64>()
        };
        self.note((0..size).map(error).fold(0.0, f64::max));
        solution
    }

    /// The place of the velocity at place `i` of phase space.
    fn velocity(&self, i: usize) -> usize {
        self.places(self.count())[i].1.unwrap_or(0)
    }

    fn degrees(&self) -> usize {
        self.places(self.count()).len()
    }
}

impl System<f64, HALF> for NumericalSystem<'_, '_> {
    const BASELINE_ONLY: bool = true;

    fn acceleration(&self, state: &Point) -> [f64; HALF] {
        self.rates_at(state).v
    }

    fn rate(&self, state: Point) -> Point {
        let rates = self.rates_at(&state);
        // The rate of a position is its velocity, without the error of a difference.
        let q = if self.pairs.is_some() { state.v } else { rates.q };
        State { q, v: rates.v }
    }
}

impl ImplicitSystem<f64, HALF> for NumericalSystem<'_, '_> {
    fn acceleration_derivative(&self, at: &Point, direction: &Point) -> [f64; HALF] {
        let Some(found) = self.derivatives(at) else { return [f64::NAN; HALF] };
        let along = found.values.apply(&self.values(direction, self.count()));
        self.point(&along).v
    }

    fn solve_damping(&self, at: &Point, h: f64, right: [f64; HALF]) -> [f64; HALF] {
        let d = self.degrees();
        let v = |i| self.velocity(i);
        let found = self.solve(at, right[..d].to_vec(), |of, i, j| h * of[(v(i), v(j))]);
        padded(&found)
    }

    fn solve_damping_and_stiffness(&self, at: &Point, h: f64, right: [f64; HALF]) -> [f64; HALF] {
        let d = self.degrees();
        let places = self.places(self.count());
        let v = |i: usize| places[i].1.unwrap_or(0);
        let found = self.solve(at, right[..d].to_vec(), |of, i, j| {
            h * (of[(v(i), v(j))] + h * of[(v(i), places[j].0)])
        });
        padded(&found)
    }

    fn solve_rate(&self, at: &Point, h: f64, right: Point) -> Point {
        if self.pairs.is_some() {
            return libration::system::solve_motion(self, at, h, right);
        }
        let x = self.values(&right, self.count());
        self.point(&self.solve(at, x, |of, i, j| h * of[(i, j)]))
    }

    fn solve_stage_accelerations<const N: usize>(
        &self,
        at: &[Point; N],
        coefficients: StageCoefficients<'_, f64, N>,
        right: [[f64; HALF]; N],
    ) -> [[f64; HALF]; N] {
        let d = self.degrees();
        let places = self.places(self.count());
        let v = |i: usize| places[i].1.unwrap_or(0);
        let right = right.iter().flat_map(|stage| &stage[..d]).copied().collect();
        let found = self.solve_coupled(at, right, |of, [row, column], i, j| {
            coefficients.of_q[row][column] * of[(v(i), places[j].0)]
                + coefficients.of_v[row][column] * of[(v(i), v(j))]
        });
        core::array::from_fn(|stage| padded(&found[stage * d..(stage + 1) * d]))
    }

    fn solve_stages<const N: usize>(
        &self,
        at: &[Point; N],
        h: &[[f64; N]; N],
        right: [Point; N],
    ) -> [Point; N] {
        if self.pairs.is_some() {
            return libration::system::solve_stage_motion(self, at, h, right);
        }
        let n = self.count();
        let right = right.iter().flat_map(|stage| self.values(stage, n)).collect();
        let found =
            self.solve_coupled(at, right, |of, [row, column], i, j| h[row][column] * of[(i, j)]);
        core::array::from_fn(|stage| self.point(&found[stage * n..(stage + 1) * n]))
    }
}

fn padded(values: &[f64]) -> [f64; HALF] {
    core::array::from_fn(|i| values.get(i).copied().unwrap_or(0.0))
}

/// The rates at each point, and the largest estimated error of one in units of the scales.
fn rates(prober: &mut Prober<'_>, points: &Matrix) -> Result<(Matrix, f64), BlackBoxError> {
    let subject = prober.subject;
    let (count, n) = (points.rows(), points.columns());
    let actions = Matrix::from_fn(count, subject.action.len(), |_, j| subject.action[j]);
    let mut levels = Vec::new();
    for level in 0..LEVELS {
        let h = subject.dt * 2.0_f64.powi(-FIRST - level);
        levels.push((h, prober.step(points, &actions, h)?));
    }
    let mut found = Matrix::zeros(count, n);
    let mut largest = 0.0_f64;
    for i in 0..count {
        for j in 0..n {
            let x = points[(i, j)];
            let of = |(h, next): &(f64, Matrix)| {
                let next = next[(i, j)];
                ((next - x) / h, 2.0 * f64::EPSILON * x.abs().max(next.abs()) / h)
            };
            let values: Vec<(f64, f64)> = levels.iter().map(of).collect();
            let (rate, error) = limit_of_halved(&values);
            found[(i, j)] = rate;
            largest = largest.max(error / subject.state_scale[j]);
        }
    }
    Ok((found, largest))
}
