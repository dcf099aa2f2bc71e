//! Clocks: lengths of steps.

mod autoregressive;
mod clock_rate;
mod independent_jitter;
mod late_ticks;
mod missed_ticks;
mod noise;
mod random_walk;
mod sinusoidal;
mod time_record;

pub use autoregressive::Correlated;
pub use clock_rate::{Drifting, Fixed, Rates, Skewed};
pub use independent_jitter::Jittered;
pub use late_ticks::LateTicks;
pub use missed_ticks::MissedTicks;
pub use noise::{Gaussian, Noise, Uniform};
pub use random_walk::RandomWalk;
pub use sinusoidal::Sinusoidal;
pub use time_record::{Recorded, RecordedError};

use super::{ControlError, Memory, StartAddress};
use crate::Float;

/// A clock: the length of every step of every trajectory, in units of the time step `Δt`.
///
/// No step is negative: where noise would make it so, it is of length zero, since a clock does not go back. Two clocks
/// in a pair are one, whose steps are the products of theirs.
pub trait Clock<T: Float>: Copy + Send + Sync {
    /// The memory per trajectory.
    type Memory: Memory<T>;
    /// The values that all trajectories share at a step.
    type Beat: Copy;

    /// Whether every step is `Δt` long.
    const EVEN: bool = false;
    /// Whether steps are random.
    const DRAWS: bool = false;

    /// Checks the parameters; `Loops` call it before they begin.
    ///
    /// # Errors
    /// The first invalid parameter.
    fn check(&self) -> Result<(), ControlError> {
        Ok(())
    }

    /// The memory before the first step.
    fn start(&self, begin: StartAddress) -> Self::Memory;

    /// The values that all trajectories share at `step`.
    fn beat(&self, step: u64) -> Self::Beat;

    /// The number of random words per step, the same for every step and trajectory; 0 for a clock that does not draw.
    fn words(&self) -> usize {
        0
    }

    /// The number of steps of the record; none if there is no limit.
    fn steps(&self) -> Option<u64> {
        None
    }

    /// The number of listed trajectories; none if there is no limit.
    fn trajectories(&self) -> Option<usize> {
        None
    }

    /// The length of the step in units of `Δt`. An implementation branches on values of `self` only and is
    /// `#[inline(always)]`; otherwise its loops are not vectorised.
    fn ratio(
        &self,
        memory: &mut Self::Memory,
        beat: Self::Beat,
        word: &mut impl FnMut() -> u32,
    ) -> T;
}

impl<T: Float, A: Clock<T>, B: Clock<T>> Clock<T> for (A, B) {
    type Memory = (A::Memory, B::Memory);
    type Beat = (A::Beat, B::Beat);

    const EVEN: bool = A::EVEN && B::EVEN;
    const DRAWS: bool = A::DRAWS || B::DRAWS;

    fn check(&self) -> Result<(), ControlError> {
        self.0.check()?;
        self.1.check()
    }

    fn start(&self, begin: StartAddress) -> Self::Memory {
        let [first, second] = begin.halves();
        (self.0.start(first), self.1.start(second))
    }

    fn beat(&self, step: u64) -> Self::Beat {
        (self.0.beat(step), self.1.beat(step))
    }

    fn words(&self) -> usize {
        self.0.words() + self.1.words()
    }

    fn steps(&self) -> Option<u64> {
        fewest(self.0.steps(), self.1.steps())
    }

    fn trajectories(&self) -> Option<usize> {
        fewest(self.0.trajectories(), self.1.trajectories())
    }

    #[inline(always)]
    fn ratio(
        &self,
        memory: &mut Self::Memory,
        beat: Self::Beat,
        word: &mut impl FnMut() -> u32,
    ) -> T {
        let first = self.0.ratio(&mut memory.0, beat.0, word);
        first * self.1.ratio(&mut memory.1, beat.1, word)
    }
}

/// The smaller of both, where there are limits.
fn fewest<N: Ord>(a: Option<N>, b: Option<N>) -> Option<N> {
    a.into_iter().chain(b).min()
}

/// `1 + ε`, but not below zero.
#[inline(always)]
fn forward<T: Float>(epsilon: T) -> T {
    let ratio = T::one() + epsilon;
    // What is no number stays none, to be seen.
    if ratio < T::zero() { T::zero() } else { ratio }
}
