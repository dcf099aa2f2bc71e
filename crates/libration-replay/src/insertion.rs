//! Insertion of rollouts into a replay buffer.

use core::ops::Range;

use bytemuck::Pod;
use libration_core::Float;

use super::capacity::Fields;
use super::memory::Marks;
use super::replay_buffer::{END, NONE, TERMINATED, TRUNCATED};
use super::rows::interleave;
use super::{ReplayBuffer, ReplayError};
use libration_batch::ensemble::Execution;
use libration_batch::rl::{Layout, Plan, RolloutTensors};

/// Rows that come in.
struct Rows<'a> {
    /// The first of their steps.
    head: u64,
    steps: usize,
    layout: Layout,
    execution: &'a Execution,
}

impl<T: Float + Pod> ReplayBuffer<T> {
    /// Inserts a [`Rollout`](libration_batch::rl::Rollout) or [`ProgramRollout`](libration_batch::rl::ProgramRollout) and overwrites
    /// the oldest steps. `next` are the observations after its last step: `[n, i]`, as
    /// [`observe`](libration_batch::rl::Environments::observe) writes them.
    ///
    /// If the first observation differs from `next` of the insertion before, as after a reset, the transition before keeps its own.
    /// The last step of a lost environment is not stored, so that samples are finite.
    ///
    /// # Errors
    /// [`ReplayError::Capacity`] if it has more steps or more ends of episodes than the capacity;
    /// [`ReplayError::Environment`] if it has another number of environments, observations or actions. The buffer is then unchanged.
    pub fn insert(
        &mut self,
        rollout: &dyn RolloutTensors<T>,
        next: &[T],
        execution: &Execution,
    ) -> Result<(), ReplayError> {
        let Plan { horizon, environments, layout, .. } = rollout.plan();
        let n = self.capacity.environments;
        ReplayError::shape("environments of the rollout", environments, n)?;
        let ([observations, actions], sizes) = (self.sizes, rollout.sizes());
        ReplayError::shape("observed numbers of the rollout", sizes[0], observations)?;
        ReplayError::shape("actions of the rollout", sizes[1], actions)?;
        let wanted = n.saturating_mul(observations);
        ReplayError::shape("numbers seen after the last step", next.len(), wanted)?;
        if horizon > self.capacity.steps {
            let capacity = self.capacity.steps;
            return Err(ReplayError::Capacity {
                name: "steps of a rollout",
                found: horizon,
                capacity,
            });
        }
        if horizon == 0 {
            return Ok(());
        }
        let (before, broken) = (self.marks, self.broken(rollout));
        let tail = self.make_room(horizon, rollout.ended() + broken.len())?;
        let broken = if tail < before.head { broken } else { Vec::new() };
        self.retire(tail);
        self.part(&broken);

        let head = self.marks.head;
        let Fields { observation, action, reward, .. } = self.memory.fields.clone();
        let rows = Rows { head, steps: horizon, layout, execution };
        self.copy(&rows, rollout.observation(), observation.clone(), observations);
        self.copy(&rows, rollout.action(), action, actions);
        self.copy(&rows, rollout.reward(), reward, 1);
        let nones = self.mark(head, rollout);
        let lost = self.end(head, rollout);
        let first = self.cell(head + horizon as u64, 0) * observations;
        let seen = &mut self.memory.field_mut::<T>(observation)[first..][..next.len()];
        seen.copy_from_slice(next);
        let live = (horizon * n) as u64 - nones - lost;
        self.marks.head += horizon as u64;
        self.marks.ends.end += rollout.ended() as u64;
        self.marks.live += live;
        self.set_weights(before, nones + lost > 0);
        self.memory.commit(self.marks);
        Ok(())
    }

