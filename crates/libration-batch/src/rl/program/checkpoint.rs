//! Checkpoints of environments by programs.

use super::ProgramEnvironments;
use crate::checkpoint::{Checkpoint, CheckpointError, Reader, Trait};
use crate::ensemble::BatchFloat;
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
        Ok(())
    }
}
