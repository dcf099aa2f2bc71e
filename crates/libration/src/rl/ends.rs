//! Ends of episodes.

/// The end of an episode.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Final<T, const O: usize> {
    /// In which step of the rollout.
    pub step: usize,
    /// Of which environment.
    pub environment: usize,
    /// What was seen last, before the next episode began.
    pub observation: [T; O],
    /// What the episode paid in all.
    pub episode_return: T,
    /// Its actions.
    pub length: u64,
    /// Whether the environment was lost: its state was no longer finite.
    pub lost: bool,
}
