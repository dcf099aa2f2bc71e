//! The end of an episode.

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
    /// Whether the environment was lost: its state, action or reward was not finite.
    pub lost: bool,
}
