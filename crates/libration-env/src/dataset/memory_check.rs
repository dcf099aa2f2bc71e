//! Check of the memory of a data set.

use libration::ensemble::InsufficientMemory;
use libration::rl::Plan;
use libration_data::parquet_bytes;

use super::group::{GroupVisitor, Number};
use super::settings::Chunk;
use super::{DataFormat, Dataset, DatasetError};
use crate::environments::AnyEnvironments;

/// A trial step that checks the memory of the chunks in flight and the policy.
pub(super) struct TrialStep<'a> {
    pub(super) dataset: &'a Dataset,
    pub(super) format: DataFormat,
    /// Threads that encode a chunk.
    pub(super) threads: usize,
}

/// Chunks in memory: one is computed, the others are encoded and written.
const AT_ONCE: u128 = 4;
/// Bytes of `step` and `environment` per row of a table.
const ADDRESS: u128 = 12;

impl TrialStep<'_> {
    /// Bytes of all chunks in memory, each of `transitions` transitions and `chunk` bytes.
    fn bytes(&self, transitions: u64, chunk: u128) -> u128 {
        let encoded = AT_ONCE - 1;
        match self.format {
            // Ends of episodes are few beside the tensors.
            DataFormat::Npy => AT_ONCE * chunk + encoded * (chunk / 4),
            DataFormat::Parquet => {
                let table = chunk + ADDRESS * u128::from(transitions);
                AT_ONCE * table
                    + encoded * (table + parquet_bytes(transitions, table, self.threads))
            }
            // One chunk, its episodes in buffers that double as they grow, and their files.
            DataFormat::Minari => 4 * chunk + parquet_bytes(transitions, 0, self.threads),
        }
    }
}

/// The error of chunks that do not fit into memory.
pub(super) fn not_enough_memory(dataset: &Dataset, shortage: InsufficientMemory) -> DatasetError {
    let Chunk { steps, environments } = dataset.chunk;
    DatasetError::OutOfMemory { shortage, steps, environments }
}

impl GroupVisitor for TrialStep<'_> {
    type Output = Result<(), DatasetError>;

    fn visit<T: Number>(self, mut all: Box<dyn AnyEnvironments<T>>) -> Self::Output {
        let Dataset { chunk, steps, .. } = *self.dataset;
        let horizon = steps.min(chunk.steps as u64) as usize;
        let plan = Plan::new(horizon, all.len()).truncated();
        let [observations, actions] = all.sizes();
        let chunk = plan.bytes(observations, actions, size_of::<T>());
        let needed = self.bytes(plan.transitions() as u64, chunk);
        InsufficientMemory::check(needed)
            .map_err(|shortage| not_enough_memory(self.dataset, shortage))?;
        let mut rollout = all.new_rollout(Plan::new(1, all.len()).truncated())?;
        Ok(all.fill(self.dataset.policy.policy(), &mut *rollout, 0..1)?)
    }
}
