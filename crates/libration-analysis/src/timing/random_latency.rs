//! Loops with random latency.

use libration_core::State;
use libration_core::control::{Feedback, Latency, RandomLatency};
use libration_linear::{Arrival, Matrix, Transit, log_spectral_radius, symmetric_square};

use super::stages::Stages;
use super::{LinearController, Plant};

impl Plant<'_> {
    /// The factor by which second moments grow in a step of the loop that `feedback` closes with random latencies.
    /// The loop is stable in the mean square where it is below 1.
    ///
    /// It is the spectral radius of the map `Pⱼ ← Σᵢ πᵢⱼ Mᵢ Pᵢ Mᵢᵀ` of second moments by latency, with the step `Mᵢ` of
    /// state and waiting commands, in `f64`: some 13 digits are right, but only 3 where the largest eigenvalues meet, as at critical
    /// damping (O. L. V. Costa, M. D. Fragoso, R. P. Marques, *Discrete-Time Markov Jump Linear
    /// Systems*, 2005, chapter 3).
    pub fn mean_square_late(&self, feedback: Feedback, latency: &RandomLatency) -> f64 {
        let steps = self.steps_late(feedback, latency);
        let squares: Vec<Matrix> = steps.iter().map(symmetric_square).collect();
        let (m, size) = (steps.len(), squares[0].rows());
        let all = Matrix::from_fn(m * size, m * size, |row, column| {
            let ((j, r), (i, c)) = ((row / size, row % size), (column / size, column % size));
            latency.follows(i, j) * squares[i][(r, c)]
        });
        log_spectral_radius(&all).exp()
    }

    /// `E[q²]`, `E[qv]` and `E[v²]` after so many steps of that loop from `state`, where nothing acts before the first
    /// command arrives.
    pub fn moments_late(
        &self,
        feedback: Feedback,
        latency: &RandomLatency,
        state: &State<f64, 1>,
        steps: u64,
    ) -> [f64; 3] {
        let maps = self.steps_late(feedback, latency);
        let n = maps[0].rows();
        let start = |i: usize| [state.q[0], state.v[0]].get(i).copied().unwrap_or(0.0);
        // E[yyᵀ; the latency is the i-th].
        let of = |p: f64| Matrix::from_fn(n, n, |i, j| p * start(i) * start(j));
        let mut moments: Vec<Matrix> = latency.table().iter().map(|&(_, p)| of(p)).collect();
        for _ in 0..steps {
            let moved: Vec<Matrix> =
                maps.iter().zip(&moments).map(|(map, moment)| map.congruence(moment)).collect();
            for (j, moment) in moments.iter_mut().enumerate() {
                *moment = Matrix::zeros(n, n);
                for (i, moved) in moved.iter().enumerate() {
                    moment.add_scaled(latency.follows(i, j), moved);
                }
            }
        }
        [(0, 0), (0, 1), (1, 1)].map(|place| moments.iter().map(|moment| moment[place]).sum())
    }

    /// The step with each latency of the table.
    fn steps_late(&self, feedback: Feedback, latency: &RandomLatency) -> Vec<Matrix> {
        let controller = LinearController::from(feedback).discrete();
        let periods = Stages::in_transit(self, controller, transit(latency), Latency::NONE, None);
        let dt = self.dt.to_f64();
        let step = |&(latency, _): &(Latency, f64)| {
            periods.arriving(1.0, dt, Arrival { latency, lost: None }).step
        };
        latency.table().iter().map(step).collect()
    }
}

/// The room for commands.
fn transit(latency: &RandomLatency) -> Transit {
    Transit { count: latency.longest(), acts_on: latency.splits_steps() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_table_counts_the_numbers_of_a_step_as_the_augmented_state_does() {
        for steps in [0.0, 0.5, 1.0, 3.0, 3.25] {
            let latency = RandomLatency::new(vec![(steps, 0.5), (1.0, 0.5)], 0.1).unwrap();
            let Transit { count, acts_on } = transit(&latency);
            assert_eq!(latency.step_size(), 2 + count + usize::from(acts_on), "{steps}");
        }
    }
}
