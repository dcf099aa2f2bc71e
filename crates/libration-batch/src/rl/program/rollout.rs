//! Rollouts of environments by programs.

use bytemuck::Pod;
use libration_core::Float;
use ndarray::{ArrayViewMut3, ShapeBuilder};

use super::transitions::Transitions;
use crate::ensemble::{Buffer, InsufficientMemory, Pages};
use crate::rl::rollout_slice::RolloutSlice;
use crate::rl::rollout_tensors::rollout_tensors;
use crate::rl::{EnvironmentError, EpisodeEnd, Layout, Plan, Rollout, RolloutTensors};

/// The transitions of [`ProgramEnvironments`](super::ProgramEnvironments) over a horizon: a [`Rollout`] with any number of observations
/// and actions.
#[derive(Debug)]
pub struct ProgramRollout<T> {
    /// What every transition has, whatever is observed.
    pub(super) transitions: Rollout<T, 0, 0>,
    observation: Buffer<T>,
    action: Buffer<T>,
    /// Final observations, `[k, i]`.
    pub(super) last: Vec<T>,
    sizes: [usize; 2],
}

/// Ends of episodes, with their final observations.
#[derive(Clone, Debug, PartialEq)]
pub struct EpisodeEnds<T> {
    /// The ends.
    pub ends: Vec<EpisodeEnd<T, 0>>,
    /// Their final observations, before the next episodes began: `[k, i]`.
    pub observations: Vec<T>,
}

impl<T> Default for EpisodeEnds<T> {
    fn default() -> Self {
        EpisodeEnds { ends: Vec::new(), observations: Vec::new() }
    }
}

impl<T: Copy, const O: usize> From<&[EpisodeEnd<T, O>]> for EpisodeEnds<T> {
    fn from(ends: &[EpisodeEnd<T, O>]) -> Self {
        EpisodeEnds {
            ends: ends.iter().map(EpisodeEnd::without_observation).collect(),
            observations: ends.iter().flat_map(|end| end.observation).collect(),
        }
    }
}

impl<T: Copy> EpisodeEnds<T> {
    pub(super) fn push(&mut self, end: EpisodeEnd<T, 0>, observation: impl Iterator<Item = T>) {
        self.ends.push(end);
        self.observations.extend(observation);
    }

    /// The ends of all threads, by step and environment.
    pub(super) fn in_order(threads: Vec<Self>, width: usize) -> Self {
        let mut threads = threads.into_iter();
        let EpisodeEnds { mut ends, mut observations } = threads.next().unwrap_or_default();
        for others in threads {
            ends.extend(others.ends);
            observations.extend(others.observations);
        }
        if ends.is_sorted_by_key(|end| (end.step, end.environment)) {
            return EpisodeEnds { ends, observations };
        }
        let mut order: Vec<usize> = (0..ends.len()).collect();
        order.sort_unstable_by_key(|&k| (ends[k].step, ends[k].environment));
        EpisodeEnds {
            observations: order
                .iter()
                .flat_map(|&k| observations[k * width..][..width].iter().copied())
                .collect(),
            ends: order.iter().map(|&k| ends[k]).collect(),
        }
    }
}

impl<T: Float + Pod> ProgramRollout<T> {
    /// Allocates a rollout with so many observations and actions.
    ///
    /// # Errors
    /// [`EnvironmentError::OutOfMemory`].
    pub fn new(plan: Plan, [observations, actions]: [usize; 2]) -> Result<Self, EnvironmentError> {
        let Plan { horizon, environments, .. } = plan;
        let number = size_of::<T>();
        let needed = plan.bytes(observations, actions, number);
        let bytes = plan.bytes_each(observations, actions, number);
        let refused =
            |shortage| EnvironmentError::OutOfMemory { horizon, environments, bytes, shortage };
        InsufficientMemory::check(needed).map_err(refused)?;
        let transitions = Rollout::new(plan)?;
        let all = horizon * environments;
        let count = all.checked_mul(observations.max(actions));
        count.ok_or_else(|| refused(InsufficientMemory { needed, available: None }))?;
        Ok(ProgramRollout {
            transitions,
            observation: Buffer::new(all * observations, Pages::Huge)?,
            action: Buffer::new(all * actions, Pages::Huge)?,
            last: Vec::new(),
            sizes: [observations, actions],
        })
    }

    /// What every transition has, whatever is observed: rewards, flags, log-probabilities, values and ends of episodes.
    pub fn transitions(&self) -> &Rollout<T, 0, 0> {
        &self.transitions
    }

    /// The same, for writing its values.
    pub fn transitions_mut(&mut self) -> &mut Rollout<T, 0, 0> {
        &mut self.transitions
    }

    /// The numbers of observations and actions.
    pub fn sizes(&self) -> [usize; 2] {
        self.sizes
    }

    /// The observations: `[t, n, i]` or `[i, t, n]`, depending on the layout.
    pub fn observation(&self) -> &[T] {
        &self.observation
    }

    /// The actions, in the same order.
    pub fn action(&self) -> &[T] {
        &self.action
    }

    /// The episodes that ended, by step and environment.
    pub fn ends(&self) -> EpisodeEnds<T> {
        let ends = self.transitions.finals().to_vec();
        EpisodeEnds { ends, observations: self.last.clone() }
    }

    /// A range of its rows, to be written.
    pub(super) fn rows(&mut self, rows: &core::ops::Range<usize>) -> Transitions<'_, T> {
        let Plan { horizon, environments, layout, .. } = self.transitions.plan();
        let [observations, actions] = self.sizes;
        let shape = |count| [horizon, environments, count];
        let RolloutSlice { reward, terminated, truncated, log_probability, .. } =
            self.transitions.slice(rows);
        Transitions {
            observation: steps(&mut self.observation, shape(observations), layout, rows),
            action: steps(&mut self.action, shape(actions), layout, rows),
            reward,
            terminated,
            truncated,
            log_probability,
        }
    }
}

impl<T: Float + Pod> RolloutTensors<T> for ProgramRollout<T> {
    rollout_tensors!(self, self.transitions);

    fn sizes(&self) -> [usize; 2] {
        self.sizes
    }

    fn end(&self, index: usize) -> (EpisodeEnd<T, 0>, &[T]) {
        let width = self.sizes[0];
        (self.transitions.finals()[index], &self.last[index * width..][..width])
    }
}

/// Some steps of a tensor of this shape, `[t, n, i]` whatever its layout.
fn steps<'a, T>(
    numbers: &'a mut [T],
    [horizon, environments, count]: [usize; 3],
    layout: Layout,
    rows: &core::ops::Range<usize>,
) -> ArrayViewMut3<'a, T> {
    let strides = match layout {
        Layout::Interleaved => (environments * count, count, 1),
        Layout::Planes => (environments, 1, horizon * environments),
    };
    let shape = (horizon, environments, count).strides(strides);
    let all = ArrayViewMut3::from_shape(shape, numbers).expect("as many numbers as its sizes say");
    let (_, rest) = all.split_at(ndarray::Axis(0), rows.start);
    rest.split_at(ndarray::Axis(0), rows.len()).0
}