    /// The environments whose next observation differs from the stored one.
    fn broken(&self, rollout: &dyn RolloutTensors<T>) -> Vec<usize> {
        let Marks { head, tail, .. } = self.marks;
        if head == tail {
            return Vec::new();
        }
        let (n, width) = (self.capacity.environments, self.sizes[0]);
        let last = &self.observation()[self.cell(head, 0) * width..][..n * width];
        let Plan { horizon, layout, .. } = rollout.plan();
        let mut rows = Vec::new();
        let first = match layout {
            Layout::Interleaved => &rollout.observation()[..n * width],
            Layout::Planes => {
                rows.resize(n * width, T::zero());
                interleave(&mut rows, rollout.observation(), horizon * n, width);
                &rows
            }
        };
        let [first, last] = [first, last].map(bytemuck::cast_slice::<T, u8>);
        if first == last {
            return Vec::new();
        }
        let row = |&i: &usize| i * width * size_of::<T>()..(i + 1) * width * size_of::<T>();
        let differs = |i: &usize| first[row(i)] != last[row(i)];
        // What ended before has its end already.
        let goes_on = |&i: &usize| self.flags()[self.cell(head - 1, i)] & (END | NONE) == 0;
        (0..n).filter(differs).filter(goes_on).collect()
    }

    /// The first step that stays after an insertion of so many steps and ends.
    fn make_room(&self, steps: usize, ends: usize) -> Result<u64, ReplayError> {
        let Marks { head, tail, ends: there, .. } = self.marks;
        let capacity = self.capacity;
        if ends > capacity.ends {
            return Err(ReplayError::Capacity {
                name: "ends of episodes",
                found: ends,
                capacity: capacity.ends,
            });
        }
        let end = head.checked_add(steps as u64).filter(|end| {
            end.checked_mul(capacity.environments as u64).is_some_and(|n| n < u64::MAX / 4)
        });
        let end = end.ok_or(ReplayError::Capacity {
            name: "numbers of transitions",
            found: usize::MAX,
            capacity: usize::MAX / 4,
        })?;
        let first = (there.end + ends as u64).saturating_sub(capacity.ends as u64);
        let crowded = if first > there.first { self.step_of_end(first - 1) + 1 } else { 0 };
        Ok(tail.max(end.saturating_sub(capacity.steps as u64)).max(crowded).min(head))
    }

    /// Steps before `tail` are there no more.
    fn retire(&mut self, tail: u64) {
        let Marks { tail: old, head, live, .. } = self.marks;
        if tail == old {
            return;
        }
        let n = self.capacity.environments;
        let gone = (tail - old) * n as u64;
        let all = (head - old) * n as u64;
        let nones = if live == all { 0 } else { self.nones(old..tail) };
        self.marks.live -= gone - nones;
        self.marks.ends.first = self.first_end(tail);
        self.marks.tail = tail;
        self.memory.commit(self.marks);
    }

    /// The number of cells without a transition in these steps.
    pub(super) fn nones(&self, steps: Range<u64>) -> u64 {
        let n = self.capacity.environments;
        let row = |step| &self.flags()[self.cell(step, 0)..][..n];
        let nones = |step| row(step).iter().filter(|&&flags| flags & NONE != 0).count() as u64;
        steps.map(nones).sum()
    }

    /// Stores the final observations of the last transitions of these environments.
    fn part(&mut self, environments: &[usize]) {
        if environments.is_empty() {
            return;
        }
        let head = self.marks.head;
        for &i in environments {
            let bytes = self.sizes[0] * size_of::<T>();
            let from = self.memory.fields.observation.start + self.cell(head, i) * bytes;
            let at = self.write_end(self.marks.ends.end, self.place_of(head - 1, i, true));
            let to = self.memory.fields.end_seen.start + at * bytes;
            self.memory.copy_within(from..from + bytes, to);
            self.marks.ends.end += 1;
        }
        // An end without its mark says what the next row says as well.
        self.memory.commit(self.marks);
        let cells: Vec<usize> = environments.iter().map(|&i| self.cell(head - 1, i)).collect();
        let flags = self.memory.fields.flags.clone();
        let flags = self.memory.field_mut::<u8>(flags);
        cells.into_iter().for_each(|cell| flags[cell] |= END);
    }

    /// Writes the place of end `i`. Returns the index of its observation.
    fn write_end(&mut self, i: u64, place: u64) -> usize {
        let at = (i % self.capacity.ends as u64) as usize;
        let range = self.memory.fields.end_place.clone();
        self.memory.field_mut::<u64>(range)[at] = place;
        at
    }

