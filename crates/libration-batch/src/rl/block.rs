//! Blocks of neighbouring environments.

use libration_core::control::{Clock, Memory, StartAddress};
use libration_core::random::Streams;
use libration_core::{Float, Scalar, State};

use super::block_size::LANES;
use super::history::History;
use super::start::Episode;
use super::{Start, Variation, World};
use crate::ensemble::kernel::{at, put};

/// A block of neighbouring environments, one per lane.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub(super) struct Block<T, C, V, const D: usize> {
    pub(super) q: [[T; LANES]; D],
    pub(super) v: [[T; LANES]; D],
    /// The rewards of the episode since the last partial sum.
    pub(super) paid: [T; LANES],
    /// The partial sums before, in `f64`: a short float loses small increments.
    pub(super) banked: [f64; LANES],
    /// The memory of the clock.
    pub(super) clock: C,
    /// The random parameters of the episode.
    pub(super) numbers: V,
    /// The error scales of the clock and of the sensor.
    pub(super) error_scale: [[T; LANES]; 2],
    /// The latencies of observations and of actions.
    pub(super) delays: [[u32; LANES]; 2],
    /// The first step of the episode.
    pub(super) began: [u64; LANES],
    /// At most the smallest of these steps.
    pub(super) oldest: u64,
    /// The number of the episode.
    pub(super) episode: [u64; LANES],
    /// The seed.
    pub(super) seed: [u64; LANES],
    /// The number of the environment in the batch of that seed.
    pub(super) environment: [u64; LANES],
    /// Flags of an ended episode before the next begins: [`TERMINATED`] and [`TRUNCATED`].
    pub(super) ended: [u8; LANES],
}

/// Steps whose rewards are summed in the float type.
const BANKED: u64 = 32;

/// Flag of a terminated episode.
pub(super) const TERMINATED: u8 = 1;
/// Flag of a truncated episode.
pub(super) const TRUNCATED: u8 = 2;

/// Flag of the output of a block: terminated because a number is not finite.
pub(super) const LOST: u8 = 2;

/// The block of a world.
pub(super) type BlockOf<T, E, const O: usize, const D: usize> =
    Block<T, ClockLanes<T, E, O, D>, NumberLanes<T, E, O, D>, D>;

/// The memory of the clock of an environment.
pub(super) type ClockMemory<T, E, const O: usize, const D: usize> =
    <<E as World<T, O, D>>::Clock as Clock<T>>::Memory;
type ClockLanes<T, E, const O: usize, const D: usize> =
    <ClockMemory<T, E, O, D> as Memory<T>>::Lanes<LANES>;

/// The random parameters of an episode.
pub(super) type Numbers<T, E, const O: usize, const D: usize> =
    <<E as World<T, O, D>>::Variation as Variation<
        T,
        <E as World<T, O, D>>::System,
        <E as World<T, O, D>>::Task,
    >>::Numbers;
/// The random parameters in lanes.
pub(super) type NumberLanes<T, E, const O: usize, const D: usize> =
    <Numbers<T, E, O, D> as Memory<T>>::Lanes<LANES>;

/// A block before any episode.
pub(super) fn empty<T: Float, E: World<T, O, D>, const O: usize, const D: usize>()
-> BlockOf<T, E, O, D> {
    let none = |_: usize| [T::zero(); LANES];
    Block {
        q: [[T::zero(); LANES]; D],
        v: [[T::zero(); LANES]; D],
        paid: [T::zero(); LANES],
        banked: [0.0; LANES],
        clock: ClockMemory::<T, E, O, D>::load(&none),
        numbers: Numbers::<T, E, O, D>::load(&none),
        error_scale: [[T::one(); LANES]; 2],
        delays: [[0; LANES]; 2],
        began: [0; LANES],
        oldest: 0,
        episode: [0; LANES],
        seed: [0; LANES],
        environment: [0; LANES],
        ended: [0; LANES],
    }
}

