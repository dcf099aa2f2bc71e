//! The timing of a loop.

use libration_core::control::{Jitter, Latency};

/// Most states of a loop whose periods are drawn.
pub(crate) const MOST_RANDOM: usize = 100;

/// Most states of a loop whose periods are all the same.
pub(crate) const MOST_REPEATED: usize = 300;

/// The timing of a loop.
#[derive(Clone, Debug, PartialEq)]
pub struct LoopTiming {
    /// The latency of each input, in periods.
    pub input_latency: Vec<Latency>,
    /// The latency of each output, in periods.
    pub output_latency: Vec<Latency>,
    /// The law of the lengths of periods, each drawn independently.
    pub jitter: Jitter,
    /// The part by which all periods are longer than they should be.
    pub skew: f64,
    /// The probability that the commands that arrive in a period are lost, all of them together and independently of other periods.
    /// Where latencies of inputs differ by whole periods, commands that were computed together arrive apart.
    pub loss: f64,
    /// What acts where a command is missing.
    pub missing: MissingCommand,
}

/// What acts in place of a command that is lost, until the next one takes over.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum MissingCommand {
    /// The command that acts already.
    #[default]
    Hold,
    /// None: zero.
    Zero,
}

impl LoopTiming {
    /// Perfect timing of a loop with so many inputs and outputs.
    pub fn ideal(inputs: usize, outputs: usize) -> Self {
        LoopTiming {
            input_latency: vec![Latency::NONE; inputs],
            output_latency: vec![Latency::NONE; outputs],
            jitter: Jitter::Gaussian(0.0),
            skew: 0.0,
            loss: 0.0,
            missing: MissingCommand::Hold,
        }
    }

    /// Whether nothing is wrong with the timing.
    pub fn is_ideal(&self) -> bool {
        let late = |latency: &Latency| *latency != Latency::NONE;
        self.repeats()
            && self.skew == 0.0
            && !self.input_latency.iter().chain(&self.output_latency).any(late)
    }

    /// Whether all periods are the same.
    pub fn repeats(&self) -> bool {
        self.jitter.rms() == 0.0 && self.loss == 0.0
    }

    /// The most states of a loop.
    pub(crate) fn most_states(&self) -> usize {
        if self.repeats() { MOST_REPEATED } else { MOST_RANDOM }
    }
}
