//! Rollouts of any sizes.

use bytemuck::Pod;

use super::{EpisodeEnd, Plan, Rollout};

/// The tensors of a [`Rollout`] or [`ProgramRollout`](super::ProgramRollout), whose sizes are known at run time. Their lengths follow
/// from the plan and the sizes.
pub trait RolloutTensors<T> {
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

    /// The number of episodes that ended.
    fn ended(&self) -> usize;

    /// End `index` of an episode, by step and environment, and its final observation.
    ///
    /// # Panics
    /// If `index` is not below [`ended`](Self::ended).
    fn end(&self, index: usize) -> (EpisodeEnd<T, 0>, &[T]);

    /// Whether there may be steps that are no transitions.
    fn pauses(&self) -> bool;

    /// Writes for the environments from `first` on whether step `t` is no transition: not 0 if it is none.
    fn write_idle(&self, t: usize, first: usize, idle: &mut [u8]);
}

/// The methods of [`RolloutTensors`] that read what every transition has; `$transitions` is the rollout that has it.
macro_rules! rollout_tensors {
    ($self:ident, $transitions:expr) => {
        fn plan(&$self) -> Plan {
            $transitions.plan()
        }

        fn observation(&$self) -> &[T] {
            $self.observation()
        }

        fn action(&$self) -> &[T] {
            $self.action()
        }

        fn reward(&$self) -> &[T] {
            $transitions.reward()
        }

        fn terminated(&$self) -> &[u8] {
            $transitions.terminated()
        }

        fn truncated(&$self) -> &[u8] {
            $transitions.truncated()
        }

        fn log_probability(&$self) -> &[T] {
            $transitions.log_probability()
        }

        fn value(&$self) -> &[T] {
            $transitions.value()
        }

        fn ended(&$self) -> usize {
            $transitions.finals().len()
        }

        fn pauses(&$self) -> bool {
            $transitions.pauses()
        }

        fn write_idle(&$self, t: usize, first: usize, idle: &mut [u8]) {
            $transitions.write_idle(t, first, idle);
        }
    };
}
#[cfg(not(test))]
pub(super) use rollout_tensors;

impl<T: Pod, const O: usize, const D: usize> RolloutTensors<T> for Rollout<T, O, D> {
    rollout_tensors!(self, self);

    fn sizes(&self) -> [usize; 2] {
        [O, D]
    }

    fn end(&self, index: usize) -> (EpisodeEnd<T, 0>, &[T]) {
        let end = &self.finals()[index];
        (end.without_observation(), &end.observation)
    }
}
