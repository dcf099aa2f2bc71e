//! The mean cost of trajectories.

use core::ops::Range;

use libration_core::Float;
use libration_core::control::LqrWeights;

use super::{Lanes, Observer};

/// Keeps the mean of `position·q² + velocity·v²` over the observed steps, per trajectory.
#[derive(Clone, Debug)]
pub struct MeanCost<const D: usize> {
    weights: [f64; 2],
    first: usize,
    /// The sum of each trajectory and its number of steps.
    sums: Vec<(f64, u64)>,
}

impl<const D: usize> MeanCost<D> {
    /// An observer of the trajectories in `range` with the weights of position and velocity; it ignores commands.
    pub fn new(range: Range<usize>, weights: LqrWeights) -> Self {
        let LqrWeights { position, velocity, .. } = weights;
        MeanCost {
            weights: [position, velocity],
            first: range.start,
            sums: vec![(0.0, 0); range.len()],
        }
    }

    /// The mean of each trajectory, in their order; NaN without observed steps.
    pub fn means(&self) -> impl Iterator<Item = f64> + '_ {
        self.sums.iter().map(|&(sum, count)| sum / count as f64)
    }
}

impl<T: Float, const D: usize> Observer<T, D> for MeanCost<D> {
    fn observe(&mut self, lanes: &Lanes<'_, T, D>) {
        let [position, velocity] = self.weights;
        let begin = lanes.first - self.first;
        for l in 0..lanes.len() {
            let (sum, count) = &mut self.sums[begin + l];
            for i in 0..D {
                let (q, v) = (lanes.q[i][l].to_f64(), lanes.v[i][l].to_f64());
                *sum += position * q * q + velocity * v * v;
            }
            *count += 1;
        }
    }
}

#[cfg(test)]
mod tests {
    use libration_core::State;
    use libration_core::integrator::VelocityVerlet;
    use libration_core::system::{BaselineOnly, Oscillator};

    use super::*;
    use crate::ensemble::{All, Execution, Loops, Setup};

    #[test]
    fn the_mean_is_that_of_the_states_seen_whatever_the_threads() {
        let weights = LqrWeights { position: 3.0, velocity: 0.5, command: 0.0 };
        let starts: Vec<State<f64, 1>> =
            (0..300).map(|n| State { q: [f64::from(n)], v: [1.0] }).collect();
        let setup = Setup::new(All(BaselineOnly(Oscillator { omega2: 4.0 })), VelocityVerlet);
        let mut alone = vec![0.0; starts.len()];
        let new = |execution| Loops::new(setup, 0.1, 0, [0.0], &starts, execution).unwrap();
        let mut one = new(Execution::serial());
        for step in 0..=20 {
            if step % 5 == 0 {
                for (n, sum) in alone.iter_mut().enumerate() {
                    let State { q: [q], v: [v] } = one.state(n).unwrap();
                    *sum += 3.0 * q * q + 0.5 * v * v;
                }
            }
            one.advance(1).unwrap();
        }
        let seen =
            new(Execution::serial()).observe(20, 5, |range| MeanCost::new(range, weights)).unwrap();
        let means: Vec<f64> = seen.iter().flat_map(MeanCost::means).collect();
        assert_eq!(means, alone.iter().map(|sum| sum / 5.0).collect::<Vec<_>>());
    }
}
