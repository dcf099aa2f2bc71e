//! Latencies per trajectory.

use super::{Arrival, Delay};
use crate::Float;
use crate::control::{ControlError, Latency, StartAddress};

/// Latencies of commands and of observations per trajectory, of any length: steps split at samples and at arrivals of
/// commands.
///
/// The command computed at the beginning of a step follows from the state one latency earlier.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Latencies<'a> {
    commands: &'a [Latency],
    observations: &'a [Latency],
}

impl<'a> Latencies<'a> {
    /// The latencies of the commands, one per trajectory.
    pub fn of_commands(commands: &'a [Latency]) -> Self {
        Latencies { commands, observations: &[] }
    }

    /// Adds latencies of the observations, as many as of commands.
    pub fn with_observations(self, observations: &'a [Latency]) -> Self {
        Latencies { observations, ..self }
    }

    /// Of a trajectory; beyond the last are those that only fill a block.
    fn of(&self, n: usize) -> (Latency, Latency) {
        let one = |of: &[Latency]| of.get(n).copied().unwrap_or(Latency::NONE);
        (one(self.commands), one(self.observations))
    }
}

/// In which an age has two digits: every float type holds whole numbers up to it.
const DIGIT: u64 = 128;

/// The steps between a sample and the arrival of its command, with the fractions of these steps.
fn age((command, observation): (Latency, Latency)) -> u64 {
    command.whole() + observation.whole() + u64::from(observation.part() > 0.0)
}

impl<T: Float> Delay<T> for Latencies<'_> {
    const SPLITS: usize = 2;

    /// The age of what arrives, in two digits, since short floats do not hold every whole number; and the parts of a step after which it
    /// does, and after which the loop looks.
    type Memory = [T; 4];
    type Beat = ();

    fn check(&self) -> Result<(), ControlError> {
        let (count, commands) = (self.observations.len(), self.commands.len());
        match count == 0 || count == commands {
            true => Ok(()),
            false => Err(ControlError {
                name: "the number of latencies of observations",
                index: None,
                value: count as f64,
                allowed: "that of the latencies of commands, or 0",
            }),
        }
    }

    fn longest(&self) -> usize {
        (0..self.commands.len()).map(|n| age(self.of(n)) as usize).max().unwrap_or(0)
    }

    fn start(&self, begin: StartAddress) -> [T; 4] {
        let (command, observation) = self.of(begin.trajectory() as usize);
        // What is observed late was seen in the rest of a step before.
        let looks = if observation.part() > 0.0 { 1.0 - observation.part() } else { 0.0 };
        let age = age((command, observation));
        let [high, low] = [age / DIGIT, age % DIGIT].map(|digit| digit as f64);
        [high, low, command.part(), looks].map(T::from_f64)
    }

    fn beat(&self, _: u64) {}

    fn trajectories(&self) -> Option<usize> {
        Some(self.commands.len())
    }

    #[inline(always)]
    fn arrival(
        &self,
        &mut [high, low, part, looks]: &mut [T; 4],
        (): (),
        _: &mut impl FnMut() -> u32,
    ) -> Arrival<T> {
        let age = high.to_f64() as u32 * DIGIT as u32 + low.to_f64() as u32;
        Arrival { fresh: true, age, part, looks }
    }
}
