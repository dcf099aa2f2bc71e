//! The transitions of environments over a horizon.

use bytemuck::Pod;
use libration_core::random::Streams;
use libration_core::{Elementary, Float};
use ndarray::{ArrayViewMut2, ArrayViewMut3, Axis};

use super::block_step::{BlockState, BlockStep, Row};
use super::episodes::EpisodeBlock;
use super::rollout::EpisodeEnds;
use super::state::Beginning;
use super::{ProgramEnvironment, ProgramPolicy};
use crate::rl::block::{LOST, TERMINATED, TRUNCATED};
use crate::rl::block_size::LANES;
use crate::rl::{Autoreset, EpisodeEnd, StepIndex};

/// Neighbouring environments of a thread, in whole blocks, and the destination of their transitions.
pub(super) struct Share<'a, T: Float> {
    pub(super) first: usize,
    pub(super) len: usize,
    pub(super) blocks: &'a mut [EpisodeBlock<T>],
    pub(super) states: &'a mut [Row<T>],
    pub(super) past: &'a mut [T],
    /// The words for clocks, sensors and actions; none where nothing is drawn.
    pub(super) words: [&'a mut [Streams<LANES>]; 3],
    pub(super) to: Transitions<'a, T>,
    /// The observations after the last step, `[n, i]`; empty if they are not requested.
    pub(super) next: &'a mut [T],
}

/// The destination of transitions of neighbouring environments: `[t, n]`, or `[t, n, i]`. What is not requested has no columns.
pub(super) struct Transitions<'a, T> {
    pub(super) observation: ArrayViewMut3<'a, T>,
    pub(super) action: ArrayViewMut3<'a, T>,
    pub(super) reward: ArrayViewMut2<'a, T>,
    pub(super) terminated: ArrayViewMut2<'a, u8>,
    pub(super) truncated: ArrayViewMut2<'a, u8>,
    pub(super) log_probability: ArrayViewMut2<'a, T>,
}

/// The steps of the environments of a share over a horizon.
pub(super) struct Horizon<'s, T> {
    pub(super) beginning: Beginning<'s>,
    pub(super) policy: ProgramPolicy<'s, T>,
    /// The number of all environments.
    pub(super) environments: usize,
    /// The number of steps before.
    pub(super) step: u64,
    /// The number of rows of the rollout written before.
    pub(super) row: usize,
}

/// A step of a block: its place, its number of environments, and its random words.
struct Site<'w> {
    place: StepIndex,
    count: usize,
    words: [&'w mut Streams<LANES>; 3],
}