    /// Copies rows of transitions of `width` numbers.
    fn copy(&mut self, new: &Rows<'_>, from: &[T], field: Range<usize>, width: usize) {
        let Rows { head, steps, layout, execution } = *new;
        let (n, rows) = (self.capacity.environments, self.capacity.rows());
        let (row, len) = (self.row(head), n * width);
        let whole = self.memory.field_mut::<T>(field);
        if layout == Layout::Planes && width > 1 {
            for (t, row) in (0..steps).map(|t| (t, (row + t) % rows)) {
                interleave(&mut whole[row * len..][..len], &from[t * n..], steps * n, width);
            }
            return;
        }
        let first = (rows - row).min(steps) * len;
        let (start, rest) = whole.split_at_mut(row * len);
        let (head, tail) = from.split_at(first);
        copy_all(&mut rest[..first], head, PIECE * width, execution);
        copy_all(&mut start[..tail.len()], tail, PIECE * width, execution);
    }

    /// Marks ends of episodes and cells without a transition. Returns the number of the latter.
    fn mark(&mut self, head: u64, rollout: &dyn RolloutTensors<T>) -> u64 {
        let n = self.capacity.environments;
        let mut idle = vec![0; n];
        let mut nones = 0;
        let (terminated, truncated) = (rollout.terminated(), rollout.truncated());
        let (horizon, pauses) = (rollout.plan().horizon, rollout.pauses());
        for t in 0..horizon {
            let cell = self.cell(head + t as u64, 0);
            let range = self.memory.fields.flags.clone();
            let to = &mut self.memory.field_mut::<u8>(range)[cell..][..n];
            let over = &terminated[t * n..][..n];
            match truncated.get(t * n..(t + 1) * n) {
                Some(cut) => {
                    let both = over.iter().zip(cut);
                    let flags =
                        |(over, cut)| over * TERMINATED + cut * TRUNCATED + (over | cut) * END;
                    to.iter_mut().zip(both).for_each(|(to, both)| *to = flags(both));
                }
                None => {
                    to.iter_mut().zip(over).for_each(|(to, over)| *to = over * (TERMINATED + END));
                }
            }
            if pauses {
                rollout.write_idle(t, 0, &mut idle);
                for (to, _) in to.iter_mut().zip(&idle).filter(|(_, idle)| **idle != 0) {
                    *to = NONE;
                    nones += 1;
                }
            }
        }
        nones
    }

    /// Stores the final observations. Returns the number of lost environments.
    fn end(&mut self, head: u64, rollout: &dyn RolloutTensors<T>) -> u64 {
        let mut lost = 0;
        let width = self.sizes[0];
        for k in 0..rollout.ended() {
            let (end, seen) = rollout.end(k);
            let step = head + end.step as u64;
            let place = self.place_of(step, end.environment, false);
            let at = self.write_end(self.marks.ends.end + k as u64, place);
            let range = self.memory.fields.end_seen.clone();
            self.memory.field_mut::<T>(range)[at * width..][..width].copy_from_slice(seen);
            if end.lost {
                lost += 1;
                let cell = self.cell(step, end.environment);
                let range = self.memory.fields.flags.clone();
                self.memory.field_mut::<u8>(range)[cell] |= NONE;
            }
        }
        lost
    }
}

/// The number of transitions per copying thread.
const PIECE: usize = 1 << 16;

/// Copies one into the other, on all threads that have a piece of so many numbers.
fn copy_all<T: Pod + Send + Sync>(to: &mut [T], from: &[T], piece: usize, execution: &Execution) {
    if from.len() < 2 * piece {
        to.copy_from_slice(from);
        return;
    }
    let pieces = execution.thread_count().min(from.len() / piece);
    let len = from.len().div_ceil(pieces);
    let pairs: Vec<_> = to.chunks_mut(len).zip(from.chunks(len)).collect();
    execution.each(pairs, |(to, from)| to.copy_from_slice(from));
}
