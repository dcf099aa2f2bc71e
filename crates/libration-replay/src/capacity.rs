//! How much a replay buffer holds.

use core::ops::Range;

use super::ReplayError;
use libration_batch::ensemble::InsufficientMemory;

/// The capacity of a replay buffer and its memory, before any allocation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Capacity {
    /// The last steps that are kept of every environment.
    pub steps: usize,
    /// The number of environments.
    pub environments: usize,
    /// Ends of episodes among them: where there are more, the oldest steps go earlier.
    pub ends: usize,
    /// Whether every transition has a priority.
    pub priorities: bool,
}

/// The number of bytes before the fields.
pub(super) const PAGE: usize = 4096;

impl Capacity {
    /// The capacity for `steps` steps of `environments` environments, where at most a quarter of the transitions end an episode.
    pub fn new(steps: usize, environments: usize) -> Self {
        let ends = (steps.saturating_mul(environments) / 4).max(environments);
        Capacity { steps, environments, ends, priorities: false }
    }

    /// Sets the capacity for ends.
    pub fn ends(self, ends: usize) -> Self {
        Capacity { ends, ..self }
    }

    /// Adds priorities.
    pub fn priorities(self) -> Self {
        Capacity { priorities: true, ..self }
    }

    /// The number of transitions.
    pub fn transitions(&self) -> u128 {
        self.steps as u128 * self.environments as u128
    }

    /// The number of rows: one more than steps, for the observation after the last.
    pub(super) fn rows(&self) -> usize {
        self.steps + 1
    }

    /// The number of bytes for `observation` and `action` values per transition, of `number` bytes each.
    ///
    /// # Errors
    /// [`ReplayError::Nothing`] if it holds nothing, or no observations or no actions; [`ReplayError::Environment`] if no machine has so much memory.
    pub fn bytes(
        &self,
        observation: usize,
        action: usize,
        number: usize,
    ) -> Result<usize, ReplayError> {
        Ok(self.fields([observation, action], number)?.len)
    }

    /// The byte ranges of the fields.
    pub(super) fn fields(
        &self,
        [observation, action]: [usize; 2],
        number: usize,
    ) -> Result<Fields, ReplayError> {
        let Capacity { steps, environments, ends, priorities } = *self;
        for (name, value) in [
            ("steps", steps),
            ("environments", environments),
            ("ends", ends),
            ("observations", observation),
            ("actions", action),
        ] {
            if value == 0 {
                return Err(ReplayError::Nothing { name });
            }
        }
        let cells = (steps as u128 + 1) * environments as u128;
        let wide = |count: u128, each: usize| count.saturating_mul(each as u128);
        let row = |count: u128, numbers: usize| wide(wide(count, numbers), number);
        let sizes = [
            row(cells, observation),
            row(cells, action),
            wide(cells, number),
            cells,
            if priorities { wide(cells, 8) } else { 0 },
            wide(ends as u128, 8),
            row(ends as u128, observation),
        ];
        let mut at = PAGE as u128;
        let mut ranges = [const { 0..0 }; 7];
        let last = isize::MAX as u128;
        for (range, size) in ranges.iter_mut().zip(sizes) {
            let needed = at.saturating_add(size);
            if needed >= last - PAGE as u128 {
                return Err(InsufficientMemory { needed, available: None }.into());
            }
            *range = at as usize..needed as usize;
            at = needed.next_multiple_of(PAGE as u128);
        }
        let [observation, action, reward, flags, weight, end_place, end_seen] = ranges;
        let len = at as usize;
        Ok(Fields { observation, action, reward, flags, weight, end_place, end_seen, len })
    }
}

/// The byte ranges of the fields; each begins on a page.
#[derive(Clone, Debug)]
pub(super) struct Fields {
    /// `[row, n, i]`.
    pub(super) observation: Range<usize>,
    /// `[row, n, i]`.
    pub(super) action: Range<usize>,
    /// `[row, n]`, as the next two.
    pub(super) reward: Range<usize>,
    pub(super) flags: Range<usize>,
    /// Powers of priorities, as `f64`.
    pub(super) weight: Range<usize>,
    /// The places of the transitions of the ends, in a ring of increasing numbers.
    pub(super) end_place: Range<usize>,
    /// The observations at the ends.
    pub(super) end_seen: Range<usize>,
    /// All bytes.
    pub(super) len: usize,
}

impl Fields {
    /// No fields.
    pub(super) fn none() -> Self {
        let [observation, action, reward, flags, weight, end_place, end_seen] = [const { 0..0 }; 7];
        Fields { observation, action, reward, flags, weight, end_place, end_seen, len: 0 }
    }
}
