//! Where a batch is written.

use libration_core::Float;

/// A batch of transitions, allocated once, to be filled again and again.
#[derive(Clone, Debug, PartialEq)]
pub struct Batch<T, const O: usize, const D: usize> {
    /// The numbers of the transitions.
    pub number: Vec<u64>,
    /// The observations.
    pub observation: Vec<[T; O]>,
    /// The actions.
    pub action: Vec<[T; D]>,
    /// The discounted sums of rewards over the steps of the lookahead: `Σ γᵏ·r`.
    pub reward: Vec<T>,
    /// The observations after the last of these steps.
    pub next_observation: Vec<[T; O]>,
    /// 1 where the episode was over then, otherwise 0.
    pub terminated: Vec<u8>,
    /// 1 where it was cut off then, otherwise 0.
    pub truncated: Vec<u8>,
    /// The discount of the value of the next observation: `γᵐ` after `m` steps, 0 after a terminated episode.
    pub discount: Vec<T>,
    /// The importance weights, which correct for the sampling probabilities; the largest of the batch is 1.
    pub weight: Vec<T>,
}

impl<T: Float, const O: usize, const D: usize> Batch<T, O, D> {
    /// Allocates a batch of `len` transitions.
    pub fn new(len: usize) -> Self {
        let zeros = || vec![T::zero(); len];
        Batch {
            number: vec![0; len],
            observation: vec![[T::zero(); O]; len],
            action: vec![[T::zero(); D]; len],
            reward: zeros(),
            next_observation: vec![[T::zero(); O]; len],
            terminated: vec![0; len],
            truncated: vec![0; len],
            discount: zeros(),
            weight: zeros(),
        }
    }

    /// All of it, to be written.
    pub fn columns(&mut self) -> Columns<'_, T, O, D> {
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
pub struct Columns<'a, T, const O: usize, const D: usize> {
    /// As in a batch.
    pub number: &'a mut [u64],
    /// As in a batch.
    pub observation: &'a mut [[T; O]],
    /// As in a batch.
    pub action: &'a mut [[T; D]],
    /// As in a batch.
    pub reward: &'a mut [T],
    /// As in a batch.
    pub next_observation: &'a mut [[T; O]],
    /// As in a batch.
    pub terminated: &'a mut [u8],
    /// As in a batch.
    pub truncated: &'a mut [u8],
    /// As in a batch.
    pub discount: &'a mut [T],
    /// As in a batch.
    pub weight: &'a mut [T],
}

impl<'a, T, const O: usize, const D: usize> Columns<'a, T, O, D> {
    /// The number of transitions.
    pub(super) fn len(&self) -> Result<usize, super::ReplayError> {
        let len = self.number.len();
        for (name, found) in [
            ("observations of the batch", self.observation.len()),
            ("actions of the batch", self.action.len()),
            ("rewards of the batch", self.reward.len()),
            ("next observations of the batch", self.next_observation.len()),
            ("terminations of the batch", self.terminated.len()),
            ("truncations of the batch", self.truncated.len()),
            ("discounts of the batch", self.discount.len()),
            ("weights of the batch", self.weight.len()),
        ] {
            super::ReplayError::shape(name, found, len)?;
        }
        Ok(len)
    }

    /// Takes off the first `count`.
    pub(super) fn split_off(&mut self, count: usize) -> Columns<'a, T, O, D> {
        Columns {
            number: first_of(&mut self.number, count),
            observation: first_of(&mut self.observation, count),
            action: first_of(&mut self.action, count),
            reward: first_of(&mut self.reward, count),
            next_observation: first_of(&mut self.next_observation, count),
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
