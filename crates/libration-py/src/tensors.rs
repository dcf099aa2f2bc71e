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
        fn column<X, T, const O: usize>(
            ends: &[EpisodeEnd<T, O>],
            of: impl Fn(&EpisodeEnd<T, O>) -> X,
        ) -> Vec<X> {
            ends.iter().map(of).collect()
        }
        let ends = self.finals();
        Ended {
            steps: column(ends, |end| end.step),
            environments: column(ends, |end| end.environment),
            lengths: column(ends, |end| end.length),
            returns: column(ends, |end| end.episode_return),
            lost: column(ends, |end| end.lost),
            seen: ends.iter().flat_map(|end| end.observation).collect(),
        }
    }

    fn transitions(&self) -> Vec<bool> {
        let Plan { horizon, environments, .. } = Rollout::plan(self);
        let all = (0..horizon).flat_map(|t| (0..environments).map(move |n| (t, n)));
        all.map(|(t, n)| self.is_transition(t, n)).collect()
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
