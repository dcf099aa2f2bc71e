//! Steps of one integrator on a linear plant.

use std::sync::OnceLock;

use libration_core::integrator::ImplicitIntegrator;
use libration_core::system::{ImplicitSystem, solve_motion};
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
    /// The equations that were solved first. All of a step are the same ones.
    equations: OnceLock<([S; 3], Factorisation<S>)>,
}

impl<'a, S: Float> StepOn<'a, S> {
    pub(crate) fn new(stepper: &'a LinearStepper, method: AnyMethod, dt: f64) -> Self {
        StepOn {
            stepper,
            rates: stepper.rates.entries().iter().map(|&x| S::from_f64(x)).collect(),
            method,
            dt: S::from_f64(dt),
            equations: OnceLock::new(),
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
    fn solve(&self, parts: [S; 3], change: impl Fn(usize, usize) -> S, right: &mut [S]) {
        let n = right.len();
        let new = || {
            let unit = |i: usize, j: usize| if i == j { S::one() } else { S::zero() };
            let places = (0..n).flat_map(|i| (0..n).map(move |j| (i, j)));
            let matrix = places.map(|(i, j)| unit(i, j) - change(i, j)).collect();
            (parts, Factorisation::new(matrix, n))
        };
        let known = self.equations.get_or_init(new);
        if known.0 == parts { known.1.solve(right) } else { new().1.solve(right) }
    }

    /// The entry of `A`.
    fn entry(&self, i: usize, j: usize) -> S {
        self.rates[i * self.stepper.order.len() + j]
    }

    /// The accelerations of a mechanical plant with implicit springs for `of_q` and implicit dampers for `of_v`.
    fn solve_mechanical(&self, of_q: S, of_v: S, mut right: [S; HALF]) -> [S; HALF] {
        let d = self.stepper.positions;
        let change = |i, j| of_q * self.entry(d + i, j) + of_v * self.entry(d + i, d + j);
        self.solve([S::zero(), of_q, of_v], change, &mut right[..d]);
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
        self.solve([S::one(), h, h], |i, j| h * self.entry(i, j), &mut x);
        let mut solution = State::origin();
        for (place, x) in x.into_iter().enumerate() {
            *at_place(&mut solution, place, *positions) = x;
        }
        solution
    }
}

#[cfg(test)]
mod tests {
    use libration_core::number::Dual;
    use libration_core::system::{DampedOscillator, Differentiated};
    use libration_core::{ImplicitMethod, Scalar};
    use libration_linear::eigenvalues;

    use super::*;
    use crate::UpdateMatrix;

    #[test]
    fn the_step_on_a_plant_has_the_bits_of_the_step_on_the_same_system_of_the_catalogue() {
        let (omega2, gamma, dt) = (7.0, 0.3, 0.11);
        let a = Matrix::from_rows(&[[0.0, 1.0], [-omega2, -gamma]]).unwrap();
        let stepper = LinearStepper::new(&a).unwrap();
        let number = Dual::<f64>::from_f64;
        let system = DampedOscillator { omega2: number(omega2), gamma: number(gamma) };
        for method in AnyMethod::all() {
            let wanted = UpdateMatrix::from_map(|e| method.step(&Differentiated(system), e, dt));
            let found = stepper.with_step::<f64>(method, dt).unwrap().update_matrix();
            for (i, row) in wanted.rows().iter().enumerate() {
                // −ω²q − γv in another order of signs.
                assert_eq!(found.row(i), row, "{}", method.name());
            }
        }
    }

    /// A plant of `d` masses with springs and dampers between all of them, of no proportion and no symmetry.
    fn plant(d: usize) -> Matrix {
        let part = |i: usize, j: usize| (0.618_034 * (1.0 + (3 * i + 7 * j) as f64)).fract();
        Matrix::from_fn(2 * d, 2 * d, |i, j| match (i < d, j < d) {
            (true, _) => f64::from(u8::from(j == i + d)),
            (false, true) if i - d == j => -40.0 - j as f64,
            (false, false) if i == j => -3.0,
            (false, true) => part(i - d, j) - 0.5,
            (false, false) => 0.1 * part(j - d, i - d),
        })
    }

    #[test]
    fn update_matrices_of_fifty_degrees_of_freedom_solve_the_equations_of_their_methods() {
        let d = 50;
        let a = plant(d);
        let (n, h) = (2 * d, 0.3);
        let stepper = LinearStepper::new(&a).unwrap();
        let identity = Matrix::identity(n);
        let plus = |factor: f64, other: &Matrix| identity.plus(&other.scaled(factor));
        // The parts of A that are treated implicitly in Δv, as rows of a matrix on velocities.
        let (stiffness, damping) = (a.block((d, 0), (d, d)), a.block((d, d), (d, d)));
        for method in ImplicitMethod::ALL {
            let found = stepper.with_step::<f64>(method, h).unwrap().update_matrix();
            let (left, right) = match method {
                ImplicitMethod::DampingStiffnessImplicit | ImplicitMethod::BackwardEuler => {
                    (plus(-h, &a), identity.clone())
                }
                ImplicitMethod::ImplicitMidpoint | ImplicitMethod::Trapezoid => {
                    (plus(-h / 2.0, &a), plus(h / 2.0, &a))
                }
                // (1 − hA_v)v' = v + h(A_q q + p·h·A_q v), with p = 1 for stable PD; q' − hv' = q.
                ImplicitMethod::DampingImplicit | ImplicitMethod::StablePd => {
                    let p = if method == ImplicitMethod::StablePd { h * h } else { 0.0 };
                    let unit = |i: usize, j: usize| f64::from(u8::from(i == j));
                    let left = Matrix::from_fn(n, n, |i, j| match (i < d, j < d) {
                        (true, true) => unit(i, j),
                        (true, false) => -h * unit(i, j - d),
                        (false, true) => 0.0,
                        (false, false) => unit(i, j) - h * damping[(i - d, j - d)],
                    });
                    let right = Matrix::from_fn(n, n, |i, j| match (i < d, j < d) {
                        (true, _) => unit(i, j),
                        (false, true) => h * stiffness[(i - d, j)],
                        (false, false) => unit(i, j) + p * stiffness[(i - d, j - d)],
                    });
                    (left, right)
                }
            };
            let mut off = &left * &found;
            off.add_scaled(-1.0, &right);
            // A hundred products of numbers up to 27.
            assert!(off.largest() < 1e-12, "{method:?} {}", off.largest());
        }
    }

    #[test]
    fn equations_of_different_steps_are_not_confused() {
        let a = Matrix::from_rows(&[[0.0, 1.0], [-8.0, -2.0]]).unwrap();
        let stepper = LinearStepper::new(&a).unwrap();
        let step = stepper.with_step::<f64>(ImplicitMethod::StablePd, 0.1).unwrap();
        let at = State::origin();
        let mut right = [0.0; HALF];
        right[0] = 1.0;
        assert_eq!(step.solve_damping(&at, 0.5, right)[0], 1.0 / 2.0);
        assert_eq!(step.solve_damping_and_stiffness(&at, 0.5, right)[0], 1.0 / 4.0);
        assert_eq!(step.solve_damping(&at, 1.5, right)[0], 1.0 / 4.0);
    }

    #[test]
    fn first_order_plants_have_the_multipliers_of_the_stability_function() {
        let a =
            Matrix::from_rows(&[[-1.0, 0.5, 0.0], [0.25, -2.0, 3.0], [1.0, 0.0, -4.0]]).unwrap();
        let stepper = LinearStepper::new(&a).unwrap();
        assert!(!stepper.is_mechanical() && !stepper.applies(ImplicitMethod::StablePd));
        let h = 0.7;
        let step = stepper.with_step::<f64>(ImplicitMethod::Trapezoid, h).unwrap();
        let found = step.update_matrix();
        let half = |sign: f64| Matrix::identity(3).plus(&a.scaled(sign * h / 2.0));
        let mut off = &half(-1.0) * &found;
        off.add_scaled(-1.0, &half(1.0));
        assert!(off.largest() < 2e-15, "{off:?}");
        let radius = |m: &Matrix| {
            eigenvalues(m).unwrap().iter().map(|value| value.norm()).fold(0.0, f64::max)
        };
        assert!(radius(&found) < 1.0);
    }
}
