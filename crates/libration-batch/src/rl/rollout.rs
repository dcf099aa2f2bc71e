//! Rollouts: the transitions of environments over a horizon, as tensors.

use core::array::from_fn;
use core::ops::Range;

use bytemuck::Pod;

use super::rollout_slice::{RolloutSlice, planes, rows_of, some_rows};
use super::{EnvironmentError, EpisodeEnd, Layout, Plan};
use crate::ensemble::{Buffer, InsufficientMemory, Pages};

/// The transitions of environments over a horizon: allocated once, filled many times.
///
/// In step `t` of environment `n`, `observation` is the one before `action`; `reward`, `terminated` and `truncated` are its results.
#[derive(Debug)]
pub struct Rollout<T, const O: usize, const D: usize> {
    plan: Plan,
    observation: Buffer<T>,
    action: Buffer<T>,
    reward: Buffer<T>,
    terminated: Buffer<u8>,
    truncated: Buffer<u8>,
    log_probability: Buffer<T>,
    value: Buffer<T>,
    /// Ends of episodes, by step and environment.
    pub(super) finals: Vec<EpisodeEnd<T, O>>,
    /// Environments whose first step was none.
    pub(super) idle: Vec<usize>,
    /// Whether the step after an end is none.
    pub(super) pauses: bool,
}

impl<T: Pod, const O: usize, const D: usize> Rollout<T, O, D> {
    /// Allocates a rollout.
    ///
    /// # Errors
    /// [`EnvironmentError::OutOfMemory`] if there is not so much: with what would fit, and before anything is taken.
    pub fn new(plan: Plan) -> Result<Self, EnvironmentError> {
        let Plan { horizon, environments, .. } = plan;
        let number = size_of::<T>();
        let (needed, bytes) = (plan.bytes(O, D, number), plan.bytes_each(O, D, number));
        let refused =
            |shortage| EnvironmentError::OutOfMemory { horizon, environments, bytes, shortage };
        InsufficientMemory::check(needed).map_err(refused)?;
        let all = horizon.checked_mul(environments).filter(|_| horizon <= isize::MAX as usize);
        let all = all.filter(|n| n.checked_mul(O.max(D)).is_some());
        let all = all.ok_or_else(|| refused(InsufficientMemory { needed, available: None }))?;
        let part = |recorded| if recorded { all } else { 0 };
        let numbers = |count| Buffer::new(count, Pages::Huge);
        let flags = |count| Buffer::new(count, Pages::Huge);
        Ok(Rollout {
            plan,
            observation: numbers(all * O)?,
            action: numbers(all * D)?,
            reward: numbers(all)?,
            terminated: flags(all)?,
            truncated: flags(part(plan.truncated))?,
            log_probability: numbers(part(plan.log_probability))?,
            value: numbers(part(plan.value))?,
            finals: Vec::new(),
            idle: Vec::new(),
            pauses: false,
        })
    }

    /// The plan.
    pub fn plan(&self) -> Plan {
        self.plan
    }

    /// The observations: `[t, n, i]` or `[i, t, n]`, depending on the layout.
    pub fn observation(&self) -> &[T] {
        &self.observation
    }

    /// The actions, in the same order.
    pub fn action(&self) -> &[T] {
        &self.action
    }

    /// The rewards: `[t, n]`.
    pub fn reward(&self) -> &[T] {
        &self.reward
    }

    /// 1 where the episode terminated, otherwise 0: `[t, n]`.
    pub fn terminated(&self) -> &[u8] {
        &self.terminated
    }

    /// 1 where the time limit truncated the episode, otherwise 0: `[t, n]`, or empty.
    pub fn truncated(&self) -> &[u8] {
        &self.truncated
    }

    /// The logarithms of the probability densities of the actions: `[t, n]`, or empty.
    pub fn log_probability(&self) -> &[T] {
        &self.log_probability
    }

