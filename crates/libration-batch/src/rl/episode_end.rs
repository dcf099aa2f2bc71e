//! The end of an episode.

/// The end of an episode.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EpisodeEnd<T, const O: usize> {
    /// In which step of the rollout.
    pub step: usize,
    /// Of which environment.
    pub environment: usize,
    /// What was seen last, before the next episode began.
    pub observation: [T; O],
    /// What the episode paid in all: the sum of sums of at most 32 rewards in the float type.
    pub episode_return: f64,
    /// Its actions.
    pub length: u64,
    /// Whether the environment was lost: its state, its action or what it was paid was no finite number.
    pub lost: bool,
}
