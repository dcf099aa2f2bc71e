//! Where a batch is written.

use libration_core::Float;

use super::ReplayError;

/// A batch of transitions, allocated once, to be filled again and again.
#[derive(Clone, Debug, PartialEq)]
pub struct Batch<T> {
    /// The numbers of the transitions.
    pub number: Vec<u64>,
    /// The observations: `[n, i]`.
    pub observation: Vec<T>,
    /// The actions: `[n, i]`.
    pub action: Vec<T>,
    /// The discounted sums of rewards over the steps of the lookahead: `Σ γᵏ·r`.
    pub reward: Vec<T>,
    /// The observations after the last of these steps: `[n, i]`.
    pub next_observation: Vec<T>,
    /// 1 where the episode was over then, otherwise 0.
    pub terminated: Vec<u8>,
    /// 1 where it was cut off then, otherwise 0.
    pub truncated: Vec<u8>,
    /// The discount of the value of the next observation: `γᵐ` after `m` steps, 0 after a terminated episode.
    pub discount: Vec<T>,
    /// The importance weights, which correct for the sampling probabilities; the largest of the batch is 1.
    pub weight: Vec<T>,
}

impl<T: Float> Batch<T> {
    /// Allocates a batch of `len` transitions with these numbers of observations and actions.
    pub fn new(len: usize, [observations, actions]: [usize; 2]) -> Self {
        let rows = |width| vec![T::zero(); len.saturating_mul(width)];
        let zeros = || rows(1);
        Batch {
            number: vec![0; len],
            observation: rows(observations),
            action: rows(actions),
            reward: zeros(),
            next_observation: rows(observations),
            terminated: vec![0; len],
            truncated: vec![0; len],
            discount: zeros(),
            weight: zeros(),
        }
    }

    /// All of it, to be written.
    pub fn columns(&mut self) -> Columns<'_, T> {
        Columns {
            number: &mut self.number,
            observation: &mut self.observation,
            action: &mut self.action,
            reward: &mut self.reward,
            next_observation: &mut self.next_observation,
            terminated: &mut self.terminated,
            truncated: &mut self.truncated,
            discount: &mut self.discount,
            weight: &mut self.weight,
        }
    }
}

/// The columns of a [`Batch`], wherever they lie.
#[derive(Debug)]
pub struct Columns<'a, T> {
    /// As in a batch.
    pub number: &'a mut [u64],
    /// As in a batch.
    pub observation: &'a mut [T],
    /// As in a batch.
    pub action: &'a mut [T],
    /// As in a batch.
    pub reward: &'a mut [T],
    /// As in a batch.
    pub next_observation: &'a mut [T],
    /// As in a batch.
    pub terminated: &'a mut [u8],
    /// As in a batch.
    pub truncated: &'a mut [u8],
    /// As in a batch.
    pub discount: &'a mut [T],
    /// As in a batch.
    pub weight: &'a mut [T],
}

impl<'a, T> Columns<'a, T> {
    /// The number of transitions with these numbers of observations and actions.
    pub(super) fn len(&self, [observations, actions]: [usize; 2]) -> Result<usize, ReplayError> {
        let len = self.number.len();
        for (name, found, width) in [
            ("observations of the batch", self.observation.len(), observations),
            ("actions of the batch", self.action.len(), actions),
            ("rewards of the batch", self.reward.len(), 1),
            ("next observations of the batch", self.next_observation.len(), observations),
            ("terminations of the batch", self.terminated.len(), 1),
            ("truncations of the batch", self.truncated.len(), 1),
            ("discounts of the batch", self.discount.len(), 1),
            ("weights of the batch", self.weight.len(), 1),
        ] {
            ReplayError::shape(name, found, len.saturating_mul(width))?;
        }
        Ok(len)
    }

    /// Takes off the first `count`, with these numbers of observations and actions.
    pub(super) fn split_off(
        &mut self,
        count: usize,
        [observations, actions]: [usize; 2],
    ) -> Columns<'a, T> {
        Columns {
            number: first_of(&mut self.number, count),
            observation: first_of(&mut self.observation, count * observations),
            action: first_of(&mut self.action, count * actions),
            reward: first_of(&mut self.reward, count),
            next_observation: first_of(&mut self.next_observation, count * observations),
            terminated: first_of(&mut self.terminated, count),
            truncated: first_of(&mut self.truncated, count),
            discount: first_of(&mut self.discount, count),
            weight: first_of(&mut self.weight, count),
        }
    }
}

/// Takes off the first `count`, or all if there are fewer.
fn first_of<'a, X>(slice: &mut &'a mut [X], count: usize) -> &'a mut [X] {
    slice.split_off_mut(..count.min(slice.len())).unwrap_or_default()
}
