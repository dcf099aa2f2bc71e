//! The transitions of environments over a horizon: scalar functions in loops over lanes.

use core::array::from_fn;
use core::marker::PhantomData;

use bytemuck::Pod;
use pulp::{Simd, WithSimd};

use super::batch::Share;
use super::rollout::Row;
use super::{Environment, Final, Layout, Place, Policy, Start, Task, Writes};
use crate::ensemble::instructions::{Target, Targeted};
use crate::ensemble::kernel::{Lines, at, put};
use crate::ensemble::{Assign, stream};
use crate::system::Held;
use crate::{Float, Integrator, State, System};

/// Environments that go through the horizon together: their rows are long enough to be written at the speed of the memory, and
/// their states stay in the first cache.
pub(super) const TILE: usize = 512;

/// What is done with the environments of a share.
pub(super) struct Horizon<'a, 's, T, A, M, K, S, P, Sys, const O: usize, const D: usize> {
    pub(super) environment: &'s Environment<A, M, K, S>,
    pub(super) policy: P,
    pub(super) seed: u64,
    /// Steps taken before.
    pub(super) step: u64,
    pub(super) share: Share<'a, T>,
    pub(super) rows: Vec<Row<'a, T, O, D>>,
    pub(super) layout: Layout,
    pub(super) writes: Writes,
    pub(super) system: PhantomData<Sys>,
}

impl<T, A, M, K, S, P, Sys, const O: usize, const D: usize> Targeted
    for Horizon<'_, '_, T, A, M, K, S, P, Sys, O, D>
where
    T: Float + Pod,
    A: Assign<Sys>,
    M: Integrator,
    K: Task<T, D, O>,
    S: Start<T, D>,
    P: Policy<T, O, D>,
    Sys: System<T, D> + Copy + Send + Sync,
{
    type Output = Vec<Final<T, O>>;

    fn on<I: Target>(self, target: I) -> Vec<Final<T, O>> {
        // Four vectors hide the latency of a step.
        match const { 4 * I::BYTES / size_of::<T>() } {
            8 => target.run(Wide::<_, 8>(self)),
            16 => target.run(Wide::<_, 16>(self)),
            32 => target.run(Wide::<_, 32>(self)),
            64 => target.run(Wide::<_, 64>(self)),
            _ => target.run(Wide::<_, 128>(self)),
        }
    }
}

/// In blocks of so many lanes, a divisor of [`TILE`].
struct Wide<H, const W: usize>(H);

/// What a row of a tile is gathered in before it is written.
struct Gathered<T, const O: usize, const D: usize> {
    observation: [[T; TILE]; O],
    action: [[T; TILE]; D],
    reward: [T; TILE],
    terminated: [u8; TILE],
    truncated: [u8; TILE],
}

impl<T, A, M, K, S, P, Sys, const O: usize, const D: usize, const W: usize> WithSimd
    for Wide<Horizon<'_, '_, T, A, M, K, S, P, Sys, O, D>, W>
