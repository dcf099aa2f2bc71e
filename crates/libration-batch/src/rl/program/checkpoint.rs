//! Checkpoints of environments by programs.

use libration_core::control::{Clock, Memory, StartAddress};

use super::ProgramEnvironments;
use super::environment::World;
use crate::checkpoint::{Checkpoint, CheckpointError, Reader, Trait};
use crate::ensemble::BatchFloat;
use crate::rl::block::ClockMemory;
use crate::rl::block_size::LANES;

impl<T: BatchFloat> Checkpoint for ProgramEnvironments<T> {
    fn traits(&self) -> Vec<Trait> {
        let mut traits = self.episodes.traits();
        traits.push(("number of states", self.definition.coordinates().to_string()));
        traits.push(("number of inputs", self.definition.dynamics.inputs().to_string()));
        traits.push(("number of numbers on their way", self.history.len().to_string()));
        traits
    }

    fn save<X>(&self, mut sink: impl FnMut(&[u8]) -> Result<(), X>) -> Result<(), X> {
        self.episodes.save(&mut sink)?;
        // Of lanes that are no environments nobody knows what they are.
        let mut save = |rows: &[T], each: usize| {
            let (whole, last) = rows.split_at(self.len() / LANES * each);
            sink(bytemuck::cast_slice(whole))?;
            let mut last = last.to_vec();
            last.chunks_mut(LANES).for_each(|row| row[self.len() % LANES..].fill(T::zero()));
            sink(bytemuck::cast_slice(&last))
        };
        save(self.states.as_flattened(), self.definition.coordinates() * LANES)?;
        save(&self.past, self.history.len())
    }

    fn restore(&mut self, state: &[u8]) -> Result<(), CheckpointError> {
        let own = size_of_val(&self.states[..]) + size_of_val(&self.past[..]);
        let whole = state.len().saturating_sub(own);
        let (episodes, rest) = state.split_at(whole);
        let mut from = Reader::new(rest, own)?;
        self.episodes.restore(episodes)?;
        from.fill(self.states.as_flattened_mut());
        from.fill(&mut self.past);
        (0..self.len()).for_each(|n| self.draw_numbers(n));
        self.is_foreign = (0..self.len()).any(|n| self.is_other_episode(n));
        Ok(())
    }
}

impl<T: BatchFloat> ProgramEnvironments<T> {
    /// Whether the episode of environment `n` did not begin with the latencies, the error scales and the clock that are drawn for it.
    fn is_other_episode(&self, n: usize) -> bool {
        let (block, l) = (&self.episodes.blocks[n / LANES], n % LANES);
        let (world, episode) = (&self.episodes.world, block.episode(l));
        let begin = StartAddress::new(episode.seed, episode.environment, episode.number);
        let error_scale = world.error_scale.draw(episode).map(T::from_f64);
        block.delays.map(|row| row[l]) != world.delays.draw(episode)
            || block.error_scale.map(|row| row[l]) != error_scale
            || ClockMemory::<T, World, 0, 0>::lane(&block.clock, l) != world.clock.start(begin)
    }
}
