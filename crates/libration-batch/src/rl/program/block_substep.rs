//! The parts of a step of the integrator of a block.

use libration_core::control::{Clock, Memory};
use libration_core::random::{Purpose, Streams};

use super::block_state::{BlockState, Row, row_of};
use super::block_step::BlockStep;
use super::environment::World;
use super::episodes::EpisodeBlock;
use super::row_program::ProgramRows;
use crate::ensemble::BatchFloat;
use crate::rl::block::ClockMemory;
use crate::rl::block_size::LANES;
use crate::rl::deviation::scale_deviation;
use crate::rl::episode_streams::begin_epochs;

impl<T: BatchFloat> BlockStep<T> {
    /// Stores the latencies of the actions of a step whose answers take times of their own.
    pub(super) fn store_latencies(&self, now: u64, block: &mut BlockState<'_, T>) {
        let Some(answers) = self.definition.answers.filter(|answers| answers.waits == 0) else {
            return;
        };
        if self.history.delays_actions() {
            let base = &block.episodes.delays[1];
            let latencies = answers.steps(&self.answer_times, self.definition.dt, base);
            self.history.act_late(block.past, now, &latencies);
        }
    }

    /// Sets the commands that are in effect in a substep.
    pub(super) fn take_commands(&mut self, now: u64, substep: u64, block: &BlockState<'_, T>) {
        if self.definition.answers.is_some_and(|answers| answers.waits == 0) {
            self.ages = self.history.arrived(block.past, now, substep);
            self.history.given(block.past, now, &self.ages, &mut self.held);
            return;
        }
        let late = &block.episodes.delays[1];
        self.history.effective(block.past, now, substep, late, &mut self.held);
        if self.inner.as_ref().is_some_and(ProgramRows::reads_last) {
            for (age, &late) in self.ages.iter_mut().zip(late) {
                *age = self.history.periods(late, substep) as u32;
            }
        }
    }

    /// Sets the lengths of a step of the integrator.
    pub(super) fn set_lengths(
        &mut self,
        [now, substeps, substep]: [u64; 3],
        block: &mut EpisodeBlock<T>,
        words: &mut Streams<LANES>,
    ) {
        if let Some(&length) = self.definition.lengths.get(substep as usize) {
            self.dt = T::from_f64(length);
            self.lengths = [self.dt; LANES];
        }
        if self.definition.is_jittered() {
            self.draw_lengths([now, substeps, substep], block, words);
        }
        let waits = u64::from(self.definition.waits());
        if let Some(answers) = self.definition.answers.filter(|_| substep < waits) {
            self.lengths = answers.waiting(&self.answer_times, self.definition.dt, substep);
        } else if substep == waits && waits > 0 && !self.definition.is_jittered() {
            self.lengths = [self.dt; LANES];
        }
    }

    /// Draws the lengths of a step of the integrator.
    fn draw_lengths(
        &mut self,
        now: [u64; 3],
        block: &mut EpisodeBlock<T>,
        words: &mut Streams<LANES>,
    ) {
        begin_epochs(words, block, now, Purpose::StepTime);
        let [step, substeps, substep] = now;
        let clock = self.world.clock;
        let beat = Clock::<T>::beat(&clock, step * substeps + substep);
        for l in 0..LANES {
            let mut memory = ClockMemory::<T, World, 0, 0>::lane(&block.clock, l);
            let ratio: T = clock.ratio(&mut memory, beat, &mut || words.next(l));
            ClockMemory::<T, World, 0, 0>::set_lane(&mut block.clock, l, memory);
            let ratio = scale_deviation(ratio, T::one(), block.error_scale[0][l]);
            let ratio = if ratio < T::zero() { T::zero() } else { ratio };
            self.lengths[l] = self.dt * ratio;
        }
    }

    /// Computes the commands of the inner controller, if there is one, in a substep that begins with new ones.
    pub(super) fn control(&mut self, substep: u64, block: &BlockState<'_, T>) {
        let waits = u64::from(self.definition.waits());
        let own = substep.checked_sub(waits);
        // The time of a chunk of actions goes on until the robot begins to wait, in the last step before.
        let last = self.substeps() - waits - 1;
        let Some(inner) = &mut self.inner else { return };
        if !own.unwrap_or(substep).is_multiple_of(self.definition.inner_steps.into()) {
            return;
        }
        if inner.reads_last() {
            let within = self.definition.time_of(own.unwrap_or(last) as u32);
            for (time, &age) in self.times.iter_mut().zip(&self.ages) {
                let periods = if waits > 0 { 0.0 } else { f64::from(age) };
                *time = T::from_f64(periods * self.span + within);
            }
        }
        let held = if self.history.delays_actions() { &self.held } else { &self.commands };
        let parameters = &block.numbers[..self.definition.parameters.len()];
        let rows = [&*block.states, parameters, held];
        let input = |i: usize| row_of(rows, i).unwrap_or(&self.times);
        inner.run(input, &mut self.inner_commands, self.instructions);
    }

    /// A step of the integrator, and its projection.
    pub(super) fn integrate(&mut self, states: &mut [Row<T>], numbers: &[Row<T>]) {
        let held = match (&self.inner, self.history.delays_actions()) {
            (Some(_), _) => &self.inner_commands,
            (None, true) => &self.held,
            (None, false) => &self.commands,
        };
        let parameters = &numbers[..self.definition.parameters.len()];
        let lengths = &self.lengths;
        let inputs = [&held[..], parameters];
        let rest = |i: usize| row_of(inputs, i).unwrap_or(lengths);
        let Some(projection) = &mut self.projection else {
            return self.step.run_in_place(states, rest, self.instructions);
        };
        self.previous.copy_from_slice(states);
        self.step.run_in_place(states, rest, self.instructions);
        let count = held.len() + parameters.len() + 1;
        let previous = &self.previous;
        let rest = |i: usize| if i < count { rest(i) } else { &previous[i - count] };
        projection.run_in_place(states, rest, self.instructions);
    }

    /// Puts back what has its answer: a step without length is none.
    pub(super) fn keep_answered(&self, states: &mut [Row<T>]) {
        for (row, kept) in states.iter_mut().zip(&self.kept) {
            for ((x, &was), &length) in row.iter_mut().zip(kept).zip(&self.lengths) {
                *x = if length > T::zero() { *x } else { was };
            }
        }
    }
}
