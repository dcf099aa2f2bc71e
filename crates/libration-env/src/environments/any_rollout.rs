//! Rollouts of any sizes.

use std::any::Any;

use bytemuck::Pod;
use libration::ensemble::Execution;
use libration::rl::{
    Discounts, EnvironmentError, EpisodeEnds, Estimates, Plan, ProgramRollout, Rollout,
};
use libration::{Elementary, Float};

/// A [`Rollout`] or a [`ProgramRollout`].
pub trait AnyRollout<T>: Send + Sync {
    /// The plan.
    fn plan(&self) -> Plan;

    /// The numbers of observations and of actions.
    fn sizes(&self) -> [usize; 2];

    /// The observations: `[t, n, i]` or `[i, t, n]`, depending on the layout.
    fn observation(&self) -> &[T];

    /// The actions, in the same order.
    fn action(&self) -> &[T];

    /// The rewards: `[t, n]`.
    fn reward(&self) -> &[T];

    /// 1 where the episode terminated, otherwise 0: `[t, n]`.
    fn terminated(&self) -> &[u8];

    /// 1 where the time limit truncated the episode, otherwise 0: `[t, n]`, or empty.
    fn truncated(&self) -> &[u8];

    /// The logarithms of the probability densities of the actions: `[t, n]`, or empty.
    fn log_probability(&self) -> &[T];

    /// The values of the observations, written by the caller: `[t, n]`, or empty.
    fn value(&self) -> &[T];

    /// The episodes that ended, by step and environment.
    fn ends(&self) -> EpisodeEnds<T>;

    /// The number of episodes that ended.
    fn ended(&self) -> usize;

    /// Whether each step is a transition: `[t, n]`.
    fn transitions(&self) -> Vec<bool>;

    /// Computes advantages and returns.
    ///
    /// # Errors
    /// See [`Estimates::fill`].
    fn estimate(
        &self,
        to: &mut Estimates<T>,
        discounts: Discounts,
        next: &[T],
        last: &[T],
    ) -> Result<(), EnvironmentError>;

    /// The rollout with its type.
    fn as_any(&mut self) -> &mut dyn Any;
}

/// The methods that a rollout has by other names; `$rest` is what has the numbers of each transition.
macro_rules! rollout {
    ($self:ident, $rest:expr) => {
        fn plan(&$self) -> Plan {
            $rest.plan()
        }

        fn observation(&$self) -> &[T] {
            $self.observation()
        }

        fn action(&$self) -> &[T] {
            $self.action()
        }

        fn reward(&$self) -> &[T] {
            $rest.reward()
        }

        fn terminated(&$self) -> &[u8] {
            $rest.terminated()
        }

        fn truncated(&$self) -> &[u8] {
            $rest.truncated()
        }

        fn log_probability(&$self) -> &[T] {
            $rest.log_probability()
        }

        fn value(&$self) -> &[T] {
            $rest.value()
        }

        fn ended(&$self) -> usize {
            $rest.finals().len()
        }

        fn transitions(&$self) -> Vec<bool> {
            $rest.transitions()
        }

        fn estimate(
            &$self,
            to: &mut Estimates<T>,
            discounts: Discounts,
            next: &[T],
            last: &[T],
        ) -> Result<(), EnvironmentError> {
            to.fill(discounts, $rest, next, last, &Execution::serial())
        }

        fn as_any(&mut $self) -> &mut dyn Any {
            $self
        }
    };
}

impl<T: Float + Elementary + Pod, const O: usize> AnyRollout<T> for Rollout<T, O, 1> {
    rollout!(self, self);

    fn sizes(&self) -> [usize; 2] {
        [O, 1]
    }

    fn ends(&self) -> EpisodeEnds<T> {
        self.finals().into()
    }
}

impl<T: Float + Elementary + Pod> AnyRollout<T> for ProgramRollout<T> {
    rollout!(self, ProgramRollout::transitions(self));

    fn sizes(&self) -> [usize; 2] {
        ProgramRollout::sizes(self)
    }

    fn ends(&self) -> EpisodeEnds<T> {
        ProgramRollout::ends(self)
    }
}
