//! The times that a policy takes to answer.

use libration_core::Float;
use libration_core::control::error::ensure;
use libration_core::control::{ControlError, Latency};
use libration_core::random::Purpose;

use crate::rl::block_size::LANES;
use crate::rl::start::Episode;
use crate::rl::{Delays, Distribution};

/// Times from observation to action that are drawn for every action, as of a policy whose inference takes now longer, now shorter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AnswerTimes {
    /// The distribution of the time in seconds. At most its mean and eight standard deviations, where it has no end.
    pub time: Distribution,
    /// The number of steps of the integrator in which the system waits for its action at the beginning of each period; 0 if it does not
    /// wait.
    ///
    /// A system that waits goes on under the command before. These steps are `dt` long until the time that was drawn is over, without
    /// errors of the clock, and belong to the [substeps](super::ProgramEnvironment::substeps). The latency of actions must be these
    /// steps. An inner controller begins a new period with the answer.
    ///
    /// A system that does not wait goes on under the newest action that has arrived: an action that arrives after a newer one is never
    /// used. Times are rounded to whole steps and added to the latency of actions.
    pub waits: u32,
}

impl AnswerTimes {
    /// The most steps after which an action of a system that does not wait arrives.
    pub(super) fn most_steps(&self, dt: f64) -> u32 {
        // A cast saturates.
        if self.waits > 0 { 0 } else { (self.time.largest() / dt).round() as u32 }
    }

    pub(super) fn check<T: Float>(
        &self,
        dt: f64,
        substeps: u32,
        delays: Delays,
    ) -> Result<(), ControlError> {
        self.time.check::<T>(0).map_err(|error| ControlError { index: None, ..error })?;
        let least = self.time.least();
        ensure("shortest time of an answer", least, "at least 0", |least| least >= 0.0)?;
        let steps = f64::from(delays.action[1]) + f64::from(self.most_steps(dt));
        let allowed = "at most 4096 steps of the integrator";
        ensure("longest time of an answer", steps, allowed, |steps| {
            steps <= Latency::MOST_STEPS as f64
        })?;
        let (waits, allowed) = (f64::from(self.waits), "less than the substeps");
        ensure("steps of waiting for an answer", waits, allowed, |waits| {
            waits < f64::from(substeps)
        })?;
        let allowed = "the steps of waiting for an answer";
        for latency in delays.action.into_iter().filter(|_| self.waits > 0) {
            ensure("latency of actions", latency.into(), allowed, |_| latency == self.waits)?;
        }
        Ok(())
    }

    /// The time of the answer to the observation after so many actions of an episode, in seconds.
    pub(super) fn draw(&self, episode: Episode, age: u64) -> f64 {
        self.time.draw_at(episode.epoch(Purpose::Latency, age)).min(self.time.largest())
    }

    /// The latencies of these answers in whole steps of the integrator.
    pub(super) fn steps<T: Float>(
        &self,
        times: &[f64; LANES],
        dt: f64,
        base: &[u32; LANES],
    ) -> [T; LANES] {
        core::array::from_fn(|l| T::from_f64((times[l] / dt).round() + f64::from(base[l])))
    }

    /// The lengths of a step of waiting for these answers.
    pub(super) fn waiting<T: Float>(
        &self,
        times: &[f64; LANES],
        dt: f64,
        substep: u64,
    ) -> [T; LANES] {
        times.map(|time| T::from_f64((time - substep as f64 * dt).clamp(0.0, dt)))
    }
}
