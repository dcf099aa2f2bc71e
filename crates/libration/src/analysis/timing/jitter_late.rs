//! Steps of random length in a loop whose command arrives late.

use super::jitter::MOST_TURN;
use super::waiting::{Matrix, Waiting, growth, symmetric_square};
use super::{Feedback, Jitter, Latency, LinearController, Plant};
use crate::Scalar;
use crate::number::Wide;

/// More than this and the powers of their matrix take seconds: of a latency of more than 17 steps.
const MOST_MOMENTS: usize = 200;

impl Plant<'_> {
    /// The rate at which second moments grow in the loop that `feedback` closes with `latency`, with steps after
    /// `jitter`: the logarithm of `ρ(E[M ⊗ M])`, with the step `M` of state and waiting commands. None beyond a latency
    /// of 17 steps, and where steps turn by more than 2048 rad in a deviation.
    ///
    /// Where a command arrives within a step, it does after the same part of it, whatever its length. It is in `f64`: some 13
    /// digits are right, but only 3 where the largest eigenvalues meet, as at critical damping.
    pub fn mean_square_rate_late(
        &self,
        feedback: Feedback,
        latency: Latency,
        jitter: Jitter,
    ) -> Option<f64> {
        let (whole, part) = (latency.whole() as usize, latency.part());
        let waiting = Waiting { memory: 0, commands: whole, acting: part > 0.0 };
        let controller = LinearController::from(feedback);
        let n = waiting.size();
        let moments = n * (n + 1) / 2;
        let turn = 2.0 * self.turn(jitter);
        if moments > MOST_MOMENTS || turn.is_nan() || turn > MOST_TURN {
            return None;
        }
        let mut mean: Matrix = vec![vec![0.0; moments]; moments];
        for (weight, epsilon) in jitter.nodes(turn) {
            let dt = self.dt * (Wide::one() + Wide::from_f64(epsilon));
            let step = waiting.step(&self.split_in_floats(part, dt), &controller, Some(whole));
            for (row, square) in mean.iter_mut().zip(symmetric_square(&step)) {
                row.iter_mut().zip(square).for_each(|(sum, x)| *sum += weight * x);
            }
        }
        Some(growth(mean))
    }
}

#[cfg(test)]
mod tests {
    use super::super::sample::textbook;
    use super::*;
    use crate::system::Oscillator;

    const MODEL: Oscillator<f64> = Oscillator { omega2: 10.0 };
    const GAINS: Feedback = Feedback { position: 4.0, velocity: 1.0 };

    #[test]
    fn without_latency_it_is_the_growth_by_exact_moments() {
        for (name, plant) in textbook(MODEL, 0.1) {
            for law in [Jitter::Gaussian(0.1), Jitter::Uniform(0.3), Jitter::Gaussian(0.5)] {
                let exact = plant.mean_square(GAINS, law).radius.to_f64().ln();
                let found = plant.mean_square_rate_late(GAINS, Latency::NONE, law).unwrap();
                // Roundings of 9 entries and of 50 norms.
                assert!((found - exact).abs() < 1e-13, "{name} {law:?}: {found} {exact}");
            }
        }
    }

    #[test]
    fn without_jitter_it_is_twice_the_growth_of_the_loop() {
        for (name, plant) in textbook(MODEL, 0.1) {
            for steps in [1.0, 2.5, 3.0] {
                let latency = Latency::of_steps(steps).unwrap();
                let exact = 2.0 * plant.spectral_radius(GAINS, latency).to_f64().ln();
                let found = plant.mean_square_rate_late(GAINS, latency, Jitter::Uniform(0.0));
                let found = found.unwrap();
                assert!((found - exact).abs() < 1e-13, "{name} {steps}: {found} {exact}");
            }
            let long = Latency::of_steps(17.5).unwrap();
            assert_eq!(plant.mean_square_rate_late(GAINS, long, Jitter::Uniform(0.1)), None);
        }
    }
}
