//! Commands as packets of independent random latencies.

use thiserror::Error;

use super::{Arrival, Delay};
use crate::Float;
use crate::control::StartAddress;
use crate::random::uniform;

/// Latencies that a packet can have, from 0 steps on.
const PLACES: usize = 16;

/// Every command is a packet that travels for a random number of steps, or is lost.
///
/// What acts is held until another packet arrives. Of those that arrive together the newest counts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Packets {
    /// Above which uniform number on (−1, 1) a packet takes longer than `i` steps.
    limits: [f32; PLACES],
    longest: usize,
    /// The fraction of a step that a packet takes besides whole steps.
    part: f64,
    order: Order,
}

/// The treatment of a packet that a newer one has overtaken.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Order {
    /// The packet is discarded, as by a receiver that compares sequence numbers or time stamps.
    NewestActs,
    /// The packet acts, because it arrives last.
    LastActs,
}

/// Error of the latencies of packets.
#[derive(Clone, Copy, Debug, Error, PartialEq)]
pub enum PacketsError {
    /// There are none, or too many.
    #[error("{0} probabilities; there must be 1 to {PLACES}, for latencies of 0 steps and on")]
    Count(usize),
    /// A probability is invalid.
    #[error("the probability of a latency of {steps} steps is {value}; it must be from 0 to 1")]
    Probability {
        /// The latency in steps.
        steps: usize,
        /// The probability.
        value: f64,
    },
    /// The fraction of a step is not at least 0 and below 1.
    #[error("the part of a step is {0}; it must be at least 0 and below 1")]
    Part(f64),
    /// The sum exceeds 1.
    #[error("the probabilities sum to {0}; it must be at most 1, and the rest is lost")]
    Sum(f64),
}

impl Packets {
    /// Packets with a latency of `i` steps with probability `probabilities[i]`; the rest to 1 is lost.
    ///
    /// # Errors
    /// A [`PacketsError`].
    pub fn new(probabilities: &[f64], order: Order) -> Result<Self, PacketsError> {
        if !(1..=PLACES).contains(&probabilities.len()) {
            return Err(PacketsError::Count(probabilities.len()));
        }
        let bad = probabilities.iter().position(|p| !(0.0..=1.0).contains(p));
        if let Some(steps) = bad {
            return Err(PacketsError::Probability { steps, value: probabilities[steps] });
        }
        let sum: f64 = probabilities.iter().sum();
        if sum > 1.0 + 1e-12 {
            return Err(PacketsError::Sum(sum));
        }
        let mut limits = [2.0; PLACES];
        let mut below = 0.0;
        for (i, limit) in limits.iter_mut().enumerate() {
            below += probabilities.get(i).copied().unwrap_or(0.0);
            // What rounding leaves to 1 is nobody's.
            *limit = if below >= 1.0 - 1e-12 { 1.0 } else { (2.0 * below - 1.0) as f32 };
        }
        Ok(Packets { limits, longest: probabilities.len() - 1, part: 0.0, order })
    }

    /// These packets, each later by this fraction of a step.
    ///
    /// # Errors
    /// If it is negative, or 1 or more.
    pub fn longer_by(self, part: f64) -> Result<Self, PacketsError> {
        let fits = (0.0..1.0).contains(&part);
        fits.then_some(Packets { part, ..self }).ok_or(PacketsError::Part(part))
    }
}

impl<T: Float> Delay<T> for Packets {
    const SPLITS: usize = 1;

    /// The age of the command that acts; and in how many steps the packets of the last steps arrive, or −1.
    type Memory = ([T; 1], [T; PLACES]);
    type Beat = ();

    fn longest(&self) -> usize {
        self.longest
    }

    fn start(&self, _: StartAddress) -> Self::Memory {
        // Any packet is newer than what acts before the first.
        ([T::from_f64(f64::from(u16::MAX))], [T::from_f64(-1.0); PLACES])
    }

    fn beat(&self, _: u64) {}

    fn words(&self) -> usize {
        1
    }

    #[inline(always)]
    fn arrival(
        &self,
        (held, travelling): &mut Self::Memory,
        (): (),
        word: &mut impl FnMut() -> u32,
    ) -> Arrival<T> {
        let number = uniform(word());
        let one = T::one();
        for i in (1..PLACES).rev() {
            travelling[i] = travelling[i - 1] - one;
        }
        let (mut takes, mut lost) = (T::zero(), true);
        for limit in self.limits {
            let longer = number >= limit;
            takes = if longer { takes + one } else { takes };
            lost &= longer;
        }
        travelling[0] = if lost { -one } else { takes };
        // The newest of those that arrive now.
        let (mut age, mut fresh) = (0_u32, false);
        for i in (0..PLACES).rev() {
            let arrives = travelling[i] == T::zero();
            age = if arrives { i as u32 } else { age };
            fresh |= arrives;
        }
        // A command that acted becomes a step older.
        let older = held[0] + one;
        let newer = T::from_f64(f64::from(age)) < older;
        let fresh = fresh & (newer | (self.order == Order::LastActs));
        held[0] = if fresh { T::from_f64(f64::from(age)) } else { older };
        Arrival { fresh, age, part: T::from_f64(self.part), looks: T::zero() }
    }
}
