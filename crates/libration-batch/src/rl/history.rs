//! Delay lines of states and actions.

use core::ops::Range;

use libration_core::{Float, State};

use super::Delays;
use super::block_size::LANES;

/// The layout of the past of a block: states at the beginning of the last steps of the integrator, `2·D` rows each, and the last
/// actions, `D` rows each, both in rings.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct History {
    states: usize,
    actions: usize,
    substeps: usize,
    /// Degrees of freedom.
    degrees: usize,
}

impl History {
    pub(super) fn new(delays: Delays, substeps: u32, degrees: usize) -> Self {
        let substeps = substeps as usize;
        let places = |most: u32| if most == 0 { 0 } else { most as usize + 1 };
        let [states, latest] = [delays.observation, delays.action].map(|[_, most]| most);
        let actions = if latest == 0 { 0 } else { (latest as usize).div_ceil(substeps) + 1 };
        History { states: places(states), actions, substeps, degrees }
    }

    /// The number of values per block.
    pub(super) fn len(&self) -> usize {
        (self.states * 2 + self.actions) * self.degrees * LANES
    }

    /// Whether observations are delayed.
    pub(super) fn delays_observations(&self) -> bool {
        self.states > 0
    }

    /// Whether actions are delayed.
    pub(super) fn delays_actions(&self) -> bool {
        self.actions > 0
    }

    /// Fills the past of lane `l` with this state and zero actions.
    pub(super) fn begin<T: Float, const D: usize>(
        &self,
        past: &mut [T],
        l: usize,
        state: &State<T, D>,
    ) {
        let rows = past.as_chunks_mut::<LANES>().0;
        let (states, actions) = rows.split_at_mut((self.states * 2 * D).min(rows.len()));
        for place in states.chunks_exact_mut(2 * D) {
            place.iter_mut().zip(state.coordinates()).for_each(|(row, x)| row[l] = x);
        }
        actions.iter_mut().for_each(|row| row[l] = T::zero());
    }

    /// Stores the state at the beginning of a step of the integrator.
    #[inline(always)]
    pub(super) fn pass<T: Copy, const D: usize>(
        &self,
        past: &mut [T],
        step: u64,
        q: &[[T; LANES]; D],
        v: &[[T; LANES]; D],
    ) {
        let rows = past.as_chunks_mut::<LANES>().0;
        let rows = &mut rows[ring(step, self.states) * 2 * D..][..2 * D];
        rows[..D].copy_from_slice(q);
        rows[D..].copy_from_slice(v);
    }

    /// Lane `l` stood still in these steps of the integrator.
    pub(super) fn hold<T: Float, const D: usize>(
        &self,
        past: &mut [T],
        l: usize,
        steps: Range<u64>,
        state: &State<T, D>,
    ) {
        let rows = past.as_chunks_mut::<LANES>().0;
        for step in steps.filter(|_| self.delays_observations()) {
            let rows = &mut rows[ring(step, self.states) * 2 * D..][..2 * D];
            rows.iter_mut().zip(state.coordinates()).for_each(|(row, x)| row[l] = x);
        }
    }

    /// Reads the states one latency before the beginning of a step of the integrator.
    #[inline(always)]
    pub(super) fn seen<T: Copy, const D: usize>(
        &self,
        past: &[T],
        step: u64,
        latencies: &[u32; LANES],
        q: &mut [[T; LANES]; D],
        v: &mut [[T; LANES]; D],
    ) {
        let rows = past.as_chunks::<LANES>().0;
        let now = ring(step, self.states);
        if same(latencies) {
            let rows = &rows[back(now, latencies[0] as usize, self.states) * 2 * D..][..2 * D];
            q.copy_from_slice(&rows[..D]);
            v.copy_from_slice(&rows[D..]);
        } else {
            for (l, &latency) in latencies.iter().enumerate() {
                let rows = &rows[back(now, latency as usize, self.states) * 2 * D..][..2 * D];
                for i in 0..D {
                    q[i][l] = rows[i][l];
                    v[i][l] = rows[D + i][l];
                }
            }
        }
    }

    /// Stores the actions of step `now`.
    #[inline(always)]
    pub(super) fn act<T: Copy, const D: usize>(
        &self,
        past: &mut [T],
        now: u64,
        actions: &[[T; LANES]; D],
    ) {
        let rows = &mut past.as_chunks_mut::<LANES>().0[self.states * 2 * D..];
        rows[ring(now, self.actions) * D..][..D].copy_from_slice(actions);
    }

    /// The actions that are in effect in a substep of step `now`.
    #[inline(always)]
    pub(super) fn effective<T: Copy, const D: usize>(
        &self,
        past: &[T],
        now: u64,
        substep: u64,
        latencies: &[u32; LANES],
        held: &mut [[T; LANES]; D],
    ) {
        let rows = &past.as_chunks::<LANES>().0[self.states * 2 * D..];
        let now = ring(now, self.actions);
        let age = |latency: u32| u64::from(latency).saturating_sub(substep) as usize;
        let age = |latency: u32| age(latency).div_ceil(self.substeps);
        if same(latencies) {
            let place = back(now, age(latencies[0]), self.actions);
            held.copy_from_slice(&rows[place * D..][..D]);
        } else {
            for (l, &latency) in latencies.iter().enumerate() {
                let place = back(now, age(latency), self.actions);
                for i in 0..D {
                    held[i][l] = rows[place * D + i][l];
                }
            }
        }
    }
}

/// The index of a step in a ring of `places` entries.
#[inline(always)]
fn ring(step: u64, places: usize) -> usize {
    (step % places as u64) as usize
}

/// The index `by` entries before another.
#[inline(always)]
fn back(place: usize, by: usize, places: usize) -> usize {
    if place >= by { place - by } else { place + places - by }
}

/// Whether all latencies are equal.
#[inline(always)]
fn same(latencies: &[u32; LANES]) -> bool {
    let mut other = 0;
    for l in 0..LANES {
        other |= latencies[l] ^ latencies[0];
    }
    other == 0
}
