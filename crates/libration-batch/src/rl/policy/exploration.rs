//! Exploration by Gaussian noise.

use libration_core::Float;
use libration_core::random::{Streams, normal};

use super::{ActionSample, Policy, StepIndex};
use crate::rl::EnvironmentError;

/// A policy with Gaussian noise on each of its actions; the log-probability is that of the noise. A policy that is itself random
/// has none that were known, and does not compile.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GaussianExploration<P, const D: usize> {
    /// The policy, whose actions are the means.
    pub policy: P,
    /// The standard deviations, above zero.
    pub sigma: [f64; D],
}

impl<P, const D: usize> GaussianExploration<P, D> {
    /// The log-probability of the mean.
    fn highest(&self) -> f64 {
        let log = |sigma: f64| libm::log(sigma) + 0.5 * libm::log(core::f64::consts::TAU);
        -self.sigma.iter().map(|&sigma| log(sigma)).sum::<f64>()
    }
}

impl<T: Float, P: Policy<T, O, D>, const O: usize, const D: usize> Policy<T, O, D>
    for GaussianExploration<P, D>
{
    const DRAWS: bool = true;

    fn check(&self, environments: usize, horizon: usize) -> Result<(), EnvironmentError> {
        const { assert!(!P::DRAWS, "exploration requires a deterministic policy") };
        self.policy.check(environments, horizon)?;
        for (index, &sigma) in self.sigma.iter().enumerate() {
            EnvironmentError::above_zero::<T>("standard deviation of exploration", index, sigma)?;
        }
        Ok(())
    }

    fn operations(&self, environments: usize) -> u64 {
        self.policy.operations(environments)
    }

    fn words(&self) -> usize {
        2 * D
    }

    #[inline(always)]
    fn act(
        &self,
        place: StepIndex,
        seen: &[T; O],
        word: &mut impl FnMut() -> u32,
    ) -> ActionSample<T, D> {
        let mut act = self.policy.act(place, seen, word);
        act.log_probability = act.log_probability + T::from_f64(self.highest());
        for i in 0..D {
            let (next, log) = explored(act.action[i], self.sigma[i], [word(), word()]);
            act.action[i] = next;
            act.log_probability = act.log_probability + log;
        }
        act
    }

    #[inline(always)]
    fn act_all<const W: usize>(
        &self,
        place: StepIndex,
        seen: &[[T; W]; O],
        words: &mut Streams<W>,
        actions: &mut [[T; W]; D],
        log_probabilities: &mut [T; W],
    ) {
        self.policy.act_all(place, seen, words, actions, log_probabilities);
        let highest = T::from_f64(self.highest());
        for log in log_probabilities.iter_mut() {
            *log = *log + highest;
        }
        for (row, &sigma) in actions.iter_mut().zip(&self.sigma) {
            for l in 0..W {
                let drawn = [words.next(l), words.next(l)];
                let (next, log) = explored(row[l], sigma, drawn);
                row[l] = next;
                log_probabilities[l] = log_probabilities[l] + log;
            }
        }
    }
}

/// An action of this mean and deviation, and how much less likely than the mean it is.
#[inline(always)]
fn explored<T: Float>(mean: T, sigma: f64, words: [u32; 2]) -> (T, T) {
    let z = T::from_f64(normal(words).into());
    (mean + T::from_f64(sigma) * z, -(T::from_f64(0.5) * (z * z)))
}
