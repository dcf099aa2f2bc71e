//! Delay lines of states and actions.

use core::ops::Range;

use libration_core::Float;

use super::Delays;
use super::block_size::LANES;

/// The layout of the past of a block: states at the beginning of the last steps of the integrator and the last actions, both in
/// rings.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct History {
    states: usize,
    actions: usize,
    substeps: usize,
    /// Rows of a state.
    coordinates: usize,
    /// Rows of an action, with its own latency where it has one.
    commands: usize,
}

/// Rows of a block: positions or velocities, or commands.
type Rows<'a, T> = &'a [[T; LANES]];
type RowsMut<'a, T> = &'a mut [[T; LANES]];

impl History {
    /// The layout for these latencies, actions being held for `substeps` steps of the integrator.
    pub(super) fn new(delays: Delays, substeps: u32, [coordinates, commands]: [usize; 2]) -> Self {
        let substeps = substeps as usize;
        let places = |most: u32| if most == 0 { 0 } else { most as usize + 1 };
        let [states, latest] = [delays.observation, delays.action].map(|[_, most]| most);
        let actions = if latest == 0 { 0 } else { (latest as usize).div_ceil(substeps) + 1 };
        History { states: places(states), actions, substeps, coordinates, commands }
    }

    /// The number of values per block.
    pub(super) fn len(&self) -> usize {
        (self.states * self.coordinates + self.actions * self.commands) * LANES
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
    pub(super) fn begin<T: Float>(
        &self,
        past: &mut [T],
        l: usize,
        state: impl Iterator<Item = T> + Clone,
    ) {
        let rows = past.as_chunks_mut::<LANES>().0;
        let (states, actions) = rows.split_at_mut(self.states * self.coordinates);
        for place in states.chunks_exact_mut(self.coordinates.max(1)) {
            place.iter_mut().zip(state.clone()).for_each(|(row, x)| row[l] = x);
        }
        actions.iter_mut().for_each(|row| row[l] = T::zero());
    }

    /// Stores the positions and velocities at the beginning of a step of the integrator.
    #[inline(always)]
    pub(super) fn pass<T: Copy>(&self, past: &mut [T], step: u64, q: Rows<'_, T>, v: Rows<'_, T>) {
        let rows = past.as_chunks_mut::<LANES>().0;
        let rows = &mut rows[ring(step, self.states) * self.coordinates..][..q.len() + v.len()];
        rows[..q.len()].copy_from_slice(q);
        rows[q.len()..].copy_from_slice(v);
    }

    /// Lane `l` stood still in these steps of the integrator.
    pub(super) fn hold<T: Float>(
        &self,
        past: &mut [T],
        l: usize,
        steps: Range<u64>,
        state: impl Iterator<Item = T> + Clone,
    ) {
        let rows = past.as_chunks_mut::<LANES>().0;
        for step in steps.filter(|_| self.delays_observations()) {
            let rows = &mut rows[ring(step, self.states) * self.coordinates..];
            rows.iter_mut().zip(state.clone()).for_each(|(row, x)| row[l] = x);
        }
    }

    /// Reads the positions and velocities one latency before the beginning of a step of the integrator.
    #[inline(always)]
    pub(super) fn seen<T: Copy>(
        &self,
        past: &[T],
        step: u64,
        latencies: &[u32; LANES],
        q: RowsMut<'_, T>,
        v: RowsMut<'_, T>,
    ) {
        let rows = past.as_chunks::<LANES>().0;
        let now = ring(step, self.states);
        let degrees = q.len();
        let place = |latency: u32| {
            let place = back(now, latency as usize, self.states);
            rows[place * self.coordinates..][..2 * degrees].split_at(degrees)
        };
        if same(latencies) {
            let (positions, velocities) = place(latencies[0]);
            q.copy_from_slice(positions);
            v.copy_from_slice(velocities);
        } else {
            for (l, &latency) in latencies.iter().enumerate() {
                let (positions, velocities) = place(latency);
                q.iter_mut().zip(positions).for_each(|(q, row)| q[l] = row[l]);
                v.iter_mut().zip(velocities).for_each(|(v, row)| v[l] = row[l]);
            }
        }
    }

    /// Stores the actions of step `now`.
    #[inline(always)]
    pub(super) fn act<T: Copy>(&self, past: &mut [T], now: u64, actions: Rows<'_, T>) {
        let rows = &mut past.as_chunks_mut::<LANES>().0[self.states * self.coordinates..];
        rows[ring(now, self.actions) * self.commands..][..actions.len()].copy_from_slice(actions);
    }

    /// How many actions ago the action was given that is in effect in a substep.
    #[inline(always)]
    pub(super) fn periods(&self, latency: u32, substep: u64) -> usize {
        (u64::from(latency).saturating_sub(substep) as usize).div_ceil(self.substeps)
    }

    /// Stores the latencies of the actions of step `now`, in steps of the integrator.
    // Compiled environments have none.
    #[cfg(not(test))]
    pub(super) fn act_late<T: Copy>(&self, past: &mut [T], now: u64, latencies: &[T; LANES]) {
        let rows = &mut past.as_chunks_mut::<LANES>().0[self.states * self.coordinates..];
        rows[(ring(now, self.actions) + 1) * self.commands - 1] = *latencies;
    }

    /// How many actions ago the newest action that has arrived was given, in a substep of step `now`. All have latencies of their own.
    #[cfg(not(test))]
    pub(super) fn arrived<T: Float>(&self, past: &[T], now: u64, substep: u64) -> [u32; LANES] {
        let rows = &past.as_chunks::<LANES>().0[self.states * self.coordinates..];
        let now = ring(now, self.actions);
        let mut ages = [self.actions as u32 - 1; LANES];
        for age in (0..self.actions).rev() {
            let latencies = &rows[(back(now, age, self.actions) + 1) * self.commands - 1];
            let passed = T::from_f64((age * self.substeps) as f64 + substep as f64);
            for (newest, &latency) in ages.iter_mut().zip(latencies) {
                if latency <= passed {
                    *newest = age as u32;
                }
            }
        }
        ages
    }

    /// The actions that were given so many actions before those of step `now`.
    #[cfg(not(test))]
    pub(super) fn given<T: Copy>(
        &self,
        past: &[T],
        now: u64,
        ages: &[u32; LANES],
        held: RowsMut<'_, T>,
    ) {
        let rows = &past.as_chunks::<LANES>().0[self.states * self.coordinates..];
        let now = ring(now, self.actions);
        for (l, &age) in ages.iter().enumerate() {
            let rows = &rows[back(now, age as usize, self.actions) * self.commands..];
            held.iter_mut().zip(rows).for_each(|(held, row)| held[l] = row[l]);
        }
    }

    /// The actions that are in effect in a substep of step `now`.
    #[inline(always)]
    pub(super) fn effective<T: Copy>(
        &self,
        past: &[T],
        now: u64,
        substep: u64,
        latencies: &[u32; LANES],
        held: RowsMut<'_, T>,
    ) {
        let rows = &past.as_chunks::<LANES>().0[self.states * self.coordinates..];
        let now = ring(now, self.actions);
        let age = |latency: u32| self.periods(latency, substep);
        if same(latencies) {
            let place = back(now, age(latencies[0]), self.actions);
            held.copy_from_slice(&rows[place * self.commands..][..held.len()]);
        } else {
            for (l, &latency) in latencies.iter().enumerate() {
                let place = back(now, age(latency), self.actions);
                let rows = &rows[place * self.commands..];
                held.iter_mut().zip(rows).for_each(|(held, row)| held[l] = row[l]);
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
