//! Rollouts of any sizes.

use std::any::Any;

use bytemuck::Pod;
use libration::ensemble::Execution;
use libration::rl::{
    Discounts, EnvironmentError, EpisodeEnds, Estimates, ProgramRollout, Rollout, RolloutTensors,
};
use libration::{Elementary, Float};

/// A [`Rollout`] or a [`ProgramRollout`].
pub trait AnyRollout<T>: RolloutTensors<T> + Send + Sync {
    /// The episodes that ended, by step and environment.
    fn ends(&self) -> EpisodeEnds<T>;

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

impl<T: Float + Elementary + Pod, const O: usize> AnyRollout<T> for Rollout<T, O, 1> {
    fn ends(&self) -> EpisodeEnds<T> {
        self.finals().into()
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

impl<T: Float + Elementary + Pod> AnyRollout<T> for ProgramRollout<T> {
    fn ends(&self) -> EpisodeEnds<T> {
        ProgramRollout::ends(self)
    }

    fn transitions(&self) -> Vec<bool> {
        ProgramRollout::transitions(self).transitions()
    }

    fn estimate(
        &self,
        to: &mut Estimates<T>,
        discounts: Discounts,
        next: &[T],
        last: &[T],
    ) -> Result<(), EnvironmentError> {
        let transitions = ProgramRollout::transitions(self);
        to.fill(discounts, transitions, next, last, &Execution::serial())
    }

    fn as_any(&mut self) -> &mut dyn Any {
        self
    }
}
