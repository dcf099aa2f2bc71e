//! Runs environments over a horizon.

use core::array::from_fn;
use core::mem::swap;
use core::ops::Range;

use bytemuck::Pod;
use libration_core::control::Clock;
use libration_core::control::error::ensure;
use libration_core::{Float, Integrator};

use super::block_size::{LANES, TILE};
use super::error::NOTHING_DRAWN;
use super::horizon::{Horizon, Share};
use super::rollout_slice::{RolloutSlice, first_of, rows_of};
use super::{
    Autoreset, EnvironmentError, Environments, EpisodeEnd, Layout, Plan, Policy, Rollout, Sensor,
    TransitionWork, World, Writes,
};
use crate::ensemble::{EnsembleError, InsufficientMemory};

/// Buffers for the results of one step.
#[derive(Debug)]
pub struct StepBuffers<'a, T> {
    /// The observations after the step: `[n, i]`.
    pub seen: &'a mut [T],
    /// The rewards.
    pub reward: &'a mut [T],
    /// 1 where the episode terminated, otherwise 0.
    pub terminated: &'a mut [u8],
    /// 1 where the time limit truncated the episode, otherwise 0.
    pub truncated: &'a mut [u8],
}

impl<T> StepBuffers<'_, T> {
    /// Checks the lengths for so many environments and observed numbers of each.
    pub(super) fn check(&self, [len, observations]: [usize; 2]) -> Result<(), EnvironmentError> {
        let seen = len.saturating_mul(observations);
        EnvironmentError::shape("observed numbers", self.seen.len(), seen)?;
        for (name, found) in [
            ("rewards", self.reward.len()),
            ("termination flags", self.terminated.len()),
            ("truncation flags", self.truncated.len()),
        ] {
            EnvironmentError::shape(name, found, len)?;
        }
        Ok(())
    }
}

