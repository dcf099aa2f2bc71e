//! Steps of integrators on linear plants of any size.

use libration_core::{Float, Integrator, Method, State, System};
use libration_linear::{MOST_STATES, Matrix};

use super::StabilityFunction;

/// Half of the most states: the degrees of freedom of the phase space in which plants are stepped.
const HALF: usize = MOST_STATES / 2;

/// `ẋ = Ax` as a system that integrators step.
///
/// If half of the states are rates of the other half, they are velocities and positions, and each integrator applies. Else the
/// states fill the phase space in their order, and only integrators with a [`StabilityFunction`] apply.
#[derive(Clone, Debug)]
pub struct LinearStepper {
    /// `A` with rows and columns in the order of the phase space.
    rates: Matrix,
    /// The state at each place of the phase space.
    order: Vec<usize>,
    /// Number of states that are positions of the phase space.
    positions: usize,
    is_mechanical: bool,
}

impl LinearStepper {
    /// That of a plant with the state matrix `a`; none if it has more than [`MOST_STATES`] states.
    pub fn new(a: &Matrix) -> Option<Self> {
        LinearStepper::of_pairs(a, positions_and_velocities(a))
    }

    /// The same of a plant whose states are not taken for positions and velocities, even if they could be.
    pub fn of_first_order(a: &Matrix) -> Option<Self> {
        LinearStepper::of_pairs(a, None)
    }

    fn of_pairs(a: &Matrix, pairs: Option<Vec<(usize, usize)>>) -> Option<Self> {
        let n = a.rows();
        if n > MOST_STATES {
            return None;
        }
        let is_mechanical = pairs.is_some();
        let (order, positions) = match pairs {
            Some(pairs) => {
                let (positions, velocities): (Vec<usize>, Vec<usize>) = pairs.into_iter().unzip();
                let count = positions.len();
                (positions.into_iter().chain(velocities).collect(), count)
            }
            None => ((0..n).collect::<Vec<usize>>(), n.div_ceil(2)),
        };
        let rates = Matrix::from_fn(n, n, |i, j| a[(order[i], order[j])]);
        Some(LinearStepper { rates, order, positions, is_mechanical })
    }

    /// Whether half of the states are rates of the other half.
    pub fn is_mechanical(&self) -> bool {
        self.is_mechanical
    }

    /// Whether an integrator applies.
    pub fn applies(&self, method: Method) -> bool {
        self.is_mechanical || StabilityFunction::new(method).is_some()
    }

    /// The matrices of stiffness and damping of a mechanical plant, both over its masses.
    pub(crate) fn stiffness_and_damping(&self) -> (Matrix, Matrix) {
        let d = self.positions;
        let over_masses = |column| self.rates.block((d, column), (d, d)).scaled(-1.0);
        (over_masses(0), over_masses(d))
    }

    /// Whether the rate of a velocity of a mechanical plant depends on a velocity.
    pub(crate) fn is_damped(&self) -> bool {
        self.stiffness_and_damping().1.largest() != 0.0
    }

    /// The places of the positions among the states; without a mechanical plant of all states.
    pub(crate) fn shape_states(&self) -> &[usize] {
        if self.is_mechanical { &self.order[..self.positions] } else { &self.order }
    }

    /// Steps of `dt` seconds in floats of type `S`; none if the integrator does not apply.
    pub fn with_step<S: Float>(&self, method: Method, dt: f64) -> Option<StepOn<'_, S>> {
        self.applies(method).then(|| StepOn {
            stepper: self,
            rates: self.rates.entries().iter().map(|&x| S::from_f64(x)).collect(),
            method,
            dt: S::from_f64(dt),
        })
    }
}

/// The pairs of a position and its velocity; none if the states are not all in such pairs.
///
/// The rate of a position is exactly one state. These arrows make a graph with at most one arrow from each state, in which a state with
/// one neighbour has no choice.
pub fn positions_and_velocities(a: &Matrix) -> Option<Vec<(usize, usize)>> {
    let n = a.rows();
    let target = |i: usize| {
        let mut entries = (0..n).filter(|&j| a[(i, j)] != 0.0);
        let only = entries.next().filter(|_| entries.next().is_none());
        only.filter(|&j| j != i && a[(i, j)] == 1.0)
    };
    let mut arrows: Vec<(usize, usize)> = (0..n).filter_map(|i| Some((i, target(i)?))).collect();
    let mut pairs = Vec::new();
    while pairs.len() * 2 < n {
        let degree = |i: usize| arrows.iter().filter(|(q, v)| *q == i || *v == i).count();
        let forced = arrows.iter().find(|(q, v)| degree(*q) == 1 || degree(*v) == 1);
        let &(q, v) = forced.or(arrows.first())?;
        pairs.push((q, v));
        arrows.retain(|&(i, j)| ![q, v].contains(&i) && ![q, v].contains(&j));
    }
    pairs.sort_unstable();
    Some(pairs)
}

