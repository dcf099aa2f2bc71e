//! Transitions that are drawn in proportion to a power of their priorities.
//!
//! T. Schaul, J. Quan, I. Antonoglou, D. Silver, *Prioritized experience replay*, ICLR 2016, section 3.

use bytemuck::Pod;
use libration_core::Float;
use libration_core::control::error::{ensure, ensure_probability};

use super::memory::Marks;
use super::power::power;
use super::replay_buffer::NONE;
use super::{Columns, Draw, Lookahead, ReplayBuffer, ReplayError};
use libration_batch::ensemble::Execution;

/// Of so large ones any number of transitions has a finite sum.
const MOST_WEIGHT: f64 = 1e280;

impl<T: Float + Pod> ReplayBuffer<T> {
    /// Fills a batch with transitions drawn in proportion to their weights, one from each of as many equal parts of the total. Their
    /// importance is `(live·w/total)^−β` for the weight `w`, over the largest of the batch: `correction` is `β`, from 0 to 1.
    ///
    /// # Errors
    /// [`ReplayError::Priorities`] if it has none; [`ReplayError::Empty`] if no transition has a weight above zero;
    /// [`ReplayError::Environment`] if the columns are not equally long or a number cannot be.
    pub fn sample_prioritised(
        &self,
        draw: Draw,
        lookahead: Lookahead,
        correction: f64,
        batch: &mut Columns<'_, T>,
        execution: &Execution,
    ) -> Result<(), ReplayError> {
        lookahead.check()?;
        ensure_probability("correction of priorities", correction)?;
        let len = batch.len(self.sizes)?;
        let sums = self.sums.as_ref().ok_or(ReplayError::Priorities)?;
        let total = sums.total();
        if total <= 0.0 {
            return Err(ReplayError::Empty("transitions with a priority above zero"));
        }
        let weights = self.weights();
        let part = total / len as f64;
        let mut targets: Vec<f64> = (0..len).map(|i| (i as f64 + draw.share(i)) * part).collect();
        let mut cells = vec![0; len];
        sums.find(weights, &mut targets, &mut cells);
        let mut importance = targets;
        for ((importance, number), &cell) in
            importance.iter_mut().zip(&mut *batch.number).zip(&cells)
        {
            *number = self.number(cell);
            let share = self.marks.live as f64 * (weights[cell] / total);
            *importance = power(share, -correction);
        }
        let largest = importance.iter().copied().fold(0.0, f64::max);
        for (to, importance) in batch.weight.iter_mut().zip(&importance) {
            *to = T::from_f64(importance / largest);
        }
        self.gather_all(lookahead, batch, len, execution);
        Ok(())
    }

    /// The transitions of these numbers have other priorities from now on, as with the errors that a learner found; their weights
    /// are `priority^exponent`. What is inserted has the largest weight so far. Gives how many have changed: what has gone
    /// since it was drawn is passed over, and of several priorities of the same the last one counts.
    ///
    /// # Errors
    /// [`ReplayError::Priorities`] if it has none; [`ReplayError::Index`] if there never was such a transition;
    /// [`ReplayError::Environment`] if there is not a priority for each, or one is below zero or its weight not finite. Nothing has
    /// changed then.
    pub fn update(
        &mut self,
        numbers: &[u64],
        priorities: &[T],
        exponent: f64,
    ) -> Result<usize, ReplayError> {
        if self.sums.is_none() {
            return Err(ReplayError::Priorities);
        }
        ReplayError::shape("priorities", priorities.len(), numbers.len())?;
        let allowed = "a finite number of at least 0";
        ensure("exponent of priorities", exponent, allowed, |x| x >= 0.0 && x.is_finite())?;
        let end = self.marks.head * self.capacity.environments as u64;
        let mut changes = Vec::with_capacity(numbers.len());
        let mut largest = self.marks.largest;
        for (index, (&number, priority)) in numbers.iter().zip(priorities).enumerate() {
            if number >= end {
                return Err(ReplayError::Index { index, value: number, end });
            }
            let priority = priority.to_f64();
            let weight = power(priority, exponent);
            if !(priority >= 0.0 && weight <= MOST_WEIGHT) {
                let (name, index) = ("priority", Some(index));
                let allowed = "at least 0, with a power of at most 1e280";
                let error =
                    libration_core::control::ControlError { name, index, value: priority, allowed };
                return Err(error.into());
            }
            if self.contains(number) {
                let (step, n) = self.width.divide(number);
                changes.push((self.cell(step, n as usize), weight));
                largest = largest.max(weight);
            }
        }
        let weights = self.memory.fields.weight.clone();
        let weights = self.memory.field_mut::<f64>(weights);
        changes.iter().for_each(|&(cell, weight)| weights[cell] = weight);
        if let Some(sums) = &mut self.sums {
            let weights = self.memory.field(&self.memory.fields.weight);
            sums.renew(weights, changes.iter().map(|&(cell, _)| cell));
        }
        if largest > self.marks.largest {
            self.marks.largest = largest;
            self.memory.commit(self.marks);
        }
        Ok(changes.len())
    }

