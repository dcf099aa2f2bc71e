//! Environments of any type.

use std::ops::Range;

use bytemuck::Pod;
use libration::checkpoint::{Checkpoint, CheckpointError};
use libration::ensemble::{BatchFloat, Execution};
use libration::rl::{
    EnvironmentError, Environments, Episode, EpisodeEnds, Plan, ProgramEnvironments, ProgramPolicy,
    ProgramRollout, Rollout, StepBuffers, World,
};
use libration::{Elementary, Float, State};

use super::AnyRollout;
use super::policy::SizedPolicy;

/// [`Environments`] or [`ProgramEnvironments`].
pub trait AnyEnvironments<T>: Send + Sync {
    /// The number of environments.
    fn len(&self) -> usize;

    /// Whether there are no environments.
    fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The number of actions per environment so far.
    fn step(&self) -> u64;

    /// The numbers of observations and of actions of an environment.
    fn sizes(&self) -> [usize; 2];

    /// Allocates a rollout.
    ///
    /// # Errors
    /// See [`Rollout::new`].
    fn new_rollout(&self, plan: Plan) -> Result<Box<dyn AnyRollout<T>>, EnvironmentError>;

    /// Fills the rows `rows` of a rollout of [`new_rollout`](Self::new_rollout); the rows before must be full.
    ///
    /// # Errors
    /// See [`Environments::fill`].
    fn fill(
        &mut self,
        policy: ProgramPolicy<'_, T>,
        rollout: &mut dyn AnyRollout<T>,
        rows: Range<usize>,
    ) -> Result<(), EnvironmentError>;

    /// Takes one action in each environment.
    ///
    /// # Errors
    /// See [`Environments::act`].
    fn act(
        &mut self,
        policy: ProgramPolicy<'_, T>,
        to: StepBuffers<'_, T>,
    ) -> Result<EpisodeEnds<T>, EnvironmentError>;

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

    /// Positions, then velocities, of environment `n`, if it exists.
    fn state(&self, n: usize) -> Option<Vec<T>>;

    /// Puts environment `n` at positions, then velocities, from which its episode goes on.
    ///
    /// # Errors
    /// See [`Environments::set_state`].
    fn set_state(&mut self, n: usize, state: &[T]) -> Result<(), EnvironmentError>;

    /// The address of the episode of environment `n`, if it exists.
    fn episode(&self, n: usize) -> Option<Episode>;

    /// What is drawn of the episode of environment `n`, if it exists: parameters that vary, largest commands unless all are constants,
    /// latencies of observations and actions in steps, error scales of clock and sensor, and the time of the answer to the present
    /// observation in seconds, if answers take times of their own.
    fn episode_numbers(&self, n: usize, ahead: u64) -> Option<Vec<T>>;

    /// The complete state as bytes.
    fn to_bytes(&self) -> Vec<u8>;

    /// Restores a state of [`to_bytes`](Self::to_bytes).
    ///
    /// # Errors
    /// See [`Checkpoint::restore`].
    fn restore(&mut self, state: &[u8]) -> Result<(), CheckpointError>;
}

/// The methods that environments of each type have by the same name.
macro_rules! environments {
    () => {
        fn len(&self) -> usize {
            self.len()
        }

        fn step(&self) -> u64 {
            self.step()
        }

        fn observe(&mut self, to: &mut [T]) -> Result<(), EnvironmentError> {
            self.observe(to)
        }

        fn reset(&mut self, which: &[bool]) -> Result<(), EnvironmentError> {
            self.reset(which)
        }

        fn end(&mut self, which: &[bool]) -> Result<(), EnvironmentError> {
            self.end(which)
        }

        fn seed(&mut self, seeds: &[Option<u64>]) -> Result<(), EnvironmentError> {
            self.seed(seeds)
        }

        fn episode(&self, n: usize) -> Option<Episode> {
            self.episode(n)
        }

        fn execute(&mut self, execution: Execution) {
            self.execute(execution);
        }

        fn to_bytes(&self) -> Vec<u8> {
            Checkpoint::to_bytes(self)
        }

        fn restore(&mut self, state: &[u8]) -> Result<(), CheckpointError> {
            Checkpoint::restore(self, state)
        }
    };
}

