//! Transitions that are drawn, each as likely.

use core::ops::Range;

use bytemuck::Pod;
use libration_core::Float;
use libration_core::control::error::ensure_probability;

use super::memory::Marks;
use super::replay_buffer::{END, NONE, TERMINATED, TRUNCATED};
use super::rows::gather;
use super::{Columns, Draw, ReplayBuffer, ReplayError};
use libration_batch::ensemble::Execution;

/// The number of steps of a transition of a batch.
///
/// R. S. Sutton, *Learning to predict by the methods of temporal differences*, Machine Learning 3, 1988. Fewer where the episode
/// ends, and where the last step that is known comes, before.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lookahead {
    /// Steps, at least 1.
    pub steps: usize,
    /// `γ`, from 0 to 1.
    pub discount: f64,
}

impl Default for Lookahead {
    /// A single step, with `γ = 0.99`.
    fn default() -> Self {
        Lookahead { steps: 1, discount: 0.99 }
    }
}

impl Lookahead {
    pub(super) fn check(&self) -> Result<(), ReplayError> {
        ensure_probability("discount", self.discount)?;
        if self.steps == 0 {
            Err(ReplayError::Nothing { name: "steps to look ahead" })
        } else {
            Ok(())
        }
    }
}

/// Steps of which transitions are drawn.
#[derive(Clone, Copy, Debug)]
pub(super) struct Starts {
    /// The number of the first.
    first: u64,
    /// All of them, transitions or not.
    count: u64,
    /// Transitions.
    live: u64,
}

/// Attempts to meet a transition among steps that may be none, before they are counted.
const ATTEMPTS: u32 = 16;

/// Transitions of a batch that are worth a thread.
const PIECE: usize = 1 << 14;

impl<T: Float + Pod> ReplayBuffer<T> {
    /// Fills a batch with transitions that are drawn with replacement, each as likely; their weights are 1.
    ///
    /// # Errors
    /// [`ReplayError::Empty`] if there is no transition; [`ReplayError::Environment`] if the columns are not equally long or the
    /// lookahead cannot be.
    pub fn sample(
        &self,
        draw: Draw,
        lookahead: Lookahead,
        batch: &mut Columns<'_, T>,
        execution: &Execution,
    ) -> Result<(), ReplayError> {
        lookahead.check()?;
        let len = batch.len(self.sizes)?;
        let starts = self.drawable(self.marks.tail..self.marks.head);
        let starts = starts.ok_or(ReplayError::Empty("transitions"))?;
        for (i, number) in batch.number.iter_mut().enumerate() {
            *number = self.any(&starts, draw, i);
        }
        batch.weight.fill(T::one());
        self.gather_all(lookahead, batch, len, execution);
        Ok(())
    }

    /// These steps, if there is a transition among them.
    pub(super) fn drawable(&self, steps: Range<u64>) -> Option<Starts> {
        let n = self.capacity.environments as u64;
        let Marks { head, tail, live: all, .. } = self.marks;
        let count = (steps.end - steps.start) * n;
        let (before, after) = (tail..steps.start, steps.end..head);
        // Where every step is a transition nobody has to count; else those few that are not among these.
        let live = if all == (head - tail) * n {
            count
        } else {
            let apart = |range: Range<u64>| (range.end - range.start) * n - self.nones(range);
            all - apart(before) - apart(after)
        };
        (live > 0).then_some(Starts { first: steps.start * n, count, live })
    }

    /// The number of one of these transitions, each as likely.
    pub(super) fn any(&self, starts: &Starts, draw: Draw, i: usize) -> u64 {
        let Starts { first, count, live } = *starts;
        if count == live {
            return first + draw.below(i, 0, count)[0];
        }
        let drawn = (0..ATTEMPTS).flat_map(|attempt| draw.below(i, attempt, count));
        let met = drawn.map(|at| first + at).find(|&number| self.contains(number));
        met.unwrap_or_else(|| {
            let which = draw.below(i, ATTEMPTS, live)[0];
            let mut all = (first..first + count).filter(|&number| self.contains(number));
            // As many are counted as there are.
            all.nth(which as usize).unwrap_or(first)
        })
    }

    /// The observation after a step with these flags.
    #[inline(always)]
    pub(super) fn next(&self, step: u64, l: usize, flags: u8) -> &[T] {
        let width = self.sizes[0];
        let apart = self.end_of(step, l, flags);
        apart.unwrap_or_else(|| &self.observation()[self.cell(step + 1, l) * width..][..width])
    }

