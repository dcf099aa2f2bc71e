//! Latencies of observations and actions.

use libration_core::control::error::ensure;
use libration_core::control::{ControlError, Latency};
use libration_core::random::Purpose;

use super::start::{Episode, uniform};

/// Latencies in steps of the integrator, drawn uniformly for every environment at the beginning of every episode.
///
/// An observation is the state one latency ago, or the initial state of the episode. An action takes effect one latency after
/// its observation; until the first action does, the command is zero.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Delays {
    /// The smallest and largest latency of observations.
    pub observation: [u32; 2],
    /// The smallest and largest latency of actions.
    pub action: [u32; 2],
}

impl Delays {
    /// Constant latencies.
    pub fn of(observation: u32, action: u32) -> Self {
        Delays { observation: [observation; 2], action: [action; 2] }
    }

    /// Whether all latencies are zero.
    pub fn is_none(&self) -> bool {
        *self == Delays::default()
    }

    /// Whether latencies differ between episodes.
    pub(super) fn varies(&self) -> bool {
        [self.observation, self.action].iter().any(|[least, most]| least != most)
    }

    pub(super) fn check(&self) -> Result<(), ControlError> {
        for (name, [least, most]) in
            [("latency of observations", self.observation), ("latency of actions", self.action)]
        {
            let allowed = "at most 4096 steps";
            ensure(name, most.into(), allowed, |most| most <= Latency::MOST_STEPS as f64)?;
            let allowed = "at most the largest";
            ensure(name, least.into(), allowed, |least| least <= f64::from(most))?;
        }
        Ok(())
    }

    /// The latencies of observations and actions of an episode.
    pub(super) fn draw(&self, episode: Episode) -> [u32; 2] {
        if !self.varies() {
            return [self.observation[0], self.action[0]];
        }
        let shares = uniform::shares::<2>(episode, Purpose::Delay, 0);
        let drawn = |[least, most]: [u32; 2], share: f64| {
            least + (share * (f64::from(most - least) + 1.0)) as u32
        };
        [drawn(self.observation, shares[0]), drawn(self.action, shares[1])]
    }
}