where
    T: Float + Pod,
    A: Assign<Sys>,
    M: Integrator,
    K: Task<T, D, O>,
    S: Start<T, D>,
    P: Policy<T, O, D>,
    Sys: System<T, D> + Copy + Send + Sync,
{
    type Output = Vec<Final<T, O>>;

    #[inline(always)]
    fn with_simd<V: Simd>(self, _: V) -> Vec<Final<T, O>> {
        let Horizon { environment, policy, seed, step, share, mut rows, layout, writes, .. } =
            self.0;
        let Environment { systems, method, dt, substeps, task, start, limit } = *environment;
        let (dt, limit) = (T::from_f64(dt), limit.unwrap_or(u32::MAX));
        let zero = T::zero();
        let mut finals = Vec::new();
        let mut out = Lines(Gathered {
            observation: [[zero; TILE]; O],
            action: [[zero; TILE]; D],
            reward: [zero; TILE],
            terminated: [0; TILE],
            truncated: [0; TILE],
        });
        let tiles = share.tiles.chunks_exact_mut(TILE * (2 * D + 1));
        let tiles = tiles.zip(share.counters.chunks_exact_mut(TILE * 2));
        for (index, (numbers, counters)) in tiles.enumerate() {
            let begin = index * TILE;
            let len = (share.len - begin).min(TILE);
            let first = share.first + begin;
            let (ages, episodes) = counters.split_at_mut(TILE);
            let blocks = numbers.as_chunks_mut::<W>().0;
            let (ages, episodes) = (ages.as_chunks_mut::<W>().0, episodes.as_chunks_mut::<W>().0);
            let per_row = TILE / W;
            for (t, row) in rows.iter_mut().enumerate() {
                for b in 0..len.div_ceil(W) {
                    let from = b * W;
                    let systems = systems.lanes::<W>(first + from, (len - from).min(W));
                    let mut q: Lines<[[T; W]; D]> = Lines(from_fn(|i| blocks[i * per_row + b]));
                    let mut v: Lines<[[T; W]; D]> =
                        Lines(from_fn(|i| blocks[(D + i) * per_row + b]));
                    let mut paid = blocks[2 * D * per_row + b];
                    let mut age = ages[b];
                    let (q0, v0) = (q.0, v.0);
                    let mut seen = [[zero; W]; O];
                    let mut action = [[zero; W]; D];
                    for l in 0..W {
                        let state = State { q: at(&q.0, l), v: at(&v.0, l) };
                        let sees = task.observe(&state);
                        let place = Place { environment: first + from + l, step: step + t as u64 };
                        put(&mut action, l, policy.act(place, &sees));
                        put(&mut seen, l, sees);
                    }
                    for _ in 0..substeps {
                        for l in 0..W {
                            let system =
                                Held { system: A::lane(&systems, l), command: at(&action, l) };
                            let state = State { q: at(&q.0, l), v: at(&v.0, l) };
                            let state = method.step(&system, state, dt);
                            put(&mut q.0, l, state.q);
                            put(&mut v.0, l, state.v);
                        }
                    }
                    let mut reward = [zero; W];
                    let (mut over, mut cut) = ([0_u8; W], [0_u8; W]);
                    let mut ended = 0;
                    for l in 0..W {
                        let before = State { q: at(&q0, l), v: at(&v0, l) };
                        let after = State { q: at(&q.0, l), v: at(&v.0, l) };
                        reward[l] = task.reward(&before, &at(&action, l), &after);
                        paid[l] = paid[l] + reward[l];
                        age[l] += 1;
                        // What is not finite times zero is not zero.
                        let mut nothing = zero;
                        for i in 0..D {
                            nothing = nothing + (after.q[i] * zero + after.v[i] * zero);
                        }
                        let lost = !(nothing == zero);
                        over[l] = u8::from(task.terminated(&after) | lost);
                        cut[l] = u8::from(age[l] >= limit);
                        ended |= over[l] | cut[l];
                    }
                    gather(&mut out.0.observation, &seen, layout, b);
                    gather(&mut out.0.action, &action, layout, b);
                    out.0.reward.as_chunks_mut::<W>().0[b] = reward;
                    out.0.terminated.as_chunks_mut::<W>().0[b] = over;
                    out.0.truncated.as_chunks_mut::<W>().0[b] = cut;
                    if ended != 0 {
                        for l in (0..W.min(len - from)).filter(|&l| over[l] | cut[l] != 0) {
                            let environment = first + from + l;
                            let last = State { q: at(&q.0, l), v: at(&v.0, l) };
                            finals.push(Final {
                                step: t,
                                environment,
                                observation: task.observe(&last),
                                episode_return: paid[l],
                                length: age[l],
                            });
                            episodes[b][l] = episodes[b][l].wrapping_add(1);
                            let episode = u64::from(episodes[b][l]);
                            let next = start.draw(seed, environment as u64, episode);
                            put(&mut q.0, l, next.q);
                            put(&mut v.0, l, next.v);
                            (paid[l], age[l]) = (zero, 0);
                        }
                    }
                    for i in 0..D {
                        blocks[i * per_row + b] = q.0[i];
                        blocks[(D + i) * per_row + b] = v.0[i];
                    }
                    blocks[2 * D * per_row + b] = paid;
                    ages[b] = age;
                }
                write(row, &out.0, begin, len, layout, writes);
            }
        }
        finals
    }
}

/// Puts the numbers of block `b` where they belong in the row.
#[inline(always)]
fn gather<T: Float + Pod, const N: usize, const W: usize>(
    row: &mut [[T; TILE]; N],
    lanes: &[[T; W]; N],
    layout: Layout,
    b: usize,
) {
    match layout {
        Layout::Planes => {
            for i in 0..N {
                row[i].as_chunks_mut::<W>().0[b] = lanes[i];
            }
        }
        Layout::Interleaved => {
            let all: &mut [T] = row.as_flattened_mut();
            let (records, _) = all.as_chunks_mut::<N>();
            let records = &mut records[b * W..][..W];
            for (l, record) in records.iter_mut().enumerate() {
                *record = at(lanes, l);
            }
        }
    }
}

/// Writes the row of a tile.
#[inline(always)]
fn write<T: Pod, const O: usize, const D: usize>(
    row: &mut Row<'_, T, O, D>,
    from: &Gathered<T, O, D>,
    begin: usize,
    len: usize,
    layout: Layout,
    writes: Writes,
) {
    fields(&mut row.observation, &from.observation, begin, len, layout, writes);
    fields(&mut row.action, &from.action, begin, len, layout, writes);
    copy(&from.reward[..len], &mut row.reward[begin..][..len], writes);
    copy(&from.terminated[..len], &mut row.terminated[begin..][..len], writes);
    if !row.truncated.is_empty() {
        copy(&from.truncated[..len], &mut row.truncated[begin..][..len], writes);
    }
}

#[inline(always)]
fn fields<T: Pod, const N: usize>(
    row: &mut [&mut [T]; N],
    from: &[[T; TILE]; N],
    begin: usize,
    len: usize,
    layout: Layout,
    writes: Writes,
) {
    match (layout, &mut row[..]) {
        (Layout::Interleaved, [all, ..]) => {
            copy(&from.as_flattened()[..len * N], &mut all[begin * N..][..len * N], writes);
        }
        _ => {
            for (plane, from) in row.iter_mut().zip(from) {
                copy(&from[..len], &mut plane[begin..][..len], writes);
            }
        }
    }
}

#[inline(always)]
fn copy<X: Pod>(from: &[X], to: &mut [X], writes: Writes) {
    match writes {
        Writes::Plain => to.copy_from_slice(from),
        Writes::Past => stream(from, to),
    }
}