impl<T, E, const O: usize, const D: usize> Environments<T, E, O, D>
where
    T: Float + Pod,
    E: World<T, O, D>,
{
    /// Fills `rollout` with the transitions of all environments under `policy`.
    ///
    /// # Errors
    /// [`EnvironmentError::Shape`] if the rollout or the policy is for another number of environments;
    /// [`EnvironmentError::Field`] if the rollout lacks a required field; [`EnvironmentError::Ensemble`] if the record of a clock is too
    /// short, or the memory is insufficient for the ends of episodes at the time limit.
    pub fn rollout<P: Policy<T, O, D>>(
        &mut self,
        policy: P,
        rollout: &mut Rollout<T, O, D>,
    ) -> Result<(), EnvironmentError> {
        let horizon = rollout.plan().horizon;
        self.fill(policy, rollout, 0..horizon)
    }

    /// Fills a range of rows of `rollout`; the rows before must be full. Filling row by row gives the same bits.
    ///
    /// # Errors
    /// As for [`rollout`](Self::rollout), and [`EnvironmentError::Shape`] if the range exceeds the rows.
    pub fn fill<P: Policy<T, O, D>>(
        &mut self,
        policy: P,
        rollout: &mut Rollout<T, O, D>,
        rows: Range<usize>,
    ) -> Result<(), EnvironmentError> {
        let plan = rollout.plan();
        self.expect_rows(&plan, &rows, [O, D])?;
        self.ready(policy, plan.horizon, rows.len())?;
        self.begin_rows(rollout, rows.start);
        let work = self.work(policy);
        let filled = Plan { horizon: rows.len(), ..plan };
        let how = (filled.threads(&self.execution, work), plan.writes, rows.start);
        let mut ends = self.advance(policy, rollout.slice(&rows), how);
        if rollout.finals.is_empty() {
            // Nothing is copied.
            swap(&mut rollout.finals, &mut ends);
        }
        rollout.finals.append(&mut ends);
        Ok(())
    }

    /// Checks that there is room for these rows of a rollout with so many observations and actions.
    pub(super) fn expect_rows(
        &self,
        plan: &Plan,
        rows: &Range<usize>,
        [observations, actions]: [usize; 2],
    ) -> Result<(), EnvironmentError> {
        let (horizon, len) = (plan.horizon, self.len);
        EnvironmentError::shape("environments of the rollout", plan.environments, len)?;
        EnvironmentError::shape("steps to be filled", rows.end, rows.end.min(horizon))?;
        let limit = self.world.parts().limit;
        if limit.is_some() && !plan.truncated {
            let (why, field) = ("the environments have a time limit", "truncated");
            return Err(EnvironmentError::Field { why, field });
        }
        // So many ends the limit makes, and to gather them takes as much again. To ask the system costs as long as a short rollout: it
        // is requested where they are more than what the plan was requested for.
        let cuts = limit.map_or(0, |l| len as u128 * (rows.len() as u128 / u128::from(l)));
        let end = size_of::<EpisodeEnd<T, 0>>() + observations.saturating_mul(size_of::<T>());
        let needed = cuts.saturating_mul(2 * end as u128);
        if needed > plan.bytes(observations, actions, size_of::<T>()) {
            InsufficientMemory::check(needed)?;
        }
        Ok(())
    }

    /// Makes a rollout ready for its rows from `row` on.
    pub(super) fn begin_rows<const N: usize, const A: usize>(
        &self,
        rollout: &mut Rollout<T, N, A>,
        row: usize,
    ) {
        if row == 0 {
            rollout.pauses = self.world.parts().autoreset != Autoreset::SameStep;
            rollout.idle = if rollout.pauses { self.stopped() } else { Vec::new() };
            rollout.finals.clear();
        }
    }

    /// Takes one action of each environment and writes the results. Returns the ends of episodes.
    ///
    /// # Errors
    /// As for [`rollout`](Self::rollout), and [`EnvironmentError::Shape`] if a buffer has another length.
    pub fn act<P: Policy<T, O, D>>(
        &mut self,
        policy: P,
        to: StepBuffers<'_, T>,
    ) -> Result<Vec<EpisodeEnd<T, O>>, EnvironmentError> {
        let len = self.len;
        to.check([len, O])?;
        self.ready(policy, 1, 1)?;
        let slice = RolloutSlice {
            observation: from_fn(|_| rows_of(&mut [], 1)),
            action: from_fn(|_| rows_of(&mut [], 1)),
            reward: rows_of(to.reward, 1),
            terminated: rows_of(to.terminated, 1),
            truncated: rows_of(to.truncated, 1),
            log_probability: rows_of(&mut [], 1),
            next: rows_of(to.seen, 1),
            layout: Layout::Interleaved,
        };
        let threads = Plan::new(1, len).threads(&self.execution, self.work(policy));
        Ok(self.advance(policy, slice, (threads, Writes::Plain, 0)))
    }

    /// The work of a transition under `policy`.
    fn work<P: Policy<T, O, D>>(&self, policy: P) -> TransitionWork {
        let parts = self.world.parts();
        let evaluations = parts.method.evaluations() as u64;
        TransitionWork {
            evaluations: evaluations.saturating_mul(parts.substeps.into()),
            policy_operations: policy.operations(self.len),
        }
    }

    /// Checks that `policy` and the clock support `steps` steps.
    fn ready<P: Policy<T, O, D>>(
        &self,
        policy: P,
        horizon: usize,
        steps: usize,
    ) -> Result<(), EnvironmentError> {
        policy.check(self.len, horizon)?;
        // Who draws may be one of several, of which others do not.
        let words = policy.words() as f64;
        ensure("random words of the policy", words, NOTHING_DRAWN, |n| P::DRAWS || n == 0.0)?;
        let parts = self.world.parts();
        let requested =
            self.step.saturating_add(steps as u64).saturating_mul(parts.substeps.into());
        if let Some(known) = parts.clock.steps().filter(|&known| known < requested) {
            return Err(EnsembleError::Record { known, requested }.into());
        }
        Ok(())
    }

    /// Runs all steps of a slice on `threads` threads, from row `row` of the rollout on.
    fn advance<'a, P: Policy<T, O, D>>(
        &'a mut self,
        policy: P,
        mut all: RolloutSlice<'a, T, O, D>,
        (threads, writes, row): (usize, Writes, usize),
    ) -> Vec<EpisodeEnd<T, O>> {
        let len = self.len;
        let (steps, substeps) = (all.steps() as u64, u64::from(self.world.parts().substeps));
        // Whole tiles where there are enough for all threads.
        let tile = TILE.min(len.div_ceil(threads).next_multiple_of(LANES)).max(LANES);
        let tiles = len.div_ceil(tile);
        let counts: Vec<usize> = (0..threads)
            .map(|i| [i, i + 1].map(|i| (tiles * i / threads * tile).min(len)))
            .map(|[from, to]| to - from)
            .collect();
        let Environments { world, history, step, .. } = *self;
        let [times, looks, acts] = &mut self.draws;
        let blocks = &self.blocks[..];
        let words = world.parts().clock.words();
        let times = times.prepare(blocks, [step, substeps], steps, words);
        let words = world.parts().sensor.words();
        let looks = looks.prepare(blocks, [step, 1], steps, words);
        let acts = acts.prepare(blocks, [step, 1], steps, policy.words());
        let mut rest = (&mut self.blocks[..], &mut self.past[..], [times, looks, acts]);
        let mut first = 0;
        let mut shares = Vec::with_capacity(counts.len());
        for &len in &counts {
            let count = len.div_ceil(LANES);
            let share = Share {
                first,
                len,
                blocks: first_of(&mut rest.0, count),
                past: first_of(&mut rest.1, count * history.len()),
                words: rest.2.each_mut().map(|words| first_of(words, count)),
            };
            shares.push((share, all.split_off(len)));
            first += len;
        }
        let instructions = self.execution.instruction_set();
        let each = self.execution.each(shares, |(share, slice)| {
            instructions.run(Horizon::<T, E, P, _, O, D> {
                world: &world,
                policy,
                history,
                environments: len,
                step,
                row,
                share,
                slice,
                writes,
            })
        });
        let finals = EpisodeEnd::in_order(each);
        self.step = self.step.saturating_add(steps);
        finals
    }

    /// The environments without a running episode.
    fn stopped(&self) -> Vec<usize> {
        let stands = |n: &usize| self.blocks[n / LANES].ended[n % LANES] != 0;
        (0..self.len).filter(stands).collect()
    }
}
