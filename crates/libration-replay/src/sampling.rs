//! Transitions that are drawn, each as likely.

use core::ops::Range;

use bytemuck::Pod;
use libration_core::Float;
use libration_core::control::error::ensure_probability;

use super::memory::Marks;
use super::replay_buffer::{END, NONE, TERMINATED, TRUNCATED};
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

impl<T: Float + Pod, const O: usize, const D: usize> ReplayBuffer<T, O, D> {
    /// Fills a batch with transitions that are drawn with replacement, each as likely; their weights are 1.
    ///
    /// # Errors
    /// [`ReplayError::Empty`] if there is no transition; [`ReplayError::Environment`] if the columns are not equally long or the
    /// lookahead cannot be.
    pub fn sample(
        &self,
        draw: Draw,
        lookahead: Lookahead,
        batch: &mut Columns<'_, T, O, D>,
        execution: &Execution,
    ) -> Result<(), ReplayError> {
        lookahead.check()?;
        let len = batch.len()?;
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
    pub(super) fn next(&self, step: u64, l: usize, flags: u8) -> [T; O] {
        let apart = self.end_of(step, l, flags);
        apart.unwrap_or_else(|| self.observation()[self.cell(step + 1, l)])
    }

    /// Fills what follows from the numbers of a batch.
    pub(super) fn gather_all(
        &self,
        lookahead: Lookahead,
        batch: &mut Columns<'_, T, O, D>,
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
        let parts = (0..pieces).map(|_| rest.split_off(piece)).collect();
        execution.each(parts, |part| self.gather(lookahead, part));
    }

    /// Fills what follows from the numbers: field by field, since a processor waits for more lines of memory at once where
    /// little is done with each.
    fn gather(&self, lookahead: Lookahead, batch: Columns<'_, T, O, D>) {
        let (mut steps, mut places) = ([0; BLOCK], [0; BLOCK]);
        let mut rest = batch;
        while !rest.number.is_empty() {
            let mut block = rest.split_off(rest.number.len().min(BLOCK));
            for (i, &number) in block.number.iter().enumerate() {
                let (step, l) = self.width.divide(number);
                (steps[i], places[i]) = (step, l as usize);
            }
            let (steps, places) = (&steps[..block.number.len()], &places[..block.number.len()]);
            if lookahead.steps == 1 {
                self.gather_next(T::from_f64(lookahead.discount), steps, places, &mut block);
            } else {
                self.gather_far(lookahead, steps, places, &mut block);
            }
        }
    }

    /// The outcome of one step.
    fn gather_next(
        &self,
        gamma: T,
        steps: &[u64],
        places: &[usize],
        batch: &mut Columns<'_, T, O, D>,
    ) {
        let (rows, width) = (self.capacity.rows(), self.capacity.environments);
        let (mut cells, mut marks) = ([0; BLOCK], [0; BLOCK]);
        let len = steps.len();
        for (cell, (&step, &l)) in cells.iter_mut().zip(steps.iter().zip(places)) {
            *cell = self.row(step) * width + l;
        }
        let cells = &mut cells[..len];
        take(&mut marks[..len], self.flags(), cells);
        take(batch.observation, self.observation(), cells);
        take(batch.action, self.action(), cells);
        take(batch.reward, self.reward(), cells);
        let last = (rows - 1) * width;
        cells
            .iter_mut()
            .for_each(|cell| *cell = if *cell < last { *cell + width } else { *cell - last });
        take(batch.next_observation, self.observation(), cells);
        for (i, &mark) in marks[..len].iter().enumerate() {
            if let Some(apart) = self.end_of(steps[i], places[i], mark) {
                batch.next_observation[i] = apart;
            }
            batch.terminated[i] = mark & TERMINATED;
            batch.truncated[i] = (mark & TRUNCATED) / TRUNCATED;
            batch.discount[i] = if mark & TERMINATED != 0 { T::zero() } else { gamma };
        }
    }

    /// The outcome of several steps.
    fn gather_far(
        &self,
        lookahead: Lookahead,
        steps: &[u64],
        places: &[usize],
        batch: &mut Columns<'_, T, O, D>,
    ) {
        let (rows, width) = (self.capacity.rows(), self.capacity.environments);
        let (seen, done) = (self.observation(), self.action());
        let (paid, flags) = (self.reward(), self.flags());
        let gamma = T::from_f64(lookahead.discount);
        for (i, (&step, &l)) in steps.iter().zip(places).enumerate() {
            let mut row = self.row(step);
            let cell = row * width + l;
            (batch.observation[i], batch.action[i]) = (seen[cell], done[cell]);
            let most = (self.marks.head - step).min(lookahead.steps as u64);
            let (mut reward, mut factor, mut at) = (paid[cell], gamma, cell);
            let mut taken = 1;
            row = if row + 1 == rows { 0 } else { row + 1 };
            while taken < most && flags[at] & END == 0 {
                let next = row * width + l;
                // What is no transition is not paid for: the one before led to where it stands.
                if flags[next] & NONE != 0 {
                    break;
                }
                at = next;
                reward = reward + factor * paid[at];
                factor = factor * gamma;
                taken += 1;
                row = if row + 1 == rows { 0 } else { row + 1 };
            }
            let mark = flags[at];
            let apart = self.end_of(step + taken - 1, l, mark);
            batch.next_observation[i] = apart.unwrap_or_else(|| seen[row * width + l]);
            batch.reward[i] = reward;
            batch.terminated[i] = mark & TERMINATED;
            batch.truncated[i] = (mark & TRUNCATED) / TRUNCATED;
            batch.discount[i] = if mark & TERMINATED != 0 { T::zero() } else { factor };
        }
    }
}

/// Transitions that are gathered together.
const BLOCK: usize = 256;

/// The values of some cells.
#[inline(always)]
fn take<X: Copy>(to: &mut [X], from: &[X], cells: &[usize]) {
    to.iter_mut().zip(cells).for_each(|(to, &cell)| *to = from[cell]);
}
