//! The plan of a rollout: its size, fields and memory.

use super::block_size::LANES;
use crate::ensemble::Execution;

/// The shortest steps that take as long as a transition with one force evaluation and a linear policy.
const TRANSITION: u64 = 8;

/// The shortest steps that take as long as a further force evaluation.
const EVALUATION: u64 = 4;

/// Work of a transition.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TransitionWork {
    /// Force evaluations.
    pub evaluations: u64,
    /// Multiplications and additions of a policy besides those of a linear one.
    pub policy_operations: u64,
}

impl TransitionWork {
    /// One force evaluation and a linear policy.
    pub const SHORTEST: TransitionWork = TransitionWork { evaluations: 1, policy_operations: 0 };

    /// The number of the shortest steps of an ensemble that take as long.
    pub(super) fn shortest_steps(self) -> u64 {
        let evaluations = self.evaluations.saturating_sub(1).saturating_mul(EVALUATION);
        TRANSITION
            .saturating_add(evaluations)
            .saturating_add(shortest_steps(self.policy_operations))
    }
}

/// The number of the shortest steps of an ensemble, of three operations, that take as long as these.
pub(super) fn shortest_steps(operations: u64) -> u64 {
    operations.div_ceil(3)
}

/// The order of several numbers of a transition in memory.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Layout {
    /// `[t, n, i]`, as most learners read them.
    #[default]
    Interleaved,
    /// `[i, t, n]`, a structure of arrays.
    Planes,
}

/// The kind of stores that write the tensors.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Writes {
    /// Through the caches: fastest if the caches of the core hold all tensors.
    #[default]
    Plain,
    /// Past the caches: fastest if they do not.
    Past,
}

impl Writes {
    /// The way for so many bytes, where the caches that a core has for itself hold so many of them. A cache that is shared is no
    /// better than the memory past it: a step takes longer than its numbers take to get there, and who writes plainly waits for
    /// lines to be fetched first.
    pub fn suited(bytes: u128, near: u64) -> Self {
        if bytes > u128::from(near) { Writes::Past } else { Writes::Plain }
    }
}

/// The size, the fields, the layout and the memory of a rollout, before any allocation.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Plan {
    /// The number of actions of each environment.
    pub horizon: usize,
    /// The number of environments. Rows of a multiple of 64 fill whole cache lines, so that all of them can be streamed.
    pub environments: usize,
    /// Whether there is a field for truncations.
    pub truncated: bool,
    /// Whether there is a field for the log-probabilities of actions.
    pub log_probability: bool,
    /// Whether there is a field for values, which the caller writes.
    pub value: bool,
    /// The layout.
    pub layout: Layout,
    /// The kind of stores.
    pub writes: Writes,
}

impl Plan {
    /// A plan with the required fields, interleaved and written through the caches.
    pub fn new(horizon: usize, environments: usize) -> Self {
        Plan { horizon, environments, ..Plan::default() }
    }

    /// Adds the field of truncations.
    pub fn truncated(self) -> Self {
        Plan { truncated: true, ..self }
    }

    /// Adds the field of log-probabilities.
    pub fn log_probabilities(self) -> Self {
        Plan { log_probability: true, ..self }
    }

    /// Adds the field of values.
    pub fn values(self) -> Self {
        Plan { value: true, ..self }
    }

    /// Sets the layout.
    pub fn layout(self, layout: Layout) -> Self {
        Plan { layout, ..self }
    }

    /// Sets the kind of stores.
    pub fn writes(self, writes: Writes) -> Self {
        Plan { writes, ..self }
    }

    /// The number of transitions.
    pub fn transitions(&self) -> u128 {
        self.horizon as u128 * self.environments as u128
    }

    /// On how many of its threads an execution has such a rollout, of which each transition is this work: on fewer where there is little
    /// to do, or where there are few environments.
    pub fn threads(&self, execution: &Execution, each: TransitionWork) -> usize {
        let transitions = u64::try_from(self.transitions()).unwrap_or(u64::MAX);
        let steps = transitions.saturating_mul(each.shortest_steps());
        execution.threads_for(steps).min(self.environments.div_ceil(LANES).max(1))
    }

    /// Every field with its bytes for a transition of `observation` and `action` numbers, of so many bytes each.
    pub fn fields(
        &self,
        observation: usize,
        action: usize,
        number: usize,
    ) -> [(&'static str, usize); 7] {
        let part = |recorded: bool, bytes| if recorded { bytes } else { 0 };
        [
            ("observation", observation.saturating_mul(number)),
            ("action", action.saturating_mul(number)),
            ("reward", number),
            ("terminated", 1),
            ("truncated", part(self.truncated, 1)),
            ("log_probability", part(self.log_probability, number)),
            ("value", part(self.value, number)),
        ]
    }

    /// The number of bytes per transition.
    pub fn bytes_each(&self, observation: usize, action: usize, number: usize) -> usize {
        let fields = self.fields(observation, action, number);
        fields.iter().fold(0, |sum: usize, (_, bytes)| sum.saturating_add(*bytes))
    }

    /// The number of bytes of the rollout.
    pub fn bytes(&self, observation: usize, action: usize, number: usize) -> u128 {
        self.transitions().saturating_mul(self.bytes_each(observation, action, number) as u128)
    }
}
