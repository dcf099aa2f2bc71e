//! Numbers that an environment has for an episode.

use std::sync::Arc;

use libration_core::Float;
use libration_core::control::ControlError;
use libration_core::control::error::ensure_finite;
use libration_core::random::Purpose;

use super::Distribution;
use super::start::Episode;

/// A number of an environment by program: a constant, or one that differs between episodes or environments.
#[derive(Clone, Debug, PartialEq)]
pub enum EpisodeNumber {
    /// The same in all episodes.
    Constant(f64),
    /// Drawn at the beginning of every episode.
    Drawn(Distribution),
    /// One for each environment of the batch, in all of its episodes.
    PerEnvironment(Arc<[f64]>),
}

impl From<f64> for EpisodeNumber {
    fn from(value: f64) -> Self {
        EpisodeNumber::Constant(value)
    }
}

impl EpisodeNumber {
    /// The most numbers of an episode.
    pub const MOST: usize = 64;

    /// The value, if it is the same in all episodes.
    pub fn as_constant(&self) -> Option<f64> {
        match self {
            EpisodeNumber::Constant(value) => Some(*value),
            EpisodeNumber::Drawn(_) | EpisodeNumber::PerEnvironment(_) => None,
        }
    }

    /// The number of environments that it is for, if that is limited.
    pub(super) fn environments(&self) -> Option<usize> {
        match self {
            EpisodeNumber::PerEnvironment(all) => Some(all.len()),
            EpisodeNumber::Constant(_) | EpisodeNumber::Drawn(_) => None,
        }
    }

    /// The smallest value; minus infinity where there is none.
    pub(super) fn least(&self) -> f64 {
        match self {
            EpisodeNumber::Constant(value) => *value,
            EpisodeNumber::PerEnvironment(all) => all.iter().copied().fold(f64::INFINITY, f64::min),
            EpisodeNumber::Drawn(distribution) => distribution.least(),
        }
    }

    pub(super) fn check<T: Float>(&self, index: usize) -> Result<(), ControlError> {
        let indexed = |error| ControlError { index: Some(index), ..error };
        let finite = |&value: &f64| ensure_finite::<T>("parameter of an episode", value);
        match self {
            EpisodeNumber::Constant(value) => finite(value).map_err(indexed),
            EpisodeNumber::PerEnvironment(all) => all.iter().try_for_each(finite).map_err(indexed),
            EpisodeNumber::Drawn(distribution) => distribution.check::<T>(index),
        }
    }

    /// The number of an episode of environment `n` of the batch; `i` is its place among the numbers of the episode.
    pub(super) fn of(&self, episode: Episode, i: usize, n: usize) -> f64 {
        match self {
            EpisodeNumber::Constant(value) => *value,
            EpisodeNumber::Drawn(distribution) => distribution.draw(episode, Purpose::Variation, i),
            EpisodeNumber::PerEnvironment(all) => all[n],
        }
    }
}
