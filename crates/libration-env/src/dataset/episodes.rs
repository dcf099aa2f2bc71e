//! Episodes of environments.

use libration::ensemble::InsufficientMemory;
use libration::rl::Rollout;

use super::group::Number;

/// An episode, or a part of a long one.
#[derive(Clone, Debug)]
pub(super) struct Episode<T, const O: usize> {
    /// The environment.
    pub(super) environment: usize,
    /// The step of its first action.
    pub(super) first: u64,
    /// The observations before each action and after the last.
    pub(super) observation: Vec<T>,
    pub(super) action: Vec<T>,
    pub(super) reward: Vec<T>,
    /// Whether it was terminated; otherwise it was truncated.
    pub(super) terminated: bool,
}

impl<T, const O: usize> Episode<T, O> {
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
    fn grow(&mut self) -> Result<(), InsufficientMemory> {
        let grown = self
            .observation
            .try_reserve(2 * O)
            .and_then(|()| self.action.try_reserve(1))
            .and_then(|()| self.reward.try_reserve(1));
        let needed =
            2 * (self.observation.capacity() + 2 * self.action.capacity()) * size_of::<T>();
        grown.map_err(|_| InsufficientMemory { needed: needed as u128, available: None })
    }

    /// The number of actions.
    pub(super) fn len(&self) -> usize {
        self.action.len()
    }
}

/// The open episodes of a group, one per environment.
#[derive(Debug)]
pub(super) struct Episodes<T, const O: usize> {
    open: Vec<Episode<T, O>>,
    /// The largest number of actions of an episode, at which it is truncated.
    most: usize,
}

impl<T: Number, const O: usize> Episodes<T, O> {
    /// Empty episodes of `len` environments from number `first` on.
    pub(super) fn new(first: usize, len: usize, most: usize) -> Self {
        Episodes { open: (first..first + len).map(Episode::new).collect(), most }
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
        rollout: &Rollout<T, O, 1>,
    ) -> Result<Vec<Episode<T, O>>, InsufficientMemory> {
        let n = self.open.len();
        let mut ended = Vec::new();
        let mut finals = rollout.finals().iter().peekable();
        let (seen, _) = rollout.observation().as_chunks::<O>();
        for (t, step) in (first..).zip(0..rollout.plan().horizon) {
            for (i, open) in self.open.iter_mut().enumerate() {
                let at = step * n + i;
                if open.len() == self.most {
                    ended.extend(close(open, &seen[at], false));
                }
                if open.len() == 0 {
                    open.first = t;
                }
                open.grow()?;
                open.observation.extend(&seen[at]);
                let end = finals.next_if(|end| (end.step, end.environment) == (step, i));
                if end.is_some_and(|end| end.lost) {
                    ended.extend(close(open, &[], false));
                    continue;
                }
                open.action.push(rollout.action()[at]);
                open.reward.push(rollout.reward()[at]);
                if let Some(end) = end {
                    let terminated = rollout.terminated()[at] != 0;
                    ended.extend(close(open, &end.observation, terminated));
                }
            }
        }
        Ok(ended)
    }

    /// Truncates the open episodes; `next` has their final observations.
    pub(super) fn cut(&mut self, next: &[T]) -> Vec<Episode<T, O>> {
        let (next, _) = next.as_chunks::<O>();
        let open = self.open.iter_mut().zip(next);
        open.filter_map(|(open, seen)| close(open, seen, false)).collect()
    }
}

/// Closes an episode and begins another; returns it if it has actions.
fn close<T: Number, const O: usize>(
    open: &mut Episode<T, O>,
    seen: &[T],
    terminated: bool,
) -> Option<Episode<T, O>> {
    let next = Episode::new(open.environment);
    let mut episode = std::mem::replace(open, next);
    episode.observation.extend(seen);
    episode.terminated = terminated;
    (episode.len() > 0).then_some(episode)
}