    /// Fills what follows from the numbers of a batch.
    pub(super) fn gather_all(
        &self,
        lookahead: Lookahead,
        batch: &mut Columns<'_, T>,
        len: usize,
        execution: &Execution,
    ) {
        let pieces = execution.thread_count().min(len / PIECE).max(1);
        let piece = len.div_ceil(pieces).max(1);
        let mut rest = Columns {
            number: batch.number,
            observation: batch.observation,
            action: batch.action,
            reward: batch.reward,
            next_observation: batch.next_observation,
            terminated: batch.terminated,
            truncated: batch.truncated,
            discount: batch.discount,
            weight: batch.weight,
        };
        let parts = (0..pieces).map(|_| rest.split_off(piece, self.sizes)).collect();
        execution.each(parts, |part| self.gather(lookahead, part));
    }

    /// Fills what follows from the numbers: field by field, since a processor waits for more lines of memory at once where
    /// little is done with each.
    fn gather(&self, lookahead: Lookahead, batch: Columns<'_, T>) {
        let [observations, actions] = self.sizes;
        let (mut steps, mut places, mut cells) = ([0; BLOCK], [0; BLOCK], [0; BLOCK]);
        let mut marks = [0; BLOCK];
        let mut rest = batch;
        while !rest.number.is_empty() {
            let mut block = rest.split_off(rest.number.len().min(BLOCK), self.sizes);
            let len = block.number.len();
            let (steps, places) = (&mut steps[..len], &mut places[..len]);
            let (cells, marks) = (&mut cells[..len], &mut marks[..len]);
            for (i, &number) in block.number.iter().enumerate() {
                let (step, l) = self.width.divide(number);
                (steps[i], places[i]) = (step, l as usize);
                cells[i] = self.cell(step, l as usize);
            }
            gather(block.observation, self.observation(), cells, observations);
            gather(block.action, self.action(), cells, actions);
            if lookahead.steps == 1 {
                let gamma = T::from_f64(lookahead.discount);
                self.gather_next(gamma, cells, marks, &mut block);
            } else {
                self.gather_far(lookahead, steps, cells, marks, &mut block);
            }
            gather(block.next_observation, self.observation(), cells, observations);
            for (i, &mark) in marks.iter().enumerate() {
                if let Some(apart) = self.end_of(steps[i], places[i], mark) {
                    let next = &mut block.next_observation[i * observations..][..observations];
                    next.copy_from_slice(apart);
                }
                block.terminated[i] = mark & TERMINATED;
                block.truncated[i] = (mark & TRUNCATED) / TRUNCATED;
            }
        }
    }

    /// The cell of the same environment in the next row.
    #[inline(always)]
    pub(super) fn cell_after(&self) -> impl Fn(usize) -> usize + Copy {
        let width = self.capacity.environments;
        let last = (self.capacity.rows() - 1) * width;
        move |cell| if cell < last { cell + width } else { cell - last }
    }

    /// The outcome of one step; writes the flags of the cells, and moves these on to their next rows.
    fn gather_next(
        &self,
        gamma: T,
        cells: &mut [usize],
        marks: &mut [u8],
        batch: &mut Columns<'_, T>,
    ) {
        gather(marks, self.flags(), cells, 1);
        gather(batch.reward, self.reward(), cells, 1);
        let after = self.cell_after();
        cells.iter_mut().for_each(|cell| *cell = after(*cell));
        for (discount, mark) in batch.discount.iter_mut().zip(marks) {
            *discount = if *mark & TERMINATED != 0 { T::zero() } else { gamma };
        }
    }

    /// The outcome of several steps; moves `steps` on to the last of these, with its flags, and the cells to the row after it.
    fn gather_far(
        &self,
        lookahead: Lookahead,
        steps: &mut [u64],
        cells: &mut [usize],
        marks: &mut [u8],
        batch: &mut Columns<'_, T>,
    ) {
        let after = self.cell_after();
        let (paid, flags) = (self.reward(), self.flags());
        let gamma = T::from_f64(lookahead.discount);
        for (i, step) in steps.iter_mut().enumerate() {
            let mut at = cells[i];
            let mut next = after(at);
            let most = (self.marks.head - *step).min(lookahead.steps as u64);
            let (mut reward, mut factor) = (paid[at], gamma);
            let mut taken = 1;
            while taken < most && flags[at] & END == 0 {
                // What is no transition is not paid for: the one before led to where it stands.
                if flags[next] & NONE != 0 {
                    break;
                }
                at = next;
                reward = reward + factor * paid[at];
                factor = factor * gamma;
                taken += 1;
                next = after(next);
            }
            *step += taken - 1;
            cells[i] = next;
            marks[i] = flags[at];
            batch.reward[i] = reward;
            batch.discount[i] = if flags[at] & TERMINATED != 0 { T::zero() } else { factor };
        }
    }
}

/// Transitions that are gathered together.
const BLOCK: usize = 256;
