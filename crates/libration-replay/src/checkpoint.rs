//! The state of a replay buffer, to be left and taken up again.

use bytemuck::Pod;
use libration_core::Float;
use memmap2::MmapMut;

use super::{Capacity, ReplayBuffer, ReplayError};
use libration_batch::checkpoint::{Checkpoint, CheckpointError, Trait};

impl<T: Float + Pod> Checkpoint for ReplayBuffer<T> {
    fn traits(&self) -> Vec<Trait> {
        let Capacity { steps, environments, ends, priorities } = self.capacity;
        let [observations, actions] = self.sizes;
        vec![
            ("kind", "replay buffer".to_owned()),
            ("float type", T::NAME.to_owned()),
            ("number of dimensions", actions.to_string()),
            ("number of observations", observations.to_string()),
            ("number of steps", steps.to_string()),
            ("number of environments", environments.to_string()),
            ("number of ends", ends.to_string()),
            ("whether there are priorities", priorities.to_string()),
        ]
    }

    fn save<E>(&self, mut sink: impl FnMut(&[u8]) -> Result<(), E>) -> Result<(), E> {
        sink(self.bytes())
    }

    fn restore(&mut self, state: &[u8]) -> Result<(), CheckpointError> {
        let (found, wanted) = (state.len(), self.bytes().len());
        if found != wanted {
            return Err(CheckpointError::Length { found, wanted });
        }
        let damaged = |error: &dyn ToString| CheckpointError::Damaged(error.to_string());
        let mut map = MmapMut::map_anon(wanted).map_err(|error| damaged(&error))?;
        map.copy_from_slice(state);
        let opened = Self::open(map, self.sizes).map_err(|error: ReplayError| damaged(&error))?;
        // It may lie in a file, and stays there.
        self.memory.copy_from(&opened.memory);
        (self.marks, self.sums) = (opened.marks, opened.sums);
        Ok(())
    }
}
