//! The rollout of a group of environments.

use libration::rl::{EpisodeEnds, Plan};

use super::chunk_files::{ChunkRollout, Rows};
use super::episodes::Episodes;
use super::group::{Group, Number};
use super::memory_check::not_enough_memory;
use super::{DataFormat, Dataset, DatasetError};
use crate::environments::AnyEnvironments;

/// The rollout of a group, computed chunk by chunk into memory that is used again.
pub(super) struct GroupRollout<'a, T: Number> {
    pub(super) dataset: &'a Dataset,
    pub(super) group: Group,
    pub(super) all: Box<dyn AnyEnvironments<T>>,
    format: DataFormat,
    /// The open episodes, for formats that store episodes.
    episodes: Option<Episodes<T>>,
}

impl<'a, T: Number> GroupRollout<'a, T> {
    /// The rollout of a group from the first step on.
    pub(super) fn new(
        dataset: &'a Dataset,
        format: DataFormat,
        group: Group,
        all: Box<dyn AnyEnvironments<T>>,
    ) -> Self {
        let episodes = || Episodes::new(group.first, group.len, dataset.longest(), all.sizes());
        let episodes = (format == DataFormat::Minari).then(episodes);
        GroupRollout { dataset, group, all, format, episodes }
    }

    /// The state after the chunks so far, for [`restore`](Self::restore): the environments, followed by the open episodes.
    pub(super) fn to_bytes(&self) -> Vec<u8> {
        let environments = self.all.to_bytes();
        let mut bytes = (environments.len() as u64).to_le_bytes().to_vec();
        bytes.extend(environments);
        if let Some(episodes) = &self.episodes {
            episodes.save(&mut bytes);
        }
        bytes
    }

    /// Restores a state of [`to_bytes`](Self::to_bytes) after `chunks` chunks. Returns whether it fits; if not, nothing changes.
    pub(super) fn restore(&mut self, state: &[u8], chunks: u64) -> bool {
        let Some((len, rest)) = state.split_first_chunk() else { return false };
        let len = usize::try_from(u64::from_le_bytes(*len)).unwrap_or(usize::MAX);
        let Some((environments, rest)) = rest.split_at_checked(len) else { return false };
        let episodes = match &self.episodes {
            None => rest.is_empty().then_some(None),
            Some(episodes) => episodes.restored(rest).map(Some),
        };
        let Some(episodes) = episodes else { return false };
        let start = self.all.to_bytes();
        if self.all.restore(environments).is_err() {
            return false;
        }
        if self.all.step() != chunks.saturating_mul(self.dataset.chunk.steps as u64) {
            // A state of these environments, which fits.
            let _ = self.all.restore(&start);
            return false;
        }
        self.episodes = episodes;
        true
    }

    /// Computes the next chunk, in the memory of an older one of the same size.
    pub(super) fn next(
        &mut self,
        used: Option<ChunkRollout<T>>,
    ) -> Result<ChunkRollout<T>, DatasetError> {
        let Dataset { chunk, steps, .. } = *self.dataset;
        let first = self.all.step();
        let horizon = (steps - first).min(chunk.steps as u64) as usize;
        let plan = Plan::new(horizon, self.group.len).truncated().layout(self.format.layout());
        let used = used.filter(|done| done.rollout.plan() == plan);
        let mut done = match used {
            Some(done) => done,
            None => ChunkRollout {
                group: self.group,
                chunk: 0,
                first: 0,
                rollout: self.all.new_rollout(plan)?,
                ends: EpisodeEnds::default(),
                episodes: Vec::new(),
                next: vec![T::zero(); self.group.len * self.all.sizes()[0]],
                rows: Rows::default(),
            },
        };
        (done.chunk, done.first) = (first / chunk.steps as u64, first);
        self.all.fill(self.dataset.policy.policy(), &mut *done.rollout, 0..horizon)?;
        done.ends = done.rollout.ends();
        self.all.observe(&mut done.next)?;
        if let Some(episodes) = &mut self.episodes {
            let ended = episodes.take(first, &*done.rollout, &done.ends);
            done.episodes = ended.map_err(|shortage| not_enough_memory(self.dataset, shortage))?;
            if self.all.step() == steps {
                done.episodes.extend(episodes.cut(&done.next));
            }
        }
        Ok(done)
    }
}
