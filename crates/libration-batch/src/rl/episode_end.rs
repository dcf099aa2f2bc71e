//! The end of an episode.

use core::mem::swap;

/// The end of an episode.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EpisodeEnd<T, const O: usize> {
    /// The step of the rollout.
    pub step: usize,
    /// The number of the environment.
    pub environment: usize,
    /// The final observation, before the next episode began.
    pub observation: [T; O],
    /// The return of the episode: the sum of sums of at most 32 rewards in the float type.
    pub episode_return: f64,
    /// The number of actions.
    pub length: u64,
    /// Whether the environment was lost: its state, observation, action or reward was not finite.
    pub lost: bool,
}

impl<T, const O: usize> EpisodeEnd<T, O> {
    /// The same without the observation.
    pub(super) fn without_observation(&self) -> EpisodeEnd<T, 0> {
        let EpisodeEnd { step, environment, episode_return, length, lost, .. } = *self;
        EpisodeEnd { step, environment, observation: [], episode_return, length, lost }
    }

    /// The ends of all threads, by step and environment.
    pub(super) fn in_order(threads: Vec<Vec<Self>>) -> Vec<Self> {
        let mut all = Vec::new();
        for mut ends in threads {
            if all.is_empty() {
                // With one thread these are all, and nothing is copied.
                swap(&mut all, &mut ends);
            }
            all.append(&mut ends);
        }
        all.sort_unstable_by_key(|end| (end.step, end.environment));
        all
    }
}
