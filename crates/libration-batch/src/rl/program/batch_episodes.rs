//! Episodes and states of a batch of environments by programs.

use super::ProgramEnvironments;
use super::state::Beginning;
use crate::ensemble::BatchFloat;
use crate::rl::block_size::LANES;
use crate::rl::{EnvironmentError, Episode};

impl<T: BatchFloat> ProgramEnvironments<T> {
    /// Positions, then velocities, of environment `n`; none if `n` is out of range.
    pub fn state(&self, n: usize) -> Option<Vec<T>> {
        let rows = self.definition.coordinates();
        let block = (n < self.len()).then(|| &self.states[n / LANES * rows..][..rows])?;
        Some(block.iter().map(|row| row[n % LANES]).collect())
    }

    /// Begins a new episode in every environment whose flag is `true`.
    ///
    /// # Errors
    /// [`EnvironmentError::Shape`] if the number of flags is not the number of environments.
    pub fn reset(&mut self, which: &[bool]) -> Result<(), EnvironmentError> {
        self.episodes.reset(which)?;
        (0..self.len()).filter(|&n| which[n]).for_each(|n| self.place(n));
        Ok(())
    }

    /// Terminates the episode of every environment whose flag is `true`, as if its task had in the step before.
    ///
    /// # Errors
    /// [`EnvironmentError::Shape`] if the number of flags is not the number of environments.
    pub fn end(&mut self, which: &[bool]) -> Result<(), EnvironmentError> {
        self.episodes.end(which)?;
        if self.definition.autoreset == crate::rl::Autoreset::SameStep {
            (0..self.len()).filter(|&n| which[n]).for_each(|n| self.place(n));
        }
        Ok(())
    }

    /// Begins a first episode in every environment with a seed.
    ///
    /// # Errors
    /// See [`Environments::seed`](crate::rl::Environments::seed).
    pub fn seed(&mut self, seeds: &[Option<u64>]) -> Result<(), EnvironmentError> {
        self.episodes.seed(seeds)?;
        (0..self.len()).filter(|&n| seeds[n].is_some()).for_each(|n| self.place(n));
        Ok(())
    }

    /// Puts environment `n` at the start of its episode.
    pub(super) fn place(&mut self, n: usize) {
        self.draw_numbers(n);
        let episode = self.episodes.blocks[n / LANES].episode(n % LANES);
        self.put(n, episode.start_within(&self.definition.start).into_iter());
    }

    /// Puts environment `n` at positions and velocities `state`. Its episode goes on from there; what it observes and what acts on it
    /// before latencies are over is that of a beginning.
    ///
    /// # Errors
    /// [`EnvironmentError::Shape`] if there is no such environment, or for a wrong number of coordinates.
    pub fn set_state(&mut self, n: usize, state: &[T]) -> Result<(), EnvironmentError> {
        EnvironmentError::shape("environments", self.len(), self.len().max(n.saturating_add(1)))?;
        EnvironmentError::shape("numbers of a state", state.len(), self.definition.coordinates())?;
        self.put(n, state.iter().copied());
        Ok(())
    }

    fn put(&mut self, n: usize, state: impl Iterator<Item = T>) {
        let (b, l) = (n / LANES, n % LANES);
        let ProgramEnvironments { definition, episodes, history, states, past, .. } = self;
        let instructions = episodes.execution.instruction_set();
        let (world, history) = (&episodes.world, *history);
        let beginning = Beginning::new(definition, world, history, instructions);
        let rows = definition.coordinates();
        let past = &mut past[b * history.len()..][..history.len()];
        beginning.place(&mut states[b * rows..][..rows], past, l, state);
    }

    /// Draws the numbers of the episode of environment `n`.
    pub(super) fn draw_numbers(&mut self, n: usize) {
        let (b, l) = (n / LANES, n % LANES);
        let ProgramEnvironments { definition, episodes, history, numbers, .. } = self;
        let instructions = episodes.execution.instruction_set();
        let (world, history) = (&episodes.world, *history);
        let beginning = Beginning::new(definition, world, history, instructions);
        let count = definition.numbers().count();
        let episode = episodes.blocks[b].episode(l);
        beginning.draw(&mut numbers[b * count..][..count], [n, l], episode);
    }

    /// The parameters that vary of the episode of environment `n`, then its largest commands unless all of them are constants; none if
    /// `n` is out of range.
    pub fn numbers(&self, n: usize) -> Option<Vec<T>> {
        let count = self.definition.numbers().count();
        let block = (n < self.len()).then(|| &self.numbers[n / LANES * count..][..count])?;
        Some(block.iter().map(|row| row[n % LANES]).collect())
    }

    /// The time of the answer to the observation of environment `n` that is so many steps ahead in its episode, in seconds, if answers
    /// take times of their own; none if `n` is out of range.
    pub fn answer_time(&self, n: usize, ahead: u64) -> Option<f64> {
        let answers = self.definition.answers.filter(|_| n < self.len())?;
        let (block, l) = (&self.episodes.blocks[n / LANES], n % LANES);
        Some(answers.draw(
            block.episode(l),
            self.step().saturating_add(ahead).saturating_sub(block.began[l]),
        ))
    }

    /// See [`Environments::perturbations`](crate::rl::Environments::perturbations).
    pub fn perturbations(&self, n: usize) -> Option<([u32; 2], [T; 2])> {
        self.episodes.perturbations(n)
    }

    /// The address of the episode of environment `n`; none if `n` is out of range.
    pub fn episode(&self, n: usize) -> Option<Episode> {
        self.episodes.episode(n)
    }
}