/// Numbers of an episode, latencies and error scales, one after the other.
fn flat<T: Float>(mut numbers: Vec<T>, (delays, scales): ([u32; 2], [T; 2])) -> Vec<T> {
    numbers.extend(delays.map(|steps| T::from_f64(steps.into())));
    numbers.extend(scales);
    numbers
}

/// The rollout with its type.
fn downcast<T, R: 'static>(
    rollout: &mut dyn AnyRollout<T>,
    wanted: [usize; 2],
) -> Result<&mut R, EnvironmentError> {
    let name = "numbers that an environment of the rollout shows";
    let error = EnvironmentError::Shape { name, found: rollout.sizes()[0], wanted: wanted[0] };
    rollout.as_any().downcast_mut().ok_or(error)
}

impl<T, E, const O: usize> AnyEnvironments<T> for Environments<T, E, O, 1>
where
    T: Float + Elementary + Pod,
    E: World<T, O, 1>,
{
    environments!();

    fn sizes(&self) -> [usize; 2] {
        [O, 1]
    }

    fn new_rollout(&self, plan: Plan) -> Result<Box<dyn AnyRollout<T>>, EnvironmentError> {
        Ok(Box::new(Rollout::<T, O, 1>::new(plan)?))
    }

    fn fill(
        &mut self,
        policy: ProgramPolicy<'_, T>,
        rollout: &mut dyn AnyRollout<T>,
        rows: Range<usize>,
    ) -> Result<(), EnvironmentError> {
        let rollout: &mut Rollout<T, O, 1> = downcast(rollout, [O, 1])?;
        self.fill(SizedPolicy::<T, O>::new(policy)?, rollout, rows)
    }

    fn act(
        &mut self,
        policy: ProgramPolicy<'_, T>,
        to: StepBuffers<'_, T>,
    ) -> Result<EpisodeEnds<T>, EnvironmentError> {
        Ok(self.act(SizedPolicy::<T, O>::new(policy)?, to)?.as_slice().into())
    }

    fn state(&self, n: usize) -> Option<Vec<T>> {
        self.state(n).map(|state| state.coordinates().collect())
    }

    fn set_state(&mut self, n: usize, state: &[T]) -> Result<(), EnvironmentError> {
        let &[q, v] = state else {
            let (name, found) = ("numbers of a state", state.len());
            return Err(EnvironmentError::Shape { name, found, wanted: 2 });
        };
        self.set_state(n, State { q: [q], v: [v] })
    }

    fn episode_numbers(&self, n: usize, _: u64) -> Option<Vec<T>> {
        self.perturbations(n).map(|all| flat(Vec::new(), all))
    }
}

impl<T: BatchFloat> AnyEnvironments<T> for ProgramEnvironments<T> {
    environments!();

    fn sizes(&self) -> [usize; 2] {
        let definition = self.definition();
        [definition.observations(), definition.actions()]
    }

    fn new_rollout(&self, plan: Plan) -> Result<Box<dyn AnyRollout<T>>, EnvironmentError> {
        Ok(Box::new(ProgramRollout::new(plan, self.sizes())?))
    }

    fn fill(
        &mut self,
        policy: ProgramPolicy<'_, T>,
        rollout: &mut dyn AnyRollout<T>,
        rows: Range<usize>,
    ) -> Result<(), EnvironmentError> {
        let sizes = self.sizes();
        self.fill(policy, downcast(rollout, sizes)?, rows)
    }

    fn act(
        &mut self,
        policy: ProgramPolicy<'_, T>,
        to: StepBuffers<'_, T>,
    ) -> Result<EpisodeEnds<T>, EnvironmentError> {
        self.act(policy, to)
    }

    fn state(&self, n: usize) -> Option<Vec<T>> {
        self.state(n)
    }

    fn set_state(&mut self, n: usize, state: &[T]) -> Result<(), EnvironmentError> {
        self.set_state(n, state)
    }

    fn episode_numbers(&self, n: usize, ahead: u64) -> Option<Vec<T>> {
        let mut all = flat(self.numbers(n)?, self.perturbations(n)?);
        all.extend(self.answer_time(n, ahead).map(T::from_f64));
        Some(all)
    }
}
