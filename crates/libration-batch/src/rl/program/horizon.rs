//! The transitions of environments over a horizon.

use libration_core::Float;
use libration_core::random::Streams;

use super::block_state::{BlockState, Row};
use super::block_step::BlockStep;
use super::episodes::EpisodeBlock;
use super::rollout::EpisodeEnds;
use super::state::Beginning;
use super::transitions::{Transitions, interleave};
use super::{ProgramEnvironment, ProgramPolicy};
use crate::ensemble::BatchFloat;
use crate::rl::block::{LOST, TERMINATED, TRUNCATED, restore_words};
use crate::rl::block_size::LANES;
use crate::rl::{Autoreset, EpisodeEnd, StepIndex};

/// Neighbouring environments of a thread, in whole blocks, and the destination of their transitions.
pub(super) struct Share<'a, T: Float> {
    pub(super) first: usize,
    pub(super) len: usize,
    pub(super) blocks: &'a mut [EpisodeBlock<T>],
    pub(super) states: &'a mut [Row<T>],
    pub(super) numbers: &'a mut [Row<T>],
    pub(super) past: &'a mut [T],
    /// The words for clocks, sensors and actions; none where nothing is drawn.
    pub(super) words: [&'a mut [Streams<LANES>]; 3],
    pub(super) to: Transitions<'a, T>,
    /// The observations after the last step, `[n, i]`; empty if they are not requested.
    pub(super) next: &'a mut [T],
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

impl<T: BatchFloat> Horizon<'_, T> {
    pub(super) fn run(&self, work: &mut BlockStep<T>, share: Share<'_, T>) -> EpisodeEnds<T> {
        let Share { first, len, blocks, states, numbers, past, .. } = share;
        let Share { words: [times, looks, acts], mut to, next, .. } = share;
        let numbers_len = work.definition.numbers().count();
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
                numbers: &mut numbers[b * numbers_len..][..numbers_len],
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
        work: &mut BlockStep<T>,
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
            ended: block.episodes.ended,
            words: self.draws(work).then(|| Box::new([0, 1, 2].map(|i| *site.words[i]))),
            held: (autoreset == Autoreset::Disabled).then(|| {
                Box::new(Held { episodes: *block.episodes, states: block.states.to_vec() })
            }),
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
            && now - block.episodes.oldest >= last
        {
            block.episodes.settle();
            for (cut, began) in cuts.iter_mut().zip(&block.episodes.began).take(site.count) {
                *cut = u8::from(now - began >= last);
                ended |= *cut != 0;
            }
        }
        if ended || stood.is_some() {
            if let Some(Stood { ended, words: Some(before), .. }) = &stood {
                let [times, looks, acts] = &mut site.words;
                restore_words(ended, [times, looks, acts], before);
            }
            self.end(work, site, block, stood.as_ref(), &mut cuts, ends);
        }
        cuts
    }

    /// Whether a step draws random words.
    fn draws(&self, work: &BlockStep<T>) -> bool {
        let definition = &work.definition;
        definition.is_jittered() || definition.is_noisy() || self.policy.words() > 0
    }

    /// Records the ends of episodes, and begins the next ones.
    fn end(
        &self,
        work: &mut BlockStep<T>,
        site: &mut Site<'_>,
        block: &mut BlockState<'_, T>,
        stood: Option<&Stood<T>>,
        cuts: &mut [u8; LANES],
        ends: &mut EpisodeEnds<T>,
    ) {
        let StepIndex { environment, step, row, .. } = site.place;
        let substeps = u64::from(work.definition.substeps);
        let autoreset = work.definition.autoreset;
        let stood_ended = stood.map_or([0; LANES], |stood| stood.ended);
        let mut ending = [0; LANES];
        for (l, ending) in ending.iter_mut().enumerate() {
            // What stands ends no episode.
            let stands = u8::from(stood_ended[l] != 0);
            *ending = (work.overs[l] | cuts[l]) & stands.wrapping_sub(1);
        }
        if ending != [0; LANES] {
            // Those that continue will see the same again.
            core::mem::swap(&mut work.seen, &mut work.last);
            if work.definition.is_noisy() {
                work.observe(step + 1, block, &mut site.words[1].clone());
            } else {
                work.observe(step + 1, block, site.words[1]);
            }
            core::mem::swap(&mut work.seen, &mut work.last);
        }
        for l in site.count..LANES {
            // Lanes that are no environments are never at an end.
            block.episodes.rest(l, step + 1);
        }
        let mut touched = stood_ended;
        touched.iter_mut().zip(&ending).for_each(|(touched, ending)| *touched |= ending);
        for l in marked(&touched).take_while(|&l| l < site.count) {
            if let Some(stood) = stood.filter(|stood| stood.ended[l] != 0) {
                let flags = if stood.held.is_some() { stood.ended[l] } else { 0 };
                work.rewards[l] = T::zero();
                (work.overs[l], cuts[l]) = (flags & TERMINATED, (flags & TRUNCATED) / TRUNCATED);
                match stood.held.as_deref() {
                    Some(Held { episodes, states }) => {
                        block.episodes.hold(episodes, l);
                        block.states.iter_mut().zip(states).for_each(|(x, was)| x[l] = was[l]);
                        let state = states.iter().map(|row| row[l]);
                        let steps = step * substeps..(step + 1) * substeps;
                        work.history.hold(block.past, l, steps, state);
                    }
                    None => self.beginning.begin(block, [environment + l, l], step + 1),
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
            ends.push(end, work.last.iter().map(|row| row[l]));
            match autoreset {
                Autoreset::SameStep => self.beginning.begin(block, [environment + l, l], step + 1),
                Autoreset::NextStep | Autoreset::Disabled => block.episodes.ended[l] = flags,
            }
        }
    }
}

/// What a block was before a step that some of its environments do not take.
///
/// Where episodes are short nearly every step has one: boxes keep it from copying what it rarely holds.
struct Stood<T: Float> {
    /// Flags of the environments that do not take it.
    ended: [u8; LANES],
    /// The random words, where any are drawn.
    words: Option<Box<[Streams<LANES>; 3]>>,
    /// Episodes and states, where they stay as they were.
    held: Option<Box<Held<T>>>,
}

/// A block to which environments are put back.
struct Held<T: Float> {
    episodes: EpisodeBlock<T>,
    states: Vec<Row<T>>,
}

/// The lanes whose mark is not zero.
fn marked(marks: &[u8; LANES]) -> impl Iterator<Item = usize> + use<> {
    let (words, _) = marks.as_chunks();
    let words: [u64; LANES / 8] = core::array::from_fn(|i| u64::from_le_bytes(words[i]));
    words.into_iter().enumerate().flat_map(|(i, mut word)| {
        core::iter::from_fn(move || {
            let byte = word.trailing_zeros() / 8;
            let found = (word != 0).then_some(8 * i + byte as usize)?;
            word &= !(0xFF << (8 * byte));
            Some(found)
        })
    })
}
