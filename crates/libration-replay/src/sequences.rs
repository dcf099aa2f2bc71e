//! Sampling of sequences of steps, for recurrent learners.

use bytemuck::Pod;
use libration_core::Float;

use super::replay_buffer::{END, NONE, TERMINATED, TRUNCATED};
use super::{Draw, ReplayBuffer, ReplayError};
use libration_batch::ensemble::Execution;

/// Sequences of equal length, allocated once and filled many times: each field is `[i, t]`.
#[derive(Clone, Debug, PartialEq)]
pub struct Sequences<T, const O: usize, const D: usize> {
    /// Steps of each.
    pub steps: usize,
    /// The number of the first transition of each: `[i]`.
    pub number: Vec<u64>,
    /// The observations.
    pub observation: Vec<[T; O]>,
    /// The actions.
    pub action: Vec<[T; D]>,
    /// The rewards.
    pub reward: Vec<T>,
    /// 1 where the episode terminated, otherwise 0.
    pub terminated: Vec<u8>,
    /// 1 where it was truncated, otherwise 0.
    pub truncated: Vec<u8>,
    /// 1 within the first episode of the sequence, 0 afterwards: for the next episode and for steps that are not transitions.
    pub mask: Vec<u8>,
    /// The observation after the last step of the mask: `[i]`.
    pub next_observation: Vec<[T; O]>,
}

impl<T: Float, const O: usize, const D: usize> Sequences<T, O, D> {
    /// Allocates `len` sequences of `steps` steps.
    pub fn new(len: usize, steps: usize) -> Self {
        let all = len * steps;
        Sequences {
            steps,
            number: vec![0; len],
            observation: vec![[T::zero(); O]; all],
            action: vec![[T::zero(); D]; all],
            reward: vec![T::zero(); all],
            terminated: vec![0; all],
            truncated: vec![0; all],
            mask: vec![0; all],
            next_observation: vec![[T::zero(); O]; len],
        }
    }
}

/// The destination of one sequence.
struct SequenceSlot<'a, T, const O: usize, const D: usize> {
    number: u64,
    observation: &'a mut [[T; O]],
    action: &'a mut [[T; D]],
    reward: &'a mut [T],
    terminated: &'a mut [u8],
    truncated: &'a mut [u8],
    mask: &'a mut [u8],
    next_observation: &'a mut [T; O],
}

/// Steps that are worth a thread.
const PIECE: usize = 1 << 14;

impl<T: Float + Pod, const O: usize, const D: usize> ReplayBuffer<T, O, D> {
    /// Samples sequences uniformly with replacement, among those within the buffer that begin with a transition.
    ///
    /// # Errors
    /// [`ReplayError::Empty`] if there is none; [`ReplayError::Nothing`] if they are of no steps;
    /// [`ReplayError::Environment`] if the fields do not fit each other.
    pub fn sample_sequences(
        &self,
        draw: Draw,
        to: &mut Sequences<T, O, D>,
        execution: &Execution,
    ) -> Result<(), ReplayError> {
        let (len, steps) = (to.number.len(), to.steps);
        if steps == 0 {
            return Err(ReplayError::Nothing { name: "steps of a sequence" });
        }
        let all = len.saturating_mul(steps);
        for (name, found, wanted) in [
            ("observations of the sequences", to.observation.len(), all),
            ("actions of the sequences", to.action.len(), all),
            ("rewards of the sequences", to.reward.len(), all),
            ("terminations of the sequences", to.terminated.len(), all),
            ("truncations of the sequences", to.truncated.len(), all),
            ("masks of the sequences", to.mask.len(), all),
            ("next observations of the sequences", to.next_observation.len(), len),
        ] {
            ReplayError::shape(name, found, wanted)?;
        }
        let last = self.marks.head.checked_sub(steps as u64);
        let starts =
            last.filter(|&last| last >= self.marks.tail).map(|last| self.marks.tail..last + 1);
        let starts = starts.and_then(|steps| self.drawable(steps));
        let starts = starts.ok_or(ReplayError::Empty("sequences of so many steps"))?;
        for (i, number) in to.number.iter_mut().enumerate() {
            *number = self.any(&starts, draw, i);
        }
        let fields = to.number.iter().zip(to.observation.chunks_mut(steps));
        let fields = fields.zip(to.action.chunks_mut(steps)).zip(to.reward.chunks_mut(steps));
        let fields =
            fields.zip(to.terminated.chunks_mut(steps)).zip(to.truncated.chunks_mut(steps));
        let fields = fields.zip(to.mask.chunks_mut(steps)).zip(&mut to.next_observation);
        let sequences =
            fields.map(|(((((((&number, seen), done), paid), over), cut), mask), next)| {
                SequenceSlot {
                    number,
                    observation: seen,
                    action: done,
                    reward: paid,
                    terminated: over,
                    truncated: cut,
                    mask,
                    next_observation: next,
                }
            });
        if execution.thread_count() == 1 || all < 2 * PIECE {
            sequences.for_each(|sequence| self.fill(sequence));
        } else {
            execution.each(sequences.collect(), |sequence| self.fill(sequence));
        }
        Ok(())
    }

    fn fill(&self, to: SequenceSlot<'_, T, O, D>) {
        let (step, l) = self.width.divide(to.number);
        let l = l as usize;
        let mut goes_on = true;
        for t in 0..to.mask.len() {
            let cell = self.cell(step + t as u64, l);
            let flags = self.flags()[cell];
            goes_on &= flags & NONE == 0;
            (to.observation[t], to.action[t]) = (self.observation()[cell], self.action()[cell]);
            to.reward[t] = self.reward()[cell];
            (to.terminated[t], to.truncated[t]) =
                (flags & TERMINATED, (flags & TRUNCATED) / TRUNCATED);
            to.mask[t] = u8::from(goes_on);
            if goes_on {
                *to.next_observation = self.next(step + t as u64, l, flags);
            }
            goes_on &= flags & END == 0;
        }
    }
}
