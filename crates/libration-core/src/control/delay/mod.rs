//! Delays: arrival times of commands.

mod latencies;
mod packets;
mod random_delay;
mod recorded_latencies;
mod schedule;

pub use latencies::Latencies;
pub use packets::{Order, Packets, PacketsError};
pub use random_delay::Random;
pub use recorded_latencies::{RecordedLatencies, RecordedLatenciesError};
pub use schedule::{Event, Schedule, ScheduleError};

use super::{ControlError, Memory, StartAddress};
use crate::Float;

/// A delay: determines which command acts.
///
/// Either all trajectories share a [`Schedule`], or at most one command arrives per step and trajectory.
pub trait Delay<T: Float>: Copy + Send + Sync {
    /// Whether there is one schedule for all.
    const SHARED: bool = false;
    /// The number of places at which a step can split: arrivals of commands, and samples.
    const SPLITS: usize;

    /// The memory per trajectory.
    type Memory: Memory<T>;
    /// The values that all trajectories share at a step.
    type Beat: Copy;

    /// Checks the parameters; `Loops` call it before they begin.
    ///
    /// # Errors
    /// The first invalid parameter.
    fn check(&self) -> Result<(), ControlError> {
        Ok(())
    }

    /// The times of samples and commands that all trajectories share. Where they do not, a command is computed in every
    /// step.
    fn schedule(&self) -> Schedule {
        Schedule::EVERY_STEP
    }

    /// The age, in commands, of the oldest that may still arrive.
    fn longest(&self) -> usize;

    /// The memory before the first step.
    fn start(&self, begin: StartAddress) -> Self::Memory;

    /// The values that all trajectories share at `step`.
    fn beat(&self, step: u64) -> Self::Beat;

    /// The number of random words per step, the same for every step and trajectory.
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

    /// The command that arrives in a step, without a common schedule.
    fn arrival(
        &self,
        memory: &mut Self::Memory,
        beat: Self::Beat,
        word: &mut impl FnMut() -> u32,
    ) -> Arrival<T>;
}

/// The arrival of a command in a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Arrival<T> {
    /// Whether a command arrives; if not, the acting one stays.
    pub fresh: bool,
    /// The age in steps; a command older than the longest latency never arrives.
    pub age: u32,
    /// The fraction of the step after which it arrives, at least 0 and below 1. It is 0 unless steps split.
    pub part: T,
    /// The fraction of the step after which the loop samples and computes the command of age 0; at least 0 and below 1.
    /// It is 0 unless steps split in two places; a command that arrives in the same step is older.
    pub looks: T,
}

impl<T: Float> Arrival<T> {
    /// A command of `age` steps ago that arrives with the beginning of the step.
    #[inline(always)]
    fn of_age(age: u32) -> Self {
        Arrival { fresh: true, age, part: T::zero(), looks: T::zero() }
    }
}

/// A schedule is a delay: the same for all trajectories.
impl<T: Float> Delay<T> for Schedule {
    const SHARED: bool = true;
    const SPLITS: usize = 2;

    type Memory = [T; 0];
    type Beat = ();

    fn schedule(&self) -> Schedule {
        *self
    }

    fn longest(&self) -> usize {
        self.commands_in_transit()
    }

    fn start(&self, _: StartAddress) -> [T; 0] {
        []
    }

    fn beat(&self, _: u64) {}

    #[inline(always)]
    fn arrival(&self, _: &mut [T; 0], (): (), _: &mut impl FnMut() -> u32) -> Arrival<T> {
        Arrival::of_age(0)
    }
}