impl<T: Float + Elementary + Pod> Horizon<'_, T> {
    pub(super) fn run(&self, work: &mut BlockStep<'_, T>, share: Share<'_, T>) -> EpisodeEnds<T> {
        let Share { first, len, blocks, states, past, words: [times, looks, acts], .. } = share;
        let Share { mut to, next, .. } = share;
        let coordinates = work.definition.coordinates();
        let observations = work.definition.observations();
        let steps = to.reward.nrows();
        let is_observed = !to.observation.is_empty()
            || self.policy.uses_observations()
            || work.definition.is_noisy();
        let past_len = work.history.len();
        let mut none = [Streams::<LANES>::none(); 3];
        let mut ends = EpisodeEnds::default();
        for (b, episodes) in blocks.iter_mut().enumerate() {
            let count = (len - b * LANES).min(LANES);
            let mut block = BlockState {
                episodes,
                states: &mut states[b * coordinates..][..coordinates],
                past: &mut past[b * past_len..][..past_len],
            };
            let [no_times, no_looks, no_acts] = &mut none;
            let times = times.get_mut(b).unwrap_or(no_times);
            let looks = looks.get_mut(b).unwrap_or(no_looks);
            let acts = acts.get_mut(b).unwrap_or(no_acts);
            let environment = first + b * LANES;
            let place = StepIndex { environment, environments: self.environments, step: 0, row: 0 };
            for t in 0..steps {
                let place = StepIndex { step: self.step + t as u64, row: self.row + t, ..place };
                let words = [&mut *times, &mut *looks, &mut *acts];
                let mut site = Site { place, count, words };
                let cuts = self.step_block(work, &mut site, &mut block, is_observed, &mut ends);
                to.write(t, b * LANES, count, work, &cuts);
            }
            if !next.is_empty() {
                let now = self.step + steps as u64;
                work.observe(now, &mut block, &mut looks.clone());
                let next = &mut next[b * LANES * observations..][..count * observations];
                interleave(&work.seen, next);
            }
        }
        ends
    }

    /// Takes an action with a block. Returns the flags of truncation.
    fn step_block(
        &self,
        work: &mut BlockStep<'_, T>,
        site: &mut Site<'_>,
        block: &mut BlockState<'_, T>,
        is_observed: bool,
        ends: &mut EpisodeEnds<T>,
    ) -> [u8; LANES] {
        let ProgramEnvironment { autoreset, limit, .. } = *work.definition;
        let now = site.place.step;
        block.episodes.bank(now);
        // What stands still is stepped with its neighbours, and put back.
        let stands = autoreset != Autoreset::SameStep && block.episodes.ended != [0; LANES];
        let stood = stands.then(|| Stood {
            episodes: *block.episodes,
            states: block.states.to_vec(),
            words: [0, 1, 2].map(|i| *site.words[i]),
        });
        let [times, looks, acts] = &mut site.words;
        if is_observed {
            work.observe(now, block, looks);
        } else {
            work.pass(now, block);
        }
        work.act(&self.policy, site.place, block, acts);
        let mut ended = work.advance(now, site.count, block, times);
        let mut cuts = [0; LANES];
        if let Some(last) = limit.map(|limit| u64::from(limit) - 1)
            && (ended || stood.is_some() || now - block.episodes.oldest >= last)
        {
            for (cut, began) in cuts.iter_mut().zip(&block.episodes.began).take(site.count) {
                *cut = u8::from(now - began >= last);
                ended |= *cut != 0;
            }
        }
        if ended || stood.is_some() {
            if let Some(stood) = &stood {
                let [times, looks, acts] = &mut site.words;
                stood.episodes.restore_words([times, looks, acts], &stood.words);
            }
            self.end(work, site, block, stood.as_ref(), &mut cuts, ends);
        }
        cuts
    }

    /// Records the ends of episodes, and begins the next ones.
    fn end(
        &self,
        work: &mut BlockStep<'_, T>,
        site: &mut Site<'_>,
        block: &mut BlockState<'_, T>,
        stood: Option<&Stood<T>>,
        cuts: &mut [u8; LANES],
        ends: &mut EpisodeEnds<T>,
    ) {
        let StepIndex { environment, step, row, .. } = site.place;
        let substeps = u64::from(work.definition.substeps);
        let autoreset = work.definition.autoreset;
        // Those that go on will see the same again.
        let seen = work.seen.clone();
        work.observe(step + 1, block, &mut site.words[1].clone());
        let last = core::mem::replace(&mut work.seen, seen);
        for l in site.count..LANES {
            // Lanes that are no environments are never at an end.
            block.episodes.rest(l, step + 1);
        }
        for l in 0..site.count {
            let next = block.episodes.next(l);
            if let Some(stood) = stood.filter(|stood| stood.episodes.ended[l] != 0) {
                let flags = match autoreset {
                    Autoreset::Disabled => stood.episodes.ended[l],
                    Autoreset::SameStep | Autoreset::NextStep => 0,
                };
                work.rewards[l] = T::zero();
                (work.overs[l], cuts[l]) = (flags & TERMINATED, (flags & TRUNCATED) / TRUNCATED);
                if autoreset == Autoreset::Disabled {
                    block.episodes.hold(&stood.episodes, l);
                    block.states.iter_mut().zip(&stood.states).for_each(|(x, was)| x[l] = was[l]);
                    let state = stood.states.iter().map(|row| row[l]);
                    let steps = step * substeps..(step + 1) * substeps;
                    work.history.hold(block.past, l, steps, state);
                } else {
                    self.beginning.begin(block, l, next, step + 1);
                }
                continue;
            }
            let lost = work.overs[l] & LOST != 0;
            work.overs[l] = u8::from(work.overs[l] != 0);
            let flags = work.overs[l] * TERMINATED + cuts[l] * TRUNCATED;
            if flags == 0 {
                continue;
            }
            let end = EpisodeEnd {
                step: row,
                environment: environment + l,
                observation: [],
                episode_return: block.episodes.paid(l),
                length: step + 1 - block.episodes.began[l],
                lost,
            };
            ends.push(end, last.iter().map(|row| row[l]));
            match autoreset {
                Autoreset::SameStep => self.beginning.begin(block, l, next, step + 1),
                Autoreset::NextStep | Autoreset::Disabled => block.episodes.ended[l] = flags,
            }
        }
        block.episodes.settle();
    }
}

