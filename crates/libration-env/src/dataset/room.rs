//! Whether a data set can be computed here.

use libration::ensemble::InsufficientMemory;
use libration::rl::{Plan, Rollout};
use libration_data::parquet_bytes;

use super::settings::Chunk;
use super::world::{Number, Visit};
use super::{DataFormat, Dataset, DatasetError};
use crate::environments::{Actor, Batch};

/// Takes a step, if there is memory for all that is on its way at once, and the policy fits.
pub(super) struct Try<'a> {
    pub(super) dataset: &'a Dataset,
    pub(super) format: DataFormat,
    /// Threads that encode a chunk.
    pub(super) threads: usize,
}

/// Chunks in memory at once: one is computed, the others are encoded and written.
const AT_ONCE: u128 = 4;
/// Bytes of `step` and `environment` in a row of a table.
const ADDRESS: u128 = 12;

impl Try<'_> {
    /// Bytes of all chunks that are in memory at once, each of so many transitions and bytes.
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
            // One at a time, with its episodes in memory that doubles as they grow, and their files.
            DataFormat::Minari => 4 * chunk + parquet_bytes(transitions, 0, self.threads),
        }
    }
}

/// That chunks do not fit into memory.
pub(super) fn missing(dataset: &Dataset, room: InsufficientMemory) -> DatasetError {
    let Chunk { steps, environments } = dataset.chunk;
    DatasetError::Room { room, steps, environments }
}

impl Visit for Try<'_> {
    type Output = Result<(), DatasetError>;

    fn visit<T: Number, const O: usize>(
        self,
        mut all: Box<dyn Batch<T, O>>,
        actor: Actor<'static, T, O>,
    ) -> Self::Output {
        let Dataset { chunk, steps, .. } = *self.dataset;
        let horizon = steps.min(chunk.steps as u64) as usize;
        let plan = Plan::new(horizon, all.len()).truncated();
        let needed = self.bytes(plan.transitions() as u64, plan.bytes(O, 1, size_of::<T>()));
        InsufficientMemory::check(needed).map_err(|room| missing(self.dataset, room))?;
        let mut rollout = Rollout::new(Plan::new(1, all.len()).truncated())?;
        Ok(all.rollout(actor, &mut rollout)?)
    }
}
