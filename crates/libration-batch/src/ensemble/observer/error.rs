//! The error against a known solution.

use core::ops::Range;

use libration_core::{Float, State};

use super::{Lanes, Observer};

/// Keeps, for every trajectory, the mean square of its distance from a solution that is known, over the
/// observed steps: the squared ℓ² error of positions, and of velocities.
#[derive(Clone, Debug)]
pub struct MeanSquareError<F> {
    first: usize,
    solution: F,
    seen: Vec<u64>,
    squares: Vec<[f64; 2]>,
}

impl<F> MeanSquareError<F> {
    /// An observer for `trajectories`; `solution(n, step)` is the exact state of trajectory `n`.
    pub fn new(trajectories: Range<usize>, solution: F) -> Self {
        let count = trajectories.len();
        MeanSquareError {
            first: trajectories.start,
            solution,
            seen: vec![0; count],
            squares: vec![[0.0; 2]; count],
        }
    }

    /// The mean squares of each trajectory, in order: of positions, and of velocities; not numbers where
    /// nothing was observed.
    pub fn means(&self) -> impl Iterator<Item = [f64; 2]> + '_ {
        let pairs = self.squares.iter().zip(&self.seen);
        pairs.map(|(squares, &seen)| squares.map(|sum| sum / seen as f64))
    }
}

impl<T, F, const D: usize> Observer<T, D> for MeanSquareError<F>
where
    T: Float,
    F: Fn(usize, u64) -> State<f64, D> + Send,
{
    fn observe(&mut self, lanes: &Lanes<'_, T, D>) {
        for l in 0..lanes.len() {
            let (state, exact) = (lanes.state(l), (self.solution)(lanes.first + l, lanes.step));
            let square = |own: [T; D], exact: [f64; D]| -> f64 {
                let apart = own.iter().zip(exact).map(|(own, exact)| own.to_f64() - exact);
                apart.map(|x| x * x).sum()
            };
            let at = lanes.first - self.first + l;
            self.seen[at] += 1;
            self.squares[at][0] += square(state.q, exact.q);
            self.squares[at][1] += square(state.v, exact.v);
        }
    }
}