/// A block before a step that some of its environments do not take.
struct Stood<T: Float> {
    episodes: EpisodeBlock<T>,
    states: Vec<Row<T>>,
    words: [Streams<LANES>; 3],
}

impl<'a, T: Float> Transitions<'a, T> {
    /// Takes off the first `count` environments.
    pub(super) fn split_off(self, count: usize) -> (Self, Self) {
        fn flags<X>(all: ArrayViewMut2<'_, X>, count: usize) -> [ArrayViewMut2<'_, X>; 2] {
            let count = count.min(all.ncols());
            all.split_at(Axis(1), count).into()
        }
        fn numbers<X>(all: ArrayViewMut3<'_, X>, count: usize) -> [ArrayViewMut3<'_, X>; 2] {
            let count = count.min(all.dim().1);
            all.split_at(Axis(1), count).into()
        }
        let [observation, observations] = numbers(self.observation, count);
        let [action, actions] = numbers(self.action, count);
        let [reward, rewards] = flags(self.reward, count);
        let [terminated, terminations] = flags(self.terminated, count);
        let [truncated, truncations] = flags(self.truncated, count);
        let [log_probability, log_probabilities] = flags(self.log_probability, count);
        let head =
            Transitions { observation, action, reward, terminated, truncated, log_probability };
        let tail = Transitions {
            observation: observations,
            action: actions,
            reward: rewards,
            terminated: terminations,
            truncated: truncations,
            log_probability: log_probabilities,
        };
        (head, tail)
    }

    /// Writes step `t` of `count` environments from the `first` on.
    fn write(
        &mut self,
        t: usize,
        first: usize,
        count: usize,
        work: &BlockStep<'_, T>,
        cuts: &[u8; LANES],
    ) {
        fn row<X: Copy>(to: &mut ArrayViewMut2<'_, X>, [t, first, count]: [usize; 3], from: &[X]) {
            // Neighbours lie side by side.
            if let Some(row) = to.index_axis_mut(Axis(0), t).into_slice().filter(|r| !r.is_empty())
            {
                row[first..first + count].copy_from_slice(&from[..count]);
            }
        }
        fn rows<X: Copy>(
            to: &mut ArrayViewMut3<'_, X>,
            [t, first, count]: [usize; 3],
            from: &[Row<X>],
        ) {
            if to.is_empty() {
                return;
            }
            let mut step = to.index_axis_mut(Axis(0), t);
            match step.as_slice_mut() {
                Some(records) => {
                    let records = &mut records[first * from.len()..][..count * from.len()];
                    interleave(from, records);
                }
                // One plane after the other.
                None => {
                    for (column, from) in step.columns_mut().into_iter().zip(from) {
                        if let Some(plane) = column.into_slice() {
                            plane[first..first + count].copy_from_slice(&from[..count]);
                        }
                    }
                }
            }
        }
        let place = [t, first, count];
        rows(&mut self.observation, place, &work.seen);
        rows(&mut self.action, place, &work.actions);
        row(&mut self.reward, place, &work.rewards);
        row(&mut self.terminated, place, &work.overs);
        row(&mut self.truncated, place, cuts);
        row(&mut self.log_probability, place, &work.log_probabilities);
    }
}

/// Writes the numbers of each lane side by side, for as many lanes as there is room.
fn interleave<X: Copy>(rows: &[Row<X>], records: &mut [X]) {
    match rows {
        [row] => records.copy_from_slice(&row[..records.len()]),
        rows => {
            for (i, row) in rows.iter().enumerate() {
                let numbers = records.iter_mut().skip(i).step_by(rows.len());
                numbers.zip(row).for_each(|(number, &x)| *number = x);
            }
        }
    }
}
