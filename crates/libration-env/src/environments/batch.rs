//! Environments of which nothing is known but what they show.

use std::ops::Range;

use bytemuck::Pod;
use libration::checkpoint::{Checkpoint, CheckpointError};
use libration::ensemble::Execution;
use libration::rl::{EnvironmentError, Environments, EpisodeEnd, Rollout, StepBuffers, World};
use libration::{Elementary, Float};

use super::Actor;

/// [`Environments`] of any kind that show `O` numbers.
pub trait Batch<T, const O: usize>: Send + Sync {
    /// How many there are.
    fn len(&self) -> usize;

    /// Whether there are none.
    fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Actions of each so far.
    fn step(&self) -> u64;

    /// Fills `rollout` with what all do.
    ///
    /// # Errors
    /// See [`Environments::rollout`].
    fn rollout(
        &mut self,
        actor: Actor<'_, T, O>,
        rollout: &mut Rollout<T, O, 1>,
    ) -> Result<(), EnvironmentError>;

    /// Fills some rows of `rollout`, those before which are full.
    ///
    /// # Errors
    /// See [`Environments::fill`].
    fn fill(
        &mut self,
        actor: Actor<'_, T, O>,
        rollout: &mut Rollout<T, O, 1>,
        rows: Range<usize>,
    ) -> Result<(), EnvironmentError>;

    /// One action of each.
    ///
    /// # Errors
    /// See [`Environments::act`].
    fn act(
        &mut self,
        actor: Actor<'_, T, O>,
        to: StepBuffers<'_, T>,
    ) -> Result<Vec<EpisodeEnd<T, O>>, EnvironmentError>;

    /// Writes what is seen now: `[n, i]`.
    ///
    /// # Errors
    /// See [`Environments::observe`].
    fn observe(&mut self, to: &mut [T]) -> Result<(), EnvironmentError>;

    /// Begins another episode in every environment for which there is a `true`.
    ///
    /// # Errors
    /// See [`Environments::reset`].
    fn reset(&mut self, which: &[bool]) -> Result<(), EnvironmentError>;

    /// Ends the episode of every environment for which there is a `true`.
    ///
    /// # Errors
    /// See [`Environments::end`].
    fn end(&mut self, which: &[bool]) -> Result<(), EnvironmentError>;

    /// Begins a first episode in every environment for which there is a seed.
    ///
    /// # Errors
    /// See [`Environments::seed`].
    fn seed(&mut self, seeds: &[Option<u64>]) -> Result<(), EnvironmentError>;

    /// Where they are stepped from now on.
    fn execute(&mut self, execution: Execution);

    /// Position and velocity of one, if there is such.
    fn state(&self, n: usize) -> Option<[T; 2]>;

    /// All that they are, as bytes.
    fn to_bytes(&self) -> Vec<u8>;

    /// Makes them what they were.
    ///
    /// # Errors
    /// See [`Checkpoint::restore`].
    fn restore(&mut self, state: &[u8]) -> Result<(), CheckpointError>;
}

impl<T, E, const O: usize> Batch<T, O> for Environments<T, E, O, 1>
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
        actor: Actor<'_, T, O>,
        rollout: &mut Rollout<T, O, 1>,
    ) -> Result<(), EnvironmentError> {
        Environments::rollout(self, actor, rollout)
    }

    fn fill(
        &mut self,
        actor: Actor<'_, T, O>,
        rollout: &mut Rollout<T, O, 1>,
        rows: Range<usize>,
    ) -> Result<(), EnvironmentError> {
        Environments::fill(self, actor, rollout, rows)
    }

    fn act(
        &mut self,
        actor: Actor<'_, T, O>,
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
