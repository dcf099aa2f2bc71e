//! What environments do over a horizon, as tensors.

use core::mem::take;

use bytemuck::Pod;

use crate::ensemble::{Buffer, EnsembleError, NoRoom, Pages};

use super::Final;

/// How several numbers of a transition lie in memory.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Layout {
    /// Side by side: `[t, n, i]`, as most learners read them.
    Interleaved,
    /// Apart: `[i, t, n]`, a structure of arrays.
    Planes,
}

/// How the tensors are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Writes {
    /// Through the caches: fastest where they hold all of it.
    Plain,
    /// Past the caches: fastest where they do not.
    Past,
}

/// How large a rollout is to be.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Plan {
    /// Actions of each environment.
    pub horizon: usize,
    /// How many environments there are.
    pub environments: usize,
    /// Numbers that are seen of each.
    pub observation: usize,
    /// Numbers of an action.
    pub action: usize,
    /// Whether episodes can be cut off: without a time limit none is, and no memory is needed to say so.
    pub truncated: bool,
    /// Bytes of a number.
    pub number: usize,
}

impl Plan {
    /// Every field with its bytes for a transition.
    pub fn fields(&self) -> [(&'static str, usize); 5] {
        [
            ("observation", self.observation * self.number),
            ("action", self.action * self.number),
            ("reward", self.number),
            ("terminated", 1),
            ("truncated", usize::from(self.truncated)),
        ]
    }

    /// Bytes for a transition.
    pub fn bytes_each(&self) -> usize {
        self.fields().iter().map(|(_, bytes)| bytes).sum()
    }

    /// How many transitions there are.
    pub fn transitions(&self) -> u128 {
        self.horizon as u128 * self.environments as u128
    }

    /// All bytes.
    pub fn bytes(&self) -> u128 {
        self.transitions() * self.bytes_each() as u128
    }

    /// How to write it where the last cache holds so many bytes.
    pub fn writes(&self, cache: u64) -> Writes {
        if self.bytes() > cache.into() { Writes::Past } else { Writes::Plain }
    }
}

/// What environments did over a horizon: allocated once, to be filled again and again.
///
/// In step `t` of environment `n`, `observation` is what was seen before `action`; `reward`, `terminated` and `truncated` are
/// what came of it.
#[derive(Debug)]
pub struct Rollout<T, const O: usize, const D: usize> {
    horizon: usize,
    environments: usize,
    layout: Layout,
    writes: Writes,
    observation: Buffer<T>,
    action: Buffer<T>,
    reward: Buffer<T>,
    terminated: Buffer<u8>,
    truncated: Buffer<u8>,
    /// Ends of episodes, by step and environment.
    pub(super) finals: Vec<Final<T, O>>,
}

impl<T: Pod, const O: usize, const D: usize> Rollout<T, O, D> {
    /// What a rollout of this kind takes.
    pub fn plan(horizon: usize, environments: usize, truncated: bool) -> Plan {
        let number = size_of::<T>();
        Plan { horizon, environments, observation: O, action: D, truncated, number }
    }

    /// Memory for a rollout, which nobody has touched.
    ///
    /// # Errors
    /// [`EnsembleError::Memory`] if there is not so much.
    pub fn new(
        horizon: usize,
        environments: usize,
        truncated: bool,
        layout: Layout,
        writes: Writes,
    ) -> Result<Self, EnsembleError> {
        let plan = Self::plan(horizon, environments, truncated);
        NoRoom::check(plan.bytes())?;
        let refused = NoRoom { needed: plan.bytes(), available: None };
        let all = horizon.checked_mul(environments).filter(|n| n.checked_mul(O.max(D)).is_some());
        let all = all.ok_or(refused)?;
        Ok(Rollout {
            horizon,
            environments,
            layout,
            writes,
            observation: Buffer::new(all * O, Pages::Huge)?,
            action: Buffer::new(all * D, Pages::Huge)?,
            reward: Buffer::new(all, Pages::Huge)?,
            terminated: Buffer::new(all, Pages::Huge)?,
            truncated: Buffer::new(if truncated { all } else { 0 }, Pages::Huge)?,
            finals: Vec::new(),
        })
    }

    /// Actions of each environment.
    pub fn horizon(&self) -> usize {
        self.horizon
    }

    /// How many environments there are.
    pub fn environments(&self) -> usize {
        self.environments
    }

    /// How its numbers lie.
    pub fn layout(&self) -> Layout {
        self.layout
    }

    /// How it is written.
    pub fn writes(&self) -> Writes {
        self.writes
    }

    /// Whether there is room to say that episodes were cut off.
    pub fn has_truncated(&self) -> bool {
        !self.truncated.is_empty() || self.terminated.is_empty()
    }

    /// What was seen: `[t, n, i]` or `[i, t, n]`, as the layout says.
    pub fn observation(&self) -> &[T] {
        &self.observation
    }