/// Begins an episode in lane `l` of a block, with the step `now`.
pub(super) fn begin<T: Float, E: World<T, O, D>, const O: usize, const D: usize>(
    block: &mut BlockOf<T, E, O, D>,
    history: History,
    past: &mut [T],
    world: &E,
    l: usize,
    episode: Episode,
    now: u64,
) {
    let parts = world.parts();
    let state: State<T, D> = parts.start.draw(episode);
    block.put_state(l, state);
    let begin = StartAddress::new(episode.seed, episode.environment, episode.number);
    ClockMemory::<T, E, O, D>::set_lane(&mut block.clock, l, parts.clock.start(begin));
    Numbers::<T, E, O, D>::set_lane(&mut block.numbers, l, parts.variation.draw(episode));
    let delays = parts.delays.draw(episode);
    (0..2).for_each(|i| block.delays[i][l] = delays[i]);
    let error_scale = parts.error_scale.draw(episode);
    (0..2).for_each(|i| block.error_scale[i][l] = T::from_f64(error_scale[i]));
    (block.seed[l], block.environment[l]) = (episode.seed, episode.environment);
    block.renew(l, episode.number, now);
    history.begin(past, l, state.coordinates());
}

impl<T: Scalar, C: Copy, V, const D: usize> Block<T, C, V, D> {
    /// The state of lane `l`.
    #[inline(always)]
    pub(super) fn state(&self, l: usize) -> State<T, D> {
        State { q: at(&self.q, l), v: at(&self.v, l) }
    }

    /// Puts lane `l` at a state.
    pub(super) fn put_state(&mut self, l: usize, state: State<T, D>) {
        put(&mut self.q, l, state.q);
        put(&mut self.v, l, state.v);
    }

    /// The episode of lane `l`.
    pub(super) fn episode(&self, l: usize) -> Episode {
        let (seed, environment) = (self.seed[l], self.environment[l]);
        Episode { seed, environment, number: self.episode[l] }
    }

    /// Begins episode `number` of the environment of lane `l` with the step `now`, but for what is drawn for it.
    #[inline(always)]
    pub(super) fn renew(&mut self, l: usize, number: u64, now: u64)
    where
        T: Float,
    {
        (self.paid[l], self.banked[l], self.ended[l]) = (T::zero(), 0.0, 0);
        (self.began[l], self.episode[l]) = (now, number);
    }

    /// The next episode of lane `l`.
    pub(super) fn next(&self, l: usize) -> Episode {
        let episode = self.episode(l);
        Episode { number: episode.number + 1, ..episode }
    }

    /// Puts lane `l`, which is not an environment, at rest from step `now` on.
    pub(super) fn rest(&mut self, l: usize, now: u64)
    where
        T: Float,
    {
        put(&mut self.q, l, [T::zero(); D]);
        put(&mut self.v, l, [T::zero(); D]);
        (self.paid[l], self.began[l]) = (T::zero(), now);
    }

    /// Adds the rewards to the partial sums, every [`BANKED`] steps.
    #[inline(always)]
    pub(super) fn bank(&mut self, step: u64)
    where
        T: Float,
    {
        if step.is_multiple_of(BANKED) {
            for l in 0..LANES {
                self.banked[l] += self.paid[l].to_f64();
                self.paid[l] = T::zero();
            }
        }
    }

    /// The return of the episode of lane `l`.
    pub(super) fn paid(&self, l: usize) -> f64
    where
        T: Float,
    {
        self.banked[l] + self.paid[l].to_f64()
    }

    /// Updates `oldest` to the smallest first step.
    pub(super) fn settle(&mut self) {
        self.oldest = self.began.iter().copied().fold(u64::MAX, u64::min);
    }

    /// Restores the state of lane `l`. The memory of its clock advances; the next episode resets it.
    pub(super) fn hold(&mut self, as_it_was: &Self, l: usize) {
        self.put_state(l, as_it_was.state(l));
        (self.paid[l], self.banked[l]) = (as_it_was.paid[l], as_it_was.banked[l]);
        // Its time stands as well.
        self.began[l] = as_it_was.began[l] + 1;
    }
}

/// Restores the words of lanes whose episodes had ended.
pub(super) fn restore_words(
    ended: &[u8; LANES],
    words: [&mut Streams<LANES>; 3],
    before: &[Streams<LANES>; 3],
) {
    for (words, before) in words.into_iter().zip(before) {
        (0..LANES).filter(|&l| ended[l] != 0).for_each(|l| words.copy_lane(l, before));
    }
}