    /// The values of the observations, written by the caller: `[t, n]`, or empty.
    pub fn value(&self) -> &[T] {
        &self.value
    }

    /// The values, for writing.
    pub fn value_mut(&mut self) -> &mut [T] {
        &mut self.value
    }

    /// The episodes that ended, by step and environment: memory for them is taken as they end, beside that of the plan.
    pub fn finals(&self) -> &[EpisodeEnd<T, O>] {
        &self.finals
    }

    /// Whether step `t` of environment `n` is a transition: not where it stood still, or began anew upon an end.
    ///
    /// # Panics
    /// If `t` or `n` is out of range.
    pub fn is_transition(&self, t: usize, n: usize) -> bool {
        let Plan { horizon, environments, .. } = self.plan;
        assert!(t < horizon && n < environments, "step {t} of environment {n}");
        let mut idle = [0];
        self.write_idle(t, n, &mut idle);
        idle[0] == 0
    }

    /// Whether each step is a transition: `[t, n]`.
    pub fn transitions(&self) -> Vec<bool> {
        let Plan { horizon, environments, .. } = self.plan;
        let all = (0..horizon).flat_map(|t| (0..environments).map(move |n| (t, n)));
        all.map(|(t, n)| self.is_transition(t, n)).collect()
    }

    /// Whether there may be steps that are no transitions.
    pub fn pauses(&self) -> bool {
        self.pauses
    }

    /// Writes for the environments from `first` on whether step `t` is no transition: not 0 if it is none.
    pub fn write_idle(&self, t: usize, first: usize, idle: &mut [u8]) {
        idle.fill(0);
        if !self.pauses {
            return;
        }
        let Some(before) = t.checked_sub(1) else {
            let all = self.idle.iter().filter_map(|n| n.checked_sub(first));
            for l in all {
                idle.get_mut(l).into_iter().for_each(|idle| *idle = 1);
            }
            return;
        };
        // What ended in one step is idle in the next.
        let at = before * self.plan.environments + first;
        for flags in [&self.terminated, &self.truncated] {
            let flags = flags.get(at..at + idle.len()).unwrap_or_default();
            idle.iter_mut().zip(flags).for_each(|(idle, flag)| *idle |= flag);
        }
    }

    /// The observation of environment `n` in step `t`.
    ///
    /// # Panics
    /// If `t` or `n` is out of range.
    pub fn seen(&self, t: usize, n: usize) -> [T; O] {
        self.of(&self.observation, t, n)
    }

    /// The action of environment `n` in step `t`.
    ///
    /// # Panics
    /// If `t` or `n` is out of range.
    pub fn done(&self, t: usize, n: usize) -> [T; D] {
        self.of(&self.action, t, n)
    }

    fn of<const N: usize>(&self, numbers: &[T], t: usize, n: usize) -> [T; N] {
        let Plan { horizon, environments, layout, .. } = self.plan;
        assert!(t < horizon && n < environments, "step {t} of environment {n}");
        let (at, all) = (t * environments + n, horizon * environments);
        from_fn(|i| match layout {
            Layout::Interleaved => numbers[at * N + i],
            Layout::Planes => numbers[i * all + at],
        })
    }

    /// Some of its rows, to be written.
    pub(super) fn slice(&mut self, rows: &Range<usize>) -> RolloutSlice<'_, T, O, D> {
        let Plan { horizon, layout, .. } = self.plan;
        let part = |all| some_rows(all, rows);
        let flags = |all| some_rows(all, rows);
        RolloutSlice {
            observation: planes(&mut self.observation, layout, horizon).map(part),
            action: planes(&mut self.action, layout, horizon).map(part),
            reward: part(rows_of(&mut self.reward, horizon)),
            terminated: flags(rows_of(&mut self.terminated, horizon)),
            truncated: flags(rows_of(&mut self.truncated, horizon)),
            log_probability: part(rows_of(&mut self.log_probability, horizon)),
            next: rows_of(&mut [], 0),
            layout,
        }
    }
}
