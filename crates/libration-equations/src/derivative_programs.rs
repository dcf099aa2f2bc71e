//! Programs of the derivatives of accelerations, and of linear equations with them.

use std::cell::OnceCell;
use std::collections::BTreeMap;

use libration_core::Scalar;
use libration_core::elimination::solve;
use libration_core::number::Dual;

use super::program::Program;
use super::step_trace::Implicit;
use super::{Dynamics, Recorded};

/// Programs of what an implicit step needs of a system, recorded when they are used first.
#[derive(Debug)]
pub(crate) struct DerivativePrograms<'d> {
    dynamics: &'d Dynamics,
    along: OnceCell<Program>,
    solutions: [OnceCell<Program>; 2],
    of_stages: BTreeMap<usize, Program>,
}

impl<'d> DerivativePrograms<'d> {
    pub(crate) fn new(dynamics: &'d Dynamics) -> Self {
        DerivativePrograms {
            dynamics,
            along: OnceCell::new(),
            solutions: [OnceCell::new(), OnceCell::new()],
            of_stages: BTreeMap::new(),
        }
    }

    /// From positions, velocities, inputs and a direction of positions and velocities to the derivative of the accelerations along it.
    pub(crate) fn along_a_direction(&self) -> &Program {
        self.along.get_or_init(|| {
            let (d, at) = (self.dynamics.degrees(), self.at());
            Program::record(at + 2 * d, |x| derivative(self.dynamics, &x[..at], &x[at..]))
        })
    }

    /// From positions, velocities, inputs, the time step and the right side to the solution.
    pub(crate) fn solution(&self, implicit: Implicit) -> &Program {
        self.solutions[implicit as usize].get_or_init(|| {
            let (d, at) = (self.dynamics.degrees(), self.at());
            Program::record(at + 1 + d, |x| {
                let (state, h, mut right) = (&x[..at], x[at], x[at + 1..].to_vec());
                let of_q = match implicit {
                    Implicit::Damping => Recorded::zero(),
                    Implicit::DampingAndStiffness => h * h,
                };
                let mut matrix = vec![Recorded::zero(); d * d];
                for j in 0..d {
                    let mut direction = vec![Recorded::zero(); 2 * d];
                    (direction[j], direction[d + j]) = (of_q, h);
                    let column = derivative(self.dynamics, state, &direction);
                    for (i, &change) in column.iter().enumerate() {
                        let unit = if i == j { Recorded::one() } else { Recorded::zero() };
                        matrix[i * d + j] = unit - change;
                    }
                }
                solve(&mut matrix, &mut right);
                right
            })
        })
    }

    /// From the positions and velocities of each of `stages` stages, inputs, both sets of coefficients and the right sides to the solutions.
    pub(crate) fn stage_solutions(&mut self, stages: usize) -> &Program {
        let dynamics = self.dynamics;
        self.of_stages.entry(stages).or_insert_with(|| {
            let (d, n, squares) = (dynamics.degrees(), stages, stages * stages);
            let moving = 2 * d * n;
            let count = moving + dynamics.inputs() + 2 * squares + n * d;
            Program::record(count, |x| {
                let (states, rest) = x.split_at(moving);
                let (inputs, rest) = rest.split_at(dynamics.inputs());
                let (of_q, rest) = rest.split_at(squares);
                let (of_v, right) = rest.split_at(squares);
                let mut right = right.to_vec();
                let mut matrix = vec![Recorded::zero(); right.len() * right.len()];
                for (i, state) in states.chunks_exact(2 * d).enumerate() {
                    let state = [state, inputs].concat();
                    let along = |place: usize| {
                        let mut direction = vec![Recorded::zero(); 2 * d];
                        direction[place] = Recorded::one();
                        derivative(dynamics, &state, &direction)
                    };
                    for j in 0..d {
                        let (by_q, by_v) = (along(j), along(d + j));
                        for (row, k) in (0..d).flat_map(|row| (0..n).map(move |k| (row, k))) {
                            let is_unit = i == k && row == j;
                            let unit = if is_unit { Recorded::one() } else { Recorded::zero() };
                            let change = of_q[i * n + k] * by_q[row] + of_v[i * n + k] * by_v[row];
                            matrix[(i * d + row) * n * d + k * d + j] = unit - change;
                        }
                    }
                }
                solve(&mut matrix, &mut right);
                right
            })
        })
    }

    /// Positions, velocities and inputs.
    fn at(&self) -> usize {
        2 * self.dynamics.degrees() + self.dynamics.inputs()
    }
}

/// The derivative of the accelerations along a direction of positions and velocities; inputs are constant.
fn derivative(dynamics: &Dynamics, at: &[Recorded], direction: &[Recorded]) -> Vec<Recorded> {
    let moving = at.iter().zip(direction).map(|(&re, &du)| Dual { re, du });
    let constant = at[direction.len()..].iter().map(|&re| Dual::constant(re));
    let inputs: Vec<Dual<Recorded>> = moving.chain(constant).collect();
    dynamics.accelerations().on::<Dual<Recorded>>().run(&inputs).map(|x| x.du).collect()
}
