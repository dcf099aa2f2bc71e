//! Loops with random latency.

use libration_core::State;
use libration_core::control::{Feedback, Latency, RandomLatency};

use super::augmented_state::AugmentedState;
use super::dense_matrix::{Matrix, log_spectral_radius, product, symmetric_square, transpose};
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
        let (m, size) = (steps.len(), squares[0].len());
        let entry = |row: usize, column: usize| {
            let ((j, r), (i, c)) = ((row / size, row % size), (column / size, column % size));
            latency.follows(i, j) * squares[i][r][c]
        };
        let all = (0..m * size).map(|r| (0..m * size).map(|c| entry(r, c)).collect()).collect();
        log_spectral_radius(all).exp()
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
        let n = maps[0].len();
        let start: Vec<f64> =
            (0..n).map(|i| [state.q[0], state.v[0]].get(i).copied().unwrap_or(0.0)).collect();
        // E[yyᵀ; the latency is the i-th].
        let of = |p: f64| start.iter().map(|a| start.iter().map(|b| p * a * b).collect()).collect();
        let mut moments: Vec<Matrix> = latency.table().iter().map(|&(_, p)| of(p)).collect();
        for _ in 0..steps {
            let moved: Vec<Matrix> = maps
                .iter()
                .zip(&moments)
                .map(|(map, moment)| transpose(&product(map, &transpose(&product(map, moment)))))
                .collect();
            let entry = |j: usize, r: usize, c: usize| -> f64 {
                moved.iter().enumerate().map(|(i, m)| latency.follows(i, j) * m[r][c]).sum()
            };
            moments = (0..maps.len())
                .map(|j| (0..n).map(|r| (0..n).map(|c| entry(j, r, c)).collect()).collect())
                .collect();
        }
        [(0, 0), (0, 1), (1, 1)].map(|(r, c)| moments.iter().map(|moment| moment[r][c]).sum())
    }

    /// The step with each latency of the table.
    fn steps_late(&self, feedback: Feedback, latency: &RandomLatency) -> Vec<Matrix> {
        let controller = LinearController::from(feedback);
        let of = |&(late, _): &(Latency, f64)| {
            let step = self.split_in_floats(late.part(), self.dt);
            waiting(latency).step(&step, &controller, Some(late.whole() as usize))
        };
        latency.table().iter().map(of).collect()
    }
}

/// The augmented state.
fn waiting(latency: &RandomLatency) -> AugmentedState {
    AugmentedState { memory: 0, commands: latency.longest(), acting: latency.splits_steps() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_table_counts_the_numbers_of_a_step_as_the_augmented_state_does() {
        for steps in [0.0, 0.5, 1.0, 3.0, 3.25] {
            let latency = RandomLatency::new(vec![(steps, 0.5), (1.0, 0.5)], 0.1).unwrap();
            assert_eq!(latency.step_size(), waiting(&latency).size(), "{steps}");
        }
    }
}
