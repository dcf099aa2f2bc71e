//! Steps of integrators on linear plants of any size.

use libration_core::{AnyMethod, Float};
use libration_linear::{MOST_STATES, Matrix};

use super::{StabilityFunction, StepOn};

/// `ẋ = Ax` as a system that integrators step.
///
/// If half of the states are rates of the other half, they are velocities and positions, and each integrator applies. Else the
/// states fill the phase space in their order, and only integrators with a [`StabilityFunction`] apply.
#[derive(Clone, Debug)]
pub struct LinearStepper {
    /// `A` with rows and columns in the order of the phase space.
    pub(crate) rates: Matrix,
    /// The state at each place of the phase space.
    pub(crate) order: Vec<usize>,
    /// Number of states that are positions of the phase space.
    pub(crate) positions: usize,
    pub(crate) is_mechanical: bool,
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
    pub fn applies(&self, method: impl Into<AnyMethod>) -> bool {
        self.is_mechanical || StabilityFunction::of(method).is_some()
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
    pub fn with_step<S: Float>(
        &self,
        method: impl Into<AnyMethod>,
        dt: f64,
    ) -> Option<StepOn<'_, S>> {
        let method = method.into();
        self.applies(method).then(|| StepOn::new(self, method, dt))
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

#[cfg(test)]
mod tests {
    use libration_core::Method;

    use super::*;

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
    fn rates_of_first_order_plants_fill_both_halves() {
        let a = matrix(&[&[-1.0, 0.5, 0.0], &[0.25, -2.0, 3.0], &[1.0, 0.0, -4.0]]);
        let stepper = LinearStepper::new(&a).unwrap();
        let found = stepper.with_step::<f64>(Method::ExplicitEuler, 0.5).unwrap().update_matrix();
        let wanted = Matrix::identity(3).plus(&a.scaled(0.5));
        assert_eq!(found, wanted);
    }
}
