//! Sampling of sequences of steps, for recurrent learners.

use bytemuck::Pod;
use libration_core::Float;

use super::replay_buffer::{END, NONE, TERMINATED, TRUNCATED};
use super::rows::gather;
use super::{Draw, ReplayBuffer, ReplayError};
use libration_batch::ensemble::Execution;

/// Sequences of equal length, allocated once and filled many times: each field is `[n, t]`, or as it says.
#[derive(Clone, Debug, PartialEq)]
pub struct Sequences<T> {
    /// Steps of each.
    pub steps: usize,
    /// The number of the first transition of each: `[n]`.
    pub number: Vec<u64>,
    /// The observations: `[n, t, i]`.
    pub observation: Vec<T>,
    /// The actions: `[n, t, i]`.
    pub action: Vec<T>,
    /// The rewards.
    pub reward: Vec<T>,
    /// 1 where the episode terminated, otherwise 0.
    pub terminated: Vec<u8>,
    /// 1 where it was truncated, otherwise 0.
    pub truncated: Vec<u8>,
    /// 1 within the first episode of the sequence, 0 afterwards: for the next episode and for steps that are not transitions.
    pub mask: Vec<u8>,
    /// The observation after the last step of the mask: `[n, i]`.
    pub next_observation: Vec<T>,
}

impl<T: Float> Sequences<T> {
    /// Allocates `len` sequences of `steps` steps with these numbers of observations and actions.
    pub fn new(len: usize, steps: usize, [observations, actions]: [usize; 2]) -> Self {
        let all = len.saturating_mul(steps);
        let rows = |count: usize, width| vec![T::zero(); count.saturating_mul(width)];
        Sequences {
            steps,
            number: vec![0; len],
            observation: rows(all, observations),
            action: rows(all, actions),
            reward: rows(all, 1),
            terminated: vec![0; all],
            truncated: vec![0; all],
            mask: vec![0; all],
            next_observation: rows(len, observations),
        }
    }
}

/// The destination of some of the sequences.
struct SequencesPart<'a, T> {
    number: &'a [u64],
    observation: &'a mut [T],
    action: &'a mut [T],
    reward: &'a mut [T],
    terminated: &'a mut [u8],
    truncated: &'a mut [u8],
    mask: &'a mut [u8],
    next_observation: &'a mut [T],
}

/// Steps that are worth a thread.
const PIECE: usize = 1 << 14;

/// Steps that are copied together.
const BLOCK: usize = 256;

impl<T: Float + Pod> ReplayBuffer<T> {
    /// Samples sequences uniformly with replacement, among those within the buffer that begin with a transition.
    ///
    /// # Errors
    /// [`ReplayError::Empty`] if there is none; [`ReplayError::Nothing`] if they are of no steps;
    /// [`ReplayError::Environment`] if the fields do not fit each other.
    pub fn sample_sequences(
        &self,
        draw: Draw,
        to: &mut Sequences<T>,
        execution: &Execution,
    ) -> Result<(), ReplayError> {
        let (len, steps) = (to.number.len(), to.steps);
        if steps == 0 {
            return Err(ReplayError::Nothing { name: "steps of a sequence" });
        }
        let [observations, actions] = self.sizes;
        let all = len.saturating_mul(steps);
        for (name, found, wanted) in [
            (
                "observations of the sequences",
                to.observation.len(),
                all.saturating_mul(observations),
            ),
            ("actions of the sequences", to.action.len(), all.saturating_mul(actions)),
            ("rewards of the sequences", to.reward.len(), all),
            ("terminations of the sequences", to.terminated.len(), all),
            ("truncations of the sequences", to.truncated.len(), all),
            ("masks of the sequences", to.mask.len(), all),
            (
                "next observations of the sequences",
                to.next_observation.len(),
                len.saturating_mul(observations),
            ),
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
        let pieces = execution.thread_count().min(all / PIECE).max(1);
        let piece = len.div_ceil(pieces).max(1);
        let rows = piece.saturating_mul(steps);
        let seen = to.observation.chunks_mut(rows.saturating_mul(observations));
        let done = to.action.chunks_mut(rows.saturating_mul(actions));
        let next = to.next_observation.chunks_mut(piece.saturating_mul(observations));
        let fields = to.number.chunks(piece).zip(seen).zip(done).zip(to.reward.chunks_mut(rows));
        let fields = fields.zip(to.terminated.chunks_mut(rows));
        let fields =
            fields.zip(to.truncated.chunks_mut(rows)).zip(to.mask.chunks_mut(rows)).zip(next);
        let parts = fields.map(|(((((((number, seen), done), paid), over), cut), mask), next)| {
            SequencesPart {
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
        execution.each(parts.collect(), |part| self.fill(steps, part));
        Ok(())
    }

    /// Fills what follows from the numbers: first field by field, as for a batch.
    fn fill(&self, steps: usize, to: SequencesPart<'_, T>) {
        let [observations, actions] = self.sizes;
        let after = self.cell_after();
        let mut cells = [0; BLOCK];
        let (mut numbers, mut cell, mut left) = (to.number.iter(), 0, 0);
        for first in (0..to.mask.len()).step_by(BLOCK) {
            let block = first..to.mask.len().min(first + BLOCK);
            let cells = &mut cells[..block.len()];
            for to in &mut *cells {
                if left == 0 {
                    cell = numbers.next().map_or(0, |&number| self.cell_of(number));
                    left = steps;
                }
                *to = cell;
                (cell, left) = (after(cell), left - 1);
            }
            let rows = |width| block.start * width..block.end * width;
            gather(
                &mut to.observation[rows(observations)],
                self.observation(),
                cells,
                observations,
            );
            gather(&mut to.action[rows(actions)], self.action(), cells, actions);
            gather(&mut to.reward[rows(1)], self.reward(), cells, 1);
            gather(&mut to.mask[rows(1)], self.flags(), cells, 1);
        }
        let flags = to.terminated.chunks_exact_mut(steps).zip(to.truncated.chunks_exact_mut(steps));
        let next = to.next_observation.chunks_exact_mut(observations);
        let all = to.number.iter().zip(flags).zip(to.mask.chunks_exact_mut(steps)).zip(next);
        for (((&number, (terminated, truncated)), mask), next) in all {
            let (step, l) = self.width.divide(number);
            let (mut goes_on, mut last) = (true, (step, 0));
            let flags = mask.iter_mut().zip(terminated).zip(truncated);
            for (step, ((mask, terminated), truncated)) in (step..).zip(flags) {
                let flags = *mask;
                goes_on &= flags & NONE == 0;
                (*terminated, *truncated) = (flags & TERMINATED, (flags & TRUNCATED) / TRUNCATED);
                *mask = u8::from(goes_on);
                last = if goes_on { (step, flags) } else { last };
                goes_on &= flags & END == 0;
            }
            next.copy_from_slice(self.next(last.0, l as usize, last.1));
        }
    }
}
