//! Type-erased rollouts.

use std::any::Any;

use libration::ensemble::Execution;
use libration::rl::{Discounts, EnvironmentError, EpisodeEnd, Estimates, Plan, Rollout};

use crate::array::Number;

/// A [`Rollout`] of environments that show any number of numbers.
pub(crate) trait Tensors<T>: Send + Sync {
    fn plan(&self) -> Plan;

    fn observations(&self) -> usize;

    /// Its tensors of numbers, each with how many a transition has.
    fn numbers(&self) -> Vec<(&'static str, &[T], usize)>;

    /// Its flags.
    fn flags(&self) -> [(&'static str, &[u8]); 2];

    /// Episodes that ended.
    fn ends(&self) -> Ended<T>;

    /// Whether each step is a transition: `[t, n]`.
    fn transitions(&self) -> Vec<bool>;

    fn estimate(
        &self,
        to: &mut Estimates<T>,
        discounts: Discounts,
        next: &[T],
        last: &[T],
    ) -> Result<(), EnvironmentError>;

    fn as_any(&mut self) -> &mut dyn Any;
}

/// Columns of episodes that ended, by step and environment.
pub(crate) struct Ended<T> {
    pub(crate) steps: Vec<usize>,
    pub(crate) environments: Vec<usize>,
    pub(crate) lengths: Vec<u64>,
    pub(crate) returns: Vec<f64>,
    pub(crate) lost: Vec<bool>,
    /// Final observations, `[k, i]`.
    pub(crate) seen: Vec<T>,
}

impl<T> Ended<T> {
    /// The columns of episodes with these final observations.
    pub(crate) fn new<X, const O: usize>(ends: &[EpisodeEnd<X, O>], seen: Vec<T>) -> Self {
        Ended {
            steps: ends.iter().map(|end| end.step).collect(),
            environments: ends.iter().map(|end| end.environment).collect(),
            lengths: ends.iter().map(|end| end.length).collect(),
            returns: ends.iter().map(|end| end.episode_return).collect(),
            lost: ends.iter().map(|end| end.lost).collect(),
            seen,
        }
    }
}

impl<T: Number, const O: usize> Tensors<T> for Rollout<T, O, 1> {
    fn plan(&self) -> Plan {
        Rollout::plan(self)
    }

    fn observations(&self) -> usize {
        O
    }

    fn numbers(&self) -> Vec<(&'static str, &[T], usize)> {
        vec![
            ("observations", self.observation(), O),
            ("actions", self.action(), 1),
            ("rewards", self.reward(), 0),
            ("log_probabilities", self.log_probability(), 0),
            ("values", self.value(), 0),
        ]
    }

    fn flags(&self) -> [(&'static str, &[u8]); 2] {
        [("terminated", self.terminated()), ("truncated", self.truncated())]
    }

    fn ends(&self) -> Ended<T> {
        let ends = self.finals();
        Ended::new(ends, ends.iter().flat_map(|end| end.observation).collect())
    }

    fn transitions(&self) -> Vec<bool> {
        Rollout::transitions(self)
    }

    fn estimate(
        &self,
        to: &mut Estimates<T>,
        discounts: Discounts,
        next: &[T],
        last: &[T],
    ) -> Result<(), EnvironmentError> {
        to.fill(discounts, self, next, last, &Execution::serial())
    }

    fn as_any(&mut self) -> &mut dyn Any {
        self
    }
}