    /// What was done about it, in the same order.
    pub fn action(&self) -> &[T] {
        &self.action
    }

    /// What it paid: `[t, n]`.
    pub fn reward(&self) -> &[T] {
        &self.reward
    }

    /// 1 where the episode was over, otherwise 0: `[t, n]`.
    pub fn terminated(&self) -> &[u8] {
        &self.terminated
    }

    /// 1 where it was cut off at the time limit, otherwise 0: `[t, n]`; empty without a limit.
    pub fn truncated(&self) -> &[u8] {
        &self.truncated
    }

    /// The episodes that ended, by step and environment.
    pub fn finals(&self) -> &[Final<T, O>] {
        &self.finals
    }

    /// What was seen by environment `n` in step `t`.
    ///
    /// # Panics
    /// If there is no such step or environment.
    pub fn seen(&self, t: usize, n: usize) -> [T; O] {
        self.of(&self.observation, t, n)
    }

    /// What it did.
    ///
    /// # Panics
    /// If there is no such step or environment.
    pub fn done(&self, t: usize, n: usize) -> [T; D] {
        self.of(&self.action, t, n)
    }

    fn of<const N: usize>(&self, numbers: &[T], t: usize, n: usize) -> [T; N] {
        assert!(t < self.horizon && n < self.environments, "step {t} of environment {n}");
        let (at, all) = (t * self.environments + n, self.horizon * self.environments);
        core::array::from_fn(|i| match self.layout {
            Layout::Interleaved => numbers[at * N + i],
            Layout::Planes => numbers[i * all + at],
        })
    }

    /// The rows of neighbouring environments, so many for each: for each of them all steps.
    pub(super) fn shares(&mut self, counts: &[usize]) -> Vec<Vec<Row<'_, T, O, D>>> {
        let (n, all) = (self.environments, self.horizon * self.environments);
        let mut observation = planes(&mut self.observation, self.layout, all, n);
        let mut action = planes(&mut self.action, self.layout, all, n);
        let mut reward = self.reward.chunks_exact_mut(n.max(1));
        let mut terminated = self.terminated.chunks_exact_mut(n.max(1));
        let mut truncated = self.truncated.chunks_exact_mut(n.max(1));
        let mut shares: Vec<Vec<_>> =
            counts.iter().map(|_| Vec::with_capacity(self.horizon)).collect();
        for _ in 0..self.horizon {
            let mut row = Row {
                observation: observation.each_mut().map(|plane| plane.next().unwrap_or_default()),
                action: action.each_mut().map(|plane| plane.next().unwrap_or_default()),
                reward: reward.next().unwrap_or_default(),
                terminated: terminated.next().unwrap_or_default(),
                truncated: truncated.next().unwrap_or_default(),
            };
            for (share, &count) in shares.iter_mut().zip(counts) {
                share.push(row.split_off(count, self.layout));
            }
        }
        shares
    }
}

/// The rows of each plane; where numbers lie side by side there is one, and its rows are longer.
fn planes<T, const N: usize>(
    numbers: &mut [T],
    layout: Layout,
    all: usize,
    n: usize,
) -> [core::slice::ChunksExactMut<'_, T>; N] {
    let (plane, row) = match layout {
        Layout::Interleaved => (all * N, n * N),
        Layout::Planes => (all, n),
    };
    let mut planes = numbers.chunks_exact_mut(plane.max(1));
    core::array::from_fn(|_| planes.next().unwrap_or_default().chunks_exact_mut(row.max(1)))
}

/// A step of neighbouring environments.
#[derive(Debug)]
pub(super) struct Row<'a, T, const O: usize, const D: usize> {
    /// The planes, or all numbers in the first.
    pub(super) observation: [&'a mut [T]; O],
    pub(super) action: [&'a mut [T]; D],
    pub(super) reward: &'a mut [T],
    pub(super) terminated: &'a mut [u8],
    /// Empty without a time limit.
    pub(super) truncated: &'a mut [u8],
}

impl<'a, T, const O: usize, const D: usize> Row<'a, T, O, D> {
    /// Takes off the first `count` environments.
    fn split_off(&mut self, count: usize, layout: Layout) -> Row<'a, T, O, D> {
        let width = |n| if layout == Layout::Interleaved { n } else { 1 };
        Row {
            observation: self.observation.each_mut().map(|plane| cut(plane, count * width(O))),
            action: self.action.each_mut().map(|plane| cut(plane, count * width(D))),
            reward: cut(&mut self.reward, count),
            terminated: cut(&mut self.terminated, count),
            truncated: cut(&mut self.truncated, count),
        }
    }
}

/// Takes off the first `count`, or all if there are fewer.
fn cut<'a, X>(slice: &mut &'a mut [X], count: usize) -> &'a mut [X] {
    let whole = take(slice);
    let (head, tail) = whole.split_at_mut(count.min(whole.len()));
    *slice = tail;
    head
}
