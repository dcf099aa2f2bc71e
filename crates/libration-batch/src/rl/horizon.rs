//! The transitions of environments over a horizon, tile by tile.

use bytemuck::Pod;
use libration_core::random::Streams;
use libration_core::{Float, System};
use pulp::{Simd, WithSimd};

use super::block::{BlockOf, restore_words};
use super::block_output::BlockOutput;
use super::block_size::{LANES, TILE};
use super::history::History;
use super::rollout_row::{Records, Writer};
use super::rollout_slice::RolloutSlice;
use super::stepper::{Site, Stepper};
use super::{EpisodeEnd, Policy, Sensor, StepIndex, World, Writes};
use crate::ensemble::Assign;
use crate::ensemble::instructions::{Target, Targeted};
use crate::ensemble::stream::Streaming;

/// Neighbouring environments of a thread, in whole blocks.
pub(super) struct Share<'a, T, B> {
    pub(super) first: usize,
    pub(super) len: usize,
    pub(super) blocks: &'a mut [B],
    pub(super) past: &'a mut [T],
    /// The words for clocks, sensors and actions; none where nothing is drawn.
    pub(super) words: [&'a mut [Streams<LANES>]; 3],
}

/// The steps of the environments of a share over a horizon.
pub(super) struct Horizon<'a, 's, T, E, P, B, const O: usize, const D: usize> {
    pub(super) world: &'s E,
    pub(super) policy: P,
    pub(super) history: History,
    /// The number of all environments.
    pub(super) environments: usize,
    /// The number of steps before.
    pub(super) step: u64,
    /// The number of rows of the rollout written before.
    pub(super) row: usize,
    pub(super) share: Share<'a, T, B>,
    pub(super) slice: RolloutSlice<'a, T, O, D>,
    pub(super) writes: Writes,
}

impl<T, E, P, const O: usize, const D: usize> Targeted
    for Horizon<'_, '_, T, E, P, BlockOf<T, E, O, D>, O, D>
where
    T: Float + Pod,
    E: World<T, O, D>,
    P: Policy<T, O, D>,
{
    const BASELINE_ONLY: bool = <E::System as System<T, D>>::BASELINE_ONLY;

    type Output = Vec<EpisodeEnd<T, O>>;

    fn on<I: Target>(self, target: I) -> Vec<EpisodeEnd<T, O>> {
        target.run(On(self, target))
    }
}

/// Work with the instruction set that it runs on.
struct On<H, I>(H, I);

impl<T, E, P, I, const O: usize, const D: usize> WithSimd
    for On<Horizon<'_, '_, T, E, P, BlockOf<T, E, O, D>, O, D>, I>
where
    T: Float + Pod,
    E: World<T, O, D>,
    P: Policy<T, O, D>,
    I: Target,
{
    type Output = Vec<EpisodeEnd<T, O>>;

    #[inline(always)]
    fn with_simd<V: Simd>(self, _: V) -> Vec<EpisodeEnd<T, O>> {
        let On(horizon, target) = self;
        let Horizon { world, policy, history, environments, step, row: before, .. } = horizon;
        let Horizon { share, mut slice, writes, .. } = horizon;
        let writer = Writer { streaming: Streaming::on(target), layout: slice.layout, writes };
        let parts = *world.parts();
        let stepper = Stepper::<T, E, P, O, D>::new(world, policy, history);
        let fused = stepper.is_fused();
        let steps = slice.steps();
        // A sensor that draws takes its words at every look.
        let is_observed =
            slice.has_observations() || policy.uses_observations() || const { E::Sensor::DRAWS };
        let [times, looks, acts] = share.words;
        let mut none = [Streams::<LANES>::none(); 3];
        let [no_times, no_looks, no_acts] = &mut none;
        let mut out = BlockOutput::<T, O, D>::zeros();
        let mut records = Records::zeros();
        for (index, blocks) in share.blocks.chunks_mut(TILE / LANES).enumerate() {
            for t in 0..steps {
                let row = &mut slice.row(t);
                for (b, block) in blocks.iter_mut().enumerate() {
                    let b = index * (TILE / LANES) + b;
                    let first = share.first + b * LANES;
                    let count = (share.len - b * LANES).min(LANES);
                    let systems = parts.systems.lanes::<LANES>(first, count);
                    let now = step + t as u64;
                    let place =
                        StepIndex { environment: first, environments, step: now, row: before + t };
                    let site = Site { place, count, systems };
                    block.bank(now);
                    // What stands still is stepped with its neighbours, and put back.
                    let stood = (!stepper.all_running(block)).then_some(*block);
                    macro_rules! past {
                        () => {
                            &mut share.past[b * history.len()..][..history.len()]
                        };
                    }
                    let acts = acts.get_mut(b).unwrap_or(no_acts);
                    let looks = looks.get_mut(b).unwrap_or(no_looks);
                    let times = times.get_mut(b).unwrap_or(no_times);
                    // And so are its words.
                    let spoken = stood.is_some().then_some([*times, *looks, *acts]);
                    let swift = fused && count == LANES && stood.is_none();
                    let mut ended = if swift {
                        let overs = &mut out.overs;
                        stepper.fused_step(
                            parts,
                            &site,
                            block,
                            acts,
                            overs,
                            b,
                            row,
                            &writer,
                            &mut records,
                        )
                    } else {
                        if is_observed {
                            stepper.observe(&site, block, past!(), looks, &mut out.step.seen);
                        } else {
                            stepper.pass(now, block, past!());
                        }
                        stepper.act(place, block, acts, &mut out.step);
                        stepper.advance(target, &site, block, past!(), times, &mut out)
                    };
                    ended |=
                        stepper.limit(now, block, ended != 0 || stood.is_some(), &mut out.cuts);
                    let whole = ended == 0 && stood.is_none();
                    if !whole {
                        if let Some((stood, spoken)) = stood.as_ref().zip(spoken.as_ref()) {
                            restore_words(&stood.ended, [times, looks, acts], spoken);
                        }
                        stepper.end(&site, block, stood.as_ref(), past!(), looks, &mut out);
                    }
                    if count < LANES {
                        if whole {
                            (out.overs, out.cuts) = NO_FLAGS;
                        }
                        row.write_part(writer.layout, b * LANES, count, &out);
                        continue;
                    }
                    if !swift {
                        // A copy: where both arms write the same, the compiler joins them, and what was in registers
                        // is in memory.
                        let step = out.step;
                        row.write_block(&writer, b, &step, &mut records);
                    }
                    let flags = if whole { &NO_FLAGS } else { &(out.overs, out.cuts) };
                    row.write_flags(&writer, b, &flags.0, &flags.1);
                }
            }
            let (next, now) = (slice.next(), step + steps as u64);
            if next.is_empty() {
                continue;
            }
            for (b, block) in blocks.iter_mut().enumerate() {
                let b = index * (TILE / LANES) + b;
                let first = share.first + b * LANES;
                let count = (share.len - b * LANES).min(LANES);
                let systems = parts.systems.lanes::<LANES>(first, count);
                let place = StepIndex { environment: first, environments, step: now, row: 0 };
                let past = &mut share.past[b * history.len()..][..history.len()];
                let words = looks.get(b).unwrap_or(no_looks);
                stepper.write_observations(
                    &Site { place, count, systems },
                    block,
                    past,
                    words,
                    &mut next[b * LANES * O..],
                );
            }
        }
        out.finals
    }
}

/// No episode terminated, and none was cut off.
const NO_FLAGS: ([u8; LANES], [u8; LANES]) = ([0; LANES], [0; LANES]);
