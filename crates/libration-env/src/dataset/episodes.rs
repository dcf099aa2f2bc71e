//! Episodes of environments.

use libration::ensemble::InsufficientMemory;
use libration::rl::EpisodeEnds;

use super::group::Number;
use crate::environments::AnyRollout;

/// An episode, or a part of a long one.
#[derive(Clone, Debug)]
pub(super) struct Episode<T> {
    /// The environment.
    pub(super) environment: usize,
    /// The step of its first action.
    pub(super) first: u64,
    /// The observations before each action and after the last.
    pub(super) observation: Vec<T>,
    /// `[t, i]`.
    pub(super) action: Vec<T>,
    pub(super) reward: Vec<T>,
    /// Whether it was terminated; otherwise it was truncated.
    pub(super) terminated: bool,
}

impl<T> Episode<T> {
    fn new(environment: usize) -> Self {
        Episode {
            environment,
            first: 0,
            observation: Vec::new(),
            action: Vec::new(),
            reward: Vec::new(),
            terminated: false,
        }
    }

    /// Reserves memory for one more step.
    fn grow(&mut self, [observations, actions]: [usize; 2]) -> Result<(), InsufficientMemory> {
        let grown = self
            .observation
            .try_reserve(2 * observations)
            .and_then(|()| self.action.try_reserve(actions))
            .and_then(|()| self.reward.try_reserve(1));
        let numbers = self.observation.capacity() + self.action.capacity() + self.reward.capacity();
        let needed = 2 * numbers * size_of::<T>();
        grown.map_err(|_| InsufficientMemory { needed: needed as u128, available: None })
    }

    /// The number of actions.
    pub(super) fn len(&self) -> usize {
        self.reward.len()
    }
}

/// The open episodes of a group, one per environment.
#[derive(Debug)]
pub(super) struct Episodes<T> {
    open: Vec<Episode<T>>,
    /// The largest number of actions of an episode, at which it is truncated.
    most: usize,
    /// The numbers of observations and actions.
    sizes: [usize; 2],
}

impl<T: Number> Episodes<T> {
    /// Empty episodes of `len` environments from number `first` on.
    pub(super) fn new(first: usize, len: usize, most: usize, sizes: [usize; 2]) -> Self {
        Episodes { open: (first..first + len).map(Episode::new).collect(), most, sizes }
    }

    /// Appends a rollout that begins at step `first` and returns the ended episodes in the order of their ends.
    ///
    /// The action by which an environment was lost is omitted.
    ///
    /// # Errors
    /// If there is no memory for the open episodes.
    pub(super) fn take(
        &mut self,
        first: u64,
        rollout: &dyn AnyRollout<T>,
        ends: &EpisodeEnds<T>,
    ) -> Result<Vec<Episode<T>>, InsufficientMemory> {
        let n = self.open.len();
        let [observations, actions] = self.sizes;
        let mut ended = Vec::new();
        let last = ends.observations.chunks_exact(observations);
        let mut finals = ends.ends.iter().zip(last).peekable();
        for (t, step) in (first..).zip(0..rollout.plan().horizon) {
            for (i, open) in self.open.iter_mut().enumerate() {
                let at = step * n + i;
                let seen = &rollout.observation()[at * observations..][..observations];
                if open.len() == self.most {
                    ended.extend(close(open, seen, false));
                }
                if open.len() == 0 {
                    open.first = t;
                }
                open.grow(self.sizes)?;
                open.observation.extend(seen);
                let end = finals.next_if(|(end, _)| (end.step, end.environment) == (step, i));
                if end.is_some_and(|(end, _)| end.lost) {
                    ended.extend(close(open, &[], false));
                    continue;
                }
                open.action.extend(&rollout.action()[at * actions..][..actions]);
                open.reward.push(rollout.reward()[at]);
                if let Some((_, last)) = end {
                    let terminated = rollout.terminated()[at] != 0;
                    ended.extend(close(open, last, terminated));
                }
            }
        }
        Ok(ended)
    }

    /// Appends the open episodes to the bytes of a state.
    pub(super) fn save(&self, to: &mut Vec<u8>) {
        for open in &self.open {
            to.extend(open.first.to_le_bytes());
            to.extend((open.len() as u64).to_le_bytes());
            for numbers in [&open.observation, &open.action, &open.reward] {
                to.extend_from_slice(bytemuck::cast_slice(numbers));
            }
        }
    }

    /// Episodes like these with the open ones of [`save`](Self::save); none if the bytes are those of others.
    pub(super) fn restored(&self, mut from: &[u8]) -> Option<Self> {
        let mut open = Vec::with_capacity(self.open.len());
        for Episode { environment, .. } in &self.open {
            let mut word = || {
                let (word, rest) = from.split_first_chunk()?;
                from = rest;
                Some(u64::from_le_bytes(*word))
            };
            let (first, len) = (word()?, usize::try_from(word()?).ok()?);
            let mut numbers = |width: usize| {
                let count = len.checked_mul(width)?;
                let (taken, rest) = from.split_at_checked(count.checked_mul(size_of::<T>())?)?;
                from = rest;
                let mut numbers = vec![T::zero(); count];
                bytemuck::cast_slice_mut(&mut numbers).copy_from_slice(taken);
                Some(numbers)
            };
            let [observations, actions] = self.sizes;
            let (observation, action) = (numbers(observations)?, numbers(actions)?);
            let reward = numbers(1)?;
            let episode =
                Episode { first, observation, action, reward, ..Episode::new(*environment) };
            open.push(episode);
        }
        from.is_empty().then_some(Episodes { open, ..*self })
    }

    /// Truncates the open episodes; `next` has their final observations.
    pub(super) fn cut(&mut self, next: &[T]) -> Vec<Episode<T>> {
        let open = self.open.iter_mut().zip(next.chunks_exact(self.sizes[0]));
        open.filter_map(|(open, seen)| close(open, seen, false)).collect()
    }
}

/// Closes an episode and begins another; returns it if it has actions.
fn close<T: Number>(open: &mut Episode<T>, seen: &[T], terminated: bool) -> Option<Episode<T>> {
    let next = Episode::new(open.environment);
    let mut episode = std::mem::replace(open, next);
    episode.observation.extend(seen);
    episode.terminated = terminated;
    (episode.len() > 0).then_some(episode)
}