/// Steps of one integrator and one length on a linear plant, in floats of type `S`.
#[derive(Clone, Debug)]
pub struct StepOn<'a, S> {
    stepper: &'a LinearStepper,
    rates: Vec<S>,
    method: Method,
    dt: S,
}

impl<S: Float> StepOn<'_, S> {
    /// One step from the states `x`, each rounded to `S`.
    pub fn step(&self, x: &[f64]) -> Vec<f64> {
        let LinearStepper { order, positions, .. } = self.stepper;
        let mut state = State::<S, HALF>::origin();
        for (place, &i) in order.iter().enumerate() {
            *at(&mut state, place, *positions) = S::from_f64(x[i]);
        }
        let mut state = self.method.step(self, state, self.dt);
        let mut next = vec![0.0; x.len()];
        for (place, &i) in order.iter().enumerate() {
            next[i] = at(&mut state, place, *positions).to_f64();
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
fn at<S>(state: &mut State<S, HALF>, place: usize, positions: usize) -> &mut S {
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

#[cfg(test)]
mod tests {
    use libration_core::system::DampedOscillator;

    use super::*;
    use crate::UpdateMatrix;

    fn matrix(rows: &[&[f64]]) -> Matrix {
        Matrix::from_rows(rows).unwrap()
    }

    #[test]
    fn positions_and_velocities_are_found_in_any_order() {
        // v₂, q₁, v₁, q₂.
        let a = matrix(&[
            &[-0.1, 2.0, 0.0, -2.0],
            &[0.0, 0.0, 1.0, 0.0],
            &[0.0, -2.0, -0.2, 2.0],
            &[1.0, 0.0, 0.0, 0.0],
        ]);
        let stepper = LinearStepper::new(&a).unwrap();
        assert!(stepper.is_mechanical());
        assert_eq!(stepper.order, [1, 3, 2, 0]);
        // A chain of integrators, whose ends have no choice.
        let chain = Matrix::from_fn(4, 4, |i, j| f64::from(u8::from(j == i + 1)));
        assert_eq!(positions_and_velocities(&chain), Some(vec![(0, 1), (2, 3)]));
        for first_order in [&matrix(&[&[0.0, 2.0], &[-1.0, 0.0]]), &chain.block((0, 0), (3, 3))] {
            let stepper = LinearStepper::new(first_order).unwrap();
            assert!(!stepper.is_mechanical());
            assert!(stepper.applies(Method::Rk4) && !stepper.applies(Method::VelocityVerlet));
        }
    }

    #[test]
    fn the_step_on_a_plant_has_the_bits_of_the_step_on_the_same_system_of_the_catalogue() {
        let (omega2, gamma, dt) = (7.0, 0.3, 0.11);
        let stepper = LinearStepper::new(&matrix(&[&[0.0, 1.0], &[-omega2, -gamma]])).unwrap();
        let system = DampedOscillator { omega2, gamma };
        for method in Method::ALL {
            let wanted = UpdateMatrix::from_map(|e| method.step(&system, e, dt));
            let found = stepper.with_step::<f64>(method, dt).unwrap().update_matrix();
            for (i, row) in wanted.rows().iter().enumerate() {
                // −ω²q − γv in another order of signs.
                assert_eq!(found.row(i), row, "{}", method.name());
            }
        }
    }

    #[test]
    fn rates_of_first_order_plants_fill_both_halves() {
        let a = matrix(&[&[-1.0, 0.5, 0.0], &[0.25, -2.0, 3.0], &[1.0, 0.0, -4.0]]);
        let stepper = LinearStepper::new(&a).unwrap();
        let found = stepper.with_step::<f64>(Method::ExplicitEuler, 0.5).unwrap().update_matrix();
        let wanted = Matrix::identity(3).plus(&a.scaled(0.5));
        assert_eq!(found, wanted);
    }
}
