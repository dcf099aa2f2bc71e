//! Environments of any type.

use std::ops::Range;

use bytemuck::Pod;
use libration::checkpoint::{Checkpoint, CheckpointError};
use libration::ensemble::Execution;
use libration::rl::{EnvironmentError, Environments, EpisodeEnd, Rollout, StepBuffers, World};
use libration::{Elementary, Float};

use super::AnyPolicy;

/// [`Environments`] of any type with `O` observations.
pub trait AnyEnvironments<T, const O: usize>: Send + Sync {
    /// The number of environments.
    fn len(&self) -> usize;

    /// Whether there are no environments.
    fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The number of actions per environment so far.
    fn step(&self) -> u64;

    /// Fills `rollout`.
    ///
    /// # Errors
    /// See [`Environments::rollout`].
    fn rollout(
        &mut self,
        actor: AnyPolicy<'_, T, O>,
        rollout: &mut Rollout<T, O, 1>,
    ) -> Result<(), EnvironmentError>;

    /// Fills the rows `rows` of `rollout`; the rows before must be full.
    ///
    /// # Errors
    /// See [`Environments::fill`].
    fn fill(
        &mut self,
        actor: AnyPolicy<'_, T, O>,
        rollout: &mut Rollout<T, O, 1>,
        rows: Range<usize>,
    ) -> Result<(), EnvironmentError>;

    /// Takes one action in each environment.
    ///
    /// # Errors
    /// See [`Environments::act`].
    fn act(
        &mut self,
        actor: AnyPolicy<'_, T, O>,
        to: StepBuffers<'_, T>,
    ) -> Result<Vec<EpisodeEnd<T, O>>, EnvironmentError>;

    /// Writes the current observations, `[n, i]`.
    ///
    /// # Errors
    /// See [`Environments::observe`].
    fn observe(&mut self, to: &mut [T]) -> Result<(), EnvironmentError>;

    /// Begins a new episode in each environment with `true`.
    ///
    /// # Errors
    /// See [`Environments::reset`].
    fn reset(&mut self, which: &[bool]) -> Result<(), EnvironmentError>;

    /// Ends the episode of each environment with `true`.
    ///
    /// # Errors
    /// See [`Environments::end`].
    fn end(&mut self, which: &[bool]) -> Result<(), EnvironmentError>;

    /// Begins a first episode in each environment with a seed.
    ///
    /// # Errors
    /// See [`Environments::seed`].
    fn seed(&mut self, seeds: &[Option<u64>]) -> Result<(), EnvironmentError>;

    /// Sets the execution of later steps.
    fn execute(&mut self, execution: Execution);

    /// Position and velocity of environment `n`, if it exists.
    fn state(&self, n: usize) -> Option<[T; 2]>;

    /// The complete state as bytes.
    fn to_bytes(&self) -> Vec<u8>;

    /// Restores a state of [`to_bytes`](Self::to_bytes).
    ///
    /// # Errors
    /// See [`Checkpoint::restore`].
    fn restore(&mut self, state: &[u8]) -> Result<(), CheckpointError>;
}

impl<T, E, const O: usize> AnyEnvironments<T, O> for Environments<T, E, O, 1>
where
    T: Float + Elementary + Pod,
    E: World<T, O, 1>,
{
    fn len(&self) -> usize {
        Environments::len(self)
    }

    fn step(&self) -> u64 {
        Environments::step(self)
    }

    fn rollout(
        &mut self,
        actor: AnyPolicy<'_, T, O>,
        rollout: &mut Rollout<T, O, 1>,
    ) -> Result<(), EnvironmentError> {
        Environments::rollout(self, actor, rollout)
    }

    fn fill(
        &mut self,
        actor: AnyPolicy<'_, T, O>,
        rollout: &mut Rollout<T, O, 1>,
        rows: Range<usize>,
    ) -> Result<(), EnvironmentError> {
        Environments::fill(self, actor, rollout, rows)
    }

    fn act(
        &mut self,
        actor: AnyPolicy<'_, T, O>,
        to: StepBuffers<'_, T>,
    ) -> Result<Vec<EpisodeEnd<T, O>>, EnvironmentError> {
        Environments::act(self, actor, to)
    }

    fn observe(&mut self, to: &mut [T]) -> Result<(), EnvironmentError> {
        Environments::observe(self, to)
    }

    fn reset(&mut self, which: &[bool]) -> Result<(), EnvironmentError> {
        Environments::reset(self, which)
    }

    fn end(&mut self, which: &[bool]) -> Result<(), EnvironmentError> {
        Environments::end(self, which)
    }

    fn seed(&mut self, seeds: &[Option<u64>]) -> Result<(), EnvironmentError> {
        Environments::seed(self, seeds)
    }

    fn execute(&mut self, execution: Execution) {
        Environments::execute(self, execution);
    }

    fn state(&self, n: usize) -> Option<[T; 2]> {
        Environments::state(self, n).map(|state| [state.q[0], state.v[0]])
    }

    fn to_bytes(&self) -> Vec<u8> {
        Checkpoint::to_bytes(self)
    }

    fn restore(&mut self, state: &[u8]) -> Result<(), CheckpointError> {
        Checkpoint::restore(self, state)
    }
}
