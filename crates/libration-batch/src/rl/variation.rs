//! Domain randomisation: parameters drawn for every episode.

use libration_core::Float;
use libration_core::array::each;
use libration_core::control::{ControlError, Memory};
use libration_core::random::Purpose;

use super::Distribution;
use super::start::Episode;

/// Domain randomisation: draws numbers at the beginning of every episode and applies them to the system and the task.
///
/// A [`Clock`](libration_core::control::Clock) draws the rate of a clock, [`Delays`](super::Delays) the latencies, and
/// [`ErrorScale`](super::ErrorScale) the factors of clock and sensor errors.
pub trait Variation<T: Float, Sys, K>: Copy + Send + Sync {
    /// The random parameters of an environment for the episode.
    type Numbers: Memory<T>;

    /// Whether the variation changes nothing.
    const SAME: bool = false;

    /// Checks the parameters.
    ///
    /// # Errors
    /// The first invalid parameter.
    fn check(&self) -> Result<(), ControlError> {
        Ok(())
    }

    /// Draws the parameters of an episode.
    fn draw(&self, episode: Episode) -> Self::Numbers;

    /// The system and the task of the episode. An implementation branches on values of `self` only and is `#[inline(always)]`;
    /// otherwise the loops over environments are not vectorised.
    fn apply(&self, numbers: &Self::Numbers, system: Sys, task: K) -> (Sys, K);
}

/// No variation: every episode has the same system and task.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct NoVariation;

impl<T: Float, Sys, K> Variation<T, Sys, K> for NoVariation {
    type Numbers = [T; 0];

    const SAME: bool = true;

    fn draw(&self, _: Episode) -> [T; 0] {
        []
    }

    #[inline(always)]
    fn apply(&self, _: &[T; 0], system: Sys, task: K) -> (Sys, K) {
        (system, task)
    }
}

/// `N` random parameters and the function that applies them.
///
/// ```
/// use libration::rl::{Distribution, task::Regulate, variation::RandomParameters};
/// use libration::system::Oscillator;
///
/// let stiffness = RandomParameters {
///     numbers: [Distribution::Uniform(5.0, 15.0)],
///     apply: |[omega2]: [f32; 1], _: Oscillator<f32>, task: Regulate| (Oscillator { omega2 }, task),
/// };
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RandomParameters<F, const N: usize> {
    /// The distribution of each parameter.
    pub numbers: [Distribution; N],
    /// The system and the task, made of the numbers and of what they would be without.
    pub apply: F,
}

impl<T, Sys, K, F, const N: usize> Variation<T, Sys, K> for RandomParameters<F, N>
where
    T: Float,
    F: Fn([T; N], Sys, K) -> (Sys, K) + Copy + Send + Sync,
{
    type Numbers = [T; N];

    fn check(&self) -> Result<(), ControlError> {
        self.numbers.iter().enumerate().try_for_each(|(i, distribution)| distribution.check::<T>(i))
    }

    fn draw(&self, episode: Episode) -> [T; N] {
        const { Episode::assert_draws(N) };
        each(|i| T::from_f64(self.numbers[i].draw(episode, Purpose::Variation, i)))
    }

    #[inline(always)]
    fn apply(&self, numbers: &[T; N], system: Sys, task: K) -> (Sys, K) {
        (self.apply)(*numbers, system, task)
    }
}