    /// The weight of the transition of this number, if it is there and there are priorities.
    pub fn weight(&self, number: u64) -> Option<f64> {
        let (step, n) = self.width.divide(number);
        let cell = self.contains(number).then(|| self.cell(step, n as usize));
        cell.and_then(|cell| self.weights().get(cell).copied())
    }

    /// The sum of all weights; 0 without priorities.
    pub fn total_weight(&self) -> f64 {
        self.sums.as_ref().map_or(0.0, |sums| sums.total())
    }

    /// The number of the transition in a cell.
    #[inline(always)]
    fn number(&self, cell: usize) -> u64 {
        let n = self.capacity.environments;
        let rows = self.capacity.rows() as u64;
        let (row, l) = self.width.divide(cell as u64);
        let last = self.marks.head - 1;
        // The compiler divides once for a whole batch.
        let newest = last % rows;
        let back = if row <= newest { newest - row } else { newest + rows - row };
        (last - back) * n as u64 + l
    }

    /// Gives new transitions the largest weight and overwritten ones none.
    pub(super) fn set_weights(&mut self, before: Marks, nones: bool) {
        if self.sums.is_none() {
            return;
        }
        let Marks { head, tail, largest, .. } = self.marks;
        (before.tail..tail).for_each(|step| self.weigh_step(step, 0.0, false));
        (before.head..head).for_each(|step| self.weigh_step(step, largest, nones));
        let rows = self.capacity.rows() as u64;
        for (first, end) in [(before.tail, tail), (before.head, head)] {
            let (n, len) = (self.capacity.environments, end - first);
            let row = first % rows;
            // Once around at most: the second part begins with the first row.
            let ahead = len.min(rows - row);
            for (row, len) in [(row, ahead), (0, (len - ahead).min(rows))] {
                let cells = row as usize * n..(row + len) as usize * n;
                let weights = self.memory.field(&self.memory.fields.weight);
                self.sums.iter_mut().for_each(|sums| sums.renew_all(weights, cells.clone()));
            }
        }
    }

    /// All transitions of a step have this weight.
    fn weigh_step(&mut self, step: u64, weight: f64, nones: bool) {
        let (cell, n) = (self.cell(step, 0), self.capacity.environments);
        let range = self.memory.fields.weight.clone();
        self.memory.field_mut::<f64>(range)[cell..][..n].fill(weight);
        if !nones {
            return;
        }
        let none = |l: &usize| self.flags()[cell + l] & NONE != 0;
        let none: Vec<usize> = (0..n).filter(none).collect();
        let range = self.memory.fields.weight.clone();
        let weights = &mut self.memory.field_mut::<f64>(range)[cell..][..n];
        none.into_iter().for_each(|l| weights[l] = 0.0);
    }

    /// Sets the weight of cells without a transition to zero.
    pub(super) fn recompute_weights(&mut self) {
        let rows = self.capacity.rows();
        let there: Vec<bool> = {
            let mut there = vec![false; rows];
            (self.marks.tail..self.marks.head).for_each(|step| there[self.row(step)] = true);
            there
        };
        let n = self.capacity.environments;
        let none: Vec<bool> = self.flags().iter().map(|flags| flags & NONE != 0).collect();
        let range = self.memory.fields.weight.clone();
        let weights = self.memory.field_mut::<f64>(range);
        for (cell, weight) in weights.iter_mut().enumerate() {
            if !there[cell / n] || none[cell] {
                *weight = 0.0;
            }
        }
    }
}
